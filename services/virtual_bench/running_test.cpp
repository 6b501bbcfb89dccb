#include "services/virtual_bench/running_test.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace sealwatch::bench {
namespace {

TimeSeries slice(const TimeSeries& samples, std::size_t first, std::size_t count) {
  const auto part = [first, count](const std::vector<double>& values) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  TimeSeries out;
  out.input_hold = samples.input_hold;
  out.time_s = part(samples.time_s);
  for (const Series& channel : samples.channels)
    out.channels.push_back({channel.name, channel.unit, channel.noise_std, part(channel.values)});
  return out;
}

BlockBoundary boundary_of(bool first, bool last) {
  if (first) return last ? BlockBoundary::whole : BlockBoundary::begin;
  return last ? BlockBoundary::end : BlockBoundary::inside;
}

}  // namespace

RunningTest::RunningTest(Recording recording, std::vector<std::string> source_ids, double block_s)
    : recording_(std::move(recording)), source_ids_(std::move(source_ids)) {
  assert(recording_.start_time && !recording_.samples.time_s.empty());
  const std::vector<double>& time = recording_.samples.time_s;
  const double interval_s = time.size() > 1 ? time[1] - time[0] : block_s;
  block_samples_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(block_s / interval_s)));
}

UtcTime RunningTest::time_of(std::size_t sample) const {
  return add_seconds(*recording_.start_time, recording_.samples.time_s[sample]);
}

UtcTime RunningTest::end() const { return time_of(recording_.samples.time_s.size() - 1); }

RawSamples RunningTest::take(std::size_t count) {
  const bool last = sent_ + count == recording_.samples.time_s.size();
  RawSamples block;
  block.asset_id = recording_.asset_id;
  block.header.message_id =
      "raw_samples/" + recording_.asset_id + "/" + recording_.recording_id + "/" + std::to_string(block_number_);
  block.header.source_ids = source_ids_;
  block.header.producer = "virtual_bench";
  block.header.event_time_known = block.start_time_known = true;
  block.header.event_time_ns = block.start_time_ns = recording_.start_time->nanoseconds;
  block.source_id = "virtual_bench";
  block.block_number = block_number_++;
  block.boundary = boundary_of(sent_ == 0, last);
  block.recording_id = recording_.recording_id;
  block.test_kind = std::string(name_of(recording_.test));
  block.samples = slice(recording_.samples, sent_, count);
  sent_ += count;
  return block;
}

std::vector<RawSamples> RunningTest::take_until(UtcTime now) {
  const std::size_t samples = recording_.samples.time_s.size();
  std::vector<RawSamples> blocks;
  while (sent_ < samples) {
    const std::size_t count = std::min(block_samples_, samples - sent_);
    if (time_of(sent_ + count - 1) > now) break;
    blocks.push_back(take(count));
  }
  return blocks;
}

RawSamples RunningTest::abort(UtcTime now, const std::string& reason) {
  assert(!finished());
  std::size_t kept = sent_ + 1;
  while (kept < recording_.samples.time_s.size() && time_of(kept) <= now) ++kept;
  recording_.samples = slice(recording_.samples, 0, kept);
  RawSamples block = take(kept - sent_);
  block.aborted = true;
  block.abort_reason = reason;
  return block;
}

}  // namespace sealwatch::bench
