#include "services/common/mismatch/datasheet.hpp"

#include <algorithm>
#include <cmath>
#include <future>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostValues = 2;
constexpr std::size_t kAsked = 4;  // values that are fitted: those that promise most
constexpr int kIterations = 20;
constexpr double kOffByAtMost = 1.5;  // times: further off a datasheet is not wrong but another's
constexpr double kCannotTell = 6.0;   // criterion

std::vector<std::string> fixed_values(const AssetConfig& asset, const PlantDescription& plant) {
  std::vector<std::string> names;
  for (const auto& [name, setting] : asset.parameters)
    if (plant.find_parameter(name) != nullptr && !setting.estimate && setting.value != 0.0 && name != "phi")
      names.push_back(name);
  return names;
}

AssetConfig with_free_value(AssetConfig asset, const std::string& name) {
  ParameterSetting& setting = asset.parameters.at(name);
  setting.estimate = true;
  setting.min = std::min(setting.value / kOffByAtMost, setting.value * kOffByAtMost);
  setting.max = std::max(setting.value / kOffByAtMost, setting.value * kOffByAtMost);
  return asset;
}

// With one value more set free; nothing where that cannot be fitted, or ends at a bound.
std::optional<FittedModel> freed(const FittedModel& from, const std::string& name, const Data& fit) {
  Result<FittedModel> model = fit_model(with_free_value(from.asset, name), fit, &from, 1, kIterations);
  if (!model) return std::nullopt;
  const auto unknown = std::ranges::find(model->problem.shared, name, &Unknown::name);
  if (unknown == model->problem.shared.end()) return std::nullopt;
  const auto at = static_cast<std::size_t>(unknown - model->problem.shared.begin());
  if (at_bound(*unknown, model->optimum.point.shared[at])) return std::nullopt;
  return std::move(*model);
}

// Normal equations of all recordings together: shared unknowns, then each recording's own.
struct NormalEquations {
  Eigen::MatrixXd gram;
  Eigen::VectorXd gradient;
};

NormalEquations normal_equations(const FittedModel& model) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Eigen::Index unknowns = shared;
  for (const PemRecording& part : model.problem.recordings) unknowns += static_cast<Eigen::Index>(part.own.size());
  NormalEquations all{.gram = Eigen::MatrixXd::Zero(unknowns, unknowns), .gradient = Eigen::VectorXd::Zero(unknowns)};
  Eigen::Index own = shared;
  for (const Linearisation& at : model.optimum.at_optimum) {
    std::vector<Eigen::Index> place(static_cast<std::size_t>(at.jacobian.cols()));
    for (std::size_t k = 0; k < place.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      place[k] = column < shared ? column : own + column - shared;
    }
    all.gram(place, place) += at.jacobian.transpose() * at.jacobian;
    all.gradient(place) += at.jacobian.transpose() * at.residual;
    own += at.jacobian.cols() - shared;
  }
  return all;
}

// What the misfit would fall by, were the model linear in the values and these not more than kOffByAtMost off:
//
//   gain = 2 d h - d^2 s,   d = h / s,   h = g_c - G_cb G_bb^-1 g_b,   s = G_cc - G_cb G_bb^-1 G_bc
//
// c: the value, b: everything that is estimated already.
double promised_gain(const NormalEquations& all, const std::vector<Eigen::Index>& estimated, Eigen::Index value) {
  constexpr double kNotShown = 1e-9;  // of its column: the estimated ones do the same
  const Eigen::VectorXd scale = all.gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd gram = scale.asDiagonal() * all.gram * scale.asDiagonal();
  const Eigen::VectorXd gradient = scale.cwiseProduct(all.gradient);
  Eigen::MatrixXd known = gram(estimated, estimated);
  known.diagonal().array() += kRidge;
  const Eigen::VectorXd across = gram(estimated, value);
  const Eigen::VectorXd weights = known.ldlt().solve(across);
  const double h = gradient(value) - weights.dot(gradient(estimated));
  const double s = gram(value, value) - weights.dot(across);
  if (!(s > kNotShown)) return 0.0;
  const double most = std::log(kOffByAtMost) / scale(value);
  const double step = std::clamp(h / s, -most, most);
  return 2.0 * step * h - step * step * s;
}

// The values that promise most, in that order.
std::vector<std::string> worth_asking(const FittedModel& from, const Data& fit, int threads) {
  const std::vector<std::string> names = fixed_values(from.asset, from.problem.recordings.front().simulation->plant());
  AssetConfig asset = from.asset;
  for (const std::string& name : names) asset = with_free_value(std::move(asset), name);
  const Result<FittedModel> all = fit_model(asset, fit, &from, threads, 0);
  if (!all) return {};
  const NormalEquations equations = normal_equations(*all);
  std::vector<Eigen::Index> estimated;
  std::vector<std::pair<double, std::string>> gains;
  const auto is_value = [&](Eigen::Index k) {
    return k < static_cast<Eigen::Index>(all->problem.shared.size()) &&
           std::ranges::find(names, all->problem.shared[static_cast<std::size_t>(k)].name) != names.end();
  };
  for (Eigen::Index k = 0; k < equations.gradient.size(); ++k)
    if (!is_value(k)) estimated.push_back(k);
  for (Eigen::Index k = 0; k < equations.gradient.size(); ++k)
    if (is_value(k))
      gains.emplace_back(promised_gain(equations, estimated, k), all->problem.shared[static_cast<std::size_t>(k)].name);
  std::ranges::stable_sort(gains, std::greater<>(), &std::pair<double, std::string>::first);
  std::vector<std::string> best;
  for (std::size_t k = 0; k < std::min(kAsked, gains.size()); ++k)
    if (gains[k].first > 0.0) best.push_back(gains[k].second);
  return best;
}

// Each of these by itself, the best fit first.
std::vector<FittedModel> with_another_value(const FittedModel& from, const Data& fit, int threads) {
  const std::vector<std::string> names = worth_asking(from, fit, threads);
  std::vector<FittedModel> models;
  for (std::size_t first = 0; first < names.size(); first += static_cast<std::size_t>(threads)) {
    std::vector<std::future<std::optional<FittedModel>>> running;
    for (std::size_t k = first; k < std::min(names.size(), first + static_cast<std::size_t>(threads)); ++k)
      running.push_back(std::async(std::launch::async, [&, k] { return freed(from, names[k], fit); }));
    for (auto& one : running) {
      std::optional<FittedModel> model = one.get();
      if (model) models.push_back(std::move(*model));
    }
  }
  std::ranges::stable_sort(models, {}, &FittedModel::misfit);
  return models;
}

std::vector<AssetValue> values_of(const FittedModel& model, const FittedModel& baseline) {
  const PlantDescription& plant = baseline.problem.recordings.front().simulation->plant();
  std::vector<AssetValue> values;
  for (const std::string& name : fixed_values(baseline.asset, plant))
    if (model.asset.parameters.at(name).estimate)
      values.push_back({.name = name,
                        .unit = plant.find_parameter(name)->unit,
                        .in_asset_file = baseline.asset.parameters.at(name).value,
                        .fitted = model.asset.parameters.at(name).value});
  return values;
}

}  // namespace

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

std::optional<WrongDatasheet> wrong_datasheet(const Trial& rival, std::size_t most_values, const FittedModel& baseline,
                                              const Data& fit, int threads) {
  std::optional<FittedModel> from;
  for (std::size_t values = 1; values <= std::min(most_values, kMostValues); ++values) {
    std::vector<FittedModel> models = with_another_value(from ? *from : baseline, fit, threads);
    if (models.empty()) return std::nullopt;
    const double phi = std::min(dispersion(models.front()), dispersion(*rival.model));
    const auto behind = [&](const FittedModel& model) { return criterion(model, phi) - criterion(*rival.model, phi); };
    const double best = behind(models.front());
    if (best <= kCannotTell) {
      WrongDatasheet wrong{.values = {}, .behind = best, .with = {}};
      for (const FittedModel& model : models)
        if (behind(model) <= best + kCannotTell) wrong.values.push_back(values_of(model, baseline));
      wrong.with.model = std::make_shared<const FittedModel>(std::move(models.front()));
      return wrong;
    }
    from = std::move(models.front());
  }
  return std::nullopt;
}

std::optional<WrongDatasheet> wrong_datasheet_beside_laws(const Trial& rival, const FittedModel& baseline,
                                                          const Data& fit, int threads) {
  const std::size_t laws = rival.effects.size();
  if (laws < 2) return std::nullopt;
  const std::vector<FittedModel> models = with_another_value(baseline, fit, threads);
  if (models.empty()) return std::nullopt;
  std::optional<WrongDatasheet> best;
  for (std::size_t chosen = 1; chosen + 1 < std::size_t{1} << laws; ++chosen) {
    Trial with;
    AssetConfig asset = models.front().asset;
    const std::vector<PhysicsTerm>& terms = rival.model->asset.physics;
    for (std::size_t k = 0; k < laws; ++k) {
      if ((chosen >> k & 1U) == 0) continue;
      with.effects.push_back(rival.effects[k]);
      asset.physics.push_back(terms[terms.size() - laws + k]);
    }
    Result<FittedModel> model = fit_model(asset, fit, &models.front(), threads, kIterations);
    if (!model) continue;
    const double phi = std::min(dispersion(*model), dispersion(*rival.model));
    const double behind = criterion(*model, phi) - criterion(*rival.model, phi);
    const double enough = with.effects.size() + 1 < laws ? 0.0 : -kWorthAnother;
    if (behind > enough || (best && behind >= best->behind)) continue;
    with.model = std::make_shared<const FittedModel>(std::move(*model));
    best = WrongDatasheet{.values = {values_of(*with.model, baseline)}, .behind = behind, .with = std::move(with)};
  }
  return best;
}

}  // namespace sealwatch::mismatch
