#include "services/cli/log_offer.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/test_limits.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/csv_rows.hpp"
#include "services/common/recording/hdf5_reader.hpp"
#include "services/common/recording/log_reader.hpp"
#include "services/common/recording/mat_reader.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/recording/text_file.hpp"
#include "services/common/recording/thousands.hpp"
#include "services/common/recording/vector_file.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kRowsLookedAt = 50;

std::string without_signs(std::string_view text) {
  std::string out;
  for (const char letter : text)
    if (std::isalpha(static_cast<unsigned char>(letter)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return out;
}

/// Seconds between two rows as a preamble says it, "Delta_X  0.01", "Sample rate: 100", "Sample Interval [ms],10"; nothing
/// where it does not, or says two.
std::optional<double> step_in_preamble(const std::vector<std::vector<std::string>>& rows, char decimal) {
  static const std::set<std::string> kSteps = {"deltax",         "dt",         "deltat",    "sampleinterval",
                                               "hresolution",    "xincrement", "increment", "samplinginterval",
                                               "sampleperiod",   "sampletime", "timestep",  "abtastintervall",
                                               "samplingperiod", "xinc",       "xincr",     "intervall"};
  static const std::set<std::string> kRates = {
      "samplerate", "samplingrate", "samplefrequency", "abtastrate", "samplingfrequency", "rate", "fs", "scanrate"};
  std::set<double> steps;
  for (const auto& row : rows) {
    if (row.empty()) continue;
    const std::string& first = row.front();
    const std::size_t sign = std::min(first.find_first_of("=:"), first.size());
    const bool is_one_cell = sign + 1 < first.size();  // "DT=0.01"
    const auto [name, unit] = split_header_cell(first.substr(0, sign));
    const bool is_step = kSteps.contains(without_signs(name));
    if (!is_step && !kRates.contains(without_signs(name))) continue;
    const std::string said = is_one_cell ? first.substr(sign + 1) : row.size() > 1 ? row[1] : "";
    const std::string_view text = trim(said);
    const std::size_t end = std::min(text.find(' '), text.size());  // "50 Hz", or the unit in a cell of its own
    const std::string_view behind = end < text.size() ? trim(text.substr(end))
                                    : !is_one_cell && row.size() > 2 && unit.empty() && !parse_number(row[2], decimal)
                                        ? trim(row[2])
                                        : std::string_view();
    const Result<double> number = parse_number(text.substr(0, end), decimal);
    const Result<UnitConversion> to_si = convert_unit(behind.empty() ? unit : behind, is_step ? "s" : "Hz");
    if (!number || !to_si || *number <= 0.0) continue;
    steps.insert(is_step ? *number * to_si->scale : 1.0 / (*number * to_si->scale));
  }
  return steps.size() == 1 ? std::optional(*steps.begin()) : std::nullopt;
}

/// The column of words that come again and again, where each row has one value with its name beside it.
std::optional<std::size_t> column_of_names(const std::vector<std::vector<std::string>>& rows,
                                           const FoundLayout& layout) {
  for (std::size_t k = 0; k < layout.header.size(); ++k) {
    std::vector<std::string> cells;
    for (const auto& row : rows)
      if (k < row.size() && !trim(row[k]).empty() && !parse_number(row[k], layout.decimal)) cells.push_back(row[k]);
    const std::set<std::string> words(cells.begin(), cells.end());
    const bool come_again = words.size() > 1 && 2 * words.size() <= cells.size() && cells.size() == rows.size();
    if (come_again && time_format_of(cells).empty()) return k;
  }
  return std::nullopt;
}

Result<Offer> offer_of_text(const std::string& file, const LogLayout& given) {
  const Result<std::unique_ptr<std::istream>> text = open_text(file);
  if (!text) return fail(text.error());
  std::istream* const in = text->get();
  Result<FoundLayout> layout = layout_of(*in, given);
  if (!layout) return fail(layout.error());
  Offer offer;
  offer.layout = std::move(*layout);
  std::string head(std::size_t{1} << 16U, '\0');
  in->read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in->gcount()));
  if (!in->eof()) head.resize(head.rfind(line_break_of(head)) + 1);
  const auto rows = rows_of(head, offer.layout.delimiter, offer.layout.first_row, kRowsLookedAt);
  offer.names = column_of_names(rows, offer.layout);
  offer.step_s =
      step_in_preamble(rows_of(head, offer.layout.delimiter, 1, offer.layout.first_row - 1), offer.layout.decimal);
  for (std::size_t k = 0; k < offer.layout.header.size(); ++k) {
    offer.columns.push_back({offer.layout.header[k], offer.layout.units[k]});
    std::vector<std::string>& cells = offer.cells.emplace_back();
    std::vector<std::size_t>& stand_in = offer.rows.emplace_back();
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (k >= rows[row].size() || holds_no_value(rows[row][k])) continue;
      const std::string& cell = rows[row][k];
      cells.push_back(without_thousands(cell, offer.layout.decimal, offer.layout.decimal_sign).value_or(cell));
      stand_in.push_back(offer.layout.first_row + row);
    }
  }
  return offer;
}

Result<Offer> offer_of_vectors(const std::string& file) {
  const Result<std::vector<MatVariable>> vectors =
      suffix_of(file) == ".mat" ? read_mat_vectors(file) : read_hdf5_vectors(file);
  if (!vectors) return fail(vectors.error());
  Offer offer;
  offer.text = false;
  offer.columns = offered_vectors(*vectors, {});
  for (const MatVariable& vector : *vectors) {
    std::vector<std::string>& cells = offer.cells.emplace_back();
    std::vector<std::size_t>& stand_in = offer.rows.emplace_back();
    for (std::size_t row = 0; row < std::min(vector.values.size(), kRowsLookedAt); ++row)
      if (!std::isnan(vector.values[row]))
        cells.push_back(text::exact(vector.values[row])), stand_in.push_back(row + 1);
    if (!vector.rule.empty()) cells.emplace_back(vector.rule), stand_in.push_back(1);  // no number
  }
  return offer;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::vector<double> numbers_of(const std::vector<std::string>& cells, char decimal) {
  std::vector<double> numbers;
  for (const std::string& cell : cells)
    if (const Result<double> number = parse_number(cell, decimal)) numbers.push_back(*number);
  return numbers;
}

bool rises(const std::vector<double>& numbers) {
  return numbers.size() > 1 && std::ranges::is_sorted(numbers) && numbers.back() > numbers.front();
}

/// Days of our time since `begin`, not seconds: some ten thousands, and a test is a small part of one.
bool are_days_since(double begin, const std::vector<double>& numbers) {
  return rises(numbers) && numbers.front() > begin + 20000.0 && numbers.back() < begin + 80000.0 &&
         numbers.back() - numbers.front() < 0.5;
}

/// The unit of time that a column says it is in; "ms" alone is a time's name, too. "" where it says none.
std::string unit_of_time(const OfferedColumn& column) {
  for (const std::string& said : {unit_of(column), unit_at_the_end(column.text, "s"), column.text})
    if (!said.empty() && convert_unit(said, "s")) return said;
  return "";
}

/// A column of fractions of a second, as "ms" beside a clock of whole seconds: its unit is less, its numbers stay below.
bool holds_fractions(const Offer& offer, std::size_t column) {
  const std::optional<double> to_s = seconds_of_one(offer.columns[column]);
  const std::vector<double> numbers = numbers_of(offer.cells[column], offer.layout.decimal);
  return to_s && *to_s < 1.0 && has_numbers(offer, column) &&
         std::ranges::all_of(numbers, [&](double number) { return number >= 0.0 && number * *to_s < 1.0; });
}

/// A column of whole seconds, or of more, beside one of fractions.
std::optional<std::size_t> coarser_time(const Offer& offer, std::size_t fractions) {
  for (std::size_t k = 0; k < offer.columns.size(); ++k) {
    const std::optional<double> to_s = seconds_of_one(offer.columns[k]);
    if (k != fractions && to_s && *to_s >= 1.0 && has_numbers(offer, k)) return k;
  }
  return std::nullopt;
}

std::optional<std::size_t> likely_time_column(const Offer& offer) {
  static const std::set<std::string> kNames = {"time",  "t",          "timestamp",   "zeit",
                                               "date",  "time stamp", "datetime",    "date/time",
                                               "datum", "x_value",    "elapsed time"};
  const auto first = [&](const auto& is_one) -> std::optional<std::size_t> {
    for (std::size_t k = 0; k < offer.columns.size(); ++k)
      if (is_one(k)) return k;
    return std::nullopt;
  };
  const auto is_named = [&](std::size_t k) {
    return kNames.contains(lower(split_header_cell(offer.columns[k].text).name));
  };
  const auto counts = [&](std::size_t k) { return has_numbers(offer, k) || !time_format_of(offer.cells[k]).empty(); };
  if (const auto named = first([&](std::size_t k) { return is_named(k) && counts(k); })) return named;
  if (const auto timed = first([&](std::size_t k) { return !time_format_of(offer.cells[k]).empty(); })) return timed;
  if (const auto named = first(is_named); named && !offer.step_s) return named;  // its first cell is then refused
  const auto in_time = [&](std::size_t k) { return !unit_of_time(offer.columns[k]).empty(); };
  const auto rising = [&](std::size_t k) {
    return has_numbers(offer, k) && rises(numbers_of(offer.cells[k], offer.layout.decimal));
  };
  if (const auto timed = first([&](std::size_t k) { return in_time(k) && rising(k); }))
    return holds_fractions(offer, *timed) ? coarser_time(offer, *timed).value_or(*timed) : *timed;
  return offer.step_s ? std::nullopt : first(rising);
}

std::string unit_of_count(const Offer& offer, std::size_t column, const std::vector<double>& numbers) {
  if (std::string said = unit_of(offer.columns[column]); !said.empty()) return said;
  if (std::string said = unit_of_time(offer.columns[column]); !said.empty()) return said;
  for (const auto& [unit, in_s] : {std::pair{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}})  // those since 1970 are large
    if (numbers.empty() || numbers.back() * in_s <= TestLimits{}.largest_time_s) return unit;
  return "ns";
}

std::string time_unit(const Offer& offer, std::size_t column) {
  if (std::string format = time_format_of(offer.cells[column]); !format.empty()) return format;
  const std::vector<double> numbers = numbers_of(offer.cells[column], offer.layout.decimal);
  constexpr double kDatenumOfExcel = 693960.0;
  if (are_days_since(0.0, numbers)) return "excel";
  if (are_days_since(kDatenumOfExcel, numbers)) return "datenum";
  const std::string unit = unit_of_count(offer, column, numbers);
  const std::string dated = numbers.empty() ? "" : since_1970(unit, numbers.front());
  return dated.empty() ? unit : dated;
}

}  // namespace

bool has_numbers(const Offer& offer, std::size_t column) {
  const std::vector<std::string>& cells = offer.cells[column];
  return !cells.empty() && std::ranges::all_of(cells, [&](const std::string& cell) {
    return parse_number(cell, offer.layout.decimal).has_value();
  });
}

bool counts_by_one(const Offer& offer, std::size_t column) {
  const std::vector<double> numbers = numbers_of(offer.cells[column], offer.layout.decimal);
  const auto is_no_step = [](double a, double b) { return b - a != 1.0; };
  return numbers.size() > 1 && std::ranges::adjacent_find(numbers, is_no_step) == numbers.end();
}

Result<Offer> offer_of(const std::string& file, const LogLayout& given) {
  const std::string suffix = suffix_of(file);
  const bool vectors = suffix == ".mat" || suffix == ".h5" || suffix == ".hdf5";
  Result<Offer> offer = vectors ? offer_of_vectors(file) : offer_of_text(file, given);
  if (offer && offer->columns.empty()) offer = fail("holds no columns");
  if (offer) return offer;
  Error error = offer.error();
  error.file = file;
  return fail(std::move(error));
}

std::string name_of_column(const Offer& offer, std::size_t column) {
  const std::string& text = offer.columns[column].text;
  return std::ranges::count(offer.columns, text, &OfferedColumn::text) > 1 ? place_name(column) : text;
}

namespace {

bool counts_rows(const Offer& offer) { return offer.step_s && !likely_time_column(offer); }

}  // namespace

bool has_time(const Offer& offer) { return counts_rows(offer) || likely_time_column(offer).has_value(); }

std::size_t time_column(const Offer& offer) {
  return counts_rows(offer) ? kNoColumn : likely_time_column(offer).value_or(0);
}

namespace {

/// The cells of a column of days before those of the time, of the rows that have both.
std::vector<std::string> with_day(const Offer& offer, std::size_t day, std::size_t time) {
  std::vector<std::string> cells;
  for (std::size_t k = 0, d = 0; k < offer.rows[time].size(); ++k) {
    while (d < offer.rows[day].size() && offer.rows[day][d] < offer.rows[time][k]) ++d;
    if (d < offer.rows[day].size() && offer.rows[day][d] == offer.rows[time][k])
      cells.push_back(offer.cells[day][d] + " " + offer.cells[time][k]);
  }
  return cells;
}

/// Adds the column of the day to a clock that tells none: the first that makes a date and a time of it.
void add_day(const Offer& offer, std::size_t time, ColumnMapping& mapping) {
  const Result<TimeFormat> format = TimeFormat::of(mapping.unit);
  if (!format || !format->is_absolute() || format->has_date()) return;
  for (std::size_t day = 0; day < offer.columns.size(); ++day) {
    if (day == time || offer.rows[day].size() < offer.rows[time].size()) continue;
    const std::string unit = time_format_of(with_day(offer, day, time));
    if (unit.empty()) continue;
    mapping.column = name_of_column(offer, day).append(kDayAndTime).append(mapping.column);
    mapping.unit = unit;
    return;
  }
}

/// Where a clock shows one time in several rows, the column of its fractions.
void add_fraction(const Offer& offer, std::size_t time, ColumnMapping& mapping) {
  if (std::ranges::adjacent_find(offer.cells[time]) == offer.cells[time].end()) return;
  for (std::size_t k = 0; k < offer.columns.size(); ++k) {
    if (k == time || !holds_fractions(offer, k)) continue;
    mapping.column.append(kDayAndTime).append(name_of_column(offer, k));
    return;
  }
}

}  // namespace

ColumnMapping guess_time(const Offer& offer) {
  const std::size_t at = time_column(offer);
  if (at == kNoColumn)
    return {.column = std::string(kCountOfRows), .unit = "s", .scale = *offer.step_s, .is_scaled = true};
  ColumnMapping time{.column = name_of_column(offer, at), .unit = time_unit(offer, at)};
  if (offer.text) add_day(offer, at, time), add_fraction(offer, at, time);
  return time;
}

}  // namespace sealwatch::cli
