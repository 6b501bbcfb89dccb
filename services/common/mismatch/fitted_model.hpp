// A model fitted to recordings, and what changes when its asset does: the working unit of the mismatch analysis.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time.hpp"
#include "services/common/estimation/pem_search.hpp"

namespace sealwatch::mismatch {

/// Recordings of one asset with their noise.
struct Data {
  std::vector<std::string> names;
  std::vector<TimeSeries> samples;
  std::vector<NoiseColour> colour;  ///< per recording
  std::vector<int> groups = {};     ///< which recording a window was cut from; empty: whole recordings
  std::size_t window_step = 1;      ///< one window in so many counts
  bool are_parts = false;           ///< windows or halves of recordings, which do not know when these began
  /// Share of a significant strength (model/physics.hpp) that the simulation's own errors (input between samples,
  /// integration, rounding) can feign, or those of a measured input: a law must want more than that to count.
  double resolution = 0.01;
  NoiseColour of_inputs = {};  ///< of the measured channels that drive the simulation, in its inputs' order
  /// Per recording, of each residual (sample * channels + channel): what the input's unrecorded course leaves of it.
  std::vector<Eigen::VectorXd> weight = {};
  std::vector<std::optional<UtcTime>> start_time = {};  ///< per recording; empty in windows
  std::string own_parameter = {};                       ///< that each recording has for itself ("R_CL"); "": none
  std::vector<std::string> may_differ = {};             ///< parameters of which each recording may have its own
  std::vector<KnownValue> known = {};                   ///< fixed values that may be off within their tolerance
  std::vector<KnownValue> fixed = {};                   ///< all fixed values, of which one may be off further
  std::map<std::string, double> given = {};             ///< parameters as the asset file has them
  std::vector<KnownValue> sensors = {};  ///< taken for exact until one of them is found to be off within its tolerance
  /// Recordings start from what was measured. Else a recording's initial state is among its own unknowns.
  bool start_as_measured = false;
  double held_within_s = 0.0;  ///< simulations are held to the recordings (SimulationOptions::held_within_s); 0: free
  double relative_tolerance = SimulationOptions{}.relative_tolerance;  ///< where a fit sets out from no other one
  /// Mean square misfit below which simulations are not exact enough to tell laws apart: a search ends there.
  double least_excess = 0.0;
  const Deadline* deadline = nullptr;  ///< of everything that is simulated
};

struct FittedModel {
  AssetConfig asset;  ///< parameters and laws at their estimates; a recording's own parameter at that of the last one
  PemProblem problem;
  PemOptimum optimum;
  double misfit = 0.0;          ///< sum of the squares of all whitened residuals, those of what is known included
  double residuals = 0.0;       ///< how many
  std::size_t free_shared = 0;  ///< shared unknowns that are neither known beforehand nor at a bound
};

/// Relative tolerance of simulations that miss as that model does: beyond a hundred times the noise they err by the same
/// share of what is missed. Steps are then as few as the answer needs.
[[nodiscard]] double tolerance_for(const FittedModel& model);
/// Whether its simulations are about as exact as that.
[[nodiscard]] bool is_exact_enough(const FittedModel& model);

/// Of a search, where nothing else is said.
inline constexpr int kSearchIterations = 30;

/// Fits the asset's free parameters and every recording's own. `start`: a fit of the same data, from whose values the
/// search sets out, until `bound` is out of reach. `threads`: recordings that are simulated at once.
[[nodiscard]] Result<FittedModel> fit_model(const AssetConfig& asset, const Data& data, const FittedModel* start,
                                            int threads, int iterations = kSearchIterations,
                                            const SearchBound& bound = {});
/// The first iterations of the same, from values that `beside` changes (of as many unknowns as `start` has; empty: none),
/// until `bound` is out of reach. Simulations stay as exact as they were where it sets out.
[[nodiscard]] Result<FittedModel> fit_model_beside(const PemPoint& beside, const AssetConfig& asset, const Data& data,
                                                   const FittedModel& start, int threads, int iterations,
                                                   const SearchBound& bound);

/// Fits the model anew to some of its recordings (or windows), from where it ended. `places`: theirs among its own, one
/// for each of `data`; beyond these for one that it was not fitted to.
[[nodiscard]] Result<FittedModel> fit_to_some(const FittedModel& model, const Data& data,
                                              std::span<const std::size_t> places, int threads,
                                              int iterations = kSearchIterations);

/// The same of another asset, whose values it sets out from.
[[nodiscard]] Result<FittedModel> fit_to_some(const FittedModel& model, const AssetConfig& asset, const Data& data,
                                              std::span<const std::size_t> places, int threads, int iterations);

/// Goes on with the search that ended at `model`, with the same unknowns.
[[nodiscard]] Result<FittedModel> continue_fit(const FittedModel& model, const Data& data, int threads, int iterations,
                                               const SearchBound& bound = {});

/// Where the search of a recording ended: as it was kept, or computed to `anew` where its derivatives were not (refit). No
/// derivatives where they cannot be computed.
[[nodiscard]] const Linearisation& linearised(const FittedModel& model, std::size_t recording,
                                              std::optional<Linearisation>& anew);

/// As it is, but every shared parameter stays what it is: only load and initial state of each recording are fitted.
[[nodiscard]] AssetConfig with_fixed_parameters(AssetConfig asset);

/// The asset with another law; strengths and shapes are free, whole numbers are not.
[[nodiscard]] AssetConfig with_law(AssetConfig asset, const Law& law, const std::string& element,
                                   std::span<const double> parameters);

/// Whether an unknown, at that point of the search, is at an end of its range.
[[nodiscard]] bool at_bound(const Unknown& unknown, double at);

/// Value of a shared unknown by its name, in its own unit; nothing when it is not among them.
[[nodiscard]] std::optional<double> estimate_of(const FittedModel& model, const std::string& name);

}  // namespace sealwatch::mismatch
