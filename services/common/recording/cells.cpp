#include "services/common/recording/cells.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <ctime>
#include <functional>

#include "sealwatch/core/leap_second.hpp"
#include "sealwatch/signal/statistics.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kLongestNumber = 60;
constexpr double kExcelDayOf1970 = 25569.0;   // days from 1899-12-30 to 1970-01-01
constexpr double kDatenumOfExcel = 693960.0;  // MATLAB's day number of 1899-12-30
constexpr std::int64_t kNanoseconds = 1'000'000'000;

/// ".25" or ",25" as nanoseconds; nothing where something else follows.
std::optional<std::int64_t> fraction_of_a_second(std::string_view text) {
  if (text.empty()) return 0;
  if (text.front() != '.' && text.front() != ',' && text.front() != ':') return std::nullopt;
  std::int64_t value = 0, unit = kNanoseconds;
  for (const char digit : text.substr(1)) {
    if (digit < '0' || digit > '9') return std::nullopt;
    unit /= 10;
    value += unit * (digit - '0');
  }
  return text.size() > 1 ? std::optional(value) : std::nullopt;
}

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// A switch's state in words, "true", "FALSE": 1 or 0.
std::optional<double> truth_of(std::string_view cell) {
  const auto is = [&](std::string_view word) {
    return std::ranges::equal(trim(cell), word, {}, [](unsigned char letter) { return std::tolower(letter); });
  };
  return is("true") ? std::optional(1.0) : is("false") ? std::optional(0.0) : std::nullopt;
}

/// The fraction of a second that stands before the end of the time, "03:00:00.25 AM", taken out of `text`: strptime does
/// not know it.
std::int64_t take_inner_fraction(std::string& text) {
  for (std::size_t at = 3; at + 1 < text.size(); ++at) {
    const bool is_sign = text[at] == '.' || text[at] == ',';
    if (!is_sign || text[at - 3] != ':' || !is_digit(text[at - 2]) || !is_digit(text[at - 1])) continue;
    const std::size_t end = std::min(text.find_first_not_of("0123456789", at + 1), text.size());
    const auto fraction = fraction_of_a_second(std::string_view(text).substr(at, end - at));
    if (fraction) text.erase(at, end - at);
    return fraction.value_or(0);
  }
  return 0;
}

/// The whole days of elapsed hours beyond a day's, "27:15:00", taken out of `text`: strptime's hours end at 23.
std::int64_t take_days(std::string& text) {
  constexpr std::int64_t kHours = 24;
  constexpr std::size_t kMostDigits = 5;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  if (digits < 2 || digits > kMostDigits || !text.substr(digits).starts_with(':')) return 0;
  const std::int64_t hours = std::stoll(text.substr(0, digits));
  text.replace(0, digits, std::to_string(hours % kHours));
  return hours / kHours;
}

/// "Z", "UTC", "+02", "+0200", "-05:30" at the end, with a blank before it or without one, taken off `text`: seconds east
/// of Greenwich.
std::int64_t take_zone_at_end(std::string_view& text) {
  constexpr int kFarthest_h = 14;
  for (const std::string_view zone : {"Z", "UTC", "GMT"}) {
    if (!text.ends_with(zone)) continue;
    text = trim(text.substr(0, text.size() - zone.size()));
    return 0;
  }
  const std::size_t sign = text.find_last_of("+-");
  if (sign == std::string_view::npos) return 0;
  std::string digits(text.substr(sign + 1));
  if (digits.size() == 5 && digits[2] == ':') digits.erase(2, 1);
  if ((digits.size() != 2 && digits.size() != 4) || !std::ranges::all_of(digits, is_digit)) return 0;
  const auto number = [&](std::size_t at) { return 10 * (digits[at] - '0') + digits[at + 1] - '0'; };
  const int minutes = digits.size() == 4 ? number(2) : 0;
  if (number(0) > kFarthest_h || minutes > 59) return 0;
  const std::int64_t seconds = 3600 * number(0) + 60 * minutes;
  const bool is_west = text[sign] == '-';
  text = trim(text.substr(0, sign));
  return is_west ? -seconds : seconds;
}

/// "03:00", "12.04.2031 03:00:00": digits on both sides of a colon.
bool is_clock(std::string_view cell) {
  for (std::size_t at = 1; at + 1 < cell.size(); ++at)
    if (cell[at] == ':' && is_digit(cell[at - 1]) && is_digit(cell[at + 1])) return true;
  return false;
}

Result<UtcTime> from_excel(double days) {
  if (!(days >= 1.0 && days <= 120000.0))  // the years 1900 to 2228
    return fail("must be a day number as spreadsheets count them, 45000.5 for instance");
  return UtcTime{static_cast<std::int64_t>(std::llround((days - kExcelDayOf1970) * kSecondsPerDay * 1e6)) * 1000};
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool holds_no_value(std::string_view cell) {
  const bool is_word = (trim(cell).size() > 1 && trim(cell).front() == '#' && !is_digit(trim(cell)[1])) ||
                       cell.find(".#") != std::string_view::npos;
  return is_word || (cell.find_first_of("0123456789") == std::string_view::npos && !truth_of(cell));
}

Result<double> parse_number(std::string_view text, char decimal) {
  text = trim(text);
  if (text.empty()) return fail("the cell is empty", "leave out the whole row of a missing sample");
  if (text.front() == '+') text.remove_prefix(1);
  constexpr std::string_view kMinus = "\xE2\x88\x92";  // U+2212, as spreadsheets write it in some languages
  std::array<char, kLongestNumber> with_minus{};
  if (text.starts_with(kMinus) && text.size() <= with_minus.size()) {
    with_minus[0] = '-';
    std::ranges::copy(text.substr(kMinus.size()), with_minus.begin() + 1);
    text = std::string_view(with_minus.data(), text.size() - kMinus.size() + 1);
  }
  std::array<char, kLongestNumber> with_point{};
  if (decimal != '.') {
    if (text.size() > with_point.size() || text.find('.') != std::string_view::npos) return fail("must be a number");
    std::string_view rest = text;
    for (char& letter : with_point) {
      if (rest.empty()) break;
      letter = rest.front() == decimal ? '.' : rest.front();
      rest.remove_prefix(1);
    }
    text = std::string_view(with_point.data(), text.size());
  }
  std::array<char, kLongestNumber> with_e{};
  if (const std::size_t at = text.find_first_of("Dd"); at != std::string_view::npos && text.size() <= with_e.size()) {
    std::ranges::copy(text, with_e.begin());  // Fortran's double precision: 1.5D+02
    with_e[at] = 'E';
    text = std::string_view(with_e.data(), text.size());
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return fail("is out of a double's range");
  if (error != std::errc{} || end != text.data() + text.size()) {
    const std::optional<double> truth = truth_of(text);
    return truth ? Result<double>(*truth) : fail("must be a number");
  }
  if (!std::isfinite(value)) return fail("must be a finite number", "leave out the whole row of a missing sample");
  return value;
}

Result<UtcTime> parse_pattern(std::string_view cell, const std::string& pattern) {
  std::string text(trim(cell));
  const std::int64_t days = pattern.starts_with("%H:%M:") ? take_days(text) : 0;
  const bool ends_in_seconds = pattern.ends_with("%S") || pattern.ends_with("%T");
  const std::int64_t inner = ends_in_seconds ? 0 : take_inner_fraction(text);
  std::tm parts{};
  parts.tm_mday = 1;  // of a pattern without a date: 1970-01-01
  parts.tm_year = 70;
  const char* const end = strptime(text.c_str(), pattern.c_str(), &parts);
  std::string_view rest = end != nullptr ? trim(end) : "";
  const std::int64_t zone_s = take_zone_at_end(rest);
  const auto fraction = end != nullptr ? fraction_of_a_second(rest) : std::nullopt;
  if (!fraction) return fail("must be a time as " + pattern + " describes it");
  if (parts.tm_sec > 59) return fail(kLeapSecond, kLeapSecondAdvice);
  if (parts.tm_year < -200 || parts.tm_year > 350) return fail("must be a time of the years 1700 to 2250");
  const std::int64_t seconds =
      timegm(&parts) - parts.tm_gmtoff - zone_s + days * static_cast<std::int64_t>(kSecondsPerDay);
  return UtcTime{seconds * kNanoseconds + inner + *fraction};
}

Result<TimeFormat> TimeFormat::of(std::string_view unit) {
  TimeFormat format;
  if (unit == "iso8601") {
    format.kind_ = Kind::iso8601;
  } else if (unit == "excel" || unit == "datenum") {
    format.kind_ = Kind::excel;
    format.days_before_excel_ = unit == "datenum" ? kDatenumOfExcel : 0.0;
  } else if (const std::size_t since = unit.find(" since "); since != std::string_view::npos) {
    Result<TimeFormat> counted = of(unit.substr(0, since));
    const Result<UtcTime> begin = parse_utc(trim(unit.substr(since + 7)));
    if (!counted || !begin)
      return fail(error_at({}, unit, "must read as 'days since 2031-04-12', with a unit of time and a UTC time"));
    counted->since_ = *begin;
    return counted;
  } else if (unit.find('%') != std::string_view::npos) {
    format.kind_ = Kind::pattern;
    format.pattern_ = unit;
  } else {
    const Result<UnitConversion> known = convert_unit(unit, "s");
    if (!known)
      return fail(
          error_at({}, unit, known.error().rule + ": time is iso8601, excel, a pattern such as %H:%M:%S, or s, ms"));
    format.to_s_ = *known;
  }
  return format;
}

Result<UtcTime> TimeFormat::moment(std::string_view cell, char decimal) const {
  if (kind_ == Kind::excel) {
    const Result<double> days = parse_number(cell, decimal);
    return days ? from_excel(*days - days_before_excel_) : fail(days.error());
  }
  if (kind_ == Kind::pattern) return parse_pattern(cell, pattern_);
  std::string text(trim(cell));
  for (char& letter : text)
    if (letter == ',') letter = '.';  // ISO 8601 allows both before fractions of a second
  std::string_view clock = text;
  const std::int64_t zone_s = is_clock(clock) ? take_zone_at_end(clock) : 0;
  Result<UtcTime> time = parse_utc(clock);
  if (time) time->nanoseconds -= zone_s * kNanoseconds;
  return time;
}

Result<double> TimeFormat::seconds(std::string_view cell, char decimal) {
  if (kind_ == Kind::number) {
    const Result<double> number = parse_number(cell, decimal);
    if (!number && is_clock(cell))
      return fail(number.error().rule,
                  "a clock or a date needs its form as unit in the map: iso8601, or a pattern as '%d.%m.%Y %H:%M:%S'");
    if (!number && number.error().advice.empty())
      return fail(number.error().rule,
                  "take the row out where it is no sample, as that of a summary or another header");
    return number ? counted(*number) : number;
  }
  const Result<UtcTime> time = moment(cell, decimal);
  if (!time) return fail(time.error().rule, time.error().advice);
  const UtcTime now = has_date() ? *time : past_midnight(*time);
  if (!base_) base_ = now;
  return static_cast<double>(now.nanoseconds - base_->nanoseconds) * 1e-9;
}

Status TimeFormat::scale_by(double scale, double offset) {
  if (scale == 1.0 && offset == 0.0) return {};
  if (kind_ != Kind::number)
    return fail("is a clock, which takes no scale and no offset", "give the numbers' unit: s, ms");
  to_s_.offset += to_s_.scale * offset;
  to_s_.scale *= scale;
  return {};
}

/// A time counted from a test's start goes back by all of its length; by nearly a day, that is but for a step as the log
/// has them, goes the clock of a wall.
UtcTime TimeFormat::past_midnight(UtcTime time) {
  constexpr std::int64_t kDay = 86400 * kNanoseconds, kShortest = 60 * kNanoseconds;
  time.nanoseconds += midnights_ * kDay;
  if (last_) {
    std::int64_t step = time.nanoseconds - last_->nanoseconds;
    if (step < 0 && step + kDay < std::max(kShortest, 2 * longest_step_ns_))
      ++midnights_, time.nanoseconds += kDay, step += kDay;
    longest_step_ns_ = std::max(longest_step_ns_, step);
  }
  last_ = time;
  return time;
}

/// The differences of a number that counts from long ago have more digits than it.
Result<double> TimeFormat::counted(double number) {
  if (!since_) return to_s_.to_si(number);
  if (!first_) {
    constexpr double kFarthest_s = 9e9;
    const double since_s = to_s_.to_si(number);
    if (!(std::abs(since_s) < kFarthest_s)) return fail("must be a time of the years 1700 to 2250");
    first_ = number;
    base_ = UtcTime{since_->nanoseconds + std::llround(since_s * 1e6) * 1000};
  }
  return to_s_.scale * (number - *first_);
}

Result<double> TimeFormat::seconds(double number) {
  if (kind_ == Kind::number) return counted(number);
  if (kind_ != Kind::excel) return fail("must be text for a time of this form", "give its unit: s, ms, ns or excel");
  const Result<UtcTime> time = from_excel(number - days_before_excel_);
  if (!time) return fail(time.error());
  if (!base_) base_ = *time;
  return static_cast<double>(time->nanoseconds - base_->nanoseconds) * 1e-9;
}

double usual_step(const std::vector<double>& times_s) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times_s.size(); ++k) steps.push_back(times_s[k] - times_s[k - 1]);
  return steps.empty() ? 1.0 : signal::median(std::move(steps));
}

Status shift_times(std::vector<double>& times_s, double shift_s) {
  for (double& time_s : times_s) time_s += shift_s;
  const auto same = std::ranges::adjacent_find(times_s, std::ranges::greater_equal());
  if (same == times_s.end()) return {};
  return fail(error_at("sample " + std::to_string(same - times_s.begin() + 2) + ", column time", {}, kOneTime,
                       "log the time from the test's begin"));
}

std::optional<UtcTime> TimeFormat::clock(double seconds) const {
  return base_ ? std::optional(add_seconds(*base_, seconds)) : std::nullopt;
}

bool TimeFormat::has_date() const {
  return kind_ != Kind::pattern || pattern_.find_first_of("djFDxcs") != std::string::npos;
}

std::string since_1970(const std::string& unit, double number) {
  constexpr double kYear_s = 365.25 * kSecondsPerDay, kFirst = 30.0, kLast = 85.0;  // LabVIEW's, from 1904, are larger
  const Result<UnitConversion> to_s = convert_unit(unit, "s");
  const bool fits = to_s && to_s->to_si(number) > kFirst * kYear_s && to_s->to_si(number) < kLast * kYear_s;
  return fits ? unit + " since 1970-01-01" : "";
}

std::optional<UtcTime> TimeFormat::utc(double seconds) const { return has_date() ? clock(seconds) : std::nullopt; }

}  // namespace sealwatch
