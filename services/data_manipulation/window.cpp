#include "services/data_manipulation/window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/signal/noise_floor.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

bool failed(const std::vector<ChannelStatus>& status, const std::string& channel) {
  return std::any_of(status.begin(), status.end(), [&channel](const ChannelStatus& one) {
    return one.channel == channel && one.state == ChannelState::FAILED;
  });
}

std::vector<const SampleBlock*> by_number(const std::vector<SampleBlock>& blocks) {
  std::vector<const SampleBlock*> ordered;
  ordered.reserve(blocks.size());
  for (const SampleBlock& block : blocks) ordered.push_back(&block);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const SampleBlock* a, const SampleBlock* b) { return a->block_number < b->block_number; });
  return ordered;
}

/// Appends the rows of a block that come after those already there.
void append(const SampleBlock& block, TimeSeries& recorded) {
  const std::vector<double>& time_s = block.samples.time_s;
  const auto after =
      recorded.time_s.empty() ? time_s.begin() : std::upper_bound(time_s.begin(), time_s.end(), recorded.time_s.back());
  const auto first = after - time_s.begin();
  recorded.time_s.insert(recorded.time_s.end(), after, time_s.end());
  for (Series& channel : recorded.channels) {
    const Series* from = block.samples.find(channel.name);
    if (from) channel.values.insert(channel.values.end(), from->values.begin() + first, from->values.end());
    channel.values.resize(recorded.time_s.size(), kNotANumber);
  }
}

bool is_discrete(const Series& channel) {
  return std::all_of(channel.values.begin(), channel.values.end(),
                     [](double value) { return std::isnan(value) || value == std::round(value); });
}

/// Discrete inputs (valves) and held voltages step; everything else runs smoothly between samples.
signal::Interpolation interpolation(const Series& channel, const AssetView& asset, bool input_hold) {
  if (!asset.is_input(channel.name)) return signal::Interpolation::cubic;
  return is_discrete(channel) || input_hold ? signal::Interpolation::hold : signal::Interpolation::cubic;
}

double noise_std(const Series& channel, const AssetView& asset) {
  if (channel.noise_std <= 0.0 && asset.is_input(channel.name) && is_discrete(channel)) return 0.0;
  return signal::believed_noise_std(channel, asset.noise_std(channel.name));
}

/// Grid without the ends that shifted channels do not reach.
signal::SamplingGrid common_grid(signal::SamplingGrid grid, const std::map<std::string, Correction>& corrections) {
  double at_begin_s = 0.0;
  double at_end_s = 0.0;
  for (const auto& [channel, correction] : corrections) {
    at_begin_s = std::max(at_begin_s, -correction.shift_s);
    at_end_s = std::max(at_end_s, correction.shift_s);
  }
  const auto rows = [&grid](double duration_s) {
    return static_cast<std::size_t>(std::ceil(duration_s / grid.interval_s - 1e-9));
  };
  const std::size_t cut = std::min(rows(at_begin_s) + rows(at_end_s), grid.count);
  grid.begin_s = grid.time_s(rows(at_begin_s));
  grid.count -= cut;
  return grid;
}

double missing_share(const TimeSeries& recorded, const signal::SamplingGrid& grid) {
  if (recorded.channels.empty()) return static_cast<double>(grid.missing_count) / static_cast<double>(grid.count);
  std::size_t missing = grid.missing_count * recorded.channels.size();
  for (const Series& channel : recorded.channels)
    missing += static_cast<std::size_t>(std::count_if(channel.values.begin(), channel.values.end(),
                                                      [](double value) { return !std::isfinite(value); }));
  return static_cast<double>(missing) / static_cast<double>(grid.count * recorded.channels.size());
}

}  // namespace

TimeSeries assemble(const std::vector<SampleBlock>& blocks, const std::vector<ChannelStatus>& status) {
  TimeSeries recorded;
  const std::vector<const SampleBlock*> ordered = by_number(blocks);
  for (const SampleBlock* block : ordered) {
    recorded.input_hold = recorded.input_hold || block->samples.input_hold;
    for (const Series& channel : block->samples.channels)
      if (!recorded.has(channel.name) && !failed(status, channel.name))
        recorded.channels.push_back({channel.name, channel.unit, channel.noise_std, {}});
  }
  for (const SampleBlock* block : ordered) append(*block, recorded);
  return recorded;
}

std::string cut_at_gap(TimeSeries& recorded, double longest_gap_s) {
  const std::vector<double>& time_s = recorded.time_s;
  const auto gap = std::adjacent_find(time_s.begin(), time_s.end(),
                                      [longest_gap_s](double a, double b) { return b - a > longest_gap_s; });
  if (gap == time_s.end()) return {};
  std::string reason = text::format("cut: nothing was recorded for {:.1f} s after {:.1f} s", *(gap + 1) - *gap, *gap);
  const auto rows = static_cast<std::size_t>(gap - time_s.begin()) + 1;
  recorded.time_s.resize(rows);
  for (Series& channel : recorded.channels) channel.values.resize(rows);
  return reason;
}

std::optional<std::string> beyond_window(const TimeSeries& recorded, const TestLimits& limits) {
  const std::size_t channels = recorded.channels.size();
  if (auto why = beyond_limits(recorded.time_s, channels, limits)) return why;
  const signal::SamplingGrid grid = signal::find_grid(recorded.time_s);
  if (auto why = too_fast(grid.interval_s, limits)) return why;
  const auto rows = static_cast<double>(recorded.time_s.size());
  const auto window_rows = static_cast<double>(grid.count);
  if (window_rows > limits.most_window_rows_per_row * rows)
    return text::format("rows {:.3g} s apart but for gaps: {:.0f} rows would stand for the {:.0f} recorded",
                        grid.interval_s, window_rows, rows);
  return too_many_numbers(window_rows * static_cast<double>(channels + 1), limits);
}

UniformWindow make_uniform(const TimeSeries& recorded, const AssetView& asset,
                           const std::map<std::string, Correction>& corrections) {
  const signal::SamplingGrid whole = signal::find_grid(recorded.time_s);
  const signal::SamplingGrid grid = common_grid(whole, corrections);
  UniformWindow window{.samples = {.time_s = {}, .channels = {}, .input_hold = recorded.input_hold},
                       .sample_rate_Hz = 1.0 / grid.interval_s,
                       .jitter_std_s = grid.jitter_std_s,
                       .missing_share = missing_share(recorded, whole)};
  for (std::size_t k = 0; k < grid.count; ++k) window.samples.time_s.push_back(grid.time_s(k));
  for (const Series& channel : recorded.channels) {
    const auto found = corrections.find(channel.name);
    const Correction correction = found == corrections.end() ? Correction{} : found->second;
    Series uniform{channel.name, channel.unit, noise_std(channel, asset), {}};
    uniform.values = signal::resample(recorded.time_s, channel.values, grid,
                                      interpolation(channel, asset, recorded.input_hold), correction.shift_s);
    if (correction.swap_sign)
      for (double& value : uniform.values) value = -value;
    window.samples.channels.push_back(std::move(uniform));
  }
  return window;
}

}  // namespace sealwatch
