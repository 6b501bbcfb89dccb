#include "services/common/forecast/history.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kLargestCondition =
    2.0;  // theta above this is a percentage or a slip, not a share of the nominal modulus
constexpr std::uint64_t kLargestFile_bytes = 1'000'000;  // a century of monthly tests is 100 kB
constexpr std::size_t kMostColumns = 100;

/// Cells of one line; quotes of RFC 4180 are taken off, blanks around a cell too.
std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  for (std::string& cell : cells) {
    const auto first = cell.find_first_not_of(" \t");
    cell = first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
  }
  return cells;
}

/// Without an asset the columns are those of a seal.
std::string worn_column(const std::optional<ConditionSetting>& condition, const char* suffix = "") {
  const bool known = condition && !condition->parameter.empty();
  return (known ? condition->parameter : "R_CL") + suffix + "[" + (known ? condition->unit : "Pa s/m3") + "]";
}
constexpr std::size_t kSlip = 2;  // letters: other columns are passed over, a misspelt one must not be

/// The column that `name` nearly is; "" for one that is spelt right or is something else altogether.
std::string misspelt(const std::string& name, const std::vector<std::string>& columns) {
  std::string meant;
  std::size_t least = kSlip + 1;
  for (const std::string& column : columns)
    if (const std::size_t distance = edit_distance(name, column); distance < least) {
      least = distance;
      meant = column;
    }
  return meant == name ? std::string() : meant;
}

struct Columns {
  std::size_t time = 0;
  std::size_t value = 0;
  std::optional<std::size_t> std_error;
  bool resistance = false;
  std::vector<std::string> header;
};

class HistoryParser {
 public:
  HistoryParser(const std::string& file, const std::optional<ConditionSetting>& seal) : file_(file), seal_(seal) {}

  Result<std::vector<ConditionSample>> parse(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    if (!std::getline(lines, line))
      return fail(at({}, {}, "is empty", "the first row must be time[iso8601],theta[1],theta_std[1]"));
    if (line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);
    if (const Status header = read_header(line); !header) return fail(header.error());
    std::vector<ConditionSample> history;
    while (std::getline(lines, line)) {
      ++row_;
      if (line.empty() || line == "\r") continue;
      auto sample = read_row(split(line));
      if (!sample) return fail(sample.error());
      if (!history.empty() && sample->time <= history.back().time)
        return fail(at(columns_.header[columns_.time], format_utc(sample->time), "comes not after the row before",
                       "sort the rows by time and keep one per test"));
      history.push_back(*sample);
    }
    if (history.empty()) return fail(at({}, {}, "has no row of data", {}));
    return history;
  }

 private:
  Error at(const std::string& column, const std::string& value, const std::string& rule,
           const std::string& advice) const {
    std::string place = "row " + std::to_string(row_);
    if (!column.empty()) place += ", column " + column;
    return Error{.file = file_, .place = place, .value = value, .rule = rule, .advice = advice};
  }

  Status read_header(const std::string& line) {
    columns_.header = split(line);
    if (columns_.header.size() > kMostColumns)
      return fail(at({}, std::to_string(columns_.header.size()) + " columns", "is not a history",
                     "a history needs time[iso8601] and theta[1], one row per test"));
    const std::string worn = worn_column(seal_), worn_std = worn_column(seal_, "_std");
    const std::vector<std::string> known = {"time[iso8601]", "theta[1]", "theta_std[1]", worn, worn_std};
    const auto find = [&](const std::string& name) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < columns_.header.size(); ++i)
        if (columns_.header[i] == name) return i;
      return std::nullopt;
    };
    for (std::size_t i = 0; i < columns_.header.size(); ++i) {
      if (find(columns_.header[i]) != i) return fail(at(columns_.header[i], {}, "stands twice", {}));
      if (const std::string meant = misspelt(columns_.header[i], known); !meant.empty())
        return fail(at({}, columns_.header[i], "is not a column of a history", "did you mean '" + meant + "'?"));
    }
    const auto time = find("time[iso8601]");
    const std::string needs = "a history needs time[iso8601] and theta[1] or " + worn + ", one row per test";
    if (!time) return fail(at({}, line, "has no column time[iso8601]", needs));
    const auto theta = find("theta[1]");
    const auto resistance = find(worn);
    if (!theta && !resistance) return fail(at({}, line, "has neither column theta[1] nor " + worn, needs));
    columns_.time = *time;
    columns_.resistance = !theta;
    columns_.value = theta ? *theta : *resistance;
    columns_.std_error = find(theta ? "theta_std[1]" : worn_std);
    if (columns_.resistance && !seal_)
      return fail(at(worn, {}, "needs the seal resistances of the asset", "give --asset with a `seal:` section"));
    return {};
  }

  Result<double> number(const std::vector<std::string>& cells, std::size_t column) const {
    const std::string& text = cells[column];
    const std::string& name = columns_.header[column];
    if (text.empty()) return fail(at(name, {}, "is missing", "leave out the whole row when there is no estimate"));
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
      return fail(at(name, text, "must be a finite number", {}));
    return value;
  }

  Result<ConditionSample> read_row(const std::vector<std::string>& cells) const {
    if (cells.size() != columns_.header.size())
      return fail(at({}, std::to_string(cells.size()) + " cells",
                     "must have as many cells as the header (" + std::to_string(columns_.header.size()) + ")",
                     "is the last line cut off?"));
    const auto time = parse_utc(cells[columns_.time]);
    if (!time)
      return fail(at(columns_.header[columns_.time], cells[columns_.time], time.error().rule, time.error().advice));
    const auto value = number(cells, columns_.value);
    if (!value) return fail(value.error());
    const bool positive = !columns_.resistance || !seal_ || seal_->is_positive();
    if ((positive && *value <= 0.0) || (!columns_.resistance && *value > kLargestCondition))
      return fail(at(columns_.header[columns_.value], cells[columns_.value],
                     columns_.resistance ? "must be positive" : "must be above 0, at most 2",
                     columns_.resistance ? "" : "theta is a share: 0.85 for 85 %"));
    const auto std_error = columns_.std_error ? number(cells, *columns_.std_error) : Result<double>(0.0);
    if (!std_error) return fail(std_error.error());
    if (*std_error < 0.0)
      return fail(at(columns_.header[*columns_.std_error], cells[*columns_.std_error], "must not be negative", {}));
    if (!columns_.resistance) return ConditionSample{*time, *value, *std_error};
    const double condition = seal_->condition(*value);
    const bool seal = seal_->part.ends_with("seal");
    const std::string what = seal ? "seal " : "", anchors = seal ? "`seal:` resistances" : "`condition:`";
    if (!(condition <= kLargestCondition))
      return fail(at(columns_.header[columns_.value], cells[columns_.value],
                     "is a " + what + "condition above 2 by the asset's " + anchors,
                     "do the file's unit, " + seal_->unit + ", and the asset fit?"));
    return ConditionSample{*time, condition, seal_->condition_std(*value, *std_error)};
  }

  const std::string& file_;
  const std::optional<ConditionSetting>& seal_;
  Columns columns_;
  int row_ = 1;
};

}  // namespace

Result<std::vector<ConditionSample>> parse_history(const std::string& text, const std::string& file,
                                                   const std::optional<ConditionSetting>& seal) {
  return HistoryParser(file, seal).parse(text);
}

Result<std::vector<ConditionSample>> read_history(const std::string& path,
                                                  const std::optional<ConditionSetting>& seal) {
  const Result<std::string> text = read_file(path, kLargestFile_bytes);
  if (!text) return fail(text.error());
  return parse_history(*text, path, seal);
}

}  // namespace sealwatch::forecast
