#include "services/common/mismatch/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch::mismatch {

double Resolution::of(const LawParameter& strength, double moved) const {
  if (strength.unit == "channel") return 0.0;
  const double least = share * sealwatch::significant_size(*plant, strength);
  if (strength.unit == "s") return std::max(least, timing_s);
  return inputs_are_known && moved > 0.0 ? std::min(least, 1.0 / moved) : least;
}

double outputs_moved_by(const FittedModel& model, std::size_t unknown) {
  const Unknown& one = model.problem.shared[unknown];
  double squares = 0.0;
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    std::optional<Linearisation> anew;
    if (const Linearisation& at = linearised(model, k, anew); at.jacobian.size() > 0)
      squares += at.jacobian.col(static_cast<Eigen::Index>(unknown)).squaredNorm();
  }
  return std::sqrt(squares / model.residuals) / std::abs(one.slope(model.optimum.point.shared[unknown]));
}

// An input that is not held may change anywhere between two samples: when, is known to a part of their distance.
Resolution resolution_of(const Data& data, const PlantDescription& plant) {
  constexpr double kShareOfInterval = 0.05;
  Resolution resolution{
      .share = data.resolution, .plant = &plant, .inputs_are_known = data.resolution <= Data{}.resolution};
  for (const TimeSeries& recorded : data.samples) {
    const double interval_s =
        (recorded.time_s.back() - recorded.time_s.front()) / static_cast<double>(recorded.time_s.size());
    if (!recorded.input_hold) resolution.timing_s = std::max(resolution.timing_s, kShareOfInterval * interval_s);
  }
  return resolution;
}

}  // namespace sealwatch::mismatch
