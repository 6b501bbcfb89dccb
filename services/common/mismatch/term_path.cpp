#include "services/common/mismatch/term_path.hpp"

#include <algorithm>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/law_columns.hpp"

namespace sealwatch::mismatch {
namespace {

// Watches a simulation: a column that adds nothing.
class PathRecorder final : public InjectedColumns {
 public:
  PathRecorder(std::size_t site, std::vector<LawColumn> strengths)
      : site_(site), entry_{Entry{.column = 0, .site = site}}, laws_(std::move(strengths)), parts_(laws_.columns()) {}
  [[nodiscard]] std::size_t columns() const override { return 1; }
  [[nodiscard]] std::span<const Entry> entries() const override { return entry_; }
  void weigh(double t, Signals signals, std::span<double> weights) override {
    weights[0] = 0.0;
    laws_.weigh(t, signals, parts_);
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
  std::size_t site_;
  std::array<Entry, 1> entry_;
  LawColumns laws_;
  std::vector<double> parts_;
};

// Where a hidden state of the recording's own (a shaft's angle) starts.
double hidden_start(const SimulatedPoint& at, const Law& law, const std::string& element) {
  if (!law.hidden || !law.hidden->free_initial) return 0.0;
  const std::vector<Unknown>& own = at.problem->recordings[at.recording].own;
  const std::string name = "initial:" + physics_parameter_name(element, law.id, law.hidden->name);
  for (std::size_t k = 0; k < own.size(); ++k)
    if (own[k].name == name) return own[k].to_value(at.own[k]);
  return 0.0;
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
  PathRecorder recorder(sites.front(), std::move(strengths));
  SimulationOptions options = at.problem->simulation_options;
  options.maximum_step_s = std::min(options.maximum_step_s, longest_step_s);
  const std::vector<double> shared(at.shared.begin(), at.shared.end()), own(at.own.begin(), at.own.end());
  const auto run = simulation.run(values_at(*at.problem, at.recording, shared, own), {}, options, &recorder);
  if (!run) return fail(run.error());
  return std::move(recorder.path);
}

}  // namespace sealwatch::mismatch
