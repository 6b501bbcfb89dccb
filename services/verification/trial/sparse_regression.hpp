// The field's usual alternative to the analysis (SINDy: Brunton, Proctor, Kutz, PNAS 113 (2016) 3932; with inputs and
// measured states): nothing is simulated. Measured channels are smoothed and differentiated, each balance is written
// with them, and what it leaves is regressed on the catalogue's laws.
//
//   residual of a balance = sum_k theta_k b_k + sum_j kappa_j l_j
//
//   winding     z - Omega w - L di/dt, z = u - R C du/dt    b: i                  l: driver, winding
//   chamber A   q - A v                                     b: V_A dp_A/dt, dp    l: chamber A, piston seal
//   piston      A dp - m dv/dt, dp = p_A - p_B              b: v, each load       l: piston
//
// b are always in the model; l of the usual shape, scaled to unit length, by sequentially thresholded least squares:
// all, drop what is below the threshold, solve again; the threshold of the lowest BIC = N ln(RSS / N) + k ln N.
//
// What it cannot do: states that nobody measures have no balance. The pump's ports are such states, behind check valves
// that close, so shaft, pump and valves are not sought, nor chamber B, whose flow is not recorded, nor sensors. What
// fools it: noise and smoothing stand in the regressors, and neighbouring samples are counted as independent, so that
// it finds something where nothing is (tests/unit/verification/sparse_regression_test.cpp).
#pragma once

#include <string>
#include <vector>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::verification {

struct SparseTerm {
  std::string id, element;
  double strength = 0.0;  ///< in the law's unit
  double gain = 0.0;      ///< by which the BIC of its balance grows without it
};

/// What was kept, largest gain first; empty also where no balance has all its channels.
[[nodiscard]] std::vector<SparseTerm> sparse_regression(const AssetConfig& asset, const mismatch::Data& recordings,
                                                        const std::vector<mismatch::Candidate>& candidates);

}  // namespace sealwatch::verification
