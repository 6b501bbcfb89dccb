// Means of the recorded channels over the steady part of a test's phases.
//
// "Extending" is motion in +x, "retracting" in -x, whichever of the phases `out` and `back` that is; "holding" is the
// phases `hold`. The first 30 % and the last 10 % of each phase are left out: sensors' filters and the pressures settle
// there. Phases of one kind that occur more than once (a bench may run two cycles) are averaged, weighted by their
// lengths.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

enum class Motion { extending, retracting, holding };

class PhaseMeans {
 public:
  PhaseMeans(const TestWindow& window, const PlantDescription& plant);
  /// Mean of a channel that is recorded and OK; nothing when there is no such channel or phase.
  [[nodiscard]] std::optional<double> mean(ChannelRole channel, Motion motion) const;
  /// Speed from the position's change over the steady part [m/s].
  [[nodiscard]] std::optional<double> speed_from_position(Motion motion) const;
  /// The same, or the mean of the velocity where the position is not OK [m/s].
  [[nodiscard]] std::optional<double> speed(Motion motion) const;
  /// p_A - p_B, from both pressures or from the differential sensor [Pa].
  [[nodiscard]] std::optional<double> pressure_difference(Motion motion) const;

 private:
  struct Span {
    std::size_t first;
    std::size_t last;  // one past
  };
  [[nodiscard]] const Series* usable(ChannelRole channel) const;
  /// Whether the piston runs in +x there, by the position, else by the velocity; nothing where neither is OK.
  [[nodiscard]] std::optional<bool> extends(const Span& span) const;
  [[nodiscard]] std::vector<Span> spans(Motion motion) const;

  const TestWindow& window_;
  const PlantDescription& plant_;
};

}  // namespace sealwatch
