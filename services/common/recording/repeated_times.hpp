// Rows of one time, where a log says by them that something jumps: the first is from before the jump, the last from after
// it, as simulation tools write their inputs and results (events of the FMI standard).
#pragma once

#include <cstddef>
#include <vector>

namespace sealwatch {

class RepeatedTimes {
 public:
  /// After a row has come that repeats the time of the row before: an equal row goes; of others the first moves to just
  /// before the jump, and those between first and last go. Columns without values are passed over. False where there is no
  /// time between the rows before and at the jump.
  [[nodiscard]] bool settle(std::vector<std::vector<double>>& columns, std::size_t time);

 private:
  std::size_t after_jump_ = 0;  ///< row that came last after a jump
};

}  // namespace sealwatch
