#include "services/common/mismatch/trace.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/ranking.hpp"

namespace sealwatch::mismatch {
namespace {

const PlantDescription& plant_of(const FittedModel& model) {
  return model.problem.recordings.front().simulation->plant();
}

}  // namespace

std::vector<Asked> trace_of(const Naming& naming) {
  std::vector<Asked> trace;
  const double phi = smallest_dispersion(naming.trials, *naming.baseline);
  const double as_it_is = criterion(*naming.baseline, phi);
  const PlantDescription& plant = plant_of(*naming.baseline);
  for (const Trial& trial : naming.trials) {
    Asked asked{.laws = {}, .score = as_it_is - criterion(*trial.model, phi)};
    for (const Effect& effect : trial.effects) asked.laws.push_back(law_at(effect, plant));
    trace.push_back(std::move(asked));
  }
  return trace;
}

Asked asked(const WrongDatasheet& values, const Naming& beside) {
  const double phi = smallest_dispersion(beside.trials, *beside.baseline);
  Asked asked{.laws = {}, .score = criterion(*beside.baseline, phi) - criterion(*values.with.model, phi)};
  const PlantDescription& plant = plant_of(*beside.baseline);
  for (const Effect& effect : values.with.effects) asked.laws.push_back(law_at(effect, plant));
  for (const AssetValue& value : values.values.front()) asked.values.push_back(value.name);
  return asked;
}

std::vector<CandidateCause> candidate_causes(const Screening& screening, const FittedModel& model,
                                             const FittedModel& baseline) {
  constexpr std::size_t kMost = 8;
  constexpr double kNamed = 0.01;  // probability from which a candidate is worth a line
  const double phi = dispersion(model), nothing = std::log(model.residuals) + kWorthAnother;
  const double beyond_noise = std::max(baseline.misfit - baseline.residuals, 1.0);
  std::vector<CandidateCause> causes;
  double largest = nothing;
  for (const Variant* variant : by_gain(screening)) largest = std::max(largest, variant->gain / phi);
  double all = std::exp(0.5 * (nothing - largest));
  for (const Variant* variant : by_gain(screening)) {
    const Candidate& candidate = screening.candidates[variant->candidate];
    const LawAt what = law_at({candidate.law, candidate.element}, plant_of(model));
    const auto known = [&](const CandidateCause& one) {
      return one.what.id == what.id && one.what.element == what.element;
    };
    if (std::ranges::any_of(causes, known)) continue;  // its best shape came first
    const double weight = std::exp(0.5 * (variant->gain / phi - largest));
    all += weight;
    causes.push_back({.what = what, .share = std::min(1.0, variant->gain / beyond_noise), .probability = weight});
  }
  for (CandidateCause& cause : causes) cause.probability /= all;
  std::erase_if(causes, [](const CandidateCause& cause) { return cause.probability < kNamed; });
  if (causes.size() > kMost) causes.resize(kMost);
  return causes;
}

}  // namespace sealwatch::mismatch
