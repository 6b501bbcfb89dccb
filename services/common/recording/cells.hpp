// Cells of a table of text: numbers with a decimal point or comma, times as clocks and spreadsheets write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/core/units.hpp"

namespace sealwatch {

/// Without blanks and tabs at its ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// The finite number that `text` is, or the rule that it breaks. `decimal` is '.' or ','.
[[nodiscard]] Result<double> parse_number(std::string_view text, char decimal = '.');

/// Whether a cell holds no value: it is empty, has no digit, as NaN, --- and Bad, or is one of the words for it that have
/// one: #DIV/0! and 1.#INF.
[[nodiscard]] bool holds_no_value(std::string_view cell);

/// How a log's time column counts.
class TimeFormat {
 public:
  /// `unit`: "iso8601", "excel" (days since 1899-12-30), "datenum" (MATLAB's days), "days since 2031-04-12", a pattern of strptime such as "%d.%m.%Y %H:%M:%S" (fractions
  /// of a second may follow; without a zone UTC), or any unit of time.
  [[nodiscard]] static Result<TimeFormat> of(std::string_view unit);

  /// Whether it tells the hour and the day, so that the recording's start is known.
  [[nodiscard]] bool is_absolute() const { return kind_ != Kind::number || since_.has_value(); }
  /// Whether it tells the day; of an absolute one.
  [[nodiscard]] bool has_date() const;
  /// `scale` number + `offset` is in the format's unit: of a count of samples, say. An Error where it is a clock.
  [[nodiscard]] Status scale_by(double scale, double offset);
  /// Seconds of `cell`: as the log counts them; of an absolute time those since the first cell that was asked. A clock
  /// without a day that passes midnight goes on.
  [[nodiscard]] Result<double> seconds(std::string_view cell, char decimal);
  /// The same of a number; an Error where the format wants text.
  [[nodiscard]] Result<double> seconds(double number);
  /// What the clock shows after so many seconds, on 1970-01-01 where it tells no day; nothing where it is none.
  [[nodiscard]] std::optional<UtcTime> clock(double seconds) const;
  /// The UTC time of so many seconds; nothing where the format is not absolute.
  [[nodiscard]] std::optional<UtcTime> utc(double seconds) const;

 private:
  enum class Kind { number, iso8601, excel, pattern };
  [[nodiscard]] Result<UtcTime> moment(std::string_view cell, char decimal) const;
  [[nodiscard]] Result<double> counted(double number);
  [[nodiscard]] UtcTime past_midnight(UtcTime time);

  Kind kind_ = Kind::number;
  UnitConversion to_s_;
  double days_before_excel_ = 0.0;
  std::string pattern_;
  std::optional<UtcTime> since_;      ///< from which numbers count
  std::optional<double> first_;       ///< of those
  std::optional<UtcTime> base_;       ///< the first time
  std::optional<UtcTime> last_;       ///< of a clock without a day
  std::int64_t longest_step_ns_ = 0;  ///< that it has made
  std::int64_t midnights_ = 0;        ///< that it has passed
};

inline constexpr const char* kOneTime = "two times fall on one, as a number has no more than 16 digits";

/// "ms since 1970-01-01" for a number of `unit` that is then a time between 2000 and 2055, and "" for any other: no test
/// lasts that long.
[[nodiscard]] std::string since_1970(const std::string& unit, double number);

/// Median distance of increasing times, s; 1 where there is one time alone.
[[nodiscard]] double usual_step(const std::vector<double>& times_s);

/// Adds `shift_s` to increasing times; an Error where two of them fall on one.
[[nodiscard]] Status shift_times(std::vector<double>& times_s, double shift_s);

/// The time that `cell` is by a pattern of strptime, with fractions of a second behind it.
[[nodiscard]] Result<UtcTime> parse_pattern(std::string_view cell, const std::string& pattern);

}  // namespace sealwatch
