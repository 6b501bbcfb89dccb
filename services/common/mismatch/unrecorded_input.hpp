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
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Weights of the residuals of `data`, which `model` was fitted to; no recording where all weights are above 0.95.
[[nodiscard]] std::vector<Eigen::VectorXd> unrecorded_input_weights(const FittedModel& model, const Data& data);

/// Per channel the share of samples that count less than half; "" where there is none.
[[nodiscard]] std::string unrecorded_input_in_words(const FittedModel& model);

}  // namespace sealwatch::mismatch
