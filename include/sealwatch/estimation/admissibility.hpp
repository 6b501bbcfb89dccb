// May a fit be trusted? Limits with their reasons in one place.
#pragma once

#include "sealwatch/core/result.hpp"
#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch {

struct AdmissibilityOptions {
  /// Whitened misfit of a channel above which the model is not the one that was recorded. 1 is the floor; three
  /// standard deviations of systematic misfit in every sample is a difference that no noise explains and that an
  /// engineer sees by eye.
  double largest_noise_normalised_rms = 3.0;
  /// A channel simulated worse than this explains less than half of what moved. Only asked of channels whose noise
  /// alone would allow `attainable_nrmse_percent`.
  double smallest_nrmse_percent = 50.0;
  double attainable_nrmse_percent = 80.0;
  /// Standard error of R_CL over R_CL. 10 % of a new seal's resistance is 0.05 in theta: an eighth of the way from new
  /// to failed, months of normal ageing; with more, the test says nothing that the last one did not.
  double largest_relative_std_error = 0.10;

  /// An Error naming value and rule when a limit makes no sense.
  [[nodiscard]] Status validate() const;
};

/// What speaks against a fit by this channel alone.
[[nodiscard]] std::vector<std::string> reasons_of_channel(const ChannelFit& channel,
                                                          const AdmissibilityOptions& options = {});

/// Sets `admissible` and adds the reasons against it, in words with numbers, to those that already stand in `report`.
void judge_admissibility(FitReport& report, const AdmissibilityOptions& options = {});

}  // namespace sealwatch
