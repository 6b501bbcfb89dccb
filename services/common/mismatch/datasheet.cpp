#include "services/common/mismatch/datasheet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/core/in_parallel.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/normal_equations.hpp"
#include "services/common/mismatch/standard_errors.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/value_swaps.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostValues = 3;
constexpr std::size_t kAsked = 6;  // values that are fitted: those that promise most
constexpr int kFirstRound = 10;    // iterations of each
// Of its share of what the laws explain: a value that promises less, on the linearised model, cannot stand for them.
constexpr double kPromising = 0.1;

const PlantDescription& plant_of(const FittedModel& model) {
  return model.problem.recordings.front().simulation->plant();
}

// An asset with some values set free, and a model near it.
struct Attempt {
  AssetConfig asset;
  std::vector<KnownValue> values;  ///< as they were known
  std::shared_ptr<const FittedModel> near;
};

// A first round from the asset's values, and from the model near it where that leads further; nothing where it cannot be
// fitted.
std::shared_ptr<FittedModel> begun(const Attempt& attempt, const Data& fit) {
  const FittedModel nowhere;
  Result<FittedModel> model = fit_model(attempt.asset, fit, &nowhere, 1, kFirstRound);
  if (!model || model->misfit >= attempt.near->misfit) {
    Result<FittedModel> other = fit_model(attempt.asset, fit, attempt.near.get(), 1, kFirstRound);
    if (other && (!model || other->misfit < model->misfit)) model = std::move(other);
  }
  return model ? std::make_shared<FittedModel>(std::move(*model)) : nullptr;
}

// In the order of the attempts: the first rounds side by side, then those go on that are not far from the best; the
// others' derivatives are not needed.
std::vector<std::shared_ptr<const FittedModel>> all_fitted(const std::vector<Attempt>& attempts, const Data& fit,
                                                           int threads) {
  constexpr double kNear = 1.5;  // times the best misfit
  auto begins = in_parallel<std::shared_ptr<FittedModel>>(attempts.size(), threads,
                                                          [&](std::size_t k) { return begun(attempts[k], fit); });
  double best = std::numeric_limits<double>::infinity();
  for (const auto& model : begins)
    if (model != nullptr) best = std::min(best, model->misfit);
  for (const auto& model : begins)
    for (std::size_t k = 0; model != nullptr && model->misfit >= kNear * best && k < model->problem.recordings.size();
         ++k)
      model->optimum.at_optimum[k].jacobian.resize(0, 0);
  std::vector<std::shared_ptr<const FittedModel>> models(begins.begin(), begins.end());
  begins.clear();
  for (std::size_t k = 0; k < models.size(); ++k) {
    if (models[k] != nullptr && models[k]->misfit < kNear * best)
      models[k] = polished({{}, models[k]}, fit, threads).model;
    if (models[k] != nullptr && !are_beyond_tolerance(*models[k], attempts[k].values)) models[k] = nullptr;
  }
  return models;
}

// What the misfit would fall by, were the model linear in the values and these not more than kOffByAtMost off:
//
//   gain = 2 d h - d^2 s,   d = h / s,   h = g_c - G_cb G_bb^-1 g_b,   s = G_cc - G_cb G_bb^-1 G_bc
//
// c: the value, b: everything else, known values with their priors in G and g.
double promised_gain(NormalEquations all, const FittedModel& model, Eigen::Index value) {
  constexpr double kNotShown = 1e-9;  // of its column: the others do the same
  std::vector<Eigen::Index> estimated;
  for (Eigen::Index k = 0; k < all.gradient.size(); ++k) {
    if (k == value) continue;
    estimated.push_back(k);
    const auto at = static_cast<std::size_t>(k);
    if (at >= model.problem.shared.size() || !model.problem.shared[at].is_known()) continue;
    const Unknown& unknown = model.problem.shared[at];
    all.gram(k, k) += 1.0 / (unknown.prior_std * unknown.prior_std);
    all.gradient(k) -= unknown.prior_residual(model.optimum.point.shared[at]) / unknown.prior_std;
  }
  const Eigen::VectorXd scale = all.gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd gram = dense::scaled(all.gram, scale);
  const Eigen::VectorXd gradient = scale.cwiseProduct(all.gradient);
  Eigen::MatrixXd known = gram(estimated, estimated);
  known.diagonal().array() += kRidge;
  const Eigen::VectorXd across = gram(estimated, value);
  const Eigen::VectorXd weights = dense::Symmetric(known).solve(across);
  const double h = gradient(value) - weights.dot(gradient(estimated));
  const double s = gram(value, value) - weights.dot(across);
  if (!(s > kNotShown)) return 0.0;
  const double most = std::log(kOffByAtMost) / scale(value);
  const double step = std::clamp(h / s, -most, most);
  return 2.0 * step * h - step * step * s;
}

struct Promise {
  KnownValue value;
  double misfit = 0.0;  ///< that would be left
};

// Of each fixed value of `asset`, the most promising first.
std::vector<Promise> promises_of(const AssetConfig& asset, const FittedModel& model, const Data& fit, int threads) {
  Data with_all = fit;
  with_all.known = known_values(asset, plant_of(model));
  const std::vector<KnownValue> fixed = with_all.known;
  std::ranges::copy_if(fit.known, std::back_inserter(with_all.known), [&](const KnownValue& one) {
    return std::ranges::find(fixed, one.name, &KnownValue::name) == fixed.end();  // of a sensor
  });
  const Result<FittedModel> all = fit_model(model.asset, with_all, &model, threads, 0);
  if (!all) return {};
  const NormalEquations equations = normal_equations(*all);
  const std::vector<Unknown>& shared = all->problem.shared;
  std::vector<Promise> promises;
  for (std::size_t k = 0; k < shared.size(); ++k) {
    const auto value = std::ranges::find(fixed, shared[k].name, &KnownValue::name);
    if (value == fixed.end() || !shared[k].is_known()) continue;
    promises.push_back(
        {.value = *value, .misfit = model.misfit - promised_gain(equations, *all, static_cast<Eigen::Index>(k))});
  }
  std::ranges::stable_sort(promises, {}, &Promise::misfit);
  return promises;
}

std::vector<AssetValue> values_of(const FittedModel& model, const AssetConfig& asset) {
  const PlantDescription& plant = plant_of(model);
  const std::vector<double> errors = standard_errors(model);
  std::vector<AssetValue> values;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    if (model.problem.shared[k].is_known()) continue;  // within its tolerance
    const std::string& name = model.problem.shared[k].name;
    const auto sheet = asset.parameters.find(name);
    if (sheet == asset.parameters.end() || sheet->second.estimate || plant.find_parameter(name) == nullptr) continue;
    values.push_back({.name = name,
                      .unit = plant.find_parameter(name)->unit,
                      .in_asset_file = sheet->second.value,
                      .fitted = model.asset.parameters.at(name).value,
                      .std_error = errors[k]});
  }
  return values;
}

// Laws that are not needed beside the value are taken out, one at a time.
Trial without_what_is_not_needed(Trial with, const DatasheetQuestion& of) {
  for (std::size_t slot = with.effects.size(); slot-- > 0;) {
    AssetConfig asset = with.model->asset;
    asset.physics.erase(asset.physics.end() - static_cast<std::ptrdiff_t>(with.effects.size() - slot));
    Result<FittedModel> fewer = fit_model(asset, of.fit, with.model.get(), of.threads);
    if (!fewer || criterion_behind(*fewer, *with.model) > kWorthAnother) continue;
    with.effects.erase(with.effects.begin() + static_cast<std::ptrdiff_t>(slot));
    with.model = std::make_shared<const FittedModel>(std::move(*fewer));
  }
  return with;
}

}  // namespace

std::string values_in_words(const std::vector<std::vector<AssetValue>>& values) {
  std::string text;
  for (const std::vector<AssetValue>& entry : values) {
    std::vector<std::string> texts;
    for (const AssetValue& value : entry) {
      const double percent = 100.0 * (value.fitted / value.in_asset_file - 1.0);
      texts.push_back(value.name + " = " + text::with_unit(value.fitted, value.unit, 4) + " instead of " +
                      number(value.in_asset_file, 4) + " (" + (percent > 0.0 ? "+" : "") + number(percent, 2) + " %)");
    }
    text += (text.empty() ? "" : ", or ") + joined(texts, " and ");
  }
  return text;
}

std::vector<AssetValue> values_off(const FittedModel& model, const AssetConfig& asset) {
  std::vector<AssetValue> values = values_of(model, asset);
  std::vector<KnownValue> free = known_values(asset, plant_of(model));
  std::erase_if(free, [&](const KnownValue& one) {
    return std::ranges::find(values, one.name, &AssetValue::name) == values.end();
  });
  if (!are_beyond_tolerance(model, free)) values.clear();
  return values;
}

std::optional<WrongDatasheet> values_alone(const DatasheetQuestion& of, std::size_t most) {
  AssetConfig asset = of.asset;
  const std::vector<KnownValue> known = known_values(asset, plant_of(of.baseline));
  std::vector<KnownValue> free;
  auto from = std::make_shared<const FittedModel>();
  for (std::size_t count = 1; count <= std::min(most, kMostValues); ++count) {
    const FittedModel& near = count == 1 ? of.baseline : *from;
    std::vector<Attempt> attempts;
    const auto share = static_cast<double>(std::min(most, kMostValues) - count + 1);
    const double least = kPromising * (near.misfit - of.found.model->misfit) / share;
    for (const Promise& promise : promises_of(asset, near, of.fit, of.threads)) {
      if (attempts.size() == kAsked || near.misfit - promise.misfit < least) break;
      attempts.push_back({.asset = with_free_value(asset, promise.value.name),
                          .values = free,
                          .near = std::shared_ptr<const FittedModel>(from, &near)});
      attempts.back().values.push_back(promise.value);
    }
    auto models = all_fitted(attempts, of.fit, of.threads);
    std::erase(models, nullptr);
    std::ranges::stable_sort(models, {}, [](const auto& model) { return model->misfit; });
    if (models.empty()) return std::nullopt;
    const double best = criterion_behind(*models.front(), *of.found.model);
    if (best <= kCannotTell) {
      WrongDatasheet wrong{.values = {}, .behind = best, .with = {.effects = {}, .model = models.front()}};
      for (const auto& model : models)
        if (criterion_behind(*model, *models.front()) <= kCannotTell)
          wrong.values.push_back(values_of(*model, of.asset));
      return wrong;
    }
    for (const AssetValue& value : values_of(*models.front(), of.asset)) {
      if (asset.parameters.at(value.name).estimate) continue;
      asset = with_free_value(std::move(asset), value.name);
      free.push_back(
          {.name = value.name,
           .value = value.in_asset_file,
           .standard_deviation = std::ranges::find(known, value.name, &KnownValue::name)->standard_deviation});
    }
    from = models.front();
  }
  return std::nullopt;
}

std::optional<WrongDatasheet> values_in_place_of_laws(const DatasheetQuestion& of) {
  const std::vector<KnownValue> values = known_values(of.asset, plant_of(of.baseline));
  std::optional<WrongDatasheet> wrong;
  Trial now = of.found;
  for (std::size_t count = 1; count <= kMostValues && !now.effects.empty(); ++count) {
    const double worse = count == 1 ? kCannotTell : -kCannotTell;
    const std::vector<std::vector<std::size_t>> out = subsets_of(now.effects.size());
    const std::vector<ValueSwap> swaps = values_in_place_of({now, out, values, of.fit, of.threads, worse});
    if (swaps.empty()) break;
    wrong.emplace();
    for (const ValueSwap& swap : swaps)
      if (swap.out == swaps.front().out && criterion_behind(*swap.with.model, *swaps.front().with.model) <= kCannotTell)
        wrong->values.push_back(values_of(*swap.with.model, of.asset));
    now = without_what_is_not_needed(swaps.front().with, of);
    const bool too_few =
        criterion_behind(*now.model, *of.found.model) > kCannotTell || values_off(*now.model, of.asset).empty();
    if (too_few) now = swaps.front().with;
    wrong->values.front() = values_of(*now.model, of.asset);
    wrong->behind = criterion_behind(*now.model, *of.found.model);
    wrong->with = now;
  }
  return wrong;
}

}  // namespace sealwatch::mismatch
