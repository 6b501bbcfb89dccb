// Fixed values of an asset are known within a tolerance: each is one more unknown of every fit, with the prior
// N(value, tolerance^2), and costs nothing within it (kWithinTolerance). "Beyond tolerance" is a cause like a law
// (datasheet.hpp).
//
// Sensors' gains and offsets are known within tolerances too. They would imitate much of what small effects do: sensors
// are exact until their being off explains more than any law does (naming.cpp). From then on all of them are unknowns of
// every fit, and only what lies beyond is a cause (laws sensor_gain and sensor_bias).
//
// Only values that show take part: those whose change by one tolerance would raise the misfit by more than a quarter
// though everything that is estimated gives way,
//
//   tolerance^2 (G_cc - G_cb G_bb^-1 G_bc) > 1/4
//
// c: the value, b: what is estimated, G: normal matrix of all recordings. The others could be anything within theirs
// without a trace.
#pragma once

#include <vector>

#include "services/common/mismatch/fitted_model.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

/// Times: further off, a fixed value is not wrong but another's.
inline constexpr double kOffByAtMost = 1.5;

/// Every fixed value that is not 0, with the asset's tolerance or the plant's; not the mean load, which each recording
/// has for itself.
[[nodiscard]] std::vector<KnownValue> known_values(const AssetConfig& asset, const PlantDescription& plant);

/// A transmitter of class 0.25: standard deviation of its gain, and of its offset as a share of the channel's range in the
/// recordings. A fault from which an engineer would care (1 %) lies beyond kWithinTolerance of them.
inline constexpr double kUsualSensorTolerance = 0.0025;

/// What the sensors of the simulated channels are off by, with the asset's tolerances or the usual ones.
[[nodiscard]] std::vector<KnownValue> known_sensors(const AssetConfig& asset, const PemProblem& problem);

/// What the sensors of measured inputs are off by. Never taken for exact: no simulated channel stands beside theirs.
[[nodiscard]] std::vector<KnownValue> known_inputs(const AssetConfig& asset, const PemProblem& problem);

/// What a law of a sensor's gain or offset is called there; "" of other laws.
[[nodiscard]] std::string tolerated_name(const Effect& effect);

/// Whether a law of a sensor's gain or offset is no more than the tolerance of one of `sensors` lets it be: no fault, that is.
[[nodiscard]] bool is_within_tolerance(const Effect& effect, const FittedModel& model,
                                       const std::vector<KnownValue>& sensors);

/// ln det(I + T F T / phi): what the recordings tell of unknowns that were known before, T their tolerances, F what the
/// recordings tell of them though everything else gives way (Schur complement of the normal matrix). The price of having
/// them at all, in units of the criterion: -2 ln of the Occam factor of their evidence.
[[nodiscard]] double occam_factor(const FittedModel& model, const std::vector<KnownValue>& of, double phi);

/// The asset with a fixed value set free, up to kOffByAtMost times off and within its range.
[[nodiscard]] AssetConfig with_free_value(AssetConfig asset, const std::string& name);

/// Whether all of `values`, which the model has free, came out beyond their tolerances and not at an end of their range.
[[nodiscard]] bool are_beyond_tolerance(const FittedModel& model, const std::vector<KnownValue>& values);

/// Those of `known` that show in these recordings, at `model`; none where the model cannot be linearised.
[[nodiscard]] std::vector<KnownValue> that_show(const std::vector<KnownValue>& known, const FittedModel& model,
                                                const Data& data, int threads);

}  // namespace sealwatch::mismatch
