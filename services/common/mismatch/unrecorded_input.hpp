// What an input does between two samples is not recorded, and the simulation takes it as linear. Where it swings from
// sample to sample (a controller that chatters, a stick-slip), what answers at once is off, whatever the physics: laws
// of drivers and sensors would be bent to it. Those residuals count less.
//
//   weight = sigma / sqrt(sigma^2 + (1.5 max d)^2)
//
// d: change of the simulation with every second sample left out (estimation/interpolation_error.hpp); its largest
// within 20 samples either side. A smooth input's own error would be a third of that; of one that swings as fast as it
// is sampled it can be more than d: on such tests, the right law in the model, 1.5 leaves 1.3 times the noise where 3
// to 13 were left.
//
// Its course feigns laws as well, weak ones that act all the time: with the right law in the model, a stick-slip of 31
// s at 200 Hz wanted friction and drag of 1 to 3 % of a size that matters. There the change shows by itself,
//
//   sum of (weight d / sigma)^2 over a recording > 2 lambda = 54
//
// (66 to 98 there; 3 to 15 of other tests at 200 Hz, 20 to 34 at 100 Hz), and laws must then want 5 %
// (Data::resolution).
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct UnrecordedInput {
  std::vector<Eigen::VectorXd> weight;  ///< of each recording's residuals; no recording where all are above 0.95
  double resolution = 0.0;              ///< share of a significant strength that it feigns; 0: less than others
};

/// For `data`, which `model` was fitted to.
[[nodiscard]] UnrecordedInput unrecorded_input(const FittedModel& model, const Data& data);

/// Per channel the share of samples that count less than half; "" where there is none.
[[nodiscard]] std::string unrecorded_input_in_words(const FittedModel& model);

}  // namespace sealwatch::mismatch
