#include "services/prognostic_assessment/pst_request.hpp"
#include "services/common/text/numbers.hpp"

#include <cassert>

namespace sealwatch::prognostic_assessment {

PstRequest next_test(const AssetConfig& asset, const LeakageEstimate& estimate) {
  assert(estimate.header.event_time_known);
  const UtcTime tested{estimate.header.event_time_ns};
  PstRequest request;
  request.asset_id = asset.asset_id;
  // A test that a repetition cannot mend (the asset has no seal resistances) gave its estimate: the regular interval
  // will do.
  const bool repetition_helps = asset.condition || !estimate.estimated;
  if (!estimate.used_for_forecast && repetition_helps) {
    request.due_time_ns = tested.nanoseconds;
    request.reason = "repeat: the test of " + format_date(tested) + " could not be used: " +
                     (estimate.reasons.empty() ? std::string("no reason given") : estimate.reasons.front());
  } else {
    request.due_time_ns = add_months(tested, asset.pst.interval_months).nanoseconds;
    request.reason =
        "regular test, " + text::in_months(asset.pst.interval_months) + " after that of " + format_date(tested);
  }
  return request;
}

PstRequest first_test(const AssetConfig& asset, UtcTime replaced, const std::string& what) {
  PstRequest request;
  request.asset_id = asset.asset_id;
  request.due_time_ns = add_months(replaced, asset.pst.interval_months).nanoseconds;
  request.reason = what + ": first regular test " + text::in_months(asset.pst.interval_months) + " after it";
  return request;
}

}  // namespace sealwatch::prognostic_assessment
