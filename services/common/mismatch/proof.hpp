// Does the added physics help on recordings that took part in nothing? Every shared parameter stays as it was fitted;
// a held-out recording's own load and initial state alone are estimated, for the model before and for the one after.
//
//   gain = (sum r_before^2 - sum r_after^2) / (2 phi),   phi: dispersion of the model after on the fit recordings
//
// its interval by resampling blocks of 1 s. Blocks: H. R. Kuensch, Annals of Statistics 17 (1989) 1217.
#pragma once

#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Misfit of each block of time of all recordings, before and after.
struct BlockGains {
  std::vector<double> gain;  ///< (r_before^2 - r_after^2) / 2 of each block
  /// Recordings that could not be compared, each with the reason: one of the models cannot be simulated on it.
  std::vector<std::string> not_compared = {};
};

struct GainInterval {
  double gain = 0.0, low = 0.0, high = 0.0;
};

/// Sum over the blocks with its 95 % bootstrap interval, over `dispersion`.
[[nodiscard]] GainInterval gain_interval(const BlockGains& blocks, double dispersion, std::uint64_t seed);

[[nodiscard]] BlockGains block_gains(const FittedModel& before, const FittedModel& after, std::size_t recording);

/// Rms, NRMSE and residual tests of every channel of one recording, with the curves.
[[nodiscard]] RecordingComparison compare(const FittedModel& before, const FittedModel& after, const Data& data,
                                          std::size_t recording);

/// All recordings' channels as one: mean squares.
[[nodiscard]] PooledFit pool(const std::vector<RecordingComparison>& recordings, bool holdout);

/// Misfit after over misfit before, of the channel for which it is largest of those beyond their noise; 0: none is.
[[nodiscard]] double times_worse(const PooledFit& fit);

/// The channel that comes out worse after than before, by more than a tenth and beyond its noise, most of all; null
/// where none does. What makes a channel of recordings that took no part worse does not carry over.
[[nodiscard]] const ChannelComparison* made_worse(const PooledFit& fit);

/// The channel that the model after misses most, where it misses more than half of its course by far more than the
/// noise; null where it comes near all.
[[nodiscard]] const ChannelComparison* farthest_off(const PooledFit& fit);

}  // namespace sealwatch::mismatch
