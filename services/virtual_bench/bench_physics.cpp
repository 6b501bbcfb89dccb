#include "services/virtual_bench/bench_physics.hpp"

#include <algorithm>

#include "services/common/model/physics_terms.hpp"

namespace sealwatch::bench {

Result<BenchPhysics> BenchPhysics::create(const AssetConfig& asset, const PlantDescription& plant) {
  const Result<PhysicsTerms> resolved = resolve_physics(plant, Eha::kSites, asset);
  if (!resolved) return fail(resolved.error());
  const auto numbers = [&](std::size_t first, std::size_t count) {
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k)
      values.push_back(resolved->parameters[first - plant.parameters.size() + k].setting.value);
    return values;
  };
  BenchPhysics physics;
  physics.scales_ = resolved->hidden_scales;
  for (const ActiveTerm& term : resolved->active) {
    physics.terms_.push_back({.law = term.law,
                              .sites = term.sites,
                              .parameters = numbers(term.first_parameter, term.law->parameters.size()),
                              .hidden = term.hidden,
                              .roundings = term.roundings});
    if (term.hidden >= 0) physics.settled_.push_back(term.law->hidden->settled);
  }
  for (const sealwatch::SensorTerm& term : resolved->sensors)
    physics.sensors_.push_back({.channel = term.channel,
                                .kind = term.kind,
                                .parameters = numbers(term.parameter, term.kind >= SiteKind::sensor_drift ? 2U : 1U)});
  for (const RecordingTerm& term : resolved->recording)
    physics.recording_.push_back({.channel = term.input, .kind = term.kind, .parameters = numbers(term.parameter, 1U)});
  return physics;
}

bool BenchPhysics::sees_command_rate() const {
  return std::ranges::any_of(terms_, [](const Term& term) { return term.law->kind == SiteKind::voltage_command; });
}

LawOutput BenchPhysics::evaluate(const Term& term, std::size_t site, const Eha::State<double>& y,
                                 const Eha::Input& input, const EhaParameters<double>& p, const double* hidden,
                                 const Added& added) {
  const auto signals = Eha::signals<double>(site, y, input, p, added);
  return term.law->evaluate(
      law_input(signals, term.hidden >= 0 ? hidden[term.hidden] : 0.0, term.parameters, term.roundings));
}

BenchPhysics::Added BenchPhysics::added(const Eha::State<double>& y, const Eha::Input& input,
                                        const EhaParameters<double>& p, const double* hidden, double* rates) const {
  Added sum{};
  for (const Term& term : terms_)
    for (const std::size_t site : term.sites)
      sum[site] += evaluate(term, site, y, input, p, hidden, sum).contribution.value;
  if (rates != nullptr)
    for (const Term& term : terms_)
      if (term.hidden >= 0) rates[term.hidden] = evaluate(term, term.sites.back(), y, input, p, hidden, sum).rate.value;
  return sum;
}

SensorError BenchPhysics::error_of(const std::string& channel) const {
  SensorError error;
  for (const SensorTerm& term : sensors_) {
    if (term.channel != channel) continue;
    if (term.kind == SiteKind::sensor_lag) error.lag_s = term.parameters[0];
    if (term.kind == SiteKind::sensor_gain) error.gain = term.parameters[0];
    if (term.kind == SiteKind::sensor_bias) error.bias = term.parameters[0];
    if (term.kind == SiteKind::sensor_drift) {
      error.drift = term.parameters[0];
      error.drift_time_s = term.parameters[1];
    }
    if (term.kind == SiteKind::sensor_saturation) {
      error.cut = term.parameters[0];
      error.end = term.parameters[1];
    }
  }
  return error;
}

RecordError BenchPhysics::record_error_of(const std::string& channel) const {
  RecordError error;
  for (const SensorTerm& term : recording_) {
    if (term.kind == SiteKind::clock_rate) error.clock_rate = term.parameters[0];
    if (term.channel != channel) continue;
    if (term.kind == SiteKind::input_gain) error.gain = term.parameters[0];
    if (term.kind == SiteKind::input_bias) error.bias = term.parameters[0];
    if (term.kind == SiteKind::input_delay) error.delay_s = term.parameters[0];
    if (term.kind == SiteKind::input_clock_rate) error.input_clock_rate = term.parameters[0];
  }
  return error;
}

}  // namespace sealwatch::bench
