#include "services/common/mismatch/remainder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/standard_errors.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kAnywhere = 3;
constexpr double kNothingElse = 2e-3;  // of what the laws found took: none that could be their form is tried

double gain_of(const FoundEffect& effect) { return -effect.delta_bic; }

std::string sits_anywhere_in_words(const FoundEffect& effect) {
  std::vector<std::string> places = {element_in_words(effect.what.element)};
  for (const std::string& other : effect.same_elements) places.push_back(element_in_words(other));
  return "A remainder beyond the noise could sit at " + joined(places, " or at ") +
         " alike: no second law is claimed for it.";
}

std::string may_be_the_form(const LawAt& law, double share) {
  return "What is left beside " + law_in_words(law) + " is " + number(100.0 * share, 2) +
         " % of what it took, and may be its exact form.";
}

/// Of the strengths of a law the one that is told best: by how many of its standard errors.
struct Told {
  double errors = 0.0;
  const LawParameter* strength = nullptr;
};

/// A law's unknowns among a model's shared ones: of its strengths, or of its shapes.
std::vector<std::size_t> unknowns_of(const FittedModel& model, const Effect& effect, bool strengths) {
  std::vector<std::size_t> places;
  for (const LawParameter& parameter : effect.law->parameters) {
    const std::string name = physics_parameter_name(effect.element, effect.law->id, parameter.name);
    const auto unknown = std::ranges::find(model.problem.shared, name, &Unknown::name);
    if (parameter.strength == strengths && unknown != model.problem.shared.end())
      places.push_back(static_cast<std::size_t>(unknown - model.problem.shared.begin()));
  }
  return places;
}

Told told_best(const FittedModel& model, const Effect& effect, const Resolution* resolution) {
  const std::vector<std::size_t> strengths = unknowns_of(model, effect, true);
  const std::vector<double> errors = standard_errors_beside(model, strengths, unknowns_of(model, effect, false));
  Told best;
  for (const std::size_t s : strengths_of(*effect.law)) {
    const LawParameter& strength = effect.law->parameters[s];
    const std::string name = physics_parameter_name(effect.element, effect.law->id, strength.name);
    const auto is_it = [&](std::size_t k) { return model.problem.shared[k].name == name; };
    const auto known = static_cast<std::size_t>(std::ranges::find_if(strengths, is_it) - strengths.begin());
    if (known == strengths.size() || !std::isfinite(errors[known]) || errors[known] <= 0.0)
      return {std::numeric_limits<double>::infinity(), &strength};
    const double feigned =
        resolution == nullptr ? 0.0 : resolution->of(strength, outputs_moved_by(model, strengths[known]));
    const double error = std::hypot(errors[known], feigned);
    const double by = std::abs(*estimate_of(model, name)) / error;
    if (best.strength == nullptr || by > best.errors) best = {by, &strength};
  }
  return best;
}

/// "": the plant's file gives no size for it, or it is a delay, which is known no better than the samples lie apart.
std::string size_in_words(const FittedModel& model, const Effect& effect, const LawParameter& strength,
                          const PlantDescription& plant) {
  const std::string unit(strength.unit);
  if (strength.own_size || plant.file.empty() || unit == "s") return "";
  const double value = *estimate_of(model, physics_parameter_name(effect.element, effect.law->id, strength.name));
  return law_in_words(effect) + " with " + std::string(strength.name) + " = " + text::with_unit(value, unit) +
         " fits better and is not claimed: by law_sizes in the plant file (" + unit + ": " +
         number(law_size(plant, strength)) + ") such a law matters here from " +
         text::with_unit(significant_size(plant, strength), unit) + " only, beside which this is nothing";
}

}  // namespace

double share_left(const FittedModel& without, const FittedModel& with, double promised) {
  return std::max(with.misfit - with.residuals, promised) / (without.misfit - with.misfit);
}

bool leaves_its_form_at_most(const FittedModel& without, const FittedModel& with, double promised) {
  return excess(with) <= kGross && with.misfit < without.misfit && share_left(without, with, promised) < kNothingElse;
}

std::string left_beside(const LawAt& law, double share) { return may_be_the_form(law, share); }

bool takes_up_little(const FittedModel& without, const FittedModel& with, double least_misfit) {
  const double noise = std::min({with.residuals, with.misfit, least_misfit});
  return with.misfit - noise > (1.0 - kExplainedAtLeast) * (without.misfit - noise);
}

std::optional<NotTold> not_told_from_zero(const Trial& trial, const Resolution& resolution) {
  constexpr double kTold = 2.0;  // standard errors: 95 % of them lie closer to the true value
  const FittedModel& model = *trial.model;
  std::optional<NotTold> least;
  double told = kTold;
  for (std::size_t slot = 0; slot < trial.effects.size(); ++slot) {
    const Effect& effect = trial.effects[slot];
    const Told by = told_best(model, effect, &resolution);
    if (by.errors >= told) continue;
    told = by.errors;
    least = NotTold{slot, "A law that fits better (" + law_in_words(effect) + ") has a strength of only " +
                              number(by.errors, 2) + " standard errors, which may be nothing: it is not claimed."};
    if (const Told alone = told_best(model, effect, nullptr); alone.errors >= kTold)
      least->by_size = size_in_words(model, effect, *alone.strength, *resolution.plant);
  }
  return least;
}

bool same_place(const LawAt& a, const LawAt& b) { return a.id == b.id && a.element == b.element; }

bool could_sit_anywhere(const FoundEffect& effect) { return effect.same_elements.size() >= kAnywhere; }

std::optional<Remainder> remainder_among(std::span<const FoundEffect> effects, const LawAt& last,
                                         const MoreThanForm& is_more_than_form) {
  for (const FoundEffect& effect : effects)
    if (same_place(effect.what, last) && could_sit_anywhere(effect))
      return Remainder{effect.what, sits_anywhere_in_words(effect)};
  const FoundEffect& largest = *std::ranges::max_element(effects, {}, gain_of);
  const FoundEffect* least = nullptr;
  for (const FoundEffect& effect : effects) {
    const bool little = gain_of(effect) < kForm * gain_of(largest);
    if (little && (least == nullptr || gain_of(effect) < gain_of(*least)) &&
        !is_more_than_form(effect.what, largest.what))
      least = &effect;
  }
  if (least == nullptr) return std::nullopt;
  return Remainder{least->what, may_be_the_form(largest.what, gain_of(*least) / gain_of(largest)) +
                                    " It would be taken by " + law_in_words(least->what) + ", which is not claimed."};
}

}  // namespace sealwatch::mismatch
