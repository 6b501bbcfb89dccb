// Topics into and out of data acquisition (ISO 13374 DA): blocks of samples with PST boundaries and channel status.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(BlockBoundary, inside, begin, end, whole)  // whole: begin and end in one block

/// Topic raw_samples: what a bench, a replay or a foreign MCS process sends. A foreign sender need only fill asset_id,
/// source_id, block_number, boundary and samples; everything else has working defaults.
struct RawSamples {
  std::string asset_id;  // key
  Header header;
  std::string source_id;           ///< who sends: "virtual_bench", "replay", "mcs"
  std::uint64_t block_number = 0;  ///< 0, 1, 2, ... within one test: gaps are noticed
  BlockBoundary boundary = BlockBoundary::inside;
  std::string recording_id;  ///< name of the test, same in all its blocks; may be ""
  std::string test_kind;     ///< "pst", "full_stroke", "other"; "" means pst
  std::string content_hash;  ///< of the whole recording where the sender knows it, else ""
  bool start_time_known = false;
  std::int64_t start_time_ns = 0;  ///< UTC of time_s = 0
  bool aborted = false;            ///< the sender says that the test was given up
  std::string abort_reason;        ///< "MCS command had priority"
  TimeSeries samples;              ///< time_s counts from the start of the test
  SEALWATCH_FIELDS(RawSamples, asset_id, header, source_id, block_number, boundary, recording_id, test_kind,
                   content_hash, start_time_known, start_time_ns, aborted, abort_reason, samples)
  friend bool operator==(const RawSamples&, const RawSamples&) = default;
};

/// Topic sample_block: time-stamped samples of one test with what was noticed on each channel so far.
struct SampleBlock {
  std::string asset_id;  // key
  Header header;         ///< message_id "sample_block/<pst_id>/<block_number>"
  std::string source_id;
  std::uint64_t block_number = 0;
  BlockBoundary boundary = BlockBoundary::inside;
  std::string recording_id;
  std::string test_kind;
  bool aborted = false;
  std::string abort_reason;
  std::vector<ChannelStatus> channel_status;  ///< one per channel of the plant; final in the block with boundary end
  std::uint64_t dropped_samples = 0;          ///< missing rows noticed so far in this test
  std::uint64_t clock_steps_back = 0;         ///< samples left out because their time did not increase
  TimeSeries samples;
  SEALWATCH_FIELDS(SampleBlock, asset_id, header, source_id, block_number, boundary, recording_id, test_kind, aborted,
                   abort_reason, channel_status, dropped_samples, clock_steps_back, samples)
  friend bool operator==(const SampleBlock&, const SampleBlock&) = default;
};

}  // namespace sealwatch
