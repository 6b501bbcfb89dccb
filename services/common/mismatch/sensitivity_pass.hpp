// The whitened sensitivities of one recording: free quantities, candidate laws, residual. A recording has hundreds of
// megabytes of them, so that the laws' are kept once, as the simulation leaves them.
#pragma once

#include <memory>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// A column of the pass: one strength of one candidate at one point of its grid.
struct PassColumn {
  std::size_t candidate = 0;
  std::size_t point = 0;
  std::size_t strength = 0;  ///< which parameter of the law
  double unit = 1.0;         ///< usual size, in the law's unit
  double hidden = 0.0;       ///< initial hidden state (a second column for a free angle)
  bool own = false;          ///< belongs to each recording by itself (a free angle)
};

[[nodiscard]] std::vector<PassColumn> pass_columns(const std::vector<Candidate>& candidates);

/// d(simulated)/d(...) of one recording: residual = recorded - simulated. All whitened and weighed but the laws, whose
/// rows are so as they are asked for.
class Pass {
 public:
  RowMatrix free;  ///< rows x (shared + own unknowns)
  Eigen::VectorXd residual;
  Eigen::Index channels = 0;
  std::vector<std::size_t> not_finite;  ///< candidates that gave no finite number somewhere: their columns mean nothing

  /// The laws' columns in one row (sample * channels + channel).
  void law_row(Eigen::Index row, Eigen::Index columns, double* values) const;

 private:
  friend Result<Pass> sensitivity_pass(const FittedModel&, std::size_t, const std::vector<Candidate>&,
                                       const std::vector<PassColumn>&);

  /// Consecutive columns that come from one matrix.
  struct Run {
    const RowMatrix* from;
    Eigen::Index first, place, count;
  };
  /// A law of one channel's sensor: its column is zero in all others.
  struct SensorColumn {
    Eigen::Index place;
    Eigen::VectorXd values;  ///< per sample
  };
  void add_column(const RowMatrix& from, Eigen::Index column, std::size_t place);
  void add_law_row(Eigen::Index row, double factor, double* columns) const;

  const PemRecording* part_ = nullptr;
  std::shared_ptr<const RowMatrix> simulated_;     ///< laws that act in the plant, unwhitened
  std::shared_ptr<const RowMatrix> of_recording_;  ///< and those of the recording
  std::vector<Run> runs_;
  std::vector<std::vector<SensorColumn>> of_sensor_;  ///< per channel
};

[[nodiscard]] Result<Pass> sensitivity_pass(const FittedModel& model, std::size_t recording,
                                            const std::vector<Candidate>& candidates,
                                            const std::vector<PassColumn>& columns);

}  // namespace sealwatch::mismatch
