#include "services/advisory_generation/options.hpp"

namespace sealwatch::advisory_generation {
namespace {

Error broken(const char* place, double value, const char* rule) {
  return Error{.file = {}, .place = place, .value = std::to_string(value), .rule = rule, .advice = {}};
}

}  // namespace

Status Options::validate() const {
  if (!(largest_failure_probability > 0.0 && largest_failure_probability <= 0.5))
    return fail(broken("largest_failure_probability", largest_failure_probability, "must be above 0, at most 0.5"));
  if (!(booking_horizon_months > 0.0 && booking_horizon_months < planning_horizon_months))
    return fail(
        broken("booking_horizon_months", booking_horizon_months, "must be above 0, below planning_horizon_months"));
  if (!(urgent_months >= 0.0)) return fail(broken("urgent_months", urgent_months, "must not be negative"));
  if (!(largest_law_gap_months > 0.0))
    return fail(broken("largest_law_gap_months", largest_law_gap_months, "must be positive"));
  if (confirming_tests < 1 || confirming_tests > confirming_window)
    return fail(broken("confirming_tests", static_cast<double>(confirming_tests), "must be 1 to confirming_window"));
  if (easing_tests < confirming_window)
    return fail(broken("easing_tests", static_cast<double>(easing_tests), "must be at least confirming_window"));
  if (!(date_tolerance_months >= 0.0))
    return fail(broken("date_tolerance_months", date_tolerance_months, "must not be negative"));
  if (!(date_tolerance_share >= 0.0 && date_tolerance_share < 1.0))
    return fail(broken("date_tolerance_share", date_tolerance_share, "must be 0 to 1"));
  if (!(dominant_likelihood > 0.0 && dominant_likelihood <= 1.0))
    return fail(broken("dominant_likelihood", dominant_likelihood, "must be above 0, at most 1"));
  return {};
}

}  // namespace sealwatch::advisory_generation
