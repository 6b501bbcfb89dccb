#include "sealwatch/core/test_limits.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
double largest_plausible(double range_min, double range_max) {
  const bool known = range_max > range_min && std::isfinite(range_min) && std::isfinite(range_max);
  const double largest = kImplausible * std::max(std::abs(range_min), std::abs(range_max));
  return known ? std::min(largest, kLargestOfAnyChannel) : kLargestOfAnyChannel;
}

std::optional<double> plausible(double value, double largest) {
  const double size = std::abs(value);
  if (!(size <= largest)) return std::nullopt;  // true for what is no number
  return size < kSmallestNumber ? 0.0 : value;
}

std::optional<std::string> too_many_numbers(double numbers, const TestLimits& limits) {
  if (numbers <= static_cast<double>(limits.most_numbers)) return std::nullopt;
  return text::format("{:.0f} numbers (rows times channels), more than the {} that one test may have", numbers,
                      limits.most_numbers);
}

std::optional<std::string> too_long(double duration_s, const TestLimits& limits) {
  if (duration_s <= limits.longest_s) return std::nullopt;
  return text::format("{} s long, more than the {:.0f} s that one test may take", text::number(duration_s, 4),
                      limits.longest_s);
}

std::optional<std::string> too_long_to_simulate(double duration_s, double longest_step_s, const TestLimits& limits) {
  const double steps = duration_s / longest_step_s;
  if (steps <= limits.most_steps_of_simulation) return std::nullopt;
  return text::format(
      "the test is {} s long: a simulation takes {} steps of {:.3g} s, more than the {:.0f} that it may "
      "take in a service; cut the recording to the stroke and some seconds around it, record a slow plant with "
      "rows further apart, or use 'sealwatch fit', which has no such limit",
      text::number(duration_s, 4), text::number(steps), longest_step_s, limits.most_steps_of_simulation);
}

std::optional<std::string> too_fast(double interval_s, const TestLimits& limits) {
  if (interval_s >= limits.shortest_interval_s * (1.0 - 1e-6)) return std::nullopt;  // rounded when printed
  return text::format("rows {:.3g} s apart, closer than the {:.3g} s that sealwatch takes", interval_s,
                      limits.shortest_interval_s);
}

namespace {

std::optional<std::string> too_many(std::size_t rows, std::size_t channels, const TestLimits& limits) {
  if (channels > limits.most_channels)
    return text::format("{} channels, more than the {} that one test may have", channels, limits.most_channels);
  return too_many_numbers(static_cast<double>(rows) * static_cast<double>(channels + 1), limits);
}

}  // namespace

std::optional<std::string> beyond_limits(std::span<const double> time_s, std::size_t channels,
                                         const TestLimits& limits) {
  if (auto why = too_many(time_s.size(), channels, limits)) return why;
  if (time_s.size() < 2) return std::nullopt;
  const auto rows = static_cast<double>(time_s.size());
  const double duration_s = time_s.back() - time_s.front();
  if (auto why = too_long(duration_s, limits)) return why;
  return too_fast(duration_s / (rows - 1.0), limits);
}

std::optional<std::string> malformed(const TimeSeries& samples, bool gaps, const TestLimits& limits) {
  const std::vector<double>& time_s = samples.time_s;
  const auto no_time = [&](double t) { return !plausible(t, limits.largest_time_s); };
  if (std::ranges::any_of(time_s, no_time)) return "an impossible time";
  if (std::ranges::adjacent_find(time_s, std::greater_equal<>()) != time_s.end()) return "times that do not increase";
  for (const Series& channel : samples.channels) {
    const auto damaged = [&](double v) { return !(gaps && std::isnan(v)) && !plausible(v, kLargestOfAnyChannel); };
    if (channel.values.size() != time_s.size()) return "a channel with another number of samples than time";
    if (!plausible(channel.noise_std, kLargestOfAnyChannel) || channel.noise_std < 0.0)
      return "an impossible noise_std";
    if (std::ranges::any_of(channel.values, damaged)) return "a number that no sensor gives";
  }
  return too_many(time_s.size(), samples.channels.size(), limits);
}

}  // namespace sealwatch
