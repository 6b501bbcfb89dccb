#include "services/common/mismatch/resolution.hpp"

#include <algorithm>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch::mismatch {

double Resolution::of(const LawParameter& strength) const {
  if (strength.unit == "channel") return 0.0;
  const double least = share * sealwatch::significant_size(*plant, strength);
  return strength.unit == "s" ? std::max(least, timing_s) : least;
}

// An input that is not held may change anywhere between two samples: when, is known to a part of their distance.
Resolution resolution_of(const Data& data, const PlantDescription& plant) {
  constexpr double kShareOfInterval = 0.05;
  Resolution resolution{.share = data.resolution, .plant = &plant};
  for (const TimeSeries& recorded : data.samples) {
    const double interval_s =
        (recorded.time_s.back() - recorded.time_s.front()) / static_cast<double>(recorded.time_s.size());
    if (!recorded.input_hold) resolution.timing_s = std::max(resolution.timing_s, kShareOfInterval * interval_s);
  }
  return resolution;
}

}  // namespace sealwatch::mismatch
