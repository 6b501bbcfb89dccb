#include "services/virtual_bench/simulate_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/numbers.hpp"
#include "services/virtual_bench/closed_loop.hpp"

namespace sealwatch::bench {
namespace {

Result<const PlantDescription*> plant_of(const AssetConfig& asset) {
  if (asset.model != "eha")
    return fail(Error{.file = {},
                      .place = "asset " + asset.asset_id + ", key model",
                      .value = asset.model,
                      .rule = "is not a plant of the virtual bench",
                      .advice = "the bench simulates eha"});
  return find_plant("eha");
}

/// The table's defaults, over them the asset's values, over them the test's.
Result<EhaParameters<double>> parameters_of(const AssetConfig& asset, const PlantDescription& plant,
                                            const TestConditions& conditions) {
  EhaParameters<double> out{};
  EhaParameters<double>::visit(
      [&](std::string_view name, double& value) {
        if (const ParameterDescription* described = plant.find_parameter(name)) value = described->value;
        if (const auto own = asset.parameters.find(std::string(name)); own != asset.parameters.end())
          value = own->second.value;
        if (const auto now = conditions.parameters.find(std::string(name)); now != conditions.parameters.end())
          value = now->second;
      },
      out);
  out.load_factor = conditions.load_factor;
  std::vector<std::string> names;
  for (const ParameterDescription& parameter : plant.parameters) names.push_back(parameter.name);
  for (const auto& [name, value] : conditions.parameters)
    if (plant.find_parameter(name) == nullptr)
      return fail(Error{.file = {},
                        .place = "parameter",
                        .value = name,
                        .rule = "is not a parameter of plant " + plant.name,
                        .advice = suggest(name, names)});
  return out;
}

Status check(const EhaParameters<double>& p, const PlantDescription& plant, const Profile& profile,
             const TestSetting& setting) {
  Status status;
  EhaParameters<double>::visit(
      [&](std::string_view name, double value) {
        const ParameterDescription* described = plant.find_parameter(name);
        if (described != nullptr && status && (!std::isfinite(value) || (described->positive && value <= 0.0)))
          status = fail(Error{.file = {},
                              .place = "parameter " + std::string(name),
                              .value = text::general(value),
                              .rule = "must be a positive number",
                              .advice = {}});
      },
      p);
  if (!status) return status;
  if (!(setting.sample_rate_Hz > 0.0) || !std::isfinite(setting.sample_rate_Hz))
    return fail("the sample rate must be positive");
  double low = profile.start_m, high = profile.start_m, time_s = 0.0;
  for (const ProfilePiece& piece : profile.pieces) {
    time_s += piece.duration_s;
    low = std::min(low, profile.reference_m(time_s));
    high = std::max(high, profile.reference_m(time_s));
  }
  if (!(profile.ramp_speed_m_s > 0.0) || !std::isfinite(time_s))
    return fail("the profile's speed must be positive and its duration finite");
  constexpr double kRounding_m = 1e-9;
  if (low < -kRounding_m || high > p.x_C + kRounding_m) return fail("the profile leaves the stroke 0 to x_C");
  return {};
}

std::vector<double> sample_times(double duration_s, double rate_Hz) {
  const auto last = static_cast<std::size_t>(std::floor(duration_s * rate_Hz * (1.0 + 1e-12)));
  std::vector<double> times(last + 1);
  for (std::size_t k = 0; k <= last; ++k) times[k] = static_cast<double>(k) / rate_Hz;
  return times;
}

/// A channel as it was recorded of what acted: values at `delay_s` later by a clock of its own, linear between the samples.
std::vector<double> recorded_of(const std::vector<double>& acted, const std::vector<double>& time_s,
                                const RecordError& error) {
  std::vector<double> recorded;
  for (const double time : time_s) {
    const double acted_at = (time + error.delay_s) / (1.0 + error.input_clock_rate);
    const double at = std::clamp(acted_at, time_s.front(), time_s.back());
    const auto after =
        std::clamp<std::ptrdiff_t>(std::ranges::lower_bound(time_s, at) - time_s.begin(), 1, std::ssize(time_s) - 1);
    const auto k = static_cast<std::size_t>(after);
    const double share = (at - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
    recorded.push_back((std::lerp(acted[k - 1], acted[k], share) - error.bias) / (1.0 + error.gain));
  }
  return recorded;
}

}  // namespace

Result<Recording> simulate_test(const AssetConfig& asset, const Profile& profile, const TestConditions& conditions,
                                const TestSetting& setting) {
  const Result<const PlantDescription*> plant = plant_of(asset);
  if (!plant) return fail(plant.error());
  ClosedLoop loop;
  loop.controller = setting.controller;
  const Result<EhaParameters<double>> parameters = parameters_of(asset, **plant, conditions);
  if (!parameters) return fail(parameters.error());
  loop.parameters = *parameters;
  if (const Status ok = check(*parameters, **plant, profile, setting); !ok) return fail(ok.error());
  Result<std::vector<Sensor>> sensors = find_sensors(asset, **plant, setting.channels);
  if (!sensors) return fail(sensors.error());
  loop.sensors = std::move(*sensors);
  Result<BenchPhysics> physics = BenchPhysics::create(asset, **plant);
  if (!physics) return fail(physics.error());
  loop.physics = std::move(*physics);
  for (Sensor& sensor : loop.sensors) sensor.error = loop.physics.error_of(sensor.channel);

  Recording recording;
  recording.asset_id = asset.asset_id;
  recording.test = profile.kind;
  recording.samples.time_s = sample_times(profile.duration_s(), setting.sample_rate_Hz);
  Result<std::vector<std::vector<double>>> values = integrate(loop, profile, recording.samples.time_s);
  if (!values) return fail(values.error());
  for (std::size_t k = 0; k < loop.sensors.size(); ++k) {
    const RecordError error = loop.physics.record_error_of(loop.sensors[k].channel);
    recording.samples.channels.push_back(measure(loop.sensors[k],
                                                 recorded_of((*values)[k], recording.samples.time_s, error),
                                                 setting.seed, recording.samples.time_s));
  }
  for (double& time : recording.samples.time_s) time *= 1.0 + loop.physics.record_error_of({}).clock_rate;
  return recording;
}

}  // namespace sealwatch::bench
