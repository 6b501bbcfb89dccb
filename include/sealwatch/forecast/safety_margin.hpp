// Functional safety of the valve between full strokes, and what internal leakage leaves of its closing.
//
// Average probability of failure on demand with partial stroke tests (IEC 61508-6, annex B, one channel, repairs
// neglected):
//
//   PFD_avg = 1/2 lambda_DU (C T_PST + (1 - C) T_FST)
//
//   lambda_DU  rate of dangerous undetected failures [1/h];  C  share of them that a PST detects [1]
//   T_PST, T_FST  intervals of partial and full stroke tests [h]
//
// Closing of the leaking cylinder (docs/model.md): the pump's flow q feeds the motion and the gap,
//
//   t_close = A_C x_C / (q - dp/R_CL),   dp = phi (1 + Phi)/A_C
//   force at standstill  F = A_C min(q R_CL, p_max)
//
//   A_C piston area [m2], x_C stroke [m], q inlet flow [m3/s], phi (1 + Phi) load [N], R_CL leakage resistance
//   [Pa s/m3], p_max relief pressure [Pa]
#pragma once

#include <optional>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"

namespace sealwatch::forecast {

struct ProofTesting {
  double dangerous_undetected_per_hour = 1e-6;  ///< lambda_DU
  double partial_stroke_coverage = 0.6;         ///< C
  double partial_stroke_interval_h = 730.0;     ///< T_PST
  double full_stroke_interval_h = 8760.0;       ///< T_FST
  [[nodiscard]] Status validate() const;
};

[[nodiscard]] Result<double> average_failure_probability_on_demand(const ProofTesting& testing);

struct TestDue {
  UtcTime due;
  double overdue_months = 0.0;  ///< 0 until it is due
};
/// When the next test is due; with no test so far, one interval after `in_service`.
[[nodiscard]] TestDue next_test_due(std::optional<UtcTime> last_test, UtcTime in_service, double interval_months,
                                    UtcTime now);

struct ClosingConditions {
  double piston_area_m2 = 5.89e-3;
  double stroke_m = 0.080;
  double inlet_flow_m3_s = 7.85e-6;
  double load_N = 6.0e4;
  double relief_pressure_Pa = 2.1e7;
  double closing_time_limit_s = 60.0;
};

struct ClosingMargin {
  std::optional<double> closing_time_s;  ///< none: the leak takes all the flow, it does not close
  double time_margin = 0.0;              ///< limit / closing time - 1 [1]; -1 when it does not close
  double force_margin = 0.0;             ///< available / needed - 1 [1]
};
/// An Error unless the leakage resistance and the conditions are positive.
[[nodiscard]] Result<ClosingMargin> closing_margin(double leakage_resistance_Pa_s_m3,
                                                   const ClosingConditions& conditions);

}  // namespace sealwatch::forecast
