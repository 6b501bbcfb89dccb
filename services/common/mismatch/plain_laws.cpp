#include "services/common/mismatch/plain_laws.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/mismatch/criterion.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kRoughly = 2.0;  // factor by which the criterion may be off in a gross misfit
constexpr double kAsGood = 1.0;   // criterion within which two searches ended at the same

// Whether some law's shape is at the end of its range: there a law is the limit of another one (bristles that bend by
// nothing are plain dry friction).
bool at_a_limit(const Trial& trial) {
  const PemProblem& problem = trial.model->problem;
  const PlantSimulation& simulation = *problem.recordings.front().simulation;
  for (const PhysicsParameter& parameter : simulation.physics_parameters()) {
    if (parameter.parameter->strength || !parameter.setting.estimate) continue;
    const std::optional<double> value = estimate_of(*trial.model, parameter.name);
    if (!value) continue;
    const double margin = 1e-6 * (parameter.setting.max - parameter.setting.min);
    if (*value - parameter.setting.min < margin || parameter.setting.max - *value < margin) return true;
  }
  return false;
}

// Where the search for the plain law sets out: at what the rich one ended with, by name, or by being the strength.
double start_value(const LawParameter& parameter, const Law& rich, const PhysicsTerm& term,
                   const PlantDescription& plant) {
  if (const auto known = term.parameters.find(std::string(parameter.name)); known != term.parameters.end())
    return known->second.value;
  const LawParameter& strength = rich.parameters[strengths_of(rich).front()];
  const double rich_value = term.parameters.at(std::string(strength.name)).value;
  if (parameter.strength && parameter.unit == strength.unit) return rich_value;
  if (parameter.strength && parameter.significant > 0.0 && strength.significant > 0.0)
    return rich_value * sealwatch::significant_size(plant, parameter) /
           sealwatch::significant_size(plant, strength);  // as large to an engineer
  return law_size(plant, parameter) * std::ranges::min(parameter.start);
}

// The trial with the plain law in place of the rich one.
Trial with_plain_law(const Trial& rich, std::size_t slot, const Law& plain, AssetConfig& asset) {
  Trial trial = rich;
  asset = rich.model->asset;
  const auto term = asset.physics.end() - static_cast<std::ptrdiff_t>(trial.effects.size() - slot);
  const PlantDescription& plant = rich.model->problem.recordings.front().simulation->plant();
  std::vector<double> parameters;
  for (const LawParameter& parameter : plain.parameters)
    parameters.push_back(start_value(parameter, *trial.effects[slot].law, *term, plant));
  const std::string element = trial.effects[slot].element;
  asset.physics.erase(term);
  trial.effects.erase(trial.effects.begin() + static_cast<std::ptrdiff_t>(slot));
  trial.effects.push_back({&plain, element});
  asset = with_law(std::move(asset), plain, element, parameters);
  return trial;
}

// By how much the criterion of a law must be lower for it to stay where a plainer one is.
double ahead_of_plain(const FittedModel& model) { return excess(model) > kGross ? kRoughly * kWorthAnother : kAsGood; }

// The plain law's search is not worth going on once it cannot come to where it is preferred, with its fewer parameters.
SearchBound worth_preferring(const FittedModel& rich, std::size_t fewer) {
  const double phi = dispersion(rich);
  const double price = static_cast<double>(fewer) * std::log(rich.residuals);
  return {.cost = 0.5 * (rich.misfit + phi * (ahead_of_plain(rich) + price)), .optimism = kOptimistic};
}

bool put_in_place(Naming& naming, std::size_t slot, const Law& plain, const Data& data, int threads) {
  AssetConfig asset;
  const FittedModel& rich = *naming.best.model;
  const std::size_t before = naming.best.effects[slot].law->parameters.size(), now = plain.parameters.size();
  Trial trial = with_plain_law(naming.best, slot, plain, asset);
  Result<FittedModel> model = fit_model(asset, data, &rich, threads, kSearchIterations,
                                        worth_preferring(rich, before > now ? before - now : 0));
  if (!model) return false;
  const bool cut = model->optimum.out_of_reach;
  trial.model = std::make_shared<const FittedModel>(std::move(*model));
  if (!cut) trial = polished(std::move(trial), data, threads);
  naming.trials.push_back(trial);
  if (cut) return false;
  const double phi = std::min(dispersion(*naming.best.model), dispersion(*trial.model));
  const double ahead = ahead_of_plain(rich);
  if (criterion(*trial.model, phi) > criterion(*naming.best.model, phi) + ahead) return false;
  naming.best = std::move(trial);
  return true;
}

// First the plain law as it is, then its closed forms: dry friction that changes direction gently is no Stribeck curve.
// Of a closed form that bears a law's id, that law: a power of 1.0002 is a laminar leak.
bool put_plain_law(Naming& naming, std::size_t slot, const Data& data, int threads) {
  const Law& rich = *naming.best.effects[slot].law;
  return std::ranges::any_of(all_laws(), [&](const Law& plain) {
    const bool limit =
        !rich.limit.empty() && plain.id == rich.limit && (!plain.closed_form || excess(*naming.best.model) <= kGross);
    const bool listed = rich.closed_form && plain.id == rich.id && !plain.closed_form;
    return (limit || listed) && put_in_place(naming, slot, plain, data, threads);
  });
}

}  // namespace

// In a gross misfit the criterion is rough, as what is left is no noise: a law that comes to a plainer one at the end
// of its range (bristles that bend by micrometres: plain dry friction) is claimed only where it is clearly better.
const Trial* best_of(const std::vector<Trial>& trials, double phi) {
  const Trial* best = nullptr;
  for (const Trial& trial : trials)
    if (best == nullptr || criterion(*trial.model, phi) < criterion(*best->model, phi)) best = &trial;
  if (best == nullptr || !at_a_limit(*best)) return best;
  // Of laws that these recordings cannot tell apart, the one that is not merely at the limit of another's shape.
  const Trial* plain = nullptr;
  for (const Trial& trial : trials)
    if (trial.effects.size() <= best->effects.size() && !at_a_limit(trial) &&
        criterion(*trial.model, phi) < criterion(*best->model, phi) + kCannotTell &&
        (plain == nullptr || criterion(*trial.model, phi) < criterion(*plain->model, phi)))
      plain = &trial;
  return plain == nullptr ? best : plain;
}

void prefer_plain_laws(Naming& naming, const Data& data, int threads) {
  for (std::size_t slot = 0; slot < naming.best.effects.size();)
    if (!put_plain_law(naming, slot, data, threads)) ++slot;  // else the plain law is now the last one
}

}  // namespace sealwatch::mismatch
