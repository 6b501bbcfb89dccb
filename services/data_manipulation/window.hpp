// The one window of a test: its blocks put together, cut, brought to a uniform rate.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/test_limits.hpp"
#include "sealwatch/message/data_acquisition.hpp"
#include "sealwatch/signal/resampling.hpp"
#include "services/data_manipulation/asset_view.hpp"
#include "services/data_manipulation/options.hpp"

namespace sealwatch {

/// What must be done to a channel so that it lines up with the others.
struct Correction {
  double shift_s = 0.0;  ///< the channel is late by this much
  bool swap_sign = false;
};

/// A test's samples as they were recorded, ordered by block number and time, without FAILED channels. A channel that a
/// block lacks is NaN there.
[[nodiscard]] TimeSeries assemble(const std::vector<SampleBlock>& blocks, const std::vector<ChannelStatus>& status);

/// Cuts the rows from the first gap longer than `longest_gap_s` on; returns the reason, "" when there was none.
[[nodiscard]] std::string cut_at_gap(TimeSeries& recorded, double longest_gap_s);

/// What forbids a window of these rows, at least two: too many, too fast, too long, or too few of those that a uniform
/// window would have; nothing where there is nothing.
[[nodiscard]] std::optional<std::string> beyond_window(const TimeSeries& recorded,
                                                       const TestLimits& limits = kTestLimits);

struct UniformWindow {
  TimeSeries samples;
  double sample_rate_Hz = 0.0;
  double jitter_std_s = 0.0;
  double missing_share = 0.0;
};

/// Resamples and corrects the recorded channels; ends for which a shifted channel has no data are cut off. noise_std is
/// the recording's own, else estimated from its samples, else the asset's.
[[nodiscard]] UniformWindow make_uniform(const TimeSeries& recorded, const AssetView& asset,
                                         const std::map<std::string, Correction>& corrections);

}  // namespace sealwatch
