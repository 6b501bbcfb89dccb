// Which explanation of a gross misfit carries over to recordings that took no part.
//
// In a gross misfit the models' own errors, not noise, decide which laws fit best, and what fits best may bend to them.
// There an explanation counts that predicts recordings beyond doubt better than the model without laws does, and than
// itself without any of its laws.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// Of an explanation, to recordings that took no part: gains of likelihood.
struct Worth {
  bool compared = false;  ///< there are recordings that took no part, and both models can be simulated on some
  GainInterval whole;     ///< against the model without laws
  std::vector<GainInterval> of_law;  ///< against the explanation without this law; empty where nothing was compared
  std::vector<std::string> not_compared;

  [[nodiscard]] bool carries_over() const;
  /// The law that helps least, by its place in the explanation.
  [[nodiscard]] std::size_t least() const;
};

class CarryOver {
 public:
  /// An explanation without one of its laws, the others fitted anew.
  using Without = std::function<Trial(const Trial&, std::size_t law)>;

  CarryOver(const HeldOut& held_out, Trial nothing, Without without);

  /// Its worth as a whole: nothing of its laws yet.
  [[nodiscard]] Worth of_whole(const Trial& trial) const;
  [[nodiscard]] Worth of(const Trial& trial) const;
  /// Whether `trial` predicts as well as `best`; not where it cannot be simulated, or the time for it is up.
  [[nodiscard]] bool predicts_as_well(const Trial& trial, const Trial& best) const;

 private:
  HeldOut held_out_;
  Trial nothing_;
  Without without_;
};

/// Of the explanations that were tried, different ones of at most so many laws, the likeliest first.
[[nodiscard]] std::vector<Trial> likeliest(const Naming& naming, std::size_t most,
                                           std::size_t most_laws = std::numeric_limits<std::size_t>::max());

}  // namespace sealwatch::mismatch
