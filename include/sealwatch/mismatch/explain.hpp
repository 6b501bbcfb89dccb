// `explain`: does the simulation differ from the recordings, where, by what physics, and does adding it help on
// recordings that took no part? docs/mismatch.md gives the method.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stop_token>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::mismatch {

struct ExplainOptions {
  double false_alarm_rate = 0.01;
  int maximum_laws = 3;
  int threads = 2;
  std::uint64_t seed = 1;  ///< of the bootstrap: the same seed gives the same report
  /// The search ends there with the best that it has, and says what it did not ask; a few simulations that the report
  /// needs come behind it. Where it did not cut the search it changes nothing.
  double time_limit_s = std::numeric_limits<double>::infinity();
  double time_used_s = 0.0;     ///< of it, before
  std::stop_token cancel = {};  ///< calls the analysis off, within a second: an Error
  [[nodiscard]] Status validate() const;
};

/// Called now and then with what is being done and the share done, 0..1.
using Progress = std::function<void(std::string_view step, double share)>;

/// An Error when there is nothing to analyse: no recording, recordings of different assets, a holdout that is also in
/// the fit, no channel that the plant simulates. What the data cannot tell is a verdict, not an Error.
[[nodiscard]] Result<Explanation> explain(const AssetConfig& asset, std::span<const Recording> fit,
                                          std::span<const Recording> holdout, const ExplainOptions& options = {},
                                          const Progress& progress = {});

}  // namespace sealwatch::mismatch
