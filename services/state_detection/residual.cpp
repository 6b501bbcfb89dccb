#include "services/state_detection/residual.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numeric>

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

/// The asset with its seal as measured, within psi_min and psi_max.
AssetConfig with_leakage(AssetConfig asset, double resistance) {
  if (const auto found = asset.parameters.find("R_CL"); found != asset.parameters.end()) {
    ParameterSetting& setting = found->second;
    setting.value = setting.max > setting.min ? std::clamp(resistance, setting.min, setting.max) : resistance;
  }
  return asset;
}

/// The seal's resistance with which the simulation comes nearest to the recording; nothing for an asset whose seal is
/// not described.
std::optional<double> nearest_leakage(const AssetConfig& asset, const TimeSeries& recorded,
                                      const Simulator& simulator) {
  if (!asset.seal || !asset.parameters.contains("R_CL")) return std::nullopt;
  const auto misfit = [&](double log_resistance) {
    const AssetConfig aged = with_leakage(asset, std::exp(log_resistance));
    const Result<TimeSeries> simulated = simulator.simulate(aged, recorded);
    if (!simulated) return std::numeric_limits<double>::max();
    double sum = 0.0;
    for (const ResidualSummary& one : summarise_residuals(asset, recorded, *simulated, Reference::own_baseline))
      sum += one.noise_normalised_rms * one.noise_normalised_rms;
    return sum;
  };
  constexpr int kBits = 16;  // of ln R: 0.05 %, less than the position's noise shows
  constexpr double kWorse = 0.5, kBetter = 1.5;
  std::uintmax_t evaluations = 40;
  const auto [log_resistance, least] =
      boost::math::tools::brent_find_minima(misfit, std::log(kWorse * asset.seal->resistance_60_Pa_s_m3),
                                            std::log(kBetter * asset.seal->resistance_100_Pa_s_m3), kBits, evaluations);
  return std::exp(log_resistance);
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

Result<std::vector<ResidualSummary>> residuals_of(const AssetConfig& asset, const TestWindow& window,
                                                  std::optional<double> leakage_resistance,
                                                  const Simulator& simulator) {
  const TimeSeries recorded = usable_channels(window);
  const Result<TimeSeries> nominal = simulator.simulate(asset, recorded);
  if (!nominal) return tl::unexpected(nominal.error());
  std::vector<ResidualSummary> all = summarise_residuals(asset, recorded, *nominal, Reference::nominal_model);
  if (!leakage_resistance) leakage_resistance = nearest_leakage(asset, recorded, simulator);
  const AssetConfig aged = leakage_resistance ? with_leakage(asset, *leakage_resistance) : asset;
  const Result<TimeSeries> own = leakage_resistance ? simulator.simulate(aged, recorded) : nominal;
  if (!own) return tl::unexpected(own.error());
  for (ResidualSummary& summary : summarise_residuals(asset, recorded, *own, Reference::own_baseline))
    all.push_back(std::move(summary));
  return all;
}

Result<std::vector<ResidualSummary>> residuals_of_accepted(const AssetConfig& accepted, const TestWindow& window,
                                                           std::optional<double> leakage_resistance,
                                                           const Simulator& simulator) {
  const TimeSeries recorded = usable_channels(window);
  if (!leakage_resistance) leakage_resistance = nearest_leakage(accepted, recorded, simulator);
  const AssetConfig aged = leakage_resistance ? with_leakage(accepted, *leakage_resistance) : accepted;
  const Result<TimeSeries> simulated = simulator.simulate(aged, recorded);
  if (!simulated) return tl::unexpected(simulated.error());
  return summarise_residuals(accepted, recorded, *simulated, Reference::accepted_model);
}

}  // namespace sealwatch
