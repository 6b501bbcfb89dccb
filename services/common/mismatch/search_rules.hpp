// What decides how far the search for laws goes: every number with its reason.
#pragma once

#include <cstddef>

namespace sealwatch::mismatch {

struct SearchRules {
  int first_round = 8;      ///< iterations of every refit: a law that fits is there by then
  int round = 10;           ///< iterations of those that go on,
  int rounds = 3;           ///< so often
  std::size_t go_on = 5;    ///< refits that go on after the first round
  std::size_t ahead = 2;    ///< refits that come first: what they come to is to be reached by the others
  double hopeful = 10.0;    ///< times what the linear model promises in a gross misfit; times the best's misfit
  double nearer = 0.5;      ///< of the distance to the best: a round that leaves more is the last, in a gross misfit
  std::size_t singles = 8;  ///< refits of single laws
  std::size_t closed_forms = 5;
  double far = 100.0;    ///< times the noise: a model that misses by more says nothing of sizes
  double smaller = 0.1;  ///< strength with which one starts again that set out too far
};

inline constexpr SearchRules kSearch;

}  // namespace sealwatch::mismatch
