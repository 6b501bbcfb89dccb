// A fixed value of the asset file in place of laws that were found: a wrong value comes out as whatever law does most of
// the same, a sensor's or the input's gain above all. Where these laws fit, the linear model tells which value would do
// what they do, and how far off it would be:
//
//   misfit(R, k) = misfit - 2 g'd + d'G d  - max over x of (2 (g - G d)'x - x'G x)
//
// g = -J'r, G = J'J + P: of all unknowns of what was found and of all fixed values, P = 1 / tolerance^2 of what is known
// but for value k; d: minus the strengths of the laws R that go; x: changes of all unknowns but theirs, that of k by no
// more than kOffByAtMost. The most promising are fitted from there. A value that comes out within its tolerance, or at
// the end of its range, is no cause.
#pragma once

#include <vector>

#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

struct ValueSwap {
  KnownValue value;
  std::vector<std::size_t> out;  ///< effects that it stands for
  Trial with;                    ///< the others beside it
  double predicted = 0.0;        ///< the value by the linear model, in its own unit
};

/// Which effects of `found` may go (indices, ascending), in favour of one of `values`.
struct SwapQuestion {
  const Trial& found;
  const std::vector<std::vector<std::size_t>>& out;
  const std::vector<KnownValue>& values;
  const Data& data;
  int threads = 1;
  double behind = 0.0;                ///< criterion that what was found may be better by
  std::vector<KnownValue> back = {};  ///< that `found` has free, and that go back to what is known of them
};

/// Those that come to it, the best first; only the best has its derivatives.
[[nodiscard]] std::vector<ValueSwap> values_in_place_of(const SwapQuestion& question);

/// All that are not empty of `count` effects.
[[nodiscard]] std::vector<std::vector<std::size_t>> subsets_of(std::size_t count);

}  // namespace sealwatch::mismatch
