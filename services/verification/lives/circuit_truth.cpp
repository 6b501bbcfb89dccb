#include "services/verification/lives/circuit_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::verification {
namespace {

constexpr double kMakeUpSmoothing_Pa = 2e4;  // s of the make-up law
constexpr double kAtRestBefore_s = 20.0;     // the make-up has had so long to fill the circuit
enum Channel { kFlow, kPressureA, kPressureB, kPosition, kVelocity, kChannels };

double make_up_flow(double pressure_Pa, double reservoir_Pa, double conductance) {
  const double excess = (reservoir_Pa - pressure_Pa) / kMakeUpSmoothing_Pa;
  constexpr double kNone = -40.0;  // below the rounding of 1 + exp
  return excess < kNone ? 0.0 : conductance * kMakeUpSmoothing_Pa * std::log1p(std::exp(excess));
}

/// First-order low-pass over steps of one length.
class LowPass {
 public:
  LowPass(double time_constant_s, double step_s, double start)
      : lag_steps_(time_constant_s / step_s),
        decay_(time_constant_s > 0.0 ? std::exp(-step_s / time_constant_s) : 0.0),
        input_(start),
        output_(start) {}
  /// The input goes straight from its last value to `value`.
  double straight(double value) {
    const double lag = (value - input_) * lag_steps_;
    output_ = value - lag + (output_ - input_ + lag) * decay_;
    input_ = value;
    return output_;
  }
  /// The input is `value` during the whole step.
  double constant(double value) { return output_ = value + (output_ - value) * decay_; }
  [[nodiscard]] double output() const { return output_; }

 private:
  double lag_steps_, decay_, input_, output_;
};

Status check_plant(const AssetConfig& asset) {
  if (asset.model != "eha")
    return fail(Error{.file = {},
                      .place = "asset " + asset.asset_id + ", key model",
                      .value = asset.model,
                      .rule = "has no cylinder circuit to verify with",
                      .advice = "verify with an asset of model eha"});
  if (!asset.physics.empty())
    return fail(Error{.file = {},
                      .place = "asset " + asset.asset_id + ", key physics",
                      .value = asset.physics.front().id,
                      .rule = "the verification's truth is the reference model alone",
                      .advice = "use the asset file without physics"});
  return {};
}

Status check_test(const AssetConfig& asset, double stroke_m, double sample_rate_Hz) {
  const double end_m = asset.pst.start_m + asset.pst.stroke_m;
  if (std::min(asset.pst.start_m, end_m) < 0.0 || std::max(asset.pst.start_m, end_m) > stroke_m)
    return fail("asset " + asset.asset_id + ": the partial stroke test leaves the stroke 0 to x_C");
  if (!(asset.pst.speed_m_s > 0.0) || !(std::abs(asset.pst.stroke_m) > 0.0))
    return fail("asset " + asset.asset_id + ": the partial stroke test does not move");
  if (!(sample_rate_Hz > 0.0) || !std::isfinite(sample_rate_Hz)) return fail("the sample rate must be positive");
  return {};
}

}  // namespace

std::vector<std::string> circuit_channels() { return {"flow", "pressure_a", "pressure_b", "position", "velocity"}; }

Result<CircuitTruth> CircuitTruth::make(const AssetConfig& asset, double sample_rate_Hz, double longest_step_s) {
  if (const Status ok = check_plant(asset); !ok) return fail(ok.error());
  const Result<const PlantDescription*> plant = find_plant(asset.model);
  if (!plant) return fail(plant.error());
  const auto parameter = [&](const char* name) {
    const auto own = asset.parameters.find(name);
    return own != asset.parameters.end() ? own->second.value : (*plant)->find_parameter(name)->value;
  };
  CircuitTruth truth;
  Circuit& c = truth.circuit_;
  for (auto [value, name] : {std::pair{&c.A_C, "A_C"},
                             {&c.V_0, "V_0"},
                             {&c.V_P, "V_P"},
                             {&c.x_C, "x_C"},
                             {&c.beta, "beta"},
                             {&c.m_C, "m_C"},
                             {&c.f_C, "f_C"},
                             {&c.phi, "phi"},
                             {&c.p_0, "p_0"},
                             {&c.K_MU, "K_MU"},
                             {&c.g_V, "g_V"},
                             {&c.r_pilot, "r_pilot"}})
    *value = parameter(name);
  c.valve = parameter("c_D") * parameter("a_V") * std::sqrt(2.0 / parameter("rho"));
  if (const Status ok = check_test(asset, c.x_C, sample_rate_Hz); !ok) return fail(ok.error());
  auto sensors = bench::find_sensors(asset, **plant, circuit_channels());
  if (!sensors) return fail(sensors.error());
  truth.sensors_ = std::move(*sensors);

  const bench::Profile profile = bench::pst_profile(asset.pst);
  truth.sample_rate_Hz_ = sample_rate_Hz;
  truth.samples_ = static_cast<std::size_t>(std::floor(profile.duration_s() * sample_rate_Hz * (1.0 + 1e-12))) + 1;
  truth.steps_per_sample_ =
      static_cast<std::size_t>(std::max(1.0, std::ceil(1.0 / (sample_rate_Hz * longest_step_s) - 1e-9)));
  truth.step_s_ = 1.0 / (sample_rate_Hz * static_cast<double>(truth.steps_per_sample_));
  const std::size_t steps = (truth.samples_ - 1) * truth.steps_per_sample_ + 1;
  truth.motion_ = stroke_motion(profile, truth.step_s_, steps);
  truth.prepare_motion();
  return truth;
}

// Position and velocity are the same in all tests: the load does not move a controlled piston from its reference.
void CircuitTruth::prepare_motion() {
  const std::size_t steps = motion_.size();
  jerk_m_s3_.resize(steps);
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min(k + 1, steps - 1);
    jerk_m_s3_[k] = (motion_[after].acceleration_m_s2 - motion_[before].acceleration_m_s2) /
                    (static_cast<double>(after - before) * step_s_);
  }
  LowPass position(sensors_[kPosition].setting.time_constant_s, step_s_, motion_.front().position_m);
  LowPass velocity(sensors_[kVelocity].setting.time_constant_s, step_s_, motion_.front().velocity_m_s);
  for (std::size_t k = 0; k < steps; ++k) {
    if (k > 0) {
      position.straight(motion_[k].position_m);
      velocity.straight(motion_[k].velocity_m_s);
    }
    if (k % steps_per_sample_ != 0) continue;
    position_m_.push_back(position.output());
    velocity_m_s_.push_back(velocity.output());
  }
}

double CircuitTruth::pressure_difference(std::size_t step, const Load& load) const {
  const MotionSample& now = motion_[step];
  return (circuit_.phi * load.factor + circuit_.f_C * now.velocity_m_s + circuit_.m_C * now.acceleration_m_s2) /
         circuit_.A_C;
}

// dp_B/dt: the valves' flow is what the circuit's volume asks for, unless the pilot lets less out of chamber A.
double CircuitTruth::return_pressure_rate(std::size_t step, double p_B, const Load& load) const {
  const Circuit& c = circuit_;
  const MotionSample& now = motion_[step];
  const double dp = pressure_difference(step, load);
  const double dp_rate = (c.f_C * now.acceleration_m_s2 + c.m_C * jerk_m_s3_[step]) / c.A_C;
  const double stiffness_A = c.beta / (c.V_0 + c.A_C * now.position_m);
  const double whole_volume = 2.0 * (c.V_0 + c.V_P) + c.A_C * c.x_C;
  const double open_rate =
      (c.beta * make_up_flow(p_B, c.p_0, c.K_MU) - (c.V_0 + c.A_C * now.position_m + c.V_P) * dp_rate) / whole_volume;
  const double wanted_flow = (open_rate + dp_rate) / stiffness_A + c.A_C * now.velocity_m_s + dp * load.conductance;
  if (wanted_flow >= 0.0) return open_rate;
  const double over_reservoir = std::max(p_B + dp - c.p_0, 0.0);
  const double open_pilot = 0.5 * (1.0 + std::tanh(c.g_V * (c.r_pilot * (p_B - c.p_0) - over_reservoir)));
  const double most_out = -c.valve * open_pilot * std::sqrt(over_reservoir);
  if (wanted_flow >= most_out) return open_rate;
  return stiffness_A * (most_out - c.A_C * now.velocity_m_s - dp * load.conductance) - dp_rate;
}

std::vector<std::vector<double>> CircuitTruth::low_passed(const Load& load) const {
  const Circuit& c = circuit_;
  // After kAtRestBefore_s of make-up, exp((p_B - p_0)/s) has grown at the rate beta K_MU / V.
  const double whole_volume = 2.0 * (c.V_0 + c.V_P) + c.A_C * c.x_C;
  double p_B = c.p_0 + kMakeUpSmoothing_Pa * std::log1p(kAtRestBefore_s * c.beta * c.K_MU / whole_volume);
  double dp = pressure_difference(0, load);
  LowPass flow(sensors_[kFlow].setting.time_constant_s, step_s_, dp * load.conductance);
  LowPass pressure_a(sensors_[kPressureA].setting.time_constant_s, step_s_, p_B + dp);
  LowPass pressure_b(sensors_[kPressureB].setting.time_constant_s, step_s_, p_B);
  std::vector<std::vector<double>> values(kChannels);
  for (std::size_t k = 0; k < kPosition; ++k) values[k].reserve(samples_);
  const auto sample = [&] {
    values[kFlow].push_back(flow.output());
    values[kPressureA].push_back(pressure_a.output());
    values[kPressureB].push_back(pressure_b.output());
  };
  sample();
  double rate = return_pressure_rate(0, p_B, load);
  for (std::size_t k = 1; k < motion_.size(); ++k) {
    const double guess = p_B + step_s_ * rate;
    const double p_B_after = p_B + 0.5 * step_s_ * (rate + return_pressure_rate(k, guess, load));
    const double dp_after = pressure_difference(k, load);
    const double volume = c.V_0 + 0.5 * c.A_C * (motion_[k].position_m + motion_[k - 1].position_m);
    const double rise = p_B_after + dp_after - p_B - dp;
    flow.constant((volume * rise / c.beta + c.A_C * (motion_[k].position_m - motion_[k - 1].position_m)) / step_s_ +
                  0.5 * (dp + dp_after) * load.conductance);
    pressure_a.straight(p_B_after + dp_after);
    pressure_b.straight(p_B_after);
    p_B = p_B_after;
    dp = dp_after;
    rate = return_pressure_rate(k, p_B, load);
    if (k % steps_per_sample_ == 0) sample();
  }
  values[kPosition] = position_m_;
  values[kVelocity] = velocity_m_s_;
  return values;
}

TimeSeries CircuitTruth::simulate_without_noise(double resistance_Pa_s_m3, double load_factor) const {
  TimeSeries samples;
  for (std::size_t k = 0; k < samples_; ++k) samples.time_s.push_back(static_cast<double>(k) / sample_rate_Hz_);
  std::vector<std::vector<double>> values =
      low_passed({.conductance = 1.0 / resistance_Pa_s_m3, .factor = 1.0 + load_factor});
  for (std::size_t k = 0; k < kChannels; ++k)
    samples.channels.push_back({.name = sensors_[k].channel,
                                .unit = sensors_[k].unit,
                                .noise_std = sensors_[k].setting.noise_std,
                                .values = std::move(values[k])});
  return samples;
}

TimeSeries CircuitTruth::simulate(double resistance_Pa_s_m3, double load_factor, std::uint64_t noise_seed) const {
  TimeSeries samples = simulate_without_noise(resistance_Pa_s_m3, load_factor);
  for (std::size_t k = 0; k < kChannels; ++k)
    samples.channels[k] = bench::measure(sensors_[k], std::move(samples.channels[k].values), noise_seed);
  return samples;
}

}  // namespace sealwatch::verification
