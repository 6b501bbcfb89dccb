// What a forecast means in money: the expected cost of replacing the seal at each candidate date.
//
//   E(t) = c_plan(t) (1 - F(t)) + c_fail F(t) + c_down E[(t - T)+] + c_life E[(T - t)+]
//
//   t       candidate date [months from now]
//   F       predictive distribution of the remaining life T
//   c_plan  cost of a planned replacement at that candidate: vessel, spares, lost production
//   c_fail  cost of one after a failure;   c_down  cost of a month with a failed valve, until the candidate date
//   c_life  worth of a month of seal life thrown away
//
// Waiting for the failure: c_fail + c_down times the months until a vessel that is called then can come.
// The currency is the caller's. E. g. A. K. S. Jardine, A. H. C. Tsang, Maintenance, Replacement and Reliability, 2013.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/forecast/predictive_distribution.hpp"

namespace sealwatch::forecast {

struct InterventionCosts {
  double planned = 1.0;            ///< c_plan where a candidate gives none
  double after_failure = 5.0;      ///< c_fail
  double failed_month = 0.5;       ///< c_down [per month]
  double unused_month = 0.0;       ///< c_life [per month]
  double months_to_vessel = 12.0;  ///< from call to arrival after a failure
  [[nodiscard]] Status validate() const;
};

struct Candidate {
  std::string label;
  double months = 0.0;              ///< from now; 0: go now
  std::optional<double> cost = {};  ///< c_plan of this one
};

struct DecisionRow {
  std::string label;
  double months = 0.0;               ///< for waiting: the median remaining life
  double failure_probability = 0.0;  ///< before that date; for waiting 1
  double expected_cost = 0.0;
  bool waiting = false;
  /// Date of the row, whose `months` count from `now`. They give a time back within 0.1 us only, which may fall on the
  /// day before: rounded to the microsecond.
  [[nodiscard]] UtcTime date(UtcTime now) const;
};

struct Decision {
  std::vector<DecisionRow> rows;  ///< candidates in the order of time, then "wait for failure"
  std::size_t cheapest = 0;       ///< index into rows
};

/// An Error for costs that make no sense or a candidate in the past.
[[nodiscard]] Result<Decision> weigh_candidates(const PredictiveDistribution& remaining_life,
                                                std::span<const Candidate> candidates, const InterventionCosts& costs);

}  // namespace sealwatch::forecast
