// All judgements of one test, before hysteresis and delay.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/state_detection/baseline.hpp"

namespace sealwatch {

/// Indicators against fixed limits and against the asset's own baseline, where each applies.
[[nodiscard]] std::vector<RegionJudgement> judge_indicators(const AssetConfig& asset,
                                                            const std::vector<Quantity>& indicators,
                                                            const Baseline& baseline);

/// "residual.<channel>": of the nominal model in percent of the channel's variation (100 - nrmse_percent; not for a
/// channel that hardly varies), of the own baseline as noise-normalised rms, of the accepted model as the same against
/// a baseline of its own.
[[nodiscard]] std::vector<RegionJudgement> judge_residuals(const AssetConfig& asset,
                                                           const std::vector<ResidualSummary>& residuals,
                                                           const Baseline& baseline, const Baseline& accepted_baseline);

/// A value that was judged before, by what is the baseline now; nothing where no rule is about it any more.
[[nodiscard]] std::optional<RegionJudgement> judge_again(const AssetConfig& asset, const Quantity& quantity,
                                                         Reference reference, const Baseline& baseline,
                                                         const Baseline& accepted_baseline);

/// Values of "channel.<name>".
inline constexpr double kChannelThere = 0.0;
inline constexpr double kChannelLost = 1.0;

/// "channel.<name>" for every channel that is OK or was expected (AssetHistory::expected_channels): there or lost.
[[nodiscard]] std::vector<RegionJudgement> judge_channels(const AssetConfig& asset,
                                                          const std::vector<ChannelStatus>& channels,
                                                          const std::set<std::string>& expected);

/// Status of a channel that was expected and is not OK; those that are not mentioned any more are NOT_USED. And of one
/// that is recorded and FAILED though it was never OK: a sensor that is dead from the first test on.
[[nodiscard]] std::vector<ChannelStatus> stale_channels(const std::vector<ChannelStatus>& channels,
                                                        const std::set<std::string>& expected);

}  // namespace sealwatch
