#include "services/common/model/plants/eha/estimation/volume_balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/common/estimation/channel_noise.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kFewestSamples = 20;  // below it not even the noise can be told

Status check_values(const TimeSeries& samples) {
  if (samples.time_s.size() < kFewestSamples)
    return fail("only " + std::to_string(samples.time_s.size()) + " samples, at least " +
                std::to_string(kFewestSamples) + " are needed");
  for (std::size_t k = 1; k < samples.time_s.size(); ++k)
    if (!(samples.time_s[k] > samples.time_s[k - 1]))
      return fail("time does not increase at sample " + std::to_string(k));
  for (const Series& channel : samples.channels) {
    if (channel.values.size() != samples.time_s.size()) return fail(channel.name + " has not one value for each time");
    if (!std::all_of(channel.values.begin(), channel.values.end(), [](double value) { return std::isfinite(value); }))
      return fail(channel.name + " has values that are not numbers");
  }
  return {};
}

// (tau_from s + 1)/(tau_to s + 1) on an integral: int y + (tau_from - tau_to) y, both lags being first-order.
std::vector<double> integrate_at_lag(std::span<const double> time_s, std::span<const double> values,
                                     double extra_lag_s) {
  std::vector<double> integral = integrate(time_s, values);
  for (std::size_t k = 0; k < integral.size(); ++k) integral[k] += extra_lag_s * values[k];
  return integral;
}

Status gather_pressures(const AssetConfig& asset, const TimeSeries& samples, CylinderSignals& signals) {
  const Series* a = samples.find("pressure_a");
  const Series* b = samples.find("pressure_b");
  const Series* difference = samples.find("pressure_differential");
  if (a != nullptr && b != nullptr) {
    signals.pressure_a_Pa = a->values;
    signals.pressure_difference_Pa.resize(a->values.size());
    std::transform(a->values.begin(), a->values.end(), b->values.begin(), signals.pressure_difference_Pa.begin(),
                   [](double p_a, double p_b) { return p_a - p_b; });
    signals.pressure_noise_std = noise_std_of(asset, *a);
    signals.pressure_lag_s = time_constant_of(asset, "pressure_a");
  } else if (difference != nullptr) {
    signals.pressure_difference_Pa = difference->values;
    signals.pressure_noise_std = noise_std_of(asset, *difference);
    signals.pressure_lag_s = time_constant_of(asset, "pressure_differential");
  } else {
    return fail(
        "no pressure that can be used was recorded: it takes pressure_a and pressure_b, or pressure_differential");
  }
  return {};
}

Status gather_motion(const AssetConfig& asset, const TimeSeries& samples, CylinderSignals& signals) {
  const Series* position = samples.find("position");
  const Series* velocity = samples.find("velocity");
  if (velocity != nullptr) {
    signals.velocity_m_s = velocity->values;
    signals.velocity_noise_std = noise_std_of(asset, *velocity);
    signals.velocity_lag_s = time_constant_of(asset, "velocity");
  }
  if (position != nullptr) {
    signals.position_recorded = true;
    signals.position_m = position->values;
    signals.position_noise_std = noise_std_of(asset, *position);
    signals.position_lag_s = time_constant_of(asset, "position");
  } else if (velocity != nullptr) {
    signals.position_m = integrate(samples.time_s, velocity->values);
    for (double& x : signals.position_m) x += asset.pst.start_m;
    signals.position_lag_s = signals.velocity_lag_s;
  } else {
    return fail("no motion that can be used was recorded: it takes position or velocity");
  }
  return {};
}

}  // namespace

std::vector<double> integrate(std::span<const double> time_s, std::span<const double> values) {
  std::vector<double> integral(values.size(), 0.0);
  for (std::size_t k = 1; k < values.size(); ++k)
    integral[k] = integral[k - 1] + 0.5 * (time_s[k] - time_s[k - 1]) * (values[k] + values[k - 1]);
  return integral;
}

Result<CylinderSignals> gather_cylinder_signals(const AssetConfig& asset, const TimeSeries& samples) {
  if (const Status usable = check_values(samples); !usable) return fail(usable.error());
  const auto area = asset.parameters.find("A_C");
  const auto dead_volume = asset.parameters.find("V_0");
  if (area == asset.parameters.end() || dead_volume == asset.parameters.end())
    return fail("model " + asset.model + " has no cylinder circuit with parameters A_C and V_0");
  const Series* flow = samples.find("flow");
  if (flow == nullptr) return fail("flow is not recorded, or its sensor shows nothing usable");
  CylinderSignals signals;
  signals.time_s = samples.time_s;
  signals.flow_m3_s = flow->values;
  signals.area_m2 = area->second.value;
  signals.dead_volume_m3 = dead_volume->second.value;
  if (const auto beta = asset.parameters.find("beta"); beta != asset.parameters.end())
    signals.bulk_modulus_Pa = beta->second.value;
  signals.flow_noise_std = noise_std_of(asset, *flow);
  signals.flow_lag_s = time_constant_of(asset, "flow");
  if (const Status found = gather_pressures(asset, samples, signals); !found) return fail(found.error());
  if (const Status found = gather_motion(asset, samples, signals); !found) return fail(found.error());
  if (!(signals.flow_noise_std > 0.0)) return fail("flow does not change and its noise is not known");
  return signals;
}

VolumeBalance make_volume_balance(const CylinderSignals& signals) {
  const std::size_t n = signals.time_s.size();
  const bool both_pressures = !signals.pressure_a_Pa.empty();
  const double lag_s = signals.position_lag_s;
  const std::vector<double> volume_in = integrate_at_lag(signals.time_s, signals.flow_m3_s, signals.flow_lag_s - lag_s);
  const std::vector<double> impulse =
      integrate_at_lag(signals.time_s, signals.pressure_difference_Pa, signals.pressure_lag_s - lag_s);
  VolumeBalance balance{.columns = Eigen::MatrixXd(n, both_pressures ? 3 : 2),
                        .level_step_std = std::vector<double>(n, 0.0),
                        .restart = std::vector<bool>(n, false)};
  const double flow_std = std::hypot(signals.flow_noise_std,
                                     signals.position_recorded ? 0.0 : signals.area_m2 * signals.velocity_noise_std);
  double compressed = 0.0;  // int V_A dp_A
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    balance.columns(row, 0) = volume_in[k] - signals.area_m2 * signals.position_m[k];
    balance.columns(row, 1) = impulse[k];
    if (both_pressures) {
      const auto chamber_volume = [&](std::size_t j) {
        return signals.dead_volume_m3 + signals.area_m2 * signals.position_m[j];
      };
      if (k > 0)
        compressed += 0.5 * (chamber_volume(k) + chamber_volume(k - 1)) *
                      (signals.pressure_a_Pa[k] - signals.pressure_a_Pa[k - 1]);
      balance.columns(row, 2) = compressed;
    }
    if (k > 0) balance.level_step_std[k] = flow_std * (signals.time_s[k] - signals.time_s[k - 1]);
  }
  balance.white_std =
      std::hypot(signals.area_m2 * signals.position_noise_std, (signals.flow_lag_s - lag_s) * signals.flow_noise_std);
  if (both_pressures) {
    const double mean_position_m =
        std::accumulate(signals.position_m.begin(), signals.position_m.end(), 0.0) / static_cast<double>(n);
    balance.g2_noise_std = (signals.dead_volume_m3 + signals.area_m2 * mean_position_m) * signals.pressure_noise_std;
    if (signals.bulk_modulus_Pa > 0.0)
      balance.white_std = std::hypot(balance.white_std, balance.g2_noise_std / signals.bulk_modulus_Pa);
  }
  return balance;
}

WhitenedBalance whiten(const VolumeBalance& balance) {
  using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3>;  // at most 3 columns, no allocation
  WhitenedBalance result;
  result.innovations = Eigen::MatrixXd::Zero(balance.columns.rows(), balance.columns.cols());
  const double white_variance = balance.white_std * balance.white_std;
  const double g2_variance = balance.g2_noise_std * balance.g2_noise_std;
  Row level = balance.columns.row(0);
  double level_variance = white_variance;
  for (Eigen::Index k = 1; k < balance.columns.rows(); ++k) {
    const auto sample = static_cast<std::size_t>(k);
    if (balance.restart[sample]) {
      level = balance.columns.row(k);
      level_variance = white_variance;
      continue;
    }
    level_variance += balance.level_step_std[sample] * balance.level_step_std[sample];
    const double variance = level_variance + white_variance;
    const double gain = level_variance / variance;
    const Row error = balance.columns.row(k) - level;
    result.innovations.row(k) = error / std::sqrt(variance);
    // White noise of variance s leaves the settled filter with variance 2 s / (2 - gain).
    result.noise_in_g2 += 2.0 * g2_variance / ((2.0 - gain) * variance);
    level += gain * error;
    level_variance *= 1.0 - gain;
  }
  return result;
}

}  // namespace sealwatch
