#include "services/common/mismatch/drawn_terms.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/missing_term.hpp"
#include "services/common/mismatch/regime.hpp"
#include "services/common/mismatch/smooth_input.hpp"

namespace sealwatch::mismatch {
namespace {

// Of the law as it will be drawn: averaged. What changes faster cannot be read.
double mean_square(const TermPath& path) {
  if (path.contribution.empty()) return 0.0;
  const std::vector<double> drawn = hat_means(make_knots(path.time_s), path.time_s, path.contribution);
  double sum = 0.0;
  for (const double value : drawn) sum += value * value;
  return sum / static_cast<double>(drawn.size());
}

// Windows of the recording in which the law is read best, in the order of time.
std::vector<std::size_t> windows_of_most(const std::vector<TermPath>& paths, const Data& data) {
  const auto recording_of = [&](std::size_t k) { return data.groups.empty() ? static_cast<int>(k) : data.groups[k]; };
  std::map<int, double> energy;
  for (std::size_t k = 0; k < paths.size(); ++k) energy[recording_of(k)] += mean_square(paths[k]);
  const auto most = std::ranges::max_element(energy, {}, [](const auto& entry) { return entry.second; });
  std::vector<std::size_t> windows;
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (recording_of(k) == most->first) windows.push_back(k);
  return windows;
}

}  // namespace

void draw_missing_terms(const FittedModel& baseline, const Trial& best, const Data& data, bool whole,
                        Explanation& result) {
  const bool named = !result.effects.empty();
  const PlantSimulation& simulation = *best.model->problem.recordings.front().simulation;
  for (const Effect& effect : best.effects) {
    const SiteKind kind = effect.law->kind;
    const std::vector<double> parameters = parameters_in(effect, best.model->asset);
    if (parameters.empty() || is_of_recording(kind)) continue;  // the equation of a recording's error says all
    const std::vector<TermPath> paths = term_paths(*best.model, effect.element, *effect.law, parameters);
    const std::size_t signal =
        deciding_signal(paths, kind, signals_seen(paths, *effect.law, parameters, simulation.plant()));
    std::optional<MissingTerm> drawn;
    for (const std::size_t k : windows_of_most(paths, data)) {
      Result<MissingTerm> piece =
          missing_term(baseline, best.model.get(), data, k, effect.element, kind, effect.law, parameters, signal);
      if (!piece) continue;
      if (drawn)
        append(*drawn, std::move(*piece));
      else
        drawn = std::move(*piece);
    }
    if (drawn) {
      if (named)
        drawn->what = law_at(effect, simulation.plant());
      else  // what the data demand there alone
        for (auto* values : {&drawn->law, &drawn->path_state, &drawn->path_law}) values->clear();
      result.missing.push_back(std::move(*drawn));
    }
    for (FoundEffect& found : result.effects)
      if (found.what.id == effect.law->id && found.what.element == effect.element)
        found.regime = regime_of(paths, kind, signals_of(simulation, effect.element, kind), whole);
  }
}

}  // namespace sealwatch::mismatch
