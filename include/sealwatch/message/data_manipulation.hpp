// Topics out of data manipulation (ISO 13374 DM): the test's window, cut once, and the features of the test.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(PhaseKind, rest, breakaway, out, hold, back)

/// One phase of a partial stroke test, in seconds since the start of the recording: [begin_s, end_s).
struct Phase {
  PhaseKind kind = PhaseKind::rest;
  double begin_s = 0.0;
  double end_s = 0.0;
  SEALWATCH_FIELDS(Phase, kind, begin_s, end_s)
  friend bool operator==(const Phase&, const Phase&) = default;
};

/// Something noticed about one channel while aligning: a time offset, a swapped sign.
struct AlignmentRemark {
  std::string channel;
  double time_offset_s = 0.0;  ///< positive: the channel is late by this much
  double time_offset_std_s = 0.0;
  bool sign_swapped = false;
  bool corrected = false;  ///< whether the window has it corrected
  std::string remark;
  SEALWATCH_FIELDS(AlignmentRemark, channel, time_offset_s, time_offset_std_s, sign_swapped, corrected, remark)
  friend bool operator==(const AlignmentRemark&, const AlignmentRemark&) = default;
};

/// Topic test_window: the one window of the test that all later layers use.
struct TestWindow {
  std::string asset_id;  // key
  Header header;         ///< message_id "test_window/<pst_id>"
  std::string recording_id;
  std::string test_kind;
  bool complete = false;  ///< begin and end both seen, not aborted
  bool aborted = false;
  std::string abort_reason;
  double sample_rate_Hz = 0.0;  ///< of the resampled window
  double jitter_std_s = 0.0;    ///< of the recording's sampling intervals
  double missing_share = 0.0;   ///< share of samples that had to be interpolated, 0..1
  std::string filter;           ///< what was filtered and its phase, in words: "none", "4th-order zero-phase ..."
  std::vector<ChannelStatus> channel_status;
  std::vector<AlignmentRemark> alignment;
  std::vector<Phase> phases;
  TimeSeries
      samples;  ///< uniform, unfiltered (estimators whiten themselves), aligned, noise_std estimated where unknown
  SEALWATCH_FIELDS(TestWindow, asset_id, header, recording_id, test_kind, complete, aborted, abort_reason,
                   sample_rate_Hz, jitter_std_s, missing_share, filter, channel_status, alignment, phases, samples)
  friend bool operator==(const TestWindow&, const TestWindow&) = default;
};

/// Topic test_features: what the operator's trend screens show of one test.
struct TestFeatures {
  std::string asset_id;  // key
  Header header;         ///< message_id "test_features/<pst_id>"
  std::string recording_id;
  std::string test_kind;
  bool complete = false;
  bool aborted = false;
  std::string abort_reason;
  double duration_s = 0.0;
  std::vector<ChannelStatus> channel_status;
  std::vector<AlignmentRemark> alignment;
  std::vector<Phase> phases;
  std::vector<Quantity> features;  ///< names in signal/features.hpp; a feature that cannot be had is absent
  SEALWATCH_FIELDS(TestFeatures, asset_id, header, recording_id, test_kind, complete, aborted, abort_reason, duration_s,
                   channel_status, alignment, phases, features)
  friend bool operator==(const TestFeatures&, const TestFeatures&) = default;
};

}  // namespace sealwatch
