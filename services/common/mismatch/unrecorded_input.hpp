// What an input does between two samples is not recorded, and the simulation takes it as linear. Where it swings from
// sample to sample (a controller that chatters, a stick-slip), what answers at once is off, whatever the physics: laws
// of drivers and sensors would be bent to it. Those residuals count less.
//
//   weight = sigma / sqrt(sigma^2 + (c max d)^2)
//
// d: change of the simulation with every second sample left out (estimation/interpolation_error.hpp); its largest
// within 20 samples either side. c: how far the course was off in such changes, 0 where it was linear, a third where it
// is smooth, above 1 where it swings as fast as it is sampled. The residuals e [sigma] tell which: c is likeliest, from 0
// to 1.5, with
//
//   e ~ N(0, phi (1 + (c max d / sigma)^2)),   phi >= 1
//
// phi: what else the model misses, before laws are sought. A gross misfit hides c, which then is the largest: on tests
// with stick and slip, the right law in the model, 1.5 leaves 1.3 times the noise where 3 to 13 were left.
//
// Its course feigns laws as well, weak ones that act all the time: with the right law in the model, a stick-slip of 31
// s at 200 Hz wanted friction and drag of 1 to 3 % of a size that matters. There the change shows by itself,
//
//   sum of (c weight d / sigma)^2 over a recording > 2.25 (2 lambda) = 121.5
//
// (149 to 221 there; 7 to 34 of other tests at 200 Hz, 45 to 77 at 100 Hz, all with c = 1.5), and laws must then want 5 %
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
