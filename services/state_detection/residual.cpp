#include "services/state_detection/residual.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

double noise_of(const AssetConfig& asset, const Series& recorded) {
  if (recorded.noise_std > 0.0) return recorded.noise_std;
  const auto sensor = asset.sensors.find(recorded.name);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.noise_std;
}

/// Channels that the test's own status calls OK.
TimeSeries usable_channels(const TestWindow& window) {
  TimeSeries samples = window.samples;
  for (const ChannelStatus& status : window.channel_status)
    if (status.state != ChannelState::OK)
      std::erase_if(samples.channels, [&](const Series& series) { return series.name == status.channel; });
  return samples;
}

/// The asset with a parameter as measured, within psi_min and psi_max.
AssetConfig with_value(AssetConfig asset, const std::string& parameter, double value) {
  if (const auto found = asset.parameters.find(parameter); found != asset.parameters.end()) {
    ParameterSetting& setting = found->second;
    setting.value = setting.max > setting.min ? std::clamp(value, setting.min, setting.max) : value;
  }
  return asset;
}

/// The value of what wears with which the simulation comes nearest to the recording; nothing for an asset whose
/// condition is not described.
std::optional<double> nearest_wear(const AssetConfig& asset, const TimeSeries& recorded, const Simulator& simulator,
                                   const std::stop_token& cancel) {
  if (!asset.condition || !asset.parameters.contains(asset.condition->parameter)) return std::nullopt;
  const bool positive = asset.condition->is_positive();
  const auto value_at = [&](double at) { return positive ? std::exp(at) : at; };
  const auto misfit = [&](double at) {
    constexpr double kWorst = std::numeric_limits<double>::max();
    if (cancel.stop_requested()) return kWorst;  // the search cannot be left
    const AssetConfig aged = with_value(asset, asset.condition->parameter, value_at(at));
    const Result<TimeSeries> simulated = simulator.simulate(aged, recorded, cancel);
    if (!simulated) return kWorst;
    double sum = 0.0;
    for (const ResidualSummary& one : summarise_residuals(asset, recorded, *simulated, Reference::own_baseline))
      sum += one.noise_normalised_rms * one.noise_normalised_rms;
    return sum;
  };
  constexpr int kBits = 16;  // of ln R: 0.05 %, less than the position's noise shows
  constexpr double kWorse = 0.5, kBetter = 1.5;
  std::uintmax_t evaluations = 40;
  const auto [low, high] = std::minmax(asset.condition->at_60, asset.condition->at_100);
  const double least = positive ? std::log(kWorse * low) : low - kWorse * (high - low);
  const double largest = positive ? std::log(kBetter * high) : high + kWorse * (high - low);
  const auto [at, sum] = boost::math::tools::brent_find_minima(misfit, least, largest, kBits, evaluations);
  return value_at(at);
}

/// The asset as worn as it is: by the seal's leakage where the test measured it, else by what comes nearest; nothing
/// where neither is known.
std::optional<AssetConfig> as_worn(const AssetConfig& asset, std::optional<double> leakage_resistance,
                                   std::optional<double> nearest) {
  const std::optional<ConditionSetting>& seal = plant_or_default(asset.model).condition;
  if (leakage_resistance && seal) return with_value(asset, seal->parameter, *leakage_resistance);
  if (!nearest) return std::nullopt;
  return with_value(asset, asset.condition->parameter, *nearest);
}

/// Not asked where the seal's leakage was measured.
std::optional<double> nearest_if_needed(const AssetConfig& asset, const TimeSeries& recorded,
                                        std::optional<double> leakage_resistance, const Simulator& simulator,
                                        const std::stop_token& cancel) {
  if (leakage_resistance && plant_or_default(asset.model).condition) return std::nullopt;
  return nearest_wear(asset, recorded, simulator, cancel);
}

}  // namespace

std::vector<ResidualSummary> summarise_residuals(const AssetConfig& asset, const TimeSeries& recorded,
                                                 const TimeSeries& simulated, Reference reference) {
  std::vector<ResidualSummary> summaries;
  for (const Series& predicted : simulated.channels) {
    const Series* measured = recorded.find(predicted.name);
    if (measured == nullptr || measured->values.size() != predicted.values.size() || measured->values.empty()) continue;
    const auto count = static_cast<double>(measured->values.size());
    const double mean = std::accumulate(measured->values.begin(), measured->values.end(), 0.0) / count;
    double residual = 0.0;
    double variation = 0.0;
    for (std::size_t k = 0; k < measured->values.size(); ++k) {
      residual += std::pow(measured->values[k] - predicted.values[k], 2);
      variation += std::pow(measured->values[k] - mean, 2);
    }
    const double noise = noise_of(asset, *measured);
    if (!(noise > 0.0) || !(variation > 0.0) || !std::isfinite(residual)) continue;
    summaries.push_back({predicted.name, reference, std::sqrt(residual / count) / noise,
                         100.0 * (1.0 - std::sqrt(residual / variation))});
  }
  return summaries;
}

Result<Residuals> residuals_of(const AssetConfig& asset, const TestWindow& window,
                               std::optional<double> leakage_resistance, const Simulator& simulator,
                               const std::stop_token& cancel) {
  const TimeSeries recorded = usable_channels(window);
  const Result<TimeSeries> nominal = simulator.simulate(asset, recorded, cancel);
  if (!nominal) return tl::unexpected(nominal.error());
  Residuals all{.summaries = summarise_residuals(asset, recorded, *nominal, Reference::nominal_model),
                .nearest_wear = nearest_if_needed(asset, recorded, leakage_resistance, simulator, cancel)};
  const std::optional<AssetConfig> worn = as_worn(asset, leakage_resistance, all.nearest_wear);
  const Result<TimeSeries> own = worn ? simulator.simulate(*worn, recorded, cancel) : nominal;
  if (!own) return tl::unexpected(own.error());
  for (ResidualSummary& summary : summarise_residuals(asset, recorded, *own, Reference::own_baseline))
    all.summaries.push_back(std::move(summary));
  return all;
}

Result<std::vector<ResidualSummary>> residuals_of_accepted(const AssetConfig& accepted, const TestWindow& window,
                                                           std::optional<double> leakage_resistance,
                                                           const Simulator& simulator, const std::stop_token& cancel) {
  const TimeSeries recorded = usable_channels(window);
  const std::optional<AssetConfig> worn = as_worn(
      accepted, leakage_resistance, nearest_if_needed(accepted, recorded, leakage_resistance, simulator, cancel));
  const Result<TimeSeries> simulated = simulator.simulate(worn.value_or(accepted), recorded, cancel);
  if (!simulated) return tl::unexpected(simulated.error());
  return summarise_residuals(accepted, recorded, *simulated, Reference::accepted_model);
}

}  // namespace sealwatch
