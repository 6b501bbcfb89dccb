#include "tests/second_generator/bench.hpp"

#include <algorithm>
#include <numbers>

namespace second_generator {

static constexpr double kPeriod = 0.01;  // s
static constexpr double kLength = 31.0;  // s
static constexpr double kWarmUp = 6.0;   // s of holding before the recording begins

struct Move {
  double distance, speed;  // m, m/s
};

// Position and velocity of moves with speed ramps of half a cosine, each followed by a rest.
class Profile {
 public:
  Profile(double start, std::vector<Move> moves, double ramp, double rest)
      : start_(start), moves_(std::move(moves)), ramp_(ramp), rest_(rest) {}

  void at(double t, double& position, double& velocity) const {
    position = start_;
    velocity = 0.0;
    t -= rest_;
    for (const auto& m : moves_) {
      if (t <= 0.0) return;
      const double duration = std::abs(m.distance) / m.speed + ramp_, sign = m.distance > 0.0 ? 1.0 : -1.0;
      if (t < duration) {
        velocity = sign * m.speed * std::min(rise(t), rise(duration - t));
        const double way = t < 0.5 * duration ? area(t) : duration - ramp_ - area(duration - t);
        position += sign * m.speed * way;
        return;
      }
      position += m.distance;
      t -= duration + rest_;
    }
  }

 private:
  double rise(double t) const { return t >= ramp_ ? 1.0 : 0.5 * (1.0 - std::cos(std::numbers::pi * t / ramp_)); }
  double area(double t) const {
    if (t >= ramp_) return t - 0.5 * ramp_;
    return 0.5 * (t - ramp_ / std::numbers::pi * std::sin(std::numbers::pi * t / ramp_));
  }

  double start_;
  std::vector<Move> moves_;
  double ramp_, rest_;
};

static Profile profile_of(int test, Random& random) {
  const double ramp = random.uniform(0.3, 0.7), wait = random.uniform(1.2, 2.0), by = random.uniform(0.97, 1.03);
  const double start = 0.060 + random.uniform(-5e-4, 5e-4);
  switch (test) {
    case 0:
      return {start, {{-0.0140, 1.30e-3 * by}, {0.0140, 1.30e-3 * by}}, ramp, wait};
    case 1:
      return {start, {{-0.0090, 0.80e-3 * by}, {0.0090, 0.80e-3 * by}}, ramp, wait};
    case 2:
      return {start, {{-0.0060, 1.50e-3 * by}, {-0.0050, 1.0e-3 * by}, {0.0110, 1.15e-3 * by}}, ramp, wait};
    case 3:
      return {start,
              {{-0.0080, 1.00e-3 * by}, {0.0040, 0.90e-3 * by}, {-0.0050, 1.4e-3}, {0.0090, 1.4e-3 * by}},
              ramp,
              wait};
    case 4:
      return {
          start, {{-0.0120, 0.95e-3 * by}, {0.0060, 1.62e-3}, {-0.0030, 0.6e-3 * by}, {0.0090, 1.62e-3}}, ramp, wait};
    default:
      return {start, {{-0.0075, 0.6e-3 * by}, {0.0030, 0.65e-3 * by}, {0.0045, 1.64e-3}}, ramp, wait};
  }
}

// The recorded voltage over true time, as far as it is known.
class Command {
 public:
  explicit Command(bool hold) : hold_(hold) {}
  void push(double t, double u) {
    time_.push_back(t);
    value_.push_back(u);
  }
  double at(double t) const {
    if (t <= time_.front()) return value_.front();
    std::size_t k = time_.size() - 1;
    while (k > 0 && time_[k] > t) --k;
    if (hold_ || k + 1 == time_.size()) return value_[k];
    return value_[k] + (value_[k + 1] - value_[k]) * (t - time_[k]) / (time_[k + 1] - time_[k]);
  }
  double last() const { return value_.back(); }

 private:
  bool hold_;
  std::vector<double> time_, value_;
};

// P on position, PI on shaft speed; the integral follows what the limits leave of the command (back-calculation).
class Cascade {
 public:
  double command(double target, double target_velocity, double position, double speed, double step) {
    static const double turns = kParameters[A_C].nominal / kParameters[alpha_P].nominal;  // rad/m
    const double wanted = turns * (target_velocity + 2.5 * (target - position));
    const double free = kParameters[Omega_M].nominal * wanted + 0.03 * (wanted - speed) + integral_;
    const double limited = std::clamp(free, -60.0, 60.0);
    integral_ += step * (0.8 * (wanted - speed) + 5.0 * (limited - free));
    return limited;
  }

 private:
  double integral_ = 4.0;
};

// A sensor's noise of unit variance: white, lowpass-coloured, with a share of 1/f down to 0.5 Hz, or rounded with dither.
class Noise {
 public:
  explicit Noise(Random& random) : random_(random), kind_(random.below(4)) {}

  double next() {
    const double e = random_.normal();
    if (kind_ == 1) {  // AR(1)
      state_[0] = 0.3 * state_[0] + std::sqrt(1.0 - 0.3 * 0.3) * e;
      return state_[0];
    }
    if (kind_ != 2) return e;
    double pink = 0.0, pole = 0.0;  // octaves of first-order noise
    for (std::size_t k = 0; k < state_.size(); ++k) {
      pole = std::exp(-2.0 * std::numbers::pi * 0.5 * std::pow(2.0, double(k)) * kPeriod);
      state_[k] = pole * state_[k] + std::sqrt(1.0 - pole * pole) * random_.normal();
      pink += state_[k] / std::sqrt(double(state_.size()));
    }
    return std::sqrt(1.0 - 0.3 * 0.3) * e + 0.3 * pink;
  }
  double round(double value, double sigma) {
    if (kind_ != 3 || sigma == 0.0) return value;
    const double dither = random_.uniform(-0.5, 0.5) + random_.uniform(-0.5, 0.5);
    return sigma * std::round(value / sigma + dither);
  }
  // Standard deviation of all of it: rounding adds 1/12, the dither 1/6.
  double spread() const { return kind_ == 3 ? std::sqrt(1.25) : 1.0; }

 private:
  Random& random_;
  int kind_;
  std::array<double, 5> state_{};
};

static const Effect* find(const Set& set, Form form) {
  for (const auto& e : set.effects)
    if (e.kind.form == form) return &e;
  return nullptr;
}

static double strength(const Set& set, Form form) {
  const Effect* e = find(set, form);
  return e == nullptr ? 0.0 : e->strength;
}

// What the sensors show of state y, t s after the recording began, without noise.
static std::array<double, 7> seen(const Set& set, const Actuator& actuator, const Vector& y, double t) {
  std::array<double, 7> shown{};
  for (int c = 0; c < 7; ++c) {
    double value = y[kChannels[c].state];
    for (const auto& e : actuator.effects()) {
      if (e.channel != c) continue;
      if (e.kind.form == Form::lag) value = y[e.state];
      if (e.kind.form == Form::gain) value *= 1.0 + e.strength;
      if (e.kind.form == Form::bias) value += e.strength;
      if (e.kind.form == Form::drift) value += e.strength * (1.0 - std::exp(-std::max(t, 0.0) / e.a));
    }
    shown[c] = set.sensor_gain[c] * value + set.sensor_offset[c];
  }
  return shown;
}

static Actuator actuator_of(const Set& set, int test) {
  Values values = set.values;
  values[phi] *= 1.0 + set.load[test];
  if (const Effect* e = find(set, Form::changing_value)) values[index_of(e->note)] *= set.changed[test];
  return Actuator(values, set.effects);
}

// Rows that are lost: up to three gaps of one to three samples.
static std::vector<bool> lost_rows(std::size_t rows, Random& random) {
  std::vector<bool> lost(rows, false);
  for (int gap = random.below(4); gap > 0; --gap) {
    const std::size_t at = 50 + std::size_t(random.below(int(rows) - 100));
    for (int k = random.below(3); k >= 0; --k) lost[at + k] = true;
  }
  return lost;
}

Recording record(const Set& set, int test, double noise) {
  Random habits(std::uint64_t(set.seed) * 7907ULL + 3ULL);  // the same in all tests of a set
  Random random(std::uint64_t(set.seed) * 104729ULL + std::uint64_t(test) * 611953ULL + 5ULL);
  Recording recording;
  recording.hold = habits.chance(0.15);
  const bool jitter = !recording.hold && habits.chance(0.3), gaps = habits.chance(0.3);
  recording.noise_known = habits.chance(0.5);
  std::vector<Noise> sources;
  for (int c = 0; c < 7; ++c) sources.emplace_back(habits);
  for (int c = 0; c < 7; ++c) recording.noise[c] = kChannels[c].noise * noise * sources[c].spread();
  // Sources draw from the habits' stream: let each test have its own.
  habits = Random(random.bits());

  const Actuator actuator = actuator_of(set, test);
  const Profile profile = profile_of(test, random);
  const double gain = 1.0 + strength(set, Form::input_gain), bias = strength(set, Form::input_bias);
  const double delay = strength(set, Form::input_delay), clock = 1.0 + strength(set, Form::clock_rate);
  Command command(recording.hold);
  Radau solver(
      [&](double t, const Vector& y, Vector& dy) { actuator.rates(gain * command.at(t - delay) + bias, y, dy); },
      actuator.tolerances());
  double target, target_velocity;
  profile.at(0.0, target, target_velocity);
  Vector y = actuator.resting(target, kParameters[p_0].nominal + random.uniform(2e4, 2e5));
  const int before = int(kWarmUp / kPeriod), rows = int(kLength / kPeriod);
  const auto lost = lost_rows(std::size_t(rows) + 1, random);
  Cascade cascade;
  double t = -kWarmUp;
  command.push(t, 4.0);
  for (int k = -before; k <= rows; ++k) {
    if (k == 0) actuator.cool(y);
    double next = (k + 1) * kPeriod;
    if (jitter) next += random.uniform(-1.5e-3, 1.5e-3);
    auto shown = seen(set, actuator, y, t);
    for (int c = 0; c < 7; ++c) {
      const double sigma = kChannels[c].noise * noise;
      shown[c] = sources[c].round(shown[c] + sigma * sources[c].next(), sigma);
    }
    profile.at(t, target, target_velocity);
    // The drive has a fine encoder of its own: its command does not carry the recorded sensors' noise.
    const double u = cascade.command(target, target_velocity, y[kX], y[kOmega], next - t);
    if (recording.hold) command.push(t, std::round(u * 1e5) * 1e-5);
    if (k >= 0 && !(gaps && lost[k])) {
      recording.time.push_back(t * clock);
      recording.voltage.push_back(command.last());
      recording.samples.push_back(shown);
    }
    if (!recording.hold) command.push(next, std::round(u * 1e5) * 1e-5);
    if (k < rows) solver.advance(t, next, y);
    t = next;
  }
  return recording;
}

}  // namespace second_generator
