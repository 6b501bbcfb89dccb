#include "services/common/mismatch/datasheet.hpp"

#include <algorithm>
#include <cmath>
#include <future>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostValues = 2;
constexpr int kRough = 4, kForTwo = 12, kFull = 20;  // iterations: of all, of all where two may be wrong, of the best
constexpr double kOffByAtMost = 1.5;                 // times: further off a datasheet is not wrong but another's
constexpr double kCannotTell = 6.0;                  // criterion

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
std::optional<FittedModel> freed(const FittedModel& from, const std::string& name, const Data& fit, int iterations) {
  Result<FittedModel> model = fit_model(with_free_value(from.asset, name), fit, &from, 1, iterations);
  if (!model) return std::nullopt;
  const auto unknown = std::ranges::find(model->problem.shared, name, &Unknown::name);
  if (unknown == model->problem.shared.end()) return std::nullopt;
  const auto at = static_cast<std::size_t>(unknown - model->problem.shared.begin());
  if (at_bound(*unknown, model->optimum.point.shared[at])) return std::nullopt;
  return std::move(*model);
}

// The best of these, fitted to the end.
std::optional<FittedModel> with_another_value(const FittedModel& from, const Data& fit, int threads, int iterations) {
  const std::vector<std::string> names = fixed_values(from.asset, from.problem.recordings.front().simulation->plant());
  std::optional<FittedModel> best;
  for (std::size_t first = 0; first < names.size(); first += static_cast<std::size_t>(threads)) {
    std::vector<std::future<std::optional<FittedModel>>> running;
    for (std::size_t k = first; k < std::min(names.size(), first + static_cast<std::size_t>(threads)); ++k)
      running.push_back(std::async(std::launch::async, [&, k] { return freed(from, names[k], fit, iterations); }));
    for (auto& one : running) {
      std::optional<FittedModel> model = one.get();
      if (model && (!best || model->misfit < best->misfit)) best = std::move(model);
    }
  }
  if (!best) return best;
  Result<FittedModel> polished = fit_model(best->asset, fit, &*best, threads, kFull);
  if (polished) best = std::move(*polished);
  return best;
}

std::vector<DatasheetValue> values_of(const FittedModel& model, const FittedModel& baseline) {
  const PlantDescription& plant = baseline.problem.recordings.front().simulation->plant();
  std::vector<DatasheetValue> values;
  for (const std::string& name : fixed_values(baseline.asset, plant))
    if (model.asset.parameters.at(name).estimate)
      values.push_back({.name = name,
                        .unit = plant.find_parameter(name)->unit,
                        .in_asset_file = baseline.asset.parameters.at(name).value,
                        .fitted = model.asset.parameters.at(name).value});
  return values;
}

}  // namespace

std::string WrongDatasheet::in_words() const {
  std::vector<std::string> texts;
  for (const DatasheetValue& value : values) {
    const double percent = 100.0 * (value.fitted / value.in_asset_file - 1.0);
    texts.push_back(value.name + " = " + number(value.fitted, 4) + " " + value.unit + " instead of " +
                    number(value.in_asset_file, 4) + " (" + (percent > 0.0 ? "+" : "") + number(percent, 2) + " %)");
  }
  return joined(texts, " and ");
}

std::optional<WrongDatasheet> wrong_datasheet(const Trial& laws, const FittedModel& baseline, const Data& fit,
                                              int threads) {
  std::optional<WrongDatasheet> wrong;
  std::optional<FittedModel> from;
  const std::size_t most = std::min(kMostValues, laws.effects.size());
  for (std::size_t values = 1; values <= most && !wrong; ++values) {
    std::optional<FittedModel> model =
        with_another_value(from ? *from : baseline, fit, threads, most > 1 ? kForTwo : kRough);
    if (!model) break;
    const double phi = std::min(dispersion(*model), dispersion(*laws.model));
    const double behind = criterion(*model, phi) - criterion(*laws.model, phi);
    const bool several = laws.effects.size() > 1;
    if (behind <= kCannotTell)
      wrong =
          WrongDatasheet{.values = values_of(*model, baseline), .instead = behind <= (several ? 0.0 : -kWorthAnother)};
    from = std::move(model);
  }
  return wrong;
}

}  // namespace sealwatch::mismatch
