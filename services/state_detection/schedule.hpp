// When the next partial stroke test is due, by event time alone.
//
//   due      = start of the last judged test + interval
//   overdue  = later than due + grace,  grace = grace_share * interval
//
// Only a judged test (passed or failed) counts as one: after a cut or aborted test the valve is as unproven as before.
// A replacement of the actuator counts too, since a new actuator is tested when it is installed. Monthly tests are made
// on some day of the month, so that one in time may come 45 days after the last: hence the grace of half an interval.
#pragma once

#include <optional>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time.hpp"

namespace sealwatch {

struct Lateness {
  UtcTime last;  ///< the test that the due date counts from
  UtcTime due;
  double days = 0.0;  ///< after the due date
};

class Schedule {
 public:
  void tested(UtcTime time) {
    if (!last_ || *last_ < time) last_ = time;
  }
  [[nodiscard]] bool has_begun() const { return last_.has_value(); }
  /// Moment from which a test is overdue; nothing before the first test.
  [[nodiscard]] std::optional<UtcTime> overdue_from(const PstSetting& pst, double grace_share) const;
  /// How late `time` is, when it is overdue.
  [[nodiscard]] std::optional<Lateness> lateness(UtcTime time, const PstSetting& pst, double grace_share) const;

 private:
  std::optional<UtcTime> last_;
};

}  // namespace sealwatch
