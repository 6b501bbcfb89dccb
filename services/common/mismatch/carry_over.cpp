#include "services/common/mismatch/carry_over.hpp"

#include <algorithm>
#include <utility>

#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/other_shapes.hpp"

namespace sealwatch::mismatch {

bool Worth::carries_over() const {
  return whole.low > 0.0 && std::ranges::all_of(of_law, [](const GainInterval& gain) { return gain.low > 0.0; });
}

std::size_t Worth::least() const {
  return static_cast<std::size_t>(std::ranges::min_element(of_law, {}, &GainInterval::low) - of_law.begin());
}

CarryOver::CarryOver(const HeldOut& held_out, Trial nothing, Without without)
    : held_out_(held_out), nothing_(std::move(nothing)), without_(std::move(without)) {}

Worth CarryOver::of_whole(const Trial& trial) const {
  Worth worth;
  const auto whole = held_out_.gains(nothing_, trial);
  if (!whole || whole->gain.empty()) return worth;
  worth.compared = true;
  worth.whole = gain_interval(*whole, dispersion(*trial.model), held_out_.options.seed);
  worth.not_compared = whole->not_compared;
  return worth;
}

Worth CarryOver::of(const Trial& trial) const {
  Worth worth = of_whole(trial);
  for (std::size_t k = 0; k < trial.effects.size() && worth.compared; ++k) {
    const auto own = held_out_.gains(without_(trial, k), trial);
    worth.of_law.push_back(own && !own->gain.empty()
                               ? gain_interval(*own, dispersion(*trial.model), held_out_.options.seed)
                               : GainInterval{});
  }
  return worth;
}

bool CarryOver::predicts_as_well(const Trial& trial, const Trial& best) const {
  const auto gains = held_out_.gains(trial, best);
  return gains && !gains->gain.empty() && gains->not_compared.empty() &&
         gain_interval(*gains, dispersion(*best.model), held_out_.options.seed).low <= 0.0;
}

std::vector<Trial> likeliest(const Naming& naming, std::size_t most, std::size_t most_laws) {
  const double phi = smallest_dispersion(naming.trials, *naming.baseline);
  std::vector<const Trial*> order;
  for (const Trial& trial : naming.trials)
    if (!trial.effects.empty() && trial.effects.size() <= most_laws) order.push_back(&trial);
  std::ranges::stable_sort(order, {}, [phi](const Trial* trial) { return criterion(*trial->model, phi); });
  std::vector<Trial> found;
  for (const Trial* trial : order) {
    if (found.size() == most) break;
    const auto known = [&](const Trial& one) { return same_effects(one.effects, trial->effects); };
    if (std::ranges::none_of(found, known)) found.push_back(*trial);
  }
  return found;
}

}  // namespace sealwatch::mismatch
