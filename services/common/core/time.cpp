#include "sealwatch/core/time.hpp"

#include <charconv>
#include <chrono>
#include <cmath>

#include "sealwatch/core/leap_second.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

tl::unexpected<Error> not_a_time(std::string_view text) {
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(text),
                    .rule = "must be a UTC time in ISO 8601",
                    .advice = "write it as 2031-04-12T03:00:00Z"});
}

// int64 nanoseconds since 1970 reach from 1678 to 2261.
constexpr int kFirstYear = 1700;
constexpr int kLastYear = 2250;

tl::unexpected<Error> out_of_range(std::string_view text) {
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(text),
                    .rule = "must be a time of the years " + std::to_string(kFirstYear) + " to " +
                            std::to_string(kLastYear) + ": times are counted in nanoseconds",
                    .advice = {}});
}

/// Reads exactly `digits` digits at the front of `text` and removes them.
bool take_number(std::string_view& text, std::size_t digits, int& value) {
  if (text.size() < digits) return false;
  for (std::size_t k = 0; k < digits; ++k)
    if (text[k] < '0' || text[k] > '9') return false;
  std::from_chars(text.data(), text.data() + digits, value);
  text.remove_prefix(digits);
  return true;
}

bool take(std::string_view& text, char expected) {
  if (text.empty() || text.front() != expected) return false;
  text.remove_prefix(1);
  return true;
}

/// Reads ".123456789" (any number of digits, those past nanoseconds are dropped).
bool take_fraction(std::string_view& text, std::int64_t& nanoseconds) {
  nanoseconds = 0;
  if (!take(text, '.')) return true;
  std::int64_t unit = kNanosecondsPerSecond;
  bool any = false;
  while (!text.empty() && text.front() >= '0' && text.front() <= '9') {
    unit /= 10;
    nanoseconds += unit * (text.front() - '0');
    text.remove_prefix(1);
    any = true;
  }
  return any;
}

/// Reads "Z", "+02:00", "-0330" or nothing (UTC).
bool take_zone(std::string_view& text, std::int64_t& seconds) {
  seconds = 0;
  if (text.empty() || take(text, 'Z') || take(text, 'z')) return true;
  const int sign = text.front() == '-' ? -1 : 1;
  if (!take(text, '+') && !take(text, '-')) return false;
  int hours = 0;
  int minutes = 0;
  if (!take_number(text, 2, hours)) return false;
  take(text, ':');
  if (!text.empty() && !take_number(text, 2, minutes)) return false;
  if (hours > 14 || minutes > 59) return false;
  seconds = std::int64_t{sign} * (hours * std::int64_t{3600} + minutes * std::int64_t{60});
  return true;
}

}  // namespace

UtcTime add_seconds(UtcTime time, double seconds) {
  return {time.nanoseconds + static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}

Result<UtcTime> parse_utc(std::string_view text) {
  std::string_view rest = text;
  int year = 0;
  int month = 0;
  int day = 0;
  if (!take_number(rest, 4, year) || !take(rest, '-') || !take_number(rest, 2, month) || !take(rest, '-') ||
      !take_number(rest, 2, day))
    return not_a_time(text);
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return not_a_time(text);
  if (year < kFirstYear || year > kLastYear) return out_of_range(text);
  int hour = 0;
  int minute = 0;
  int second = 0;
  std::int64_t nanoseconds = 0;
  std::int64_t zone_seconds = 0;
  if (!rest.empty()) {
    if (!take(rest, 'T') && !take(rest, ' ')) return not_a_time(text);
    if (!take_number(rest, 2, hour) || !take(rest, ':') || !take_number(rest, 2, minute)) return not_a_time(text);
    if (take(rest, ':') && !take_number(rest, 2, second)) return not_a_time(text);
    if (!take_fraction(rest, nanoseconds) || !take_zone(rest, zone_seconds) || !rest.empty()) return not_a_time(text);
    if (hour < 24 && minute < 60 && second == 60)
      return fail(
          Error{.file = {}, .place = {}, .value = std::string(text), .rule = kLeapSecond, .advice = kLeapSecondAdvice});
    if (hour > 23 || minute > 59 || second > 59) return not_a_time(text);
  }
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  const std::int64_t seconds =
      days * 86400 + hour * std::int64_t{3600} + minute * std::int64_t{60} + second - zone_seconds;
  return UtcTime{seconds * kNanosecondsPerSecond + nanoseconds};
}

std::string format_date(UtcTime time) { return format_utc(time).substr(0, 10); }

std::string format_utc(UtcTime time) {
  std::int64_t seconds = time.nanoseconds / kNanosecondsPerSecond;
  std::int64_t nanoseconds = time.nanoseconds % kNanosecondsPerSecond;
  if (nanoseconds < 0) {
    nanoseconds += kNanosecondsPerSecond;
    --seconds;
  }
  const std::chrono::sys_seconds moment{std::chrono::seconds(seconds)};
  const auto midnight = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day date{midnight};
  const std::chrono::hh_mm_ss clock{moment - midnight};
  std::string result = text::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(date.year()),
                                    static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                                    clock.hours().count(), clock.minutes().count(), clock.seconds().count());
  if (nanoseconds != 0) {
    result += text::format(".{:09}", nanoseconds);
    while (result.back() == '0') result.pop_back();
  }
  return result + "Z";
}

}  // namespace sealwatch
