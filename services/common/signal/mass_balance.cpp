#include "services/common/signal/mass_balance.hpp"

#include <cmath>

#include "services/common/signal/feature_parts.hpp"

namespace sealwatch::signal {
namespace {

constexpr double kClearly = 3.0;  // standard errors

}  // namespace

bool MassBalance::possible() const {
  return test_.raw(ChannelRole::flow) != nullptr && !test_.position().empty() && test_.cylinder().area_a_m2.has_value();
}

/// Mean rate of change over the range from its smoothed ends.
Estimate MassBalance::rate(const std::vector<double>& smooth, double noise_std, Range range) const {
  const double duration_s = test_.interval_s() * static_cast<double>(range.size() - 1);
  return {(smooth[range.end - 1] - smooth[range.begin]) / duration_s, std::sqrt(2.0) * noise_std / duration_s};
}

/// Flow that the compression of the oil in chamber A takes.
Estimate MassBalance::compression(Range range) const {
  const Cylinder& cylinder = test_.cylinder();
  if (!cylinder.bulk_modulus_Pa) return {};
  const bool has_a = test_.raw(ChannelRole::pressure_up) != nullptr;
  const ChannelRole channel = has_a ? ChannelRole::pressure_up : ChannelRole::pressure_difference;
  const std::vector<double>* pressure = test_.smooth(channel);
  if (!pressure) return {};
  const double volume =
      cylinder.dead_volume_m3.value_or(0.0) + *cylinder.area_a_m2 * mean(part(test_.position(), range)).value;
  const double capacity = (has_a ? 1.0 : 0.5) * volume / *cylinder.bulk_modulus_Pa;
  const Estimate change = rate(*pressure, test_.smooth_noise_std(channel), range);
  return {capacity * change.value, capacity * change.std_error};
}

Estimate MassBalance::leakage(Range range) const {
  const double area = *test_.cylinder().area_a_m2;
  const Estimate flow = mean(part(*test_.raw(ChannelRole::flow), range));
  const Estimate swept = test_.raw(ChannelRole::stroke)
                             ? rate(test_.position(), test_.smooth_noise_std(ChannelRole::stroke), range)
                             : mean(part(*test_.raw(ChannelRole::speed), range));
  const Estimate stored = compression(range);
  return {flow.value - area * swept.value - stored.value,
          std::hypot(flow.std_error, area * swept.std_error, stored.std_error)};
}

std::optional<Estimate> MassBalance::leakage(const std::vector<Range>& ranges) const {
  std::vector<Estimate> estimates;
  estimates.reserve(ranges.size());
  for (const Range& range : ranges) estimates.push_back(leakage(range));
  if (estimates.empty()) return std::nullopt;
  return weighted_mean(estimates);
}

std::vector<double> MassBalance::differential_pressure() const {
  const std::vector<double>* pressure_a = test_.raw(ChannelRole::pressure_up);
  const std::vector<double>* pressure_b = test_.raw(ChannelRole::pressure_down);
  if (!pressure_a || !pressure_b) {
    const std::vector<double>* differential = test_.raw(ChannelRole::pressure_difference);
    return differential ? *differential : std::vector<double>{};
  }
  std::vector<double> result = *pressure_a;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= (*pressure_b)[i];
  return result;
}

std::optional<Estimate> MassBalance::resistance(const std::vector<Range>& ranges) const {
  const std::vector<double> differential = differential_pressure();
  if (differential.empty() || ranges.empty()) return std::nullopt;
  std::vector<Estimate> conductances;  // q / dp: linear in the noisy flow, so that averaging it is unbiased
  for (const Range& range : ranges) {
    const Estimate flow = leakage(range);
    const double pressure = mean(part(differential, range)).value;
    if (pressure == 0.0) return std::nullopt;
    conductances.push_back({flow.value / pressure, flow.std_error / std::abs(pressure)});
  }
  const Estimate conductance = weighted_mean(conductances);
  if (conductance.value < kClearly * conductance.std_error || conductance.value <= 0.0) return std::nullopt;
  return Estimate{1.0 / conductance.value, conductance.std_error / (conductance.value * conductance.value)};
}

}  // namespace sealwatch::signal
