#include "sealwatch/forecast/decision.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/text/numbers.hpp"

namespace sealwatch::forecast {
namespace {

Status not_negative(const char* place, double value) {
  if (value >= 0.0 && std::isfinite(value)) return {};
  return fail(
      Error{.file = {}, .place = place, .value = text::general(value), .rule = "must not be negative", .advice = {}});
}

}  // namespace

Status InterventionCosts::validate() const {
  const std::pair<const char*, double> entries[] = {{"planned", planned},
                                                    {"after_failure", after_failure},
                                                    {"failed_month", failed_month},
                                                    {"unused_month", unused_month},
                                                    {"months_to_vessel", months_to_vessel}};
  for (const auto& [place, value] : entries)
    if (Status valid = not_negative(place, value); !valid) return valid;
  return {};
}

UtcTime DecisionRow::date(UtcTime now) const {
  constexpr std::int64_t kMicrosecond_ns = 1000;
  const std::int64_t time_ns = add_months(now, months).nanoseconds;
  const std::int64_t since_ns = ((time_ns % kMicrosecond_ns) + kMicrosecond_ns) % kMicrosecond_ns;
  return {time_ns - since_ns + (2 * since_ns >= kMicrosecond_ns ? kMicrosecond_ns : 0)};
}

Result<Decision> weigh_candidates(const PredictiveDistribution& remaining_life, std::span<const Candidate> candidates,
                                  const InterventionCosts& costs) {
  if (const Status valid = costs.validate(); !valid) return fail(valid.error());
  Decision decision;
  for (const Candidate& candidate : candidates) {
    if (const Status valid = not_negative("candidate months", candidate.months); !valid) return fail(valid.error());
    if (const Status valid = not_negative("candidate cost", candidate.cost.value_or(0.0)); !valid)
      return fail(valid.error());
    const double failed = remaining_life.cdf(candidate.months);
    const double months_failed = remaining_life.expected_months_failed_before(candidate.months);
    const double months_unused = remaining_life.mean() - candidate.months + months_failed;  // E[T - t] + E[(t - T)+]
    decision.rows.push_back({.label = candidate.label,
                             .months = candidate.months,
                             .failure_probability = failed,
                             .expected_cost = candidate.cost.value_or(costs.planned) * (1.0 - failed) +
                                              costs.after_failure * failed + costs.failed_month * months_failed +
                                              costs.unused_month * months_unused});
  }
  std::stable_sort(decision.rows.begin(), decision.rows.end(),
                   [](const DecisionRow& a, const DecisionRow& b) { return a.months < b.months; });
  decision.rows.push_back({.label = "wait for failure",
                           .months = remaining_life.quantile(0.5),
                           .failure_probability = 1.0,
                           .expected_cost = costs.after_failure + costs.failed_month * costs.months_to_vessel,
                           .waiting = true});
  const auto cheapest =
      std::min_element(decision.rows.begin(), decision.rows.end(),
                       [](const DecisionRow& a, const DecisionRow& b) { return a.expected_cost < b.expected_cost; });
  decision.cheapest = static_cast<std::size_t>(cheapest - decision.rows.begin());
  return decision;
}

}  // namespace sealwatch::forecast
