#include "services/data_acquisition/recording_blocks.hpp"

#include <algorithm>
#include <cassert>

namespace sealwatch {
namespace {

TimeSeries rows(const TimeSeries& samples, std::size_t begin, std::size_t end) {
  const auto slice = [begin, end](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(begin),
                               values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  TimeSeries part{.time_s = slice(samples.time_s), .channels = {}, .input_hold = samples.input_hold};
  for (const Series& channel : samples.channels)
    part.channels.push_back({channel.name, channel.unit, channel.noise_std, slice(channel.values)});
  return part;
}

BlockBoundary boundary(bool first, bool last) {
  if (first) return last ? BlockBoundary::whole : BlockBoundary::begin;
  return last ? BlockBoundary::end : BlockBoundary::inside;
}

RawSamples common_part(const Recording& recording, const std::string& source_id, bool replay) {
  RawSamples raw;
  raw.asset_id = recording.asset_id;
  raw.header.replay = replay;
  raw.header.event_time_known = recording.start_time.has_value();
  raw.header.event_time_ns = recording.start_time ? recording.start_time->nanoseconds : 0;
  raw.header.producer = source_id;
  raw.source_id = source_id;
  raw.recording_id = recording.recording_id;
  raw.test_kind = std::string(name_of(recording.test));
  raw.content_hash = recording.content_hash;
  raw.start_time_known = raw.header.event_time_known;
  raw.start_time_ns = raw.header.event_time_ns;
  return raw;
}

}  // namespace

std::vector<RawSamples> blocks_of(const Recording& recording, std::size_t samples_per_block,
                                  const std::string& source_id, bool replay) {
  assert(samples_per_block > 0);
  const std::size_t count = recording.samples.time_s.size();
  std::vector<RawSamples> blocks;
  for (std::size_t begin = 0; begin < count; begin += samples_per_block) {
    const std::size_t end = std::min(begin + samples_per_block, count);
    RawSamples raw = common_part(recording, source_id, replay);
    raw.block_number = blocks.size();
    raw.boundary = boundary(begin == 0, end == count);
    // A test of unknown time takes no part in forecasts; once its time is known it is another one.
    raw.header.message_id = "raw_samples/" + raw.asset_id + "/" + raw.recording_id + "/" + raw.content_hash +
                            (raw.header.event_time_known ? "/" : "/no-time/") + std::to_string(raw.block_number);
    raw.samples = rows(recording.samples, begin, end);
    blocks.push_back(std::move(raw));
  }
  return blocks;
}

RawSamples end_of(const SampleBlock& closing) {
  RawSamples raw;
  raw.asset_id = closing.asset_id;
  raw.header.message_id = "raw_samples/" + closing.asset_id + "/" + closing.header.pst_id + "/no-more";
  raw.header.producer = raw.source_id = closing.source_id;
  raw.recording_id = closing.recording_id;
  raw.test_kind = closing.test_kind;
  raw.block_number = closing.block_number;
  raw.boundary = BlockBoundary::end;
  raw.aborted = closing.aborted;
  raw.abort_reason = closing.abort_reason;
  raw.start_time_known = raw.header.event_time_known = closing.header.event_time_known;
  raw.start_time_ns = raw.header.event_time_ns = closing.header.event_time_ns;
  return raw;
}

}  // namespace sealwatch
