// Time: one representation (UTC, integer nanoseconds since 1970-01-01T00:00:00Z) and an injected clock.
// Layers and mathematics never ask the operating system for "now"; whoever needs the time is handed a Clock.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// UTC time in nanoseconds since the Unix epoch. Unknown times are std::optional<UtcTime>, never a sentinel.
struct UtcTime {
  std::int64_t nanoseconds = 0;
  friend auto operator<=>(const UtcTime&, const UtcTime&) = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

inline constexpr double kSecondsPerDay = 86400.0;
/// Mean Gregorian month, 365.2425/12 days: what "month" means in every remaining-useful-life figure.
inline constexpr double kSecondsPerMonth = 365.2425 / 12.0 * kSecondsPerDay;

[[nodiscard]] inline double seconds_between(UtcTime from, UtcTime to) {
  return static_cast<double>(to.nanoseconds - from.nanoseconds) * 1e-9;
}
[[nodiscard]] inline double months_between(UtcTime from, UtcTime to) {
  return seconds_between(from, to) / kSecondsPerMonth;
}
/// `time` plus `seconds` (rounded to the nanosecond).
[[nodiscard]] UtcTime add_seconds(UtcTime time, double seconds);
[[nodiscard]] inline UtcTime add_months(UtcTime time, double months) {
  return add_seconds(time, months * kSecondsPerMonth);
}

/// Parses ISO 8601: "2031-04-12", "2031-04-12T03:00:00Z", "2031-04-12T03:00:00.25+02:00" (no zone means UTC).
[[nodiscard]] Result<UtcTime> parse_utc(std::string_view text);
/// "2031-04-12T03:00:00Z"; fractions of a second only if there are any.
[[nodiscard]] std::string format_utc(UtcTime time);
/// "2031-04-12"
[[nodiscard]] std::string format_date(UtcTime time);

/// Where "now" comes from. The system clock is in services/common/runtime, tests inject ManualClock.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual UtcTime now() const = 0;
};

class ManualClock final : public Clock {
 public:
  explicit ManualClock(UtcTime start = {}) : now_(start) {}
  [[nodiscard]] UtcTime now() const override { return now_; }
  void set(UtcTime time) { now_ = time; }
  void advance(double seconds) { now_ = add_seconds(now_, seconds); }

 private:
  UtcTime now_;
};

}  // namespace sealwatch
