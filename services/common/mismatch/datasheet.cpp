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

// Not where a value ended at a bound, or within its tolerance, where it needs no explanation.
bool is_a_cause(const FittedModel& model, const std::vector<KnownValue>& values) {
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    const auto value = std::ranges::find(values, unknown.name, &KnownValue::name);
    if (value == values.end()) continue;
    const double off = unknown.to_value(model.optimum.point.shared[k]) - value->value;
    const bool within = std::abs(off) < kWithinTolerance * value->standard_deviation;
    if (within || at_bound(unknown, model.optimum.point.shared[k])) return false;
  }
  return true;
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
    if (models[k] != nullptr && !is_a_cause(*models[k], attempts[k].values)) models[k] = nullptr;
  }
  return models;
}

// Which of them fits best; their number where none could be fitted.
std::size_t best_of(const std::vector<std::shared_ptr<const FittedModel>>& models) {
  std::size_t best = models.size();
  for (std::size_t k = 0; k < models.size(); ++k)
    if (models[k] != nullptr && (best == models.size() || models[k]->misfit < models[best]->misfit)) best = k;
  return best;
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

double behind(const FittedModel& model, const FittedModel& found) {
  const double phi = std::min(dispersion(model), dispersion(found));
  return criterion(model, phi) - criterion(found, phi);
}

// The asset with those of the laws found that are kept, at the values they were found with.
AssetConfig with_laws(AssetConfig asset, const Trial& found, const std::vector<std::size_t>& kept) {
  const std::vector<PhysicsTerm>& terms = found.model->asset.physics;
  for (const std::size_t k : kept) asset.physics.push_back(terms[terms.size() - found.effects.size() + k]);
  return asset;
}

std::vector<std::size_t> without(std::vector<std::size_t> kept, std::size_t left_out) {
  std::erase(kept, left_out);
  return kept;
}

// The best value in place of one law.
struct Replaced {
  KnownValue value;
  std::vector<std::size_t> kept;
  std::shared_ptr<const FittedModel> model;
};

std::optional<Replaced> one_law_replaced(const DatasheetQuestion& of) {
  std::vector<std::size_t> all(of.found.effects.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  struct Place {
    Promise promise;
    std::size_t law;
    std::shared_ptr<const FittedModel> near;
  };
  std::vector<Place> places;
  for (const std::size_t law : all) {
    Result<FittedModel> fewer =
        fit_model(with_laws(of.asset, of.found, without(all, law)), of.fit, of.found.model.get(), of.threads);
    if (!fewer) continue;
    const auto near = std::make_shared<const FittedModel>(std::move(*fewer));
    const double least = kPromising * (near->misfit - of.found.model->misfit);
    for (Promise& promise : promises_of(of.asset, *near, of.fit, of.threads))
      if (near->misfit - promise.misfit >= least) places.push_back({std::move(promise), law, near});
  }
  std::ranges::stable_sort(places, {}, [](const Place& place) { return place.promise.misfit; });
  if (places.size() > kAsked) places.resize(kAsked);
  std::vector<Attempt> attempts;
  for (const Place& place : places)
    attempts.push_back(
        {.asset = with_free_value(with_laws(of.asset, of.found, without(all, place.law)), place.promise.value.name),
         .values = {place.promise.value},
         .near = place.near});
  const auto models = all_fitted(attempts, of.fit, of.threads);
  const std::size_t best = best_of(models);
  if (best == models.size()) return std::nullopt;
  return Replaced{places[best].promise.value, without(all, places[best].law), models[best]};
}

// Laws that are not needed beside the value are taken out, one at a time.
void drop_what_is_not_needed(const DatasheetQuestion& of, Replaced& replaced) {
  while (!replaced.kept.empty()) {
    std::vector<Attempt> attempts;
    for (const std::size_t law : replaced.kept)
      attempts.push_back(
          {.asset = with_free_value(with_laws(of.asset, of.found, without(replaced.kept, law)), replaced.value.name),
           .values = {replaced.value},
           .near = replaced.model});
    const auto models = all_fitted(attempts, of.fit, of.threads);
    const std::size_t best = best_of(models);
    if (best == models.size() || behind(*models[best], *replaced.model) > kWorthAnother) return;
    replaced.kept = without(replaced.kept, replaced.kept[best]);
    replaced.model = models[best];
  }
}

}  // namespace

AssetConfig with_free_value(AssetConfig asset, const std::string& name) {
  ParameterSetting& setting = asset.parameters.at(name);
  const auto [low, high] = std::minmax({setting.value / kOffByAtMost, setting.value * kOffByAtMost});
  setting = {
      .value = setting.value, .min = std::max(setting.min, low), .max = std::min(setting.max, high), .estimate = true};
  return asset;
}

std::string values_in_words(const std::vector<std::vector<AssetValue>>& values) {
  std::string text;
  for (const std::vector<AssetValue>& entry : values) {
    std::vector<std::string> texts;
    for (const AssetValue& value : entry) {
      const double percent = 100.0 * (value.fitted / value.in_asset_file - 1.0);
      const std::string unit = value.unit == "1" ? "" : " " + value.unit;
      texts.push_back(value.name + " = " + number(value.fitted, 4) + unit + " instead of " +
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
  if (!is_a_cause(model, free)) values.clear();
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
    const double best = behind(*models.front(), *of.found.model);
    if (best <= kCannotTell) {
      WrongDatasheet wrong{.values = {}, .behind = best, .with = {.effects = {}, .model = models.front()}};
      for (const auto& model : models)
        if (behind(*model, *models.front()) <= kCannotTell) wrong.values.push_back(values_of(*model, of.asset));
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

std::optional<WrongDatasheet> value_in_place_of_laws(const DatasheetQuestion& of) {
  const std::size_t laws = of.found.effects.size();
  if (laws < 2) return std::nullopt;
  std::optional<Replaced> replaced = one_law_replaced(of);
  if (!replaced) return std::nullopt;
  drop_what_is_not_needed(of, *replaced);
  WrongDatasheet wrong{.values = {values_of(*replaced->model, of.asset)},
                       .behind = behind(*replaced->model, *of.found.model),
                       .with = with_derivatives({{}, replaced->model}, of.fit, of.threads)};
  if (wrong.behind > kCannotTell) return std::nullopt;
  for (const std::size_t k : replaced->kept) wrong.with.effects.push_back(of.found.effects[k]);
  return wrong;
}

}  // namespace sealwatch::mismatch
