// The whitened sensitivities of one recording: free quantities, candidate laws, residual.
#pragma once

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

/// d(simulated)/d(...) whitened: residual = recorded - simulated.
struct Pass {
  RowMatrix free;  ///< rows x (shared + own unknowns)
  RowMatrix laws;  ///< rows x columns
  Eigen::VectorXd residual;
  Eigen::Index channels = 0;
};

[[nodiscard]] Result<Pass> sensitivity_pass(const FittedModel& model, std::size_t recording,
                                            const std::vector<Candidate>& candidates,
                                            const std::vector<PassColumn>& columns);

}  // namespace sealwatch::mismatch
