// What the analysis sees of recordings that are long: fewer rows, and one as two halves, so that what one half shows can
// be proven on the other.
//
//   tau = max over the outputs of  dt (1 + 2 sum_k rho_k),  up to the first rho_k <= 0
//
// rho: autocorrelation of a recorded output. Samples closer than tau say the same twice: the halves are tau apart, and
// a recording shorter than ten tau is one test, of which nothing can be left out.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sealwatch/core/recording.hpp"

namespace sealwatch::mismatch {

/// tau [s] of the channels that stand in `outputs`; 0 where none of them moves.
[[nodiscard]] double correlation_time_s(const TimeSeries& samples, std::span<const std::string> outputs);

/// Both halves of a long recording, each named by its file and its time; nothing where it is too short.
[[nodiscard]] std::vector<Recording> in_halves(const Recording& recording, std::span<const std::string> outputs);

/// Samples times channels, time among them, of a recording that is analysed whole: half a minute of eight channels at
/// 1 kHz. The sensitivities to all laws take 2.5 kB for each number.
inline constexpr std::size_t kMostNumbersAnalysed = 250'000;

/// The recordings, of one with more numbers than that every second, third, ... row. `notes` gets a sentence for each.
[[nodiscard]] std::vector<Recording> thinned(std::span<const Recording> recordings, std::vector<std::string>& notes);

}  // namespace sealwatch::mismatch
