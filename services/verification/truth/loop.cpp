#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

#include "services/verification/truth/plant.hpp"
#include "services/virtual_bench/rosenbrock.hpp"

namespace sealwatch::bench {
namespace {

using namespace truth_index;
constexpr std::size_t kIntegral = 9;  // of the velocity controller, behind the plant's states
constexpr std::size_t kFixedStates = 10;
/// Usual sizes: the integrator sees state / size.
constexpr std::array<double, kFixedStates> kUsual = {10.0, 5.0, 50.0, 1e6, 1e6, 1e6, 1e6, 1e-3, 1e-2, 10.0};

constexpr std::array<std::string_view, 9> kQuantities = {"motor_voltage", "motor_current", "shaft_speed",
                                                         "pressure_a",    "pressure_b",    "pressure_differential",
                                                         "flow",          "velocity",      "position"};
constexpr std::array<double, 9> kQuantitySize = {10.0, 5.0, 50.0, 1e6, 1e6, 1e6, 1e-6, 1e-3, 1e-2};

std::size_t quantity_of(std::string_view channel) {
  const auto found = std::ranges::find(kQuantities, channel);
  return std::min<std::size_t>(static_cast<std::size_t>(found - kQuantities.begin()), kQuantities.size() - 1);
}

/// All states: plant, controller, memories of effects, two low-passes a sensor (those with a time of 0 are passed by).
class Loop {
 public:
  Loop(const TruthTest& test, double ramp_speed_m_s) : test_(test), p_(test.parameters) {
    controller_ = {.setting = test.controller,
                   .feed_forward_V_s_m = p_.back_emf * p_.piston_area / p_.displacement,
                   .ramp_speed_m_s = ramp_speed_m_s};
    usual_.assign(kUsual.begin(), kUsual.end());
    for (const HiddenEffect& effect : test.effects) {
      memory_.push_back(usual_.size());
      if (effect.form->has_memory) usual_.push_back(effect.form->memory_size);
    }
    for (const TruthSensor& sensor : test.sensors) {
      first_filter_.push_back(usual_.size());
      quantity_.push_back(quantity_of(sensor.channel));
      const double size = kQuantitySize[quantity_.back()];
      for (const double lag : {sensor.time_constant_s, sensor.extra_lag_s})
        if (lag > 0.0) usual_.push_back(size);
    }
  }

  void follow(double from_s, double reference_m, double speed_m_s) {
    from_s_ = from_s;
    reference_m_ = reference_m;
    speed_m_s_ = speed_m_s;
  }

  void rates(double t, const double* scaled, double* out) const {
    const TruthState y = plant(scaled);
    const ControllerOutput control = command(t, y, scaled);
    std::vector<double> memory_rates(test_.effects.size());
    const TruthAdditions more = additions(t, y, control.voltage_V, scaled, memory_rates.data());
    const TruthState dy = truth_rates(y, control.voltage_V, p_, more);
    for (std::size_t k = 0; k < dy.size(); ++k) out[k] = dy[k] / usual_[k];
    out[kIntegral] = control.integral_rate_V_s / usual_[kIntegral];
    for (std::size_t k = 0; k < test_.effects.size(); ++k)
      if (test_.effects[k].form->has_memory) out[memory_[k]] = memory_rates[k] / usual_[memory_[k]];
    for (std::size_t k = 0; k < test_.sensors.size(); ++k) {
      const TruthSensor& sensor = test_.sensors[k];
      std::size_t own = first_filter_[k];
      double value = 0.0;
      if (sensor.time_constant_s > 0.0 || sensor.extra_lag_s > 0.0)
        value = shown(k, y, control.voltage_V, more) / usual_[own];
      for (const double lag : {sensor.time_constant_s, sensor.extra_lag_s}) {
        if (!(lag > 0.0)) continue;
        out[own] = (value - scaled[own]) / lag;
        value = scaled[own++];
      }
    }
  }

  void read(double t, const std::vector<double>& scaled, std::size_t sample,
            std::vector<std::vector<double>>& values) const {
    const TruthState y = plant(scaled.data());
    const double voltage = command(t, y, scaled.data()).voltage_V;
    const TruthAdditions more = additions(t, y, voltage, scaled.data(), nullptr);
    for (std::size_t k = 0; k < test_.sensors.size(); ++k) {
      const TruthSensor& sensor = test_.sensors[k];
      const auto filters =
          static_cast<std::size_t>(sensor.time_constant_s > 0.0) + static_cast<std::size_t>(sensor.extra_lag_s > 0.0);
      const std::size_t last = first_filter_[k] + filters - 1;
      values[k][sample] = filters > 0 ? scaled[last] * usual_[last] : shown(k, y, voltage, more);
    }
  }

  /// At rest at `x`, roughly: where settling starts from.
  [[nodiscard]] std::vector<double> guess(double x) const {
    const double drop = p_.load / p_.piston_area;
    const double omega = drop * (1.0 / p_.seal_resistance + 1.0 / p_.pump_resistance) / p_.displacement;
    const double current =
        ((p_.motor_viscosity + p_.pump_viscosity) * omega + p_.displacement * drop) / p_.torque_constant;
    const double voltage = p_.winding_resistance * current + p_.back_emf * omega;
    const double high = p_.reservoir_pressure + std::max(drop, 0.0);
    const double low = p_.reservoir_pressure + std::max(-drop, 0.0);
    const TruthState y = {voltage, current, omega, high, low, high, low, 0.0, x};
    std::vector<double> scaled(usual_.size(), 0.0);
    for (std::size_t k = 0; k < y.size(); ++k) scaled[k] = y[k] / usual_[k];
    scaled[kIntegral] = voltage / usual_[kIntegral];
    for (std::size_t k = 0; k < test_.sensors.size(); ++k) {
      std::size_t own = first_filter_[k];
      for (const double lag : {test_.sensors[k].time_constant_s, test_.sensors[k].extra_lag_s})
        if (lag > 0.0) {
          scaled[own] = shown(k, y, voltage, {}) / usual_[own];
          ++own;
        }
    }
    return scaled;
  }

  void make_cold(std::vector<double>& scaled) const {
    for (std::size_t k = 0; k < test_.effects.size(); ++k)
      if (test_.effects[k].form->cold_start) scaled[memory_[k]] = 0.0;
  }

 private:
  [[nodiscard]] TruthState plant(const double* scaled) const {
    TruthState y;
    for (std::size_t k = 0; k < y.size(); ++k) y[k] = scaled[k] * usual_[k];
    return y;
  }

  [[nodiscard]] ControllerOutput command(double t, const TruthState& y, const double* scaled) const {
    if (t >= 0.0 && !test_.command_V.empty()) return {.voltage_V = replayed(t)};
    const double reference = reference_m_ + speed_m_s_ * (t - from_s_);
    return controller_(reference, y[kPosition], y[kSpeed], scaled[kIntegral] * usual_[kIntegral]);
  }

  [[nodiscard]] double replayed(double t) const {
    const std::vector<double>& command = test_.command_V;
    const double at = t / test_.command_step_s;
    const auto k = static_cast<std::size_t>(at);
    if (k + 1 >= command.size()) return command.back();
    return command[k] + (at - static_cast<double>(k)) * (command[k + 1] - command[k]);
  }

  [[nodiscard]] TruthAdditions additions(double t, const TruthState& y, double command_V, const double* scaled,
                                         double* memory_rates) const {
    TruthAdditions more;
    const TruthSignals at{.time_s = t,
                          .command_V = command_V,
                          .voltage_V = y[kVoltage],
                          .current_A = y[kCurrent],
                          .shaft_speed = y[kShaft],
                          .port_1_Pa = y[kPort1],
                          .port_2_Pa = y[kPort2],
                          .chamber_Pa = {y[kChamberA], y[kChamberB]},
                          .speed_m_s = y[kSpeed],
                          .position_m = y[kPosition],
                          .winding_resistance_ohm = p_.winding_resistance};
    for (std::size_t k = 0; k < test_.effects.size(); ++k) {
      const HiddenEffect& effect = test_.effects[k];
      const double memory = effect.form->has_memory ? scaled[memory_[k]] * usual_[memory_[k]] : 0.0;
      const double rate = effect.form->act(at, effect, memory, more);
      if (memory_rates != nullptr) memory_rates[k] = rate;
    }
    return more;
  }

  [[nodiscard]] double shown(std::size_t sensor, const TruthState& y, double command_V,
                             const TruthAdditions& more) const {
    switch (quantity_[sensor]) {
      case 0:
        return command_V;
      case 1:
        return y[kCurrent];
      case 2:
        return y[kShaft];
      case 3:
        return y[kChamberA];
      case 4:
        return y[kChamberB];
      case 5:
        return y[kChamberA] - y[kChamberB];
      case 6:
        return truth_inlet_flow(y, p_, more);
      case 7:
        return y[kSpeed];
      default:
        return y[kPosition];
    }
  }

  const TruthTest& test_;
  const TruthParameters& p_;
  CascadeController controller_;
  std::vector<double> usual_;
  std::vector<std::size_t> memory_, first_filter_, quantity_;
  double from_s_ = 0.0, reference_m_ = 0.0, speed_m_s_ = 0.0;
};

std::vector<std::vector<double>> run(const TruthTest& test, const Profile& profile,
                                     const std::vector<double>& times_s) {
  std::vector<std::vector<double>> values(test.sensors.size(), std::vector<double>(times_s.size(), 0.0));
  Loop loop(test, profile.ramp_speed_m_s);
  const Rates rates = [&](double t, const double* y, double* dy) { loop.rates(t, y, dy); };
  std::size_t sample = 0;
  const TakeSample take = [&](double t, const std::vector<double>& y) { loop.read(t, y, sample++, values); };
  const StepControl control{.tolerance = test.tolerance, .most_steps = 2000000};

  std::vector<double> state = loop.guess(profile.start_m);
  loop.follow(-test.settling_time_s, profile.start_m, 0.0);
  (void)integrate_rosenbrock(rates, state, -test.settling_time_s, 0.0, {}, take, control);
  loop.make_cold(state);
  if (!times_s.empty() && times_s.front() == 0.0) take(0.0, state);
  double from_s = 0.0, reference_m = profile.start_m;
  for (const ProfilePiece& piece : profile.pieces) {
    loop.follow(from_s, reference_m, piece.speed_m_s);
    const double to_s = from_s + piece.duration_s;
    (void)integrate_rosenbrock(rates, state, from_s, to_s, times_s, take, control);
    from_s = to_s;
    reference_m += piece.speed_m_s * piece.duration_s;
  }
  for (; sample < times_s.size();) take(times_s[sample], state);  // a hair behind the last piece's end
  return values;
}

}  // namespace

Result<std::vector<std::vector<double>>> run_truth(const TruthTest& test, const Profile& profile,
                                                   const std::vector<double>& times_s) {
  std::vector<std::vector<double>> values;
  try {
    values = run(test, profile, times_s);
  } catch (const std::exception& problem) {  // Odeint reports by exceptions
    return fail(std::string("the trial's actuator cannot be simulated: ") + problem.what());
  }
  for (const std::vector<double>& channel : values)
    for (const double value : channel)
      if (!std::isfinite(value)) return fail("the trial's actuator cannot be simulated: no finite result");
  return values;
}

}  // namespace sealwatch::bench
