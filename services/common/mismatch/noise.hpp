// Noise of the recordings from the recordings alone: standard deviation per channel (signal/noise_floor.hpp, unless
// the sidecar gives it) and its colour.
//
//   quiet pieces     the quarter of all pieces of 64 samples in which least moves (polynomials of degree 3 to 7);
//                    what is beyond these polynomials has no part in the choice
//   colour           autocovariance of that rest, pooled over pieces and recordings; AR(3) by Yule and Walker, only
//                    where the correlation is significant, and where polynomials of up to degree 15 leave the same:
//                    what they take off beside is motion
//   standard deviation   that of the coloured noise, where colour was found: differences do not see slow noise
//
// Never from a model's residuals. Yule-Walker: G. U. Yule, Phil. Trans. Royal Society A 226 (1927) 267.
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Fills data.colour, and noise_std of the channels where slow noise is larger than differences say; sentences on what
/// was found.
[[nodiscard]] std::vector<std::string> find_noise(Data& data, const std::vector<std::string>& channels);

}  // namespace sealwatch::mismatch
