#include "services/common/mismatch/value_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/tolerance.hpp"

namespace sealwatch::mismatch {
namespace {

bool is_that_law(const Effect& a, const Effect& b) { return a.law->id == b.law->id && a.element == b.element; }

// The asset with a value free whose place the file gives.
AssetConfig with_free(AssetConfig asset, const KnownValue& value) {
  asset.parameters.at(value.name).value = value.value;
  return with_free_value(std::move(asset), value.name);
}

// Criterion of what was found with the value less that with the value as it is known and with its laws again, beside
// everything else: above 0 the value only stood for these. Infinitely little where that cannot be fitted.
double behind_laws(const Naming& beside, const Trial& laws, const ValueSwap& swap, const Data& data, int threads) {
  const FittedModel& best = *beside.best.model;
  AssetConfig asset = best.asset;
  asset.parameters.at(swap.value.name) = laws.model->asset.parameters.at(swap.value.name);
  const std::vector<PhysicsTerm>& physics = laws.model->asset.physics;
  const auto first = physics.size() - laws.effects.size();
  for (const std::size_t slot : swap.out) {
    const auto found_again = [&](const Effect& effect) { return is_that_law(effect, laws.effects[slot]); };
    if (std::ranges::none_of(beside.best.effects, found_again)) asset.physics.push_back(physics[first + slot]);
  }
  Result<FittedModel> fitted = fit_model(asset, data, &best, threads);
  if (!fitted) return -std::numeric_limits<double>::infinity();
  const Trial back = polished({{}, std::make_shared<const FittedModel>(std::move(*fitted))}, data, threads);
  return criterion_behind(best, *back.model);
}

// A law that other shapes or forms of it could serve better than what was found first.
bool has_shapes(const Effect& effect) {
  const bool of_its_own =
      std::ranges::any_of(effect.law->parameters, [](const LawParameter& one) { return !one.strength; });
  const auto forms = std::ranges::count_if(all_laws(), [&](const Law& law) { return law.id == effect.law->id; });
  return of_its_own || forms > 1;
}

}  // namespace

std::vector<KnownValue> freed_by(const Trial& from, const FittedModel& baseline, const Data& data) {
  std::vector<KnownValue> freed = data.fixed;
  std::erase_if(freed, [&](const KnownValue& value) {
    return from.model == nullptr || !from.model->asset.parameters.at(value.name).estimate ||
           baseline.asset.parameters.at(value.name).estimate;
  });
  return freed;
}

Result<Naming> beside_values(const Naming& naming, const std::vector<KnownValue>& values, const Trial& from,
                             const Data& data, const ExplainOptions& options, const Progress& progress) {
  std::shared_ptr<const FittedModel> baseline = from.model;
  if (!from.effects.empty()) {
    AssetConfig asset = naming.baseline->asset;
    for (const KnownValue& value : values) {
      asset = with_free(std::move(asset), value);
      asset.parameters.at(value.name).value = from.model->asset.parameters.at(value.name).value;
    }
    Result<FittedModel> alone = fit_baseline(asset, data, *from.model, options.threads);
    if (!alone) return fail(alone.error());
    baseline = std::make_shared<const FittedModel>(std::move(*alone));
  }
  Result<Naming> beside = name_effects(baseline, data, options, progress, from);
  if (!beside) return beside;
  beside->baseline_with_sensors.reset();  // of the model as it is, that is
  for (const KnownValue& value : values) beside->freed.insert(beside->freed.begin(), value.name);
  return beside;
}

std::optional<Naming> search_beside(Naming& naming, const ValueSwap& swap, const Data& data,
                                    const ExplainOptions& options, const Progress& progress) {
  if (progress) progress("looking again, beside a value of the asset file", 0.5);
  Result<Naming> beside = beside_values(naming, {swap.value}, swap.with, data, options, progress);
  if (!beside) return std::nullopt;
  const double behind = passed(data.deadline) ? criterion_behind(*swap.with.model, *naming.best.model)
                                              : behind_laws(*beside, naming.best, swap, data, options.threads);
  if (behind > 0.0) {
    naming.refused.push_back(swap.value.name);
    return std::nullopt;
  }
  beside->behind_laws = beside->freed.size() > 1 ? std::max(beside->behind_laws, behind) : behind;
  for (const std::size_t slot : swap.out) beside->replaced.push_back(naming.best.effects[slot]);
  beside->with_laws = std::make_shared<const Naming>(naming);
  return std::move(*beside);
}

std::optional<Naming> value_in_place(Naming& naming, bool without_shapes, const Data& data,
                                     const ExplainOptions& options, const Progress& progress) {
  constexpr long kMostValues = 2;
  const auto is_free = [&](const KnownValue& value) {
    return naming.baseline->asset.parameters.at(value.name).estimate;
  };
  if (data.fixed.empty() || std::ranges::count_if(data.fixed, is_free) >= kMostValues) return std::nullopt;
  auto out = subsets_of(naming.best.effects.size());
  std::erase_if(out, [&](const std::vector<std::size_t>& slots) {
    const auto shaped = [&](std::size_t slot) { return has_shapes(naming.best.effects[slot]); };
    return std::ranges::none_of(slots, shaped) != without_shapes;
  });
  if (out.empty()) return std::nullopt;
  std::vector<KnownValue> values = data.fixed;
  std::erase_if(values, [&](const KnownValue& value) {
    return std::ranges::find(naming.refused, value.name) != naming.refused.end();
  });
  const auto swaps = values_in_place_of({naming.best, out, values, data, options.threads, -kCannotTell});
  if (swaps.empty() || swaps.front().with.model->optimum.at_optimum.front().jacobian.size() == 0) return std::nullopt;
  return search_beside(naming, swaps.front(), data, options, progress);
}

std::optional<ValueSwap> value_that_ends_it(const Naming& naming, const Data& data, int threads) {
  const FittedModel& found = *naming.best.model;
  const bool begins = naming.best.effects.empty() && naming.refused.empty() && excess(found) > kGross;
  const auto is_free = [&](const KnownValue& value) { return found.asset.parameters.at(value.name).estimate; };
  if (!begins || data.fixed.empty() || std::ranges::any_of(data.fixed, is_free)) return std::nullopt;
  const double phi = dispersion(found),
               ends_it = (kGross * found.residuals - found.misfit) / phi + std::log(found.residuals / phi);
  const std::vector<std::vector<std::size_t>> no_law(1);
  auto swaps = values_in_place_of({naming.best, no_law, data.fixed, data, threads, std::min(ends_it, -kWorthAnother)});
  if (swaps.empty() || excess(*swaps.front().with.model) > kGross) return std::nullopt;
  return std::move(swaps.front());
}

}  // namespace sealwatch::mismatch
