#include "services/state_detection/schedule.hpp"

namespace sealwatch {

std::optional<UtcTime> Schedule::overdue_from(const PstSetting& pst, double grace_share) const {
  if (!last_ || !(pst.interval_months > 0.0)) return std::nullopt;
  return add_months(*last_, pst.interval_months * (1.0 + grace_share));
}

std::optional<Lateness> Schedule::lateness(UtcTime time, const PstSetting& pst, double grace_share) const {
  const auto overdue = overdue_from(pst, grace_share);
  if (!overdue || time < *overdue) return std::nullopt;
  const UtcTime due = add_months(*last_, pst.interval_months);
  return Lateness{*last_, due, seconds_between(due, time) / kSecondsPerDay};
}

}  // namespace sealwatch
