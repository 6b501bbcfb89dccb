#include "sealwatch/forecast/safety_margin.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/text/numbers.hpp"

namespace sealwatch::forecast {
namespace {

Status positive(const char* place, double value) {
  if (value > 0.0 && std::isfinite(value)) return {};
  return fail(
      Error{.file = {}, .place = place, .value = text::general(value), .rule = "must be positive", .advice = {}});
}

}  // namespace

Status ProofTesting::validate() const {
  if (auto s = positive("dangerous_undetected_per_hour", dangerous_undetected_per_hour); !s) return s;
  if (auto s = positive("partial_stroke_interval_h", partial_stroke_interval_h); !s) return s;
  if (auto s = positive("full_stroke_interval_h", full_stroke_interval_h); !s) return s;
  if (!(partial_stroke_coverage >= 0.0 && partial_stroke_coverage <= 1.0))
    return fail(Error{.file = {},
                      .place = "partial_stroke_coverage",
                      .value = text::general(partial_stroke_coverage),
                      .rule = "must be within 0 and 1",
                      .advice = "a share: 0.6 for 60 %"});
  return {};
}

Result<double> average_failure_probability_on_demand(const ProofTesting& testing) {
  if (const Status valid = testing.validate(); !valid) return fail(valid.error());
  const double C = testing.partial_stroke_coverage;
  return 0.5 * testing.dangerous_undetected_per_hour *
         (C * testing.partial_stroke_interval_h + (1.0 - C) * testing.full_stroke_interval_h);
}

TestDue next_test_due(std::optional<UtcTime> last_test, UtcTime in_service, double interval_months, UtcTime now) {
  const UtcTime due = add_months(last_test.value_or(in_service), interval_months);
  return {.due = due, .overdue_months = std::max(months_between(due, now), 0.0)};
}

Result<ClosingMargin> closing_margin(double leakage_resistance_Pa_s_m3, const ClosingConditions& conditions) {
  const std::pair<const char*, double> entries[] = {{"leakage_resistance_Pa_s_m3", leakage_resistance_Pa_s_m3},
                                                    {"piston_area_m2", conditions.piston_area_m2},
                                                    {"stroke_m", conditions.stroke_m},
                                                    {"inlet_flow_m3_s", conditions.inlet_flow_m3_s},
                                                    {"load_N", conditions.load_N},
                                                    {"relief_pressure_Pa", conditions.relief_pressure_Pa},
                                                    {"closing_time_limit_s", conditions.closing_time_limit_s}};
  for (const auto& [place, value] : entries)
    if (const Status valid = positive(place, value); !valid) return fail(valid.error());
  const double pressure = conditions.load_N / conditions.piston_area_m2;
  const double flow_to_motion = conditions.inlet_flow_m3_s - pressure / leakage_resistance_Pa_s_m3;
  const double force = conditions.piston_area_m2 *
                       std::min(conditions.inlet_flow_m3_s * leakage_resistance_Pa_s_m3, conditions.relief_pressure_Pa);
  ClosingMargin margin{
      .closing_time_s = std::nullopt, .time_margin = -1.0, .force_margin = force / conditions.load_N - 1.0};
  // Relieved before the load gives way, or all flow through the gap: the stem stands.
  if (flow_to_motion <= 0.0 || pressure >= conditions.relief_pressure_Pa) return margin;
  margin.closing_time_s = conditions.piston_area_m2 * conditions.stroke_m / flow_to_motion;
  margin.time_margin = conditions.closing_time_limit_s / *margin.closing_time_s - 1.0;
  return margin;
}

}  // namespace sealwatch::forecast
