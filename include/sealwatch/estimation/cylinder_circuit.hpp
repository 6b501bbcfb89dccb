// Gray-box PEM of the cylinder circuit: leakage resistance of the piston seal from flow, pressures and position (MODEL
// section 4).
//
//   chamber A       dp_A/dt = beta/V_A (q - A_C v - (p_A - p_B)/R_CL),   V_A = V_0 + A_C x
//   integrated      y(t) = int q dt - A_C x = (1/R_CL) int (p_A - p_B) dt + (1/beta) int V_A dp_A + constant
//
// q: flow into chamber A [m3/s], x: position [m], p: pressure [Pa], positive as in docs/model.md. The integrated form
// needs no derivative of a noisy signal, and its noise is known: white flow noise sums to a random walk, position noise
// stays white,
//
//   y_k = level_k + (1/R_CL) g1_k + (1/beta) g2_k + A_C (noise of x),    level_k+1 = level_k + h_k (noise of q),
//
// a local-level model. Its Kalman filter whitens y, g1 and g2 exactly; least squares on the innovations is then the
// prediction-error estimate, with standard errors that hold (a Monte Carlo test shows it). The first level takes the
// place of the unknown initial state. All sensors are brought to the lag of the position sensor: int q dt + (tau_q -
// tau_x) q is exact for first-order lags and costs no noise.
//
// Both pressures recorded: p_A and p_B are inputs; R_CL and beta are free, in bounds.
// Only p_A - p_B recorded: the mean pressure of the two chambers is not seen, and it moves whenever the actuator starts
// or stops; any closure (p_B constant, q_V2 = -q) biases R_CL of a new seal by about -6 %, of a worn one by -1 %. So
// the level starts anew at each such transient, and only steady runs and holds count, where (p_A - p_B)/R_CL = q - A_C
// v: unbiased, at about 1.5 times the standard error; beta is not identifiable. Control by hold phases (v = 0, R_CL =
// (p_A - p_B)/q): the same estimate from the holds alone must agree. A constant error q_0 of the flow sensor cannot be
// told from leakage: it shifts 1/R_CL by q_0/(p_A - p_B).
#pragma once

#include <span>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/estimation/admissibility.hpp"
#include "sealwatch/estimation/fit_report.hpp"
#include "sealwatch/message/data_manipulation.hpp"

namespace sealwatch {

struct CylinderCircuitOptions {
  /// Flow is steady where its mean over this long before and after differs by less than `steady_flow_share` of its
  /// range.
  double steady_window_s = 0.25;
  double steady_flow_share = 0.025;
  /// The chambers' mean pressure follows a change of flow within this time (make-up and check valves).
  double settling_time_s = 1.0;
  /// Holds and whole test disagree when R_CL differs by more than this many standard errors and by more than this
  /// share.
  double hold_control_sigmas = 4.0;
  double hold_control_share = 0.05;
  AdmissibilityOptions admissibility;

  [[nodiscard]] Status validate() const;
};

/// Never fails: what cannot be fitted is a report with admissible = false and the reasons.
[[nodiscard]] FitReport fit_cylinder_circuit(const AssetConfig& asset, const TimeSeries& samples,
                                             std::span<const Phase> phases, const CylinderCircuitOptions& options = {});

/// Whether the asset's plant is one that has that circuit.
[[nodiscard]] bool has_cylinder_circuit(const AssetConfig& asset);

}  // namespace sealwatch
