#include "services/verification/truth/conditions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {
namespace {

struct UsualSensor {
  std::string_view channel;
  double noise, time_constant_s;
};
constexpr std::array<UsualSensor, 8> kSensors = {{{"motor_current", 0.02, 0.0},
                                                  {"shaft_speed", 0.5, 0.0},
                                                  {"pressure_a", 1e4, 5e-3},
                                                  {"pressure_b", 1e4, 5e-3},
                                                  {"pressure_differential", 1e4, 5e-3},
                                                  {"flow", 4e-8, 50e-3},
                                                  {"position", 5e-6, 2e-3},
                                                  {"velocity", 1e-5, 5e-3}}};

const UsualSensor* usual(const std::string& channel) {
  const auto found = std::ranges::find(kSensors, channel, &UsualSensor::channel);
  return found == kSensors.end() ? nullptr : &*found;
}

constexpr double kRest_s = 1.0;

/// A profile of moves by `way_m`, each followed by a hold.
Profile moves(double start_m, double speed_m_s, const std::vector<double>& ways_m, double hold_s) {
  Profile profile{.kind = TestKind::pst, .start_m = start_m, .pieces = {{kRest_s, 0.0}}, .ramp_speed_m_s = speed_m_s};
  for (const double way : ways_m) {
    profile.pieces.push_back({std::abs(way) / speed_m_s, std::copysign(speed_m_s, way)});
    profile.pieces.push_back({hold_s, 0.0});
  }
  return profile;
}

Profile there_and_back(double start, double speed, double stroke, double hold) {
  return moves(start, speed, {-stroke, stroke}, hold);
}
Profile twice(double start, double speed, double stroke, double hold) {
  return moves(start, speed, {-stroke, stroke, -0.5 * stroke, 0.5 * stroke}, hold);
}
Profile stairs(double start, double speed, double stroke, double hold) {
  return moves(start, speed, {-0.5 * stroke, -0.5 * stroke, 0.5 * stroke, 0.5 * stroke}, hold);
}

constexpr double kStart_m = 0.060, kStroke_m = 0.016, kSpeed_m_s = 1.33e-3, kHold_s = 3.0;

Profile nominal() { return there_and_back(kStart_m, kSpeed_m_s, kStroke_m, kHold_s); }

/// Tests that differ in load, speed, place and profile, and two more under conditions that none of them has.
void choose_wide(TrialPlan& plan, forecast::UniformRandom& random) {
  const auto about = [&](double value, double share) { return value * random.between(1.0 - share, 1.0 + share); };
  const auto load = [&](double value) { return value + random.between(-0.03, 0.03); };
  plan.fit = {{nominal(), load(0.0)},
              {there_and_back(about(0.058, 0.05), about(0.80e-3, 0.1), about(0.015, 0.1), kHold_s), load(-0.20)},
              {twice(about(0.060, 0.03), about(1.33e-3, 0.08), about(0.015, 0.1), 2.0), load(0.15)},
              {stairs(about(0.062, 0.03), about(1.60e-3, 0.03), about(0.016, 0.05), kHold_s), load(-0.10)}};
  plan.holdout = {{stairs(about(0.056, 0.03), about(1.05e-3, 0.03), about(0.014, 0.05), kHold_s), load(0.24)},
                  {twice(about(0.064, 0.03), about(1.70e-3, 0.02), about(0.017, 0.05), 2.0), load(-0.28)}};
}

/// The same test again and again; only the load wanders by a per cent.
std::vector<PlannedTrialTest> nominal_tests(int count, forecast::UniformRandom& random) {
  std::vector<PlannedTrialTest> tests;
  for (int k = 0; k < count; ++k) tests.push_back({nominal(), random.between(-0.01, 0.01)});
  return tests;
}

std::vector<double> sample_times(double duration_s, double jitter, std::uint64_t seed) {
  constexpr double kPeriod_s = 0.01;
  forecast::UniformRandom random(sub_seed(seed, "jitter"));
  std::vector<double> times;
  const auto last = static_cast<std::size_t>(std::floor(duration_s / kPeriod_s + 1e-9));
  for (std::size_t k = 0; k <= last; ++k) {
    const double off = k == 0 || k == last ? 0.0 : jitter * random.between(-1.0, 1.0);
    times.push_back(kPeriod_s * (static_cast<double>(k) + off));
  }
  return times;
}

/// Fault, coloured noise, rounding.
Series measured(const std::string& channel, std::vector<double> values, const TrialPlan& plan, std::uint64_t seed) {
  const auto [gain, bias] = fault_of(plan, channel);
  TrialNoise noise;
  if (const auto own = plan.noise.find(channel); own != plan.noise.end()) noise = own->second;
  NormalRandom normal(sub_seed(seed, channel));
  double error = noise.standard_deviation * normal.next();
  const double innovation = noise.standard_deviation * std::sqrt(1.0 - noise.correlation * noise.correlation);
  for (double& value : values) {
    value = gain * value + bias + error;
    if (noise.quantum > 0.0) value = noise.quantum * std::round(value / noise.quantum);
    error = noise.correlation * error + innovation * normal.next();
  }
  return {.name = channel, .unit = {}, .noise_std = 0.0, .values = std::move(values)};
}

std::string_view unit_of(const std::string& channel) {
  if (channel == "motor_voltage") return "V";
  if (channel == "motor_current") return "A";
  if (channel == "shaft_speed") return "rad/s";
  if (channel == "flow") return "m3/s";
  if (channel == "position") return "m";
  return channel == "velocity" ? "m/s" : "Pa";
}

double fault_size(const TrialPlan& plan, std::string_view kind) {
  for (const SensorFault& fault : plan.faults)
    if (fault.kind == kind) return fault.size;
  return 0.0;
}

/// What the record says of the voltage: u acted, and u(t) = (1 + g) u_recorded(t - tau) + b.
Status record_input(const TrialPlan& plan, const TruthTest& test, const PlannedTrialTest& planned,
                    const std::vector<double>& time_s, std::vector<double>& voltage) {
  if (const double delay_s = fault_size(plan, "input_delay"); delay_s != 0.0) {
    std::vector<double> asked = {0.0};  // before the test and behind it the voltage rests
    std::vector<std::size_t> row_of;
    for (const double time : time_s) {
      const double at = std::clamp(time + delay_s, 0.0, planned.profile.duration_s());
      if (at > asked.back()) asked.push_back(at);
      row_of.push_back(asked.size() - 1);
    }
    const auto acted = run_truth(test, planned.profile, asked);
    if (!acted) return fail(acted.error());
    for (std::size_t k = 0; k < row_of.size(); ++k) voltage[k] = acted->front()[row_of[k]];
  }
  for (double& volts : voltage)
    volts = (volts - fault_size(plan, "input_bias")) / (1.0 + fault_size(plan, "input_gain"));
  return {};
}

Result<Recording> record(const TrialPlan& plan, const PlannedTrialTest& planned, std::string name) {
  const TruthTest test = truth_test(plan, planned);
  Recording recording;
  recording.file = name + ".csv";
  recording.recording_id = std::move(name);
  recording.test = TestKind::pst;
  recording.samples.time_s = sample_times(planned.profile.duration_s(), plan.jitter, planned.seed);
  auto values = run_truth(test, planned.profile, recording.samples.time_s);
  if (!values) return fail(values.error());
  if (plan.channels.front() == "motor_voltage")
    if (const Status ok = record_input(plan, test, planned, recording.samples.time_s, values->front()); !ok)
      return fail(ok.error());
  for (double& time : recording.samples.time_s) time *= 1.0 + fault_size(plan, "clock_rate");
  for (std::size_t k = 0; k < plan.channels.size(); ++k) {
    Series series = measured(plan.channels[k], std::move((*values)[k]), plan, planned.seed);
    series.unit = unit_of(plan.channels[k]);
    recording.samples.channels.push_back(std::move(series));
  }
  return recording;
}

}  // namespace

double usual_noise(const std::string& channel) {
  const UsualSensor* sensor = usual(channel);
  return sensor == nullptr ? 0.0 : sensor->noise;
}

GainAndBias fault_of(const TrialPlan& plan, const std::string& channel) {
  GainAndBias own;
  for (const SensorFault& fault : plan.faults)
    if (fault.channel == channel) {
      if (fault.kind == "sensor_gain") own.gain += fault.size;
      if (fault.kind == "sensor_bias") own.bias += fault.size;
    }
  return own;
}

TruthTest truth_test(const TrialPlan& plan, const PlannedTrialTest& planned) {
  TruthTest test{.parameters = plan.parameters, .effects = plan.effects};
  test.parameters.load *= 1.0 + planned.load_factor;
  for (const std::string& channel : plan.channels) {
    TruthSensor sensor{.channel = channel};
    if (const UsualSensor* own = usual(channel)) sensor.time_constant_s = own->time_constant_s;
    for (const SensorFault& fault : plan.faults)
      if (fault.channel == channel && fault.kind == "sensor_lag") sensor.extra_lag_s = fault.size;
    test.sensors.push_back(std::move(sensor));
  }
  return test;
}

void choose_channels(TrialPlan& plan) {
  plan.channels = {"motor_voltage", "motor_current", "shaft_speed", "pressure_a",
                   "pressure_b",    "flow",          "position",    "velocity"};
  if (plan.stratum == TrialStratum::source_sensors) {
    plan.channels = {"pressure_differential", "flow", "position", "velocity"};
    if ((plan.seed / 4) % 2 == 1) plan.channels = {"pressure_a", "pressure_b", "flow", "position", "velocity"};
  }
}

void choose_conditions(TrialPlan& plan, std::uint64_t own) {
  forecast::UniformRandom random(sub_seed(own, "conditions"));
  choose_wide(plan, random);
  if (plan.stratum == TrialStratum::concealed) {
    const std::vector<PlannedTrialTest> first = nominal_tests(2, random);
    plan.fit[0] = first[0];
    plan.fit[1] = first[1];
  }
  if (plan.stratum == TrialStratum::nominal_only) {
    plan.fit = nominal_tests(4, random);
    plan.holdout = nominal_tests(2, random);
  }
  std::size_t k = 0;
  for (auto* list : {&plan.fit, &plan.holdout})
    for (PlannedTrialTest& test : *list) test.seed = sub_seed(own, "test " + std::to_string(k++));
}

void choose_noise(TrialPlan& plan, std::uint64_t own) {
  forecast::UniformRandom random(sub_seed(own, "noise"));
  const bool coloured = random.unit() < 0.4, rounded = random.unit() < 0.3, jittered = random.unit() < 0.25;
  if (jittered) plan.jitter = 0.2;
  for (const std::string& channel : plan.channels) {
    const double sigma = usual_noise(channel);
    if (!(sigma > 0.0)) continue;
    TrialNoise noise{.standard_deviation = sigma};
    const double draw = random.unit(), correlation = random.between(0.2, 0.7), step = random.between(0.3, 1.0);
    if (coloured && draw < 0.4) noise.correlation = correlation;
    if (rounded && draw > 0.5) noise.quantum = step * sigma;
    plan.noise[channel] = noise;
  }
}

Result<TrialRecordings> record_trial(const TrialPlan& plan) {
  TrialRecordings recordings;
  for (const bool held : {false, true}) {
    const std::vector<PlannedTrialTest>& tests = held ? plan.holdout : plan.fit;
    for (std::size_t k = 0; k < tests.size(); ++k) {
      Result<Recording> one = record(plan, tests[k], (held ? "holdout_" : "fit_") + std::to_string(k));
      if (!one) return fail(one.error());
      (held ? recordings.holdout : recordings.fit).push_back(std::move(*one));
    }
  }
  return recordings;
}

AssetConfig trial_asset() {
  AssetConfig asset;
  asset.asset_id = "TRIAL";
  for (const ParameterDescription& row : (*find_plant(asset.model))->parameters)
    asset.parameters[row.name] = {.value = row.value, .min = row.min, .max = row.max, .estimate = false};
  const TruthParameters p;
  const std::pair<const char*, double> free[] = {{"R_CL", p.seal_resistance},
                                                 {"f_C", p.piston_viscosity},
                                                 {"R_PL", p.pump_resistance},
                                                 {"f_M", p.motor_viscosity},
                                                 {"beta", p.oil_modulus},
                                                 {"R_M", p.winding_resistance},
                                                 {"phi", p.load}};
  for (const auto& [name, value] : free)
    asset.parameters[name] = {.value = value, .min = 0.1 * value, .max = 3.0 * value, .estimate = true};
  return asset;
}

}  // namespace sealwatch::bench
