#include "services/common/mismatch/term_path.hpp"

#include <algorithm>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/model/law_columns.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::string_view kSensor = "sensor:";

// Watches a simulation: a column that adds nothing.
class PathRecorder final : public InjectedColumns {
 public:
  PathRecorder(std::size_t site, std::vector<LawColumn> strengths, const PlantDescription& plant)
      : site_(site),
        entry_{Entry{.column = 0, .site = site}},
        laws_(std::move(strengths), plant),
        parts_(laws_.columns()) {}
  [[nodiscard]] std::size_t columns() const override { return 1; }
  [[nodiscard]] std::span<const Entry> entries() const override { return entry_; }
  void weigh(double t, Signals signals, std::span<double> weights) override {
    weights[0] = 0.0;
    laws_.weigh(t, signals, parts_);
    while (!path.time_s.empty() && path.time_s.back() > t) take_back_last();
    if (path.time_s.empty() || t > path.time_s.back()) {
      path.time_s.push_back(t);
      path.signals.emplace_back();
      path.contribution.emplace_back();
    }
    path.signals.back() = signals[site_];
    path.contribution.back() = 0.0;
    for (const double part : parts_) path.contribution.back() += part;
  }

  TermPath path;

 private:
  void take_back_last() {
    path.time_s.pop_back();
    path.signals.pop_back();
    path.contribution.pop_back();
  }

  std::size_t site_;
  std::array<Entry, 1> entry_;
  LawColumns laws_;
  std::vector<double> parts_;
};

// Where a hidden state of the recording's own (a shaft's angle, bristles) starts.
double hidden_start(const SimulatedPoint& at, const Law& law, const std::string& element) {
  if (!law.hidden || !law.hidden->free_initial) return 0.0;
  const std::vector<Unknown>& own = at.problem->recordings[at.recording].own;
  const std::string name = "initial:" + physics_parameter_name(element, law.id, law.hidden->name);
  for (std::size_t k = 0; k < own.size(); ++k)
    if (own[k].name == name) return own[k].to_value(at.own[k]);
  return 0.0;
}

Result<std::vector<double>> simulated_channel(const SimulatedPoint& at, const ModelValues& values,
                                              std::size_t channel) {
  const auto run = at.problem->recordings[at.recording].simulation->run(values, {}, at.problem->simulation_options);
  if (!run) return fail(run.error());
  const Eigen::VectorXd column = run->values.col(static_cast<Eigen::Index>(channel));
  return std::vector<double>(column.begin(), column.end());
}

// Signals between samples that are far apart change little more: a long record is not followed in finer steps than
// this.
double path_step_s(const PemRecording& part) {
  constexpr double kUsualStep_s = 0.05, kFewestSteps = 480.0, kMostSteps = 4000.0;
  const double duration_s = part.time_s.back() - part.time_s.front();
  return std::clamp(kUsualStep_s, duration_s / kMostSteps, duration_s / kFewestSteps);
}

}  // namespace

SimulatedPoint point_of(const FittedModel& model, std::size_t recording) {
  return {&model.problem, recording, model.optimum.point.shared, model.optimum.point.own[recording]};
}

std::vector<std::size_t> sites_of(const PlantSimulation& simulation, std::string_view element, SiteKind kind) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < simulation.sites().size(); ++k)
    if (simulation.sites()[k].element == element && simulation.sites()[k].kind == kind) found.push_back(k);
  return found;
}

Result<TermPath> term_path(const SimulatedPoint& at, const std::string& element, SiteKind kind, const Law* law,
                           std::span<const double> parameters, double longest_step_s) {
  const PlantSimulation& simulation = *at.problem->recordings[at.recording].simulation;
  const std::vector<std::size_t> sites = sites_of(simulation, element, kind);
  if (sites.empty())
    return fail(Error{.file = {},
                      .place = element,
                      .value = std::string(name_of(kind)),
                      .rule = "is not a site of " + simulation.plant().name,
                      .advice = {}});
  std::vector<LawColumn> strengths;
  if (law != nullptr)
    for (const std::size_t k : strengths_of(*law))
      strengths.push_back({.law = law,
                           .sites = {sites.front()},
                           .parameters = {parameters.begin(), parameters.end()},
                           .strength = k,
                           .unit = parameters[k],
                           .hidden = hidden_start(at, *law, element)});
  PathRecorder recorder(sites.front(), std::move(strengths), simulation.plant());
  SimulationOptions options = at.problem->simulation_options;
  options.maximum_step_s = std::min(options.maximum_step_s, longest_step_s);
  const std::vector<double> shared(at.shared.begin(), at.shared.end()), own(at.own.begin(), at.own.end());
  const auto run = simulation.run(values_at(*at.problem, at.recording, shared, own), {}, options, &recorder);
  if (!run) return fail(run.error());
  return std::move(recorder.path);
}

std::size_t channel_of(const PlantSimulation& simulation, const std::string& element) {
  const auto channels = simulation.channels();
  const std::string name = element.starts_with(kSensor) ? element.substr(kSensor.size()) : element;
  return static_cast<std::size_t>(std::ranges::find(channels, name) - channels.begin());
}

Result<TermPath> sensor_path(const SimulatedPoint& at, const std::string& element, const Law* law) {
  const PemRecording& part = at.problem->recordings[at.recording];
  const std::size_t channel = channel_of(*part.simulation, element);
  const std::vector<double> shared(at.shared.begin(), at.shared.end()), own(at.own.begin(), at.own.end());
  const ModelValues values = values_at(*at.problem, at.recording, shared, own);
  ModelValues absent = values;
  for (const std::size_t k : law == nullptr ? std::vector<std::size_t>{} : strengths_of(*law)) {
    const auto strength = part.simulation->find(physics_parameter_name(element, law->id, law->parameters[k].name));
    if (!strength) return fail(strength.error());
    strength->in(absent) = 0.0;
  }
  const auto reading = simulated_channel(at, values, channel), without = simulated_channel(at, absent, channel);
  if (!reading) return fail(reading.error());
  if (!without) return fail(without.error());
  TermPath path{.time_s = part.time_s, .signals = {}, .contribution = {}};
  for (std::size_t k = 0; k < reading->size(); ++k) {
    path.signals.push_back({(*without)[k]});
    path.contribution.push_back((*reading)[k] - (*without)[k]);
  }
  return path;
}

std::vector<TermPath> term_paths(const FittedModel& with, const std::string& element, const Law& law,
                                 std::span<const double> parameters) {
  std::vector<TermPath> paths;
  for (std::size_t k = 0; k < with.problem.recordings.size(); ++k) {
    const SimulatedPoint at = point_of(with, k);
    Result<TermPath> path = is_sensor(law.kind) ? sensor_path(at, element, &law)
                                                : term_path(at, element, law.kind, &law, parameters,
                                                            path_step_s(with.problem.recordings[k]));
    paths.push_back(path ? std::move(*path) : TermPath{});
  }
  return paths;
}

}  // namespace sealwatch::mismatch
