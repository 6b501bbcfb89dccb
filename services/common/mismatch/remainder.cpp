#include "services/common/mismatch/remainder.hpp"

#include <algorithm>
#include <vector>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kAnywhere = 3;
constexpr double kFormHere = 2e-2, kFormElsewhere = 2e-3;  // of the largest law's gain

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

}  // namespace

double share_left(const FittedModel& without, const FittedModel& with, double promised) {
  return std::max(with.misfit - with.residuals, promised) / (without.misfit - with.misfit);
}

bool leaves_its_form_at_most(const FittedModel& without, const FittedModel& with, double promised) {
  return excess(with) <= kGross && with.misfit < without.misfit && share_left(without, with, promised) < kFormElsewhere;
}

std::string left_beside(const LawAt& law, double share) { return may_be_the_form(law, share); }

bool same_place(const LawAt& a, const LawAt& b) { return a.id == b.id && a.element == b.element; }

bool could_sit_anywhere(const FoundEffect& effect) { return effect.same_elements.size() >= kAnywhere; }

std::optional<Remainder> remainder_among(std::span<const FoundEffect> effects, const LawAt& last) {
  for (const FoundEffect& effect : effects)
    if (same_place(effect.what, last) && could_sit_anywhere(effect))
      return Remainder{effect.what, sits_anywhere_in_words(effect)};
  const FoundEffect& largest = *std::ranges::max_element(effects, {}, gain_of);
  const FoundEffect* least = nullptr;
  for (const FoundEffect& effect : effects) {
    const double form = effect.what.element == largest.what.element ? kFormHere : kFormElsewhere;
    const bool little = gain_of(effect) < form * gain_of(largest);
    if (little && (least == nullptr || gain_of(effect) < gain_of(*least))) least = &effect;
  }
  if (least == nullptr) return std::nullopt;
  return Remainder{least->what, may_be_the_form(largest.what, gain_of(*least) / gain_of(largest)) +
                                    " It would be taken by " + law_in_words(least->what) + ", which is not claimed."};
}

}  // namespace sealwatch::mismatch
