#include "services/data_acquisition/open_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sealwatch/core/test_limits.hpp"
#include "sealwatch/core/units.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kLeftOut = "left out: ";
constexpr std::size_t kIntervalsForUsual = 20;  // whose median is the usual interval
constexpr double kLongestStep_s = 1.0;          // a longer gap says nothing about how far a speed has come
constexpr double kFallbackStroke_m = 0.05;

double stroke_of(const AssetConfig* asset, const PlantDescription& plant) {
  const ParameterDescription* stroke = plant.find_parameter(ParameterRole::stroke);
  if (stroke == nullptr) return kFallbackStroke_m;
  if (asset) {
    const auto found = asset->parameters.find(stroke->name);
    if (found != asset->parameters.end()) return found->second.value;
  }
  return stroke->value;
}

SensorSetting sensor_of(const AssetConfig* asset, const std::string& channel) {
  if (!asset) return {};
  const auto found = asset->sensors.find(channel);
  return found == asset->sensors.end() ? SensorSetting{} : found->second;
}

/// A block without rows counts as one row, so that a test of such blocks has an end too.
double numbers_of(std::size_t rows, std::size_t channels) {
  return static_cast<double>(std::max<std::size_t>(rows, 1)) * static_cast<double>(channels + 1);
}

double value_at(const TimeSeries& samples, const PlantDescription* plant, ChannelRole channel, std::size_t row) {
  const Series* series = plant == nullptr ? nullptr : find_series(samples, *plant, channel);
  return series ? series->values[row] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

OpenTest::OpenTest(std::string asset_id, const AssetConfig* asset, const PlantDescription* plant,
                   const DataAcquisitionOptions& options)
    : asset_id_(std::move(asset_id)), plant_(plant), options_(&options) {
  travel_.fill(std::numeric_limits<double>::quiet_NaN());
  if (!plant_) return;
  const double stroke_m = stroke_of(asset, *plant_);
  for (const ChannelDescription& channel : plant_->channels)
    watches_.emplace_back(channel.name, ChannelWatch(channel, sensor_of(asset, channel.name), stroke_m, *options_));
}

/// Beyond the longest test a time is damaged, like one that goes back.
bool OpenTest::is_time(double time_s) const {
  const bool in_test = !first_time_s_ || time_s - *first_time_s_ <= kTestLimits.longest_s;
  return plausible(time_s, kTestLimits.largest_time_s).has_value() && in_test;
}

/// Rows whose time is a number and increases. A block that comes late is only held against itself.
std::vector<std::size_t> OpenTest::increasing_rows(const RawSamples& raw) {
  std::vector<std::size_t> rows;
  double before = -std::numeric_limits<double>::infinity();
  if (latest(raw.block_number) && last_time_s_) before = *last_time_s_;
  for (std::size_t row = 0; row < raw.samples.time_s.size(); ++row) {
    const double time_s = raw.samples.time_s[row];
    if (!is_time(time_s) || time_s <= before) {
      ++clock_steps_back_;
      continue;
    }
    before = time_s;
    rows.push_back(row);
  }
  return rows;
}

/// The channel in SI with these rows, or nothing when it cannot be used. Values that are missing, or that no sensor
/// gives, become NaN: a mark, which every later layer knows.
std::optional<Series> OpenTest::accept(const Series& channel, const std::vector<std::size_t>& rows) {
  const ChannelDescription* known = plant_ ? plant_->find_channel(channel.name) : nullptr;
  if (plant_ && !known) {
    left_out_[channel.name] = std::string(kLeftOut) + "not a channel of plant " + plant_->name;
    return std::nullopt;
  }
  Series series{
      .name = channel.name, .unit = known ? known->unit : channel.unit, .noise_std = channel.noise_std, .values = {}};
  const double largest = known ? largest_plausible(known->range_min, known->range_max) : kLargestOfAnyChannel;
  UnitConversion conversion;
  if (known && !channel.unit.empty() && channel.unit != known->unit) {
    const Result<UnitConversion> found = find_unit(channel.unit);
    if (!found || found->si_unit != known->unit) {
      left_out_[channel.name] = std::string(kLeftOut) + "unit '" + channel.unit + "' is not a unit of this channel";
      return std::nullopt;
    }
    conversion = *found;
    series.noise_std *= conversion.scale;
  }
  series.noise_std = std::max(0.0, plausible(series.noise_std, largest).value_or(0.0));
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  series.values.reserve(rows.size());
  for (const std::size_t row : rows) {
    const double value = row < channel.values.size() ? conversion.to_si(channel.values[row]) : kMissing;
    series.values.push_back(plausible(value, largest).value_or(kMissing));
  }
  return series;
}

TimeSeries OpenTest::clean(const RawSamples& raw) {
  const std::vector<std::size_t> rows = increasing_rows(raw);
  TimeSeries samples;
  samples.input_hold = raw.samples.input_hold;
  for (const std::size_t row : rows) samples.time_s.push_back(raw.samples.time_s[row]);
  for (const Series& channel : raw.samples.channels) {
    if (samples.has(channel.name)) continue;  // sent twice: the first counts
    if (std::optional<Series> series = accept(channel, rows)) samples.channels.push_back(std::move(*series));
  }
  return samples;
}

std::optional<std::string> OpenTest::beyond_limits(const RawSamples& raw) const {
  const std::vector<double>& time_s = raw.samples.time_s;
  const std::size_t channels = raw.samples.channels.size();
  if (channels > kTestLimits.most_channels) return sealwatch::beyond_limits({}, channels);
  if (auto why = too_many_numbers(numbers_ + numbers_of(time_s.size(), channels))) return why;
  if (time_s.empty() || !first_time_s_ || !plausible(time_s.front(), kTestLimits.largest_time_s)) return std::nullopt;
  return too_long(time_s.front() - *first_time_s_);
}

void OpenTest::complete(const RawSamples& raw, SampleBlock& block) {
  block.samples = clean(raw);
  block.clock_steps_back = clock_steps_back_;
  absorb(block);
  block.dropped_samples = missing_rows_;
  block.channel_status = status();
}

void OpenTest::absorb(const SampleBlock& block) {
  for (const ChannelStatus& status : block.channel_status)
    if (status.reason.starts_with(kLeftOut)) left_out_[status.channel] = status.reason;
  const bool in_order = latest(block.block_number);
  if (in_order && !seen_.empty() && block.block_number > *seen_.rbegin() + 1)
    for (auto& [name, watch] : watches_) watch.interrupt();
  clock_steps_back_ = std::max(clock_steps_back_, block.clock_steps_back);
  count_rows(block, in_order);
  take_rows(block);
  seen_.insert(block.block_number);
  last_ = block;
  last_->samples = {};
}

void OpenTest::count_gap(double interval_s) {
  if (usual_interval_s_ <= 0.0) {
    first_intervals_s_.push_back(interval_s);
    if (first_intervals_s_.size() < kIntervalsForUsual) return;
    std::nth_element(first_intervals_s_.begin(), first_intervals_s_.begin() + kIntervalsForUsual / 2,
                     first_intervals_s_.end());
    usual_interval_s_ = first_intervals_s_[kIntervalsForUsual / 2];
    for (const double earlier : std::exchange(first_intervals_s_, {})) count_gap(earlier);
    return;
  }
  if (interval_s > options_->gap_factor * usual_interval_s_)
    missing_rows_ += static_cast<std::uint64_t>(std::llround(std::min(interval_s / usual_interval_s_, 1e12))) - 1;
}

/// Gaps inside the block and before it; a late block fills the gap that its absence had made.
void OpenTest::count_rows(const SampleBlock& block, bool in_order) {
  const std::vector<double>& time_s = block.samples.time_s;
  rows_ += time_s.size();
  numbers_ += numbers_of(time_s.size(), block.samples.channels.size());
  if (time_s.empty()) return;
  if (!first_time_s_) first_time_s_ = time_s.front();
  for (std::size_t row = 1; row < time_s.size(); ++row) count_gap(time_s[row] - time_s[row - 1]);
  if (!in_order) {
    missing_rows_ -= std::min<std::uint64_t>(missing_rows_, time_s.size());
    return;
  }
  if (last_time_s_) count_gap(time_s.front() - *last_time_s_);
  last_time_s_ = time_s.back();
}

void OpenTest::take_rows(const SampleBlock& block) {
  const TimeSeries& samples = block.samples;
  const auto advance = [](double& travelled, double speed, double step_s) {
    if (!std::isfinite(speed)) return;
    if (std::isnan(travelled)) travelled = 0.0;
    if (step_s < kLongestStep_s) travelled += speed * step_s;
  };
  for (std::size_t row = 0; row < samples.time_s.size(); ++row) {
    const double step_s = row > 0 ? samples.time_s[row] - samples.time_s[row - 1] : usual_interval_s_;
    travel_[static_cast<std::size_t>(Witness::position)] = value_at(samples, plant_, ChannelRole::stroke, row);
    travel_[static_cast<std::size_t>(Witness::pump_angle)] = value_at(samples, plant_, ChannelRole::shaft_angle, row);
    advance(travel_[static_cast<std::size_t>(Witness::velocity)], value_at(samples, plant_, ChannelRole::speed, row),
            step_s);
    advance(travel_[static_cast<std::size_t>(Witness::shaft_speed)],
            value_at(samples, plant_, ChannelRole::shaft_speed, row), step_s);
    for (auto& [name, watch] : watches_)
      if (const Series* series = samples.find(name)) watch.add(samples.time_s[row], series->values[row], travel_);
  }
  if (plant_) return;
  for (const Series& channel : samples.channels)
    left_out_[channel.name] = "not judged: no plant is configured for asset '" + asset_id_ + "'";
}

std::vector<ChannelStatus> OpenTest::status() const {
  std::vector<ChannelStatus> result;
  const std::uint64_t lost = missing_rows_ + clock_steps_back_;
  const double lost_share = lost == 0 ? 0.0 : static_cast<double>(lost) / static_cast<double>(rows_ + lost);
  for (const auto& [name, watch] : watches_) {
    ChannelStatus status = watch.status(*options_);
    if (status.state == ChannelState::OK && lost_share > options_->unknown_missing_share) {
      status = {.channel = name,
                .state = ChannelState::UNKNOWN,
                .reason = text::percent(lost_share, 0) + " of the samples are missing or out of time order"};
    }
    const auto out = left_out_.find(name);
    if (out != left_out_.end() && status.state == ChannelState::NOT_USED)
      status = {.channel = name, .state = ChannelState::UNKNOWN, .reason = out->second};
    result.push_back(std::move(status));
  }
  for (const auto& [name, reason] : left_out_)
    if (!plant_ || !plant_->find_channel(name))
      result.push_back({.channel = name, .state = ChannelState::UNKNOWN, .reason = reason});
  return result;
}

SampleBlock OpenTest::closing_block(const std::string& reason) const {
  SampleBlock block = *last_;
  block.block_number = *seen_.rbegin() + 1;  // 0 after the highest that there is: then the first that is free
  while (seen_.contains(block.block_number)) ++block.block_number;
  block.boundary = BlockBoundary::end;
  block.aborted = true;
  block.abort_reason = reason;
  block.channel_status = status();
  block.dropped_samples = missing_rows_;
  block.clock_steps_back = clock_steps_back_;
  block.header.source_ids = {last_->header.message_id};
  block.header.message_id = "sample_block/" + block.header.pst_id + "/" + std::to_string(block.block_number);
  return block;
}

}  // namespace sealwatch
