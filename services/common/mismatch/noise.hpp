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
// Never from a model's residuals, which may hold the effect that is sought. They can refute a colour, though: what
// whitening by it makes of noise of that colour is no larger, and of anything beside it at most its gain times as large,
//   w - 1 <= g (p - 1),   g = max over frequencies |1 - sum_j a_j exp(-i w j)|^2 / s^2 <= (1 + sum_j |a_j|)^2 / s^2
// with p the mean square of a channel's residuals over the noise's variance, w that of the whitened ones, s the
// innovation's standard deviation. The colour of what rang in the quiet pieces is not the noise's. Yule-Walker: G. U. Yule, Phil. Trans. Royal Society A 226 (1927) 267.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Of noise, at lags 0 to 3.
using Covariances = std::array<double, 4>;

/// Adds the products of samples at each lag, each as many as there are samples.
void add_products(const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& values, Covariances& sum);

/// Colour and standard deviation of a sensor's noise and `more` of it, independent of each other.
[[nodiscard]] std::pair<ChannelColour, double> sum_of_noise(const ChannelColour& sensor, double sensor_std,
                                                            const Covariances& more);

/// Fills data.colour, and noise_std of the channels where slow noise is larger than differences say.
void find_noise(Data& data, const std::vector<std::string>& channels);

/// A sentence for each channel whose noise has a colour. `channels`: as they were given to find_noise().
[[nodiscard]] std::vector<std::string> colours_in_words(const Data& data, const std::vector<std::string>& channels);

/// Whether residuals at the noise refute this colour. `plain`, `whitened`: their mean squares over the noise's variance.
[[nodiscard]] bool is_refuted(const ChannelColour& colour, double plain, double whitened);

/// Gives channels whose colour the residuals refute that of the residuals; false where there are none. `model`: fitted to
/// `data`.
[[nodiscard]] bool take_colour_of_residuals(const FittedModel& model, Data& data);

}  // namespace sealwatch::mismatch
