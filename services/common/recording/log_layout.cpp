#include "services/common/recording/log_layout.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/csv_rows.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/thousands.hpp"
#include "services/common/text/words.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kRowsLookedAt = 400;

constexpr std::array kDelimiters = {std::pair{"semicolon", ';'}, std::pair{"tab", '\t'}, std::pair{"comma", ','},
                                    std::pair{"bar", '|'}, std::pair{"blank", ' '}};
constexpr std::array kDecimals = {std::pair{"point", '.'}, std::pair{"comma", ','}};

// The day before the month: of "3/4/2031" nobody can tell, of "25/4/2031" and "4/25/2031" the cells do.
constexpr std::array kTimePatterns = {"%d.%m.%Y %H:%M:%S",    "%d.%m.%Y, %H:%M:%S",
                                      "%d.%m.%Y %H:%M",       "%d/%m/%Y %H:%M:%S",
                                      "%d/%m/%Y, %H:%M:%S",   "%d-%m-%Y %H:%M:%S",
                                      "%m/%d/%Y %I:%M:%S %p", "%m/%d/%Y, %I:%M:%S %p",
                                      "%m/%d/%Y %H:%M:%S",    "%m-%d-%Y %H:%M:%S",
                                      "%Y/%m/%d %H:%M:%S",    "%Y.%m.%d %H:%M:%S",
                                      "%Y-%m-%d %I:%M:%S %p", "%d-%b-%Y %H:%M:%S",
                                      "%d-%b-%y %H:%M:%S",    "%d-%b-%Y %I:%M:%S %p",
                                      "%d-%b-%y %I:%M:%S %p", "%b %d %Y %H:%M:%S",
                                      "%d %b %Y %H:%M:%S",    "%d.%m.%y %H:%M:%S",
                                      "%d/%m/%y %H:%M:%S",    "%m/%d/%y %I:%M:%S %p",
                                      "%m/%d/%y %H:%M:%S",    "%Y%m%d %H%M%S",
                                      "%Y%m%dT%H%M%S",        "%H:%M:%S",
                                      "%I:%M:%S %p"};

using Rows = std::vector<std::vector<std::string>>;

constexpr const char* kWithoutSigns = "%Y%m%d%H%M%S";

/// "20310412030000.25": fourteen digits of a day in our time; a count since 1970 has thirteen, or is none of these.
bool is_without_signs(std::string_view cell) {
  const std::string_view text = trim(cell);
  constexpr std::size_t kDigits = 14;
  if (std::min(text.find_first_not_of("0123456789"), text.size()) != kDigits) return false;
  const auto number = [text](std::size_t at) { return 10 * (text[at] - '0') + text[at + 1] - '0'; };
  const bool day =
      number(0) >= 19 && number(0) <= 20 && number(4) >= 1 && number(4) <= 12 && number(6) >= 1 && number(6) <= 31;
  return day && number(8) < 24 && number(10) < 60 && number(12) < 60 && parse_pattern(text, kWithoutSigns).has_value();
}

constexpr const char* kMinutes = "%M:%S";

/// "00:10.5": hours and minutes have no fraction behind them.
bool is_minutes(std::string_view cell) {
  return cell.find_first_of(".,") != std::string_view::npos && parse_pattern(cell, kMinutes).has_value();
}

bool is_iso(std::string_view cell) {
  const auto format = TimeFormat::of("iso8601");
  return trim(cell).size() > 10 && TimeFormat(*format).seconds(cell, '.').has_value();
}

bool is_time(std::string_view cell) {
  return is_iso(cell) || is_minutes(cell) || std::ranges::any_of(kTimePatterns, [&](const char* pattern) {
           return parse_pattern(cell, pattern).has_value();
         });
}

/// How the numbers of a table are written.
struct NumberForm {
  char decimal = '.';
  bool thousands = false;  ///< some are grouped
};

bool is_value(std::string_view cell, const NumberForm& form) {
  const std::string_view text = trim(cell);
  if (text.empty()) return false;
  const bool begins_as_one =
      (text.front() >= '0' && text.front() <= '9') || text.front() == '-' || text.front() == '+' || text.front() == '.';
  return parse_number(text, form.decimal).has_value() ||
         (form.thousands && without_thousands(text, form.decimal, DecimalSign::known)) ||
         (begins_as_one && is_time(text));
}

std::size_t values_in(const std::vector<std::string>& row, const NumberForm& form) {
  return static_cast<std::size_t>(
      std::ranges::count_if(row, [&form](const std::string& cell) { return is_value(cell, form); }));
}

bool is_blank(const std::string& cell) { return trim(cell).empty(); }

/// Preamble, too, has numbers and times here and there. A log of states and alarms has mostly texts.
enum class Expected { mostly_values, mostly_texts };

/// Rows in which at least half of the cells that are not empty are numbers or times; two, where texts are expected.
bool is_row_of_values(const std::vector<std::string>& row, const NumberForm& form, Expected expected) {
  const auto filled = row.size() - static_cast<std::size_t>(std::ranges::count_if(row, is_blank));
  const std::size_t values = values_in(row, form);
  return filled >= 2 && (2 * values >= filled || (expected == Expected::mostly_texts && values >= 2));
}

struct Reading {
  Rows rows;  ///< from the file's first
  char delimiter;
  NumberForm form;
  Expected expected;
  std::size_t width = 0;  ///< the commonest number of cells among rows of values
  std::size_t values = 0;
};

Reading read_as(std::string_view head, char delimiter, const NumberForm& form, Expected expected) {
  Reading reading{
      .rows = rows_of(head, delimiter, 1, kRowsLookedAt), .delimiter = delimiter, .form = form, .expected = expected};
  std::map<std::size_t, std::size_t> widths;
  for (const auto& row : reading.rows)
    if (is_row_of_values(row, form, expected)) ++widths[row.size()];
  for (const auto& [width, count] : widths)  // of widths that are as common the largest: the other rows are cut
    if (reading.width == 0 || count >= widths[reading.width]) reading.width = width;
  if (widths.empty()) return reading;
  for (const auto& row : reading.rows)
    if (row.size() == reading.width && is_row_of_values(row, form, expected)) reading.values += values_in(row, form);
  return reading;
}

/// A number in quotes with a comma that separates no thousands: "0,52". Where commas stand between columns too, it is
/// the decimal sign.
bool has_quoted_decimals(std::string_view head) {
  constexpr std::size_t kOfThousands = 3;
  for (const auto& row : rows_of(head, ',', 1, kRowsLookedAt))
    for (const std::string& cell : row)
      if (const std::size_t comma = cell.rfind(','); comma != std::string::npos && parse_number(cell, ','))
        if (trim(cell).size() - trim(cell).rfind(',') - 1 != kOfThousands) return true;
  return false;
}

/// Replaces `best` by what reads more values.
void try_readings(std::string_view head, const LogLayout& given, Expected expected, bool thousands,
                  std::optional<Reading>& best) {
  for (const auto& [delimiter_name, delimiter] : kDelimiters)
    for (const auto& [decimal_name, decimal] : kDecimals) {
      if (!given.delimiter.empty() && given.delimiter != delimiter_name) continue;
      if (!given.decimal.empty() && given.decimal != decimal_name) continue;
      const bool both = delimiter == ',' && decimal == ',';
      if (both && given.decimal.empty() && !has_quoted_decimals(head)) continue;
      if (delimiter == ' ' && given.delimiter.empty() && best) continue;
      Reading reading = read_as(head, delimiter, {.decimal = decimal, .thousands = thousands}, expected);
      if (reading.width > 0 && (!best || reading.values > best->values)) best = std::move(reading);
    }
}

/// The best of all ways to read it; blanks, and thousands apart, only where nothing else makes as good a table.
std::optional<Reading> best_reading(std::string_view head, const LogLayout& given, Expected expected) {
  std::optional<Reading> best;
  try_readings(head, given, expected, false, best);
  try_readings(head, given, expected, true, best);
  return best;
}

/// What the table's cells show of its decimal sign.
DecimalSign decimal_sign_of(const Reading& reading) {
  const char decimal = reading.form.decimal;
  std::vector<bool> has_whole(reading.width), has_either(reading.width);
  for (const auto& row : reading.rows) {
    if (row.size() != reading.width || !is_row_of_values(row, reading.form, reading.expected)) continue;
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (shows_decimal_sign(row[k], decimal)) return DecimalSign::known;
      if (may_have_thousands(row[k], decimal))
        has_either[k] = true;
      else if (parse_number(row[k], decimal))
        has_whole[k] = true;
    }
  }
  for (std::size_t k = 0; k < reading.width; ++k)
    if (has_whole[k] && has_either[k]) return DecimalSign::doubtful;
  return DecimalSign::likely;
}

// What the map says of delimiter and decimal sign may be what is wrong.
std::string advice_on_layout(std::string_view head, const LogLayout& given) {
  LogLayout free = given;
  free.delimiter.clear();
  free.decimal.clear();
  const auto other = given == free ? std::nullopt : best_reading(head, free, Expected::mostly_values);
  if (!other) return "say how the log is written, under log: delimiter, decimal, header_row";
  std::string says;
  if (!given.delimiter.empty()) says = "delimiter: " + given.delimiter;
  if (!given.decimal.empty()) text::add_to_list(says, "decimal: " + given.decimal);
  const auto name = std::ranges::find(kDelimiters, other->delimiter, &std::pair<const char*, char>::second);
  return "log: says " + says +
         "; the file reads with delimiter: " + (name == kDelimiters.end() ? "blank" : name->first) +
         ", decimal: " + (other->form.decimal == ',' ? "comma" : "point");
}

/// "Unit" of "Unit: mm", as Simulink writes what is said of each column; "" where nothing is.
std::string_view label_of(std::string_view cell) {
  cell = trim(cell);
  const std::size_t end = cell.find(": ");
  return end == std::string_view::npos ? std::string_view() : cell.substr(0, end);
}

/// Whether its cells say the same thing of their columns: "Type: double", "Type: single".
bool is_labelled(const std::vector<std::string>& row) {
  std::set<std::string_view> labels;
  for (const std::string& cell : row)
    if (!is_blank(cell)) labels.insert(label_of(cell));
  return labels.size() == 1 && !labels.begin()->empty() && row.size() > 1;
}

std::string without_brackets(std::string_view text) {
  text = trim(text);
  if (text.starts_with("Unit: ")) text = trim(text.substr(6));
  if (text.size() > 2 && (text.front() == '[' || text.front() == '(')) text = trim(text.substr(1, text.size() - 2));
  return text == "-" ? "" : as_utf8(text);
}

/// "Y_Unit_Label", "Units:", "Einheit": what a row of units is called in its first cell.
bool is_name_of_units(std::string_view cell) {
  std::string text(trim(cell));
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text.find("unit") != std::string::npos || text.find("einheit") != std::string::npos;
}

std::vector<std::string> without_name_of_units(std::vector<std::string> row) {
  if (!row.empty() && is_name_of_units(row.front()) && !is_labelled(row)) row.front().clear();
  return row;
}

/// Whether all cells are units; or, where a name stands above each, most of them: "hh:mm:ss" is none.
bool is_row_of_units(const std::vector<std::string>& row, const std::vector<std::string>& above,
                     const NumberForm& form) {
  std::size_t filled = 0, units = 0, named = 0;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const std::string unit = without_brackets(row[k]);
    if (unit.empty()) continue;
    ++filled;
    units += is_unit(unit) && unit.find(" in ") == std::string::npos ? 1 : 0;  // "t in s": tonne inch second
    named += k < above.size() && !is_blank(above[k]) && !is_value(above[k], form) ? 1 : 0;
  }
  return filled > 0 && (units == filled || (2 * units > filled && named == filled));
}

std::vector<std::string> filled_to(std::vector<std::string> cells, std::size_t width) {
  cells.resize(std::max(width, cells.size()));
  return cells;
}

/// Far above the names, too, a row of units is one where it says so: "Y_Unit_Label  Volts  mm". 0: there is none.
std::size_t row_called_units(const Reading& reading, std::size_t header_row) {
  for (std::size_t number = header_row; number-- > 1;) {
    const std::vector<std::string>& row = reading.rows[number - 1];
    if (row.size() > reading.width || row.empty() || !is_name_of_units(row.front())) continue;
    const auto count_of = [&row](const auto& is_one) { return std::count_if(row.begin() + 1, row.end(), is_one); };
    const auto filled = count_of([](const std::string& cell) { return !is_blank(cell); });
    const auto units = count_of([](const std::string& cell) { return is_unit(without_brackets(cell)); });
    const bool names_a_machine = filled < 2 && reading.width > 2;  // "Unit;A"
    if (units > 0 && 2 * units >= filled && !names_a_machine) return number;
  }
  return 0;
}

/// Of the rows above the table the lowest that is no remark, "DT=0.01" in one cell of many, on the names and units over
/// it; `above` where there are none.
std::size_t without_remarks(const Reading& reading, std::size_t above, std::size_t least) {
  constexpr std::size_t kMostRemarks = 5;
  const auto filled = [&](std::size_t number) {
    const auto& row = reading.rows[number - 1];
    return row.size() - static_cast<std::size_t>(std::ranges::count_if(row, is_blank));
  };
  for (std::size_t number = above; number > least && number + kMostRemarks > above; --number) {
    const auto& row = reading.rows[number - 1];
    if (2 * filled(number) < reading.width) continue;
    return row.size() == reading.width && values_in(row, reading.form) == 0 ? number : above;
  }
  return above;
}

/// The rows above the table. Row numbers are the editor's, 1 for the first; rows[k] is row k + 1.
void find_header(const Reading& reading, const LogLayout& given, FoundLayout& out) {
  const auto row = [&reading](std::size_t number) -> const std::vector<std::string>& {
    return reading.rows[number - 1];
  };
  const auto filled_row = [&](std::size_t number) {
    while (number > 0 && std::ranges::all_of(row(number), is_blank)) --number;
    return number;
  };
  out.units_row = static_cast<std::size_t>(given.units_row);
  const bool header_given = given.header_row > 0;
  const std::size_t least = header_given ? static_cast<std::size_t>(given.header_row) : 1;
  std::size_t above = without_remarks(reading, filled_row(out.first_row - 1), header_given ? least : 0);
  for (; above > least && is_labelled(row(above)); above = filled_row(above - 1))
    if (out.units_row == 0 && label_of(row(above).back()) == "Unit") out.units_row = above;
  const auto are_units = [&](std::size_t number) {
    if (number <= least || row(number).size() <= 1) return false;
    const std::size_t names = filled_row(number - 1);
    return is_row_of_units(without_name_of_units(row(number)), names > 0 ? row(names) : std::vector<std::string>(),
                           reading.form);
  };
  if (out.units_row == 0 && are_units(above)) out.units_row = above;
  const std::size_t next = above > 1 ? filled_row(above - 1) : 0, names = next > 1 ? filled_row(next - 1) : 0;
  const bool is_below_units = names > 0 && row(next).size() == reading.width && row(names).size() == reading.width;
  if (out.units_row == 0 && is_below_units && are_units(next)) out.units_row = above = next;  // a remark on each column
  if (out.units_row == above && above > 0) above = filled_row(above - 1);
  out.header_row = header_given ? static_cast<std::size_t>(given.header_row) : 0;
  if (!header_given && above > 0 && 2 * row(above).size() > reading.width) out.header_row = above;
  if (out.units_row > 0 || out.header_row < 2) return;
  const std::size_t over = filled_row(out.header_row - 1);  // units may stand over the names as well as under them
  const bool is_as_wide = over > 0 && row(over).size() == reading.width;
  if (is_as_wide && is_row_of_units(without_name_of_units(row(over)), {}, reading.form)) out.units_row = over;
  if (out.units_row == 0) out.units_row = row_called_units(reading, out.header_row);
}

/// Of the rows of values those whose first cell is a text, where that of most, or of the last, is none: "Samples  800  800".
class NamedRows {
 public:
  explicit NamedRows(const Reading& reading) : reading_(reading) {
    std::size_t rows = 0, named = 0;
    bool is_last_named = false;
    for (const auto& row : reading.rows) {
      if (!is_of_table(row)) continue;
      is_last_named = begins_with_text(row);
      ++rows, named += is_last_named ? 1 : 0;
    }
    are_few_ = 2 * named < rows || !is_last_named;  // a short table has fewer rows than its preamble
  }
  [[nodiscard]] bool is_of_table(const std::vector<std::string>& row) const {
    return row.size() == reading_.width && is_row_of_values(row, reading_.form, reading_.expected);
  }
  [[nodiscard]] bool is_one(const std::vector<std::string>& row) const { return are_few_ && begins_with_text(row); }

 private:
  [[nodiscard]] bool begins_with_text(const std::vector<std::string>& row) const {
    return !is_blank(row.front()) && values_in({row.front()}, reading_.form) == 0;
  }
  const Reading& reading_;
  bool are_few_ = false;
};

/// TwinCAT Scope: each row above the table begins with its key, which stands again over each further column of times.
constexpr const char *kScopeName = "Name", *kScopeUnit = "Unit", *kScopeStep = "SampleTime[ms]";

bool is_scope_export(const Reading& reading, std::size_t first_row) {
  const auto has = [&](const char* key) {
    return std::any_of(reading.rows.begin(), reading.rows.begin() + static_cast<std::ptrdiff_t>(first_row - 1),
                       [&](const auto& row) { return row.size() == reading.width && trim(row.front()) == key; });
  };
  return has(kScopeName) && has(kScopeStep);
}

void name_scope_columns(const Reading& reading, FoundLayout& out) {
  for (std::size_t number = 1; number < out.first_row; ++number) {
    const std::vector<std::string>& row = reading.rows[number - 1];
    if (row.size() != reading.width) continue;
    const bool names = trim(row.front()) == kScopeName, units = trim(row.front()) == kScopeUnit;
    if (!names && !units) continue;
    (names ? out.header_row : out.units_row) = number;
    std::vector<std::string>& cells = names ? out.header : out.units;
    cells.clear();
    for (const std::string& cell : row) {
      const bool of_times = trim(cell) == trim(row.front());  // counted from the first sample
      cells.push_back(!of_times ? header_text(cell) : names ? "Time" : "ms");
    }
  }
  if (out.units.size() != out.header.size()) out.units.assign(out.header.size(), "");
  for (std::size_t k = 0; k < out.header.size(); ++k)
    if (out.header[k] == "Time") out.units[k] = "ms";
}

/// The table's first row behind `least`; 0: there is none. Named rows are preamble where a row of names stands between
/// them and the table; else they are the table's, and whoever reads it refuses the text.
std::size_t find_first_row(const Reading& reading, std::size_t least) {
  const NamedRows named(reading);
  std::size_t first_named = 0;
  bool names_follow = false;
  for (std::size_t k = least; k < reading.rows.size(); ++k) {
    const std::vector<std::string>& row = reading.rows[k];
    if (!named.is_of_table(row)) {
      const auto filled = row.size() - static_cast<std::size_t>(std::ranges::count_if(row, is_blank));
      names_follow = names_follow || (first_named > 0 && filled > 1 && values_in(row, reading.form) == 0);
    } else if (!named.is_one(row)) {
      return first_named > 0 && !names_follow ? first_named : k + 1;
    } else if (first_named == 0) {
      first_named = k + 1;
    }
  }
  return first_named;
}

/// NaN, ---, n/a, #N/A: what loggers write where a channel has no value; not any word without a digit, as a name may be.
bool is_word_for_no_value(std::string_view cell) {
  static const std::set<std::string> kWords = {"nan",  "n/a", "na",    "null",  "none",    "inf",     "infinity",
                                               "bad",  "err", "error", "ol",    "invalid", "no data", "nodata",
                                               "#n/a", "?",   "over",  "under", "---",     "--",      "-"};
  std::string text(trim(cell));
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_signed = text.size() > 1 && (text.front() == '-' || text.front() == '+');
  return kWords.contains(text) || kWords.contains(text.substr(is_signed ? 1 : 0)) || text.starts_with("---");
}

/// The table's first row: above the first one with values there may be some whose channels have none yet, "0.0;NaN;---",
/// below the names.
std::size_t with_rows_without_values(const Reading& reading, std::size_t first_row, std::size_t least) {
  const auto is_one = [&](const std::vector<std::string>& row) {
    return row.size() == reading.width && is_value(row.front(), reading.form) &&
           std::all_of(row.begin() + 1, row.end(), [&](const std::string& cell) {
             return is_blank(cell) || is_word_for_no_value(cell) || is_value(cell, reading.form);
           });
  };
  std::size_t first = first_row;
  while (first > least + 1 && is_one(reading.rows[first - 2])) --first;
  const auto& above = reading.rows[first > 1 ? first - 2 : 0];
  const bool names_stand_above = first > 1 && above.size() == reading.width && values_in(above, reading.form) == 0 &&
                                 !std::ranges::all_of(above, is_blank);
  return names_stand_above ? first : first_row;
}

/// "% time x": the sign that makes a comment of the header is no name where it makes a cell too many.
std::vector<std::string> without_comment_sign(std::vector<std::string> header, std::size_t width) {
  if (header.size() == width + 1 && (header.front() == "%" || header.front() == "#")) header.erase(header.begin());
  return header;
}

/// Where the bracket opens that closes at the end of `cell`; npos: none does.
std::size_t opening_of(std::string_view cell, char open, char close) {
  int depth = 0;
  for (std::size_t at = cell.size(); at-- > 0 && (depth > 0 || at + 1 == cell.size());) {
    depth += cell[at] == close ? 1 : cell[at] == open ? -1 : 0;
    if (depth == 0) return cell[at] == open ? at : std::string_view::npos;
  }
  return std::string_view::npos;
}

}  // namespace

namespace {

/// A line whose quotes do not close, as if they were letters: a row of the table stays one, and whoever reads it names
/// the quote.
std::vector<std::string> split_at(std::string_view line, char delimiter) {
  std::vector<std::string> cells;
  for (;;) {
    const std::size_t end = std::min(line.find(delimiter), line.size());
    cells.emplace_back(line.substr(0, end));
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

}  // namespace

namespace {

/// The cells of a whole row; nothing where its quotes do not fit.
std::optional<std::vector<std::string>> cells_in(std::string_view text, char delimiter) {
  std::istringstream in{std::string(text)};
  CsvRows rows(in, delimiter);
  std::vector<std::string_view> row;
  if (!rows.next(row)) return std::nullopt;
  return std::vector<std::string>(row.begin(), row.end());
}

/// How many bytes the row has that `head` begins with: quoted cells may have line breaks, as headers of spreadsheets do.
/// A quote that does not close, as an inch sign in a preamble, ends with its line.
std::size_t length_of_row(std::string_view head, char delimiter, char line_break) {
  constexpr int kMostLines = 50;
  const std::size_t line = std::min(head.find(line_break), head.size());
  std::size_t length = line;
  for (int lines = 1; lines <= kMostLines; ++lines) {
    if (std::ranges::count(head.substr(0, length), '"') % 2 == 0)
      return cells_in(head.substr(0, length), delimiter) ? length : line;
    if (length == head.size()) return line;
    length = std::min(head.find(line_break, length + 1), head.size());
  }
  return line;
}

}  // namespace

Rows rows_of(std::string_view head, char delimiter, std::size_t first_row, std::size_t most) {
  Rows rows;
  const char line_break = line_break_of(head);
  std::size_t number = 0;
  while (!head.empty() && rows.size() < most) {
    const std::size_t length = length_of_row(head, delimiter, line_break);
    const std::string_view text = head.substr(0, length);
    if (++number >= first_row) rows.push_back(cells_in(text, delimiter).value_or(split_at(text, delimiter)));
    for (auto more = std::ranges::count(text, line_break); more > 0; --more)
      if (++number >= first_row) rows.emplace_back(1);
    head.remove_prefix(std::min(length + 1, head.size()));
  }
  return rows;
}

Result<FoundLayout> find_layout(std::string_view head, const LogLayout& given) {
  if (head.empty()) return fail(error_at("row 1, column 1", {}, "the file is empty"));
  std::optional<Reading> reading = best_reading(head, given, Expected::mostly_values);
  if (!reading) reading = best_reading(head, given, Expected::mostly_texts);
  if (!reading)
    return fail(error_at("row 1, column 1", head.substr(0, head.find('\n')),
                         "no table of numbers follows within " + std::to_string(kRowsLookedAt) + " rows",
                         advice_on_layout(head, given)));
  FoundLayout out{.delimiter = reading->delimiter, .decimal = reading->form.decimal, .header = {}, .units = {}};
  out.decimal_sign = given.decimal.empty() ? decimal_sign_of(*reading) : DecimalSign::known;
  out.first_row = static_cast<std::size_t>(given.first_row);
  const auto least = static_cast<std::size_t>(std::max(given.header_row, given.units_row));
  if (out.first_row == 0) out.first_row = find_first_row(*reading, least);
  if (given.first_row == 0 && out.first_row > 0)
    out.first_row = with_rows_without_values(*reading, out.first_row, least);
  if (out.first_row == 0 || out.first_row > reading->rows.size())
    return fail(error_at("row " + std::to_string(reading->rows.size()) + ", column 1", {},
                         "the file ends before its first row of numbers", "look at header_row and first_row"));
  if (given.header_row == 0 && is_scope_export(*reading, out.first_row)) {
    name_scope_columns(*reading, out);
    return out;
  }
  find_header(*reading, given, out);
  const auto cells_of = [&](std::size_t number) {
    return filled_to(number > 0 ? reading->rows[number - 1] : std::vector<std::string>(), reading->width);
  };
  for (const std::string& cell : without_comment_sign(cells_of(out.header_row), reading->width))
    out.header.push_back(out.header_row > 0 ? header_text(cell) : place_name(out.header.size()));
  for (const std::string& cell : without_name_of_units(cells_of(out.units_row)))
    out.units.push_back(without_brackets(cell));
  out.units.resize(out.header.size());
  return out;
}

std::string header_text(std::string_view cell) {
  std::string text;
  for (const char letter : trim(cell)) {
    const bool is_break = letter == '\n' || letter == '\r';
    if (!is_break || !text.ends_with(' ')) text += is_break ? ' ' : letter;
  }
  std::string_view name = trim(text);
  const bool is_quoted = name.size() > 2 && name.front() == '"' && name.find('"', 1) == name.size() - 1;
  return as_utf8(is_quoted ? trim(name.substr(1, name.size() - 2)) : name);
}

bool repeats_head(const FoundLayout& layout, const std::vector<std::string_view>& cells) {
  const std::string_view first = cells.empty() ? std::string_view() : trim(cells.front());
  if (!first.empty() && std::isdigit(static_cast<unsigned char>(first.front())) != 0)
    return false;  // as nearly all are
  const auto is_row = [&](const std::vector<std::string>& row, const auto& as_it_was_read) {
    for (std::size_t k = 0; k < std::max(row.size(), cells.size()); ++k)
      if (as_it_was_read(k < cells.size() ? cells[k] : std::string_view()) != (k < row.size() ? row[k] : ""))
        return false;
    return true;
  };
  return (layout.header_row > 0 && is_row(layout.header, header_text)) ||
         (layout.units_row > 0 && is_row(layout.units, without_brackets));
}

namespace {

/// "2" of "y[2]", "2,1" of "A[2,1]"; "1" stands for no unit as well, and is taken for that.
bool is_index(std::string_view text) {
  return !text.empty() && text != "1" && text.find_first_not_of("0123456789,") == std::string_view::npos;
}

}  // namespace

namespace {

bool is_unit_or_time(std::string_view text) { return is_unit(text) || TimeFormat::of(text).has_value(); }

/// "ms" of "ms seit Start", where words follow; all of it where it is a unit, or begins with none.
std::string_view unit_before_words(std::string_view text) {
  const std::string_view first = text.substr(0, text.find_first_of(" ,;"));
  return !is_unit_or_time(text) && is_unit(first) ? first : text;
}

}  // namespace

NameAndUnitText split_header_cell(std::string_view cell) {
  cell = trim(cell);
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}, {'{', '}'}}) {
    const std::size_t at = opening_of(cell, open, close);
    if (at == std::string_view::npos || at == 0) continue;
    const std::size_t blank = cell.rfind(' ', at);
    const std::string_view word = cell.substr(blank + 1);
    if (blank != std::string_view::npos && blank + 1 < at && convert_unit(word, "Pa"))  // "PT-1 bar(g)"
      return {std::string(trim(cell.substr(0, blank))), std::string(word)};
    const std::string_view unit = trim(cell.substr(at + 1, cell.size() - at - 2));
    const bool derivative = open == '(' && at == 3 && cell.starts_with("der");  // of a state s, say
    const bool counts = open == '{' && unit.find_first_not_of("0123456789") == std::string_view::npos;
    if (is_index(unit) || derivative || counts) continue;
    if (open == '[') return {std::string(trim(cell.substr(0, at))), std::string(unit_before_words(unit))};
    if (is_unit_or_time(unit)) return {std::string(trim(cell.substr(0, at))), std::string(unit)};
  }
  for (const std::string_view between : {" / ", ", ", " in "}) {
    const std::size_t at = cell.rfind(between);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view unit = trim(cell.substr(at + between.size()));
    if (is_unit(unit)) return {std::string(trim(cell.substr(0, at))), std::string(unit)};
  }
  return {std::string(cell), {}};
}

std::string time_format_of(const std::vector<std::string>& cells) {
  if (cells.empty()) return {};
  if (std::ranges::all_of(cells, is_iso)) return "iso8601";
  if (std::ranges::all_of(cells, is_without_signs)) return kWithoutSigns;
  if (std::ranges::all_of(cells, is_minutes)) return kMinutes;
  for (const char* pattern : kTimePatterns)
    if (std::ranges::all_of(cells, [&](const auto& cell) { return parse_pattern(cell, pattern).has_value(); }))
      return pattern;
  return {};
}

std::string as_utf8(std::string_view text) {
  if (is_utf8(text)) return visible(text);
  std::string out;
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte < 0x80) {
      out += letter;
    } else {
      out += static_cast<char>(0xC0U | (byte >> 6U));
      out += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return visible(out);
}

}  // namespace sealwatch
