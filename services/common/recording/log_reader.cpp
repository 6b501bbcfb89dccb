#include "services/common/recording/log_reader.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/recording/cells.hpp"
#include "services/common/recording/csv_rows.hpp"
#include "services/common/recording/last_number.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/recording/repeated_times.hpp"
#include "services/common/recording/thousands.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

constexpr const char* kRowsAFixedTimeApart = "{column: row, unit: s, scale: SECONDS_BETWEEN_ROWS}";
constexpr std::size_t kHead_bytes = std::size_t{1} << 18U;

/// Without the empty cells at the end: many loggers put a delimiter behind every row.
std::size_t filled_cells(const auto& cells) {
  const auto is_filled = [](std::string_view cell) { return !trim(cell).empty(); };
  const auto last = std::find_if(cells.rbegin(), cells.rend(), is_filled);
  return static_cast<std::size_t>(cells.rend() - last);
}

class LogReader {
 public:
  LogReader(std::istream& in, FoundLayout layout, const PlantDescription& plant, const ChannelMap& map)
      : rows_(in, layout.delimiter), layout_(std::move(layout)), plant_(plant), map_(map) {}

  Result<Log> read() {
    if (const Status header = read_header(); !header) return fail(header.error());
    for (;;) {
      const Result<bool> more = rows_.next(cells_);
      if (!more) return fail(more.error());
      if (!*more) break;
      if (const Status row = read_row(); !row) return fail(row.error());
    }
    if (values_.front().empty() && out_.tests.empty())
      return fail(error_at("row " + std::to_string(layout_.first_row) + ", column time", {}, "no samples follow"));
    if (const Status ended = end_test(); !ended) return fail(ended.error());
    name_contents();
    out_.left_aside = mapped_.left_aside;
    out_.warnings = mapped_.warnings;
    return std::move(out_);
  }

 private:
  Status read_header() {
    std::vector<OfferedColumn> offered;
    for (std::size_t k = 0; k < layout_.header.size(); ++k) offered.push_back({layout_.header[k], layout_.units[k]});
    Result<MappedColumns> mapped = map_columns(offered, plant_, map_);
    if (!mapped) {
      Error error = mapped.error();
      error.place = "row " + std::to_string(std::max<std::size_t>(layout_.header_row, 1)) + ", " + error.place;
      return fail(std::move(error));
    }
    mapped_ = std::move(*mapped);
    Result<TimeFormat> format = time_format(mapped_);
    if (!format) return fail(format.error());
    time_format_ = std::move(*format);
    for (std::size_t k = 0; k < mapped_.columns.size(); ++k)
      if (mapped_.columns[k].column.name == "time") time_ = k;
    values_.resize(mapped_.columns.size());
    width_ = filled_cells(layout_.header);
    for (std::size_t row = 1; row < layout_.first_row; ++row)
      if (const Result<bool> skipped = rows_.skip_line(); !skipped) return fail(skipped.error());
    return {};
  }

  Status read_row() {
    const std::size_t filled = filled_cells(cells_);
    if (filled == 0 || repeats_head(layout_, cells_)) return {};
    ++rows_of_table_;
    if (map_.log.incomplete_rows == "skip" && is_incomplete()) return {};
    if (++rows_read_ * mapped_.columns.size() > kMostNumbers)
      return fail(error_in(0, "the file holds more than " + std::to_string(kMostNumbers) + " numbers",
                           "one recording is one test: split the file"));
    if (filled > width_) return fail(too_wide(filled));
    std::vector<double> numbers(mapped_.columns.size());
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const Result<double> number = number_at(k);
      if (!number) return fail(error_in(k, number.error().rule, number.error().advice));
      numbers[k] = *number;
    }
    if (Status time = check_time(numbers[time_]); !time) return time;
    numbers[time_] += shift_s_;
    if (values_[time_].empty()) first_row_ = rows_.row();
    for (std::size_t k = 0; k < numbers.size(); ++k) values_[k].push_back(numbers[k]);
    const std::vector<double>& time = values_[time_];
    const bool repeats = time.size() > 1 && time.back() == time[time.size() - 2];
    if (repeats && !repeated_.settle(values_, time_)) return fail(error_in(time_, "time repeats", "log a finer time"));
    return check_last_cell(filled);
  }

  /// Of a column that is used, the time apart: a clock may leave out a fraction that is zero.
  Status check_last_cell(std::size_t filled) {
    for (std::size_t k = 0; k < mapped_.columns.size(); ++k) {
      const bool is_last = k != time_ && mapped_.columns[k].index + 1 == filled && filled == cells_.size();
      if (is_last && last_number_.is_cut(cell(k), layout_.decimal, rows_.has_line_break()))
        return fail(error_in(k, kCutNumber, kWholeRow));
    }
    return {};
  }

  [[nodiscard]] std::string_view cell(std::size_t k) const { return cell_of(mapped_.columns[k].index); }

  [[nodiscard]] std::string_view cell_of(std::size_t index) const {
    return index < cells_.size() ? cells_[index] : std::string_view();
  }

  /// Not only of this one: blocks of one file may have their columns in another order.
  [[nodiscard]] bool is_name_of_a_column(std::string_view cell) const {
    return layout_.header_row > 0 && !trim(cell).empty() &&
           std::ranges::find(layout_.header, header_text(cell)) != layout_.header.end();
  }

  /// What the time is read from: its cell, behind that of the day where this has its own.
  [[nodiscard]] std::string_view time_cell() {
    if (!mapped_.day) return cell(time_);
    day_and_time_ = trim(cell_of(*mapped_.day));
    day_and_time_.append(" ").append(trim(cell(time_)));
    return day_and_time_;
  }

  [[nodiscard]] bool is_incomplete() const {
    for (const auto& part : {mapped_.day, mapped_.fraction})
      if (part && holds_no_value(cell_of(*part))) return true;
    return std::ranges::any_of(mapped_.columns, [&](const MappedColumn& column) {
      return column.index != kNoColumn && holds_no_value(cell_of(column.index));
    });
  }

  /// A cell of numbers without separators of thousands, where it has some; an Error where that cannot be told.
  [[nodiscard]] Result<std::string_view> plain(std::string_view cell) {
    const bool is_number = parse_number(cell, layout_.decimal).has_value();
    if (is_number && !(is_doubtful() && may_have_thousands(cell, layout_.decimal))) return cell;
    if (auto without = without_thousands(cell, layout_.decimal, layout_.decimal_sign)) {
      without_thousands_ = std::move(*without);
      return without_thousands_;
    }
    if (is_number || without_thousands(cell, layout_.decimal, DecimalSign::known))
      return fail("may be a number with thousands or with decimals", "log: {decimal: point} or {decimal: comma}");
    return cell;
  }

  [[nodiscard]] bool is_doubtful() const { return layout_.decimal_sign == DecimalSign::doubtful; }

  [[nodiscard]] Result<double> number_in(std::string_view cell) {
    Result<double> number = parse_number(cell, layout_.decimal);
    if (number && !is_doubtful()) return number;
    const Result<std::string_view> text = plain(cell);
    return text ? parse_number(*text, layout_.decimal) : fail(text.error());
  }

  Result<double> seconds_at() {
    if (mapped_.columns[time_].index == kNoColumn) return time_format_.seconds(static_cast<double>(rows_of_table_ - 1));
    const auto read = [&](std::string_view text) { return time_format_.seconds(text, layout_.decimal); };
    Result<double> seconds = read(time_cell());
    if ((!seconds || is_doubtful()) && !mapped_.day) {
      const Result<std::string_view> text = plain(cell(time_));
      if (!text) return fail(text.error());
      if (*text != cell(time_)) seconds = read(*text);
    }
    if (!seconds || !mapped_.fraction) return seconds;
    const Result<double> fraction = number_in(cell_of(*mapped_.fraction));
    if (!fraction)
      return fail("its fraction, in column " + std::to_string(*mapped_.fraction + 1) + ", must be a number");
    return *seconds + *fraction * mapped_.fraction_to_s;
  }

  Result<double> number_at(std::size_t k) {
    const bool is_counted = mapped_.columns[k].index == kNoColumn;
    if (!is_counted && mapped_.columns[k].index >= cells_.size())
      return fail("the row has " + std::to_string(cells_.size()) + " cells and this is column " +
                      std::to_string(mapped_.columns[k].index + 1),
                  rows_.has_line_break() ? "take the row out" : "the last line is cut off");
    if (k == time_ && !is_counted && values_[time_].empty() && trim(cell(k)).empty())
      return fail("the cell is empty", std::string("in the map: time: ") + kRowsAFixedTimeApart);
    if (k == time_) {
      Result<double> seconds = seconds_at();
      if (!seconds && is_name_of_a_column(cell(k)))
        return fail("is a column's name: another header", "make a file of its own of what follows");
      return seconds;
    }
    const Result<double> number = number_in(cell(k));
    if (!number && holds_no_value(cell(k)))
      return fail(number.error().rule, "log: {incomplete_rows: skip} leaves such rows out");
    if (!number) return fail(number.error().rule, number.error().advice);
    const double value = mapped_.columns[k].column.to_si.to_si(*number);
    return std::isfinite(value) ? Result<double>(value) : fail("is out of a double's range");
  }

  /// A time column that starts anew: refused, the same test going on, or another test, as the map says.
  Status check_time(double time_s) {
    const std::vector<double>& time = values_[time_];
    if (time.empty() || time_s + shift_s_ > time.back()) return {};
    const bool repeats = time_s + shift_s_ == time.back();
    if (repeats && map_.log.repeated_times == "jump") return {};
    if (map_.log.time_resets == "split" && !repeats) return end_test();
    if (map_.log.time_resets == "join" && !repeats) {
      shift_s_ = time.back() + usual_step(time) - time_s;
      if (time_s + shift_s_ > time.back()) return {};
      return fail(error_in(time_, "the row before is at " + text::significant(time.back(), 9) + " s: " + kOneTime,
                           "log the time from the test's begin"));
    }
    return fail(error_in(
        time_,
        repeats ? "time repeats" : "time goes back: the row before is at " + text::significant(time.back(), 9) + " s",
        repeats ? kRepeatAdvice + std::string("; of rows a fixed time apart: time: ") + kRowsAFixedTimeApart
                : "log: {time_resets: join} takes it as one test, split as another test"));
  }

  Status end_test() {
    if (values_[time_].empty()) return {};
    LogTest test;
    test.first_row = first_row_;
    test.start_time = time_format_.utc(values_[time_].front());
    test.clock = time_format_.clock(values_[time_].front());
    note_count_since_1970();
    if (time_format_.is_absolute())
      if (Status shifted = shift_times(values_[time_], -values_[time_].front()); !shifted) return shifted;
    std::vector<Column> columns;
    for (const MappedColumn& mapped : mapped_.columns) columns.push_back(mapped.column);
    test.read = assemble(std::move(columns), std::move(values_));
    out_.tests.push_back(std::move(test));
    values_.assign(mapped_.columns.size(), {});
    repeated_ = {};
    shift_s_ = 0.0;
    return {};
  }

  void note_count_since_1970() {
    const bool counts = !time_format_.is_absolute() && !since_1970("s", values_[time_].front()).empty();
    if (!counts || !out_.tests.empty()) return;
    mapped_.warnings.push_back("the time counts from 1970, as it seems: in the map, `unit: " + mapped_.time_unit +
                               " since 1970-01-01` begins the test at 0 s and dates it");
  }

  void name_contents() {
    for (std::size_t k = 0; k < out_.tests.size(); ++k)
      out_.tests[k].read.content_hash =
          out_.tests.size() == 1 ? rows_.content_hash()
                                 : content_hash(rows_.content_hash().append("#").append(std::to_string(k + 1)));
  }

  /// A decimal comma, or a separator inside a text, moves what follows into other columns.
  [[nodiscard]] Error too_wide(std::size_t filled) const {
    const std::string header = layout_.header_row > 0 ? "header has " : "table has ";
    return error_at("row " + std::to_string(rows_.row()) + ", column " + std::to_string(width_ + 1), cells_[width_],
                    "the row has " + std::to_string(filled) + " cells where the " + header + std::to_string(width_),
                    "a decimal comma or a text splits a cell in two: mend the row, or name the column in the header");
  }

  [[nodiscard]] Error error_in(std::size_t k, std::string rule, std::string advice = {}) const {
    const std::string& channel = mapped_.columns[k].column.name;
    const std::size_t index = mapped_.columns[k].index;
    const std::string row = "row " + std::to_string(rows_.row());
    if (index == kNoColumn) return error_at(row + ", channel time", {}, std::move(rule), std::move(advice));
    return error_at(row + ", column " + std::to_string(index + 1) + " (" + printable(layout_.header[index]) +
                        ", channel " + channel + ")",
                    k == time_ && mapped_.day ? day_and_time_ : cell(k), std::move(rule), std::move(advice));
  }

  CsvRows rows_;
  FoundLayout layout_;
  const PlantDescription& plant_;
  const ChannelMap& map_;
  MappedColumns mapped_;
  TimeFormat time_format_;
  std::vector<std::string_view> cells_;
  std::string day_and_time_, without_thousands_;
  std::vector<std::vector<double>> values_;  ///< of the test that is being read, by mapped column
  std::size_t time_ = 0;                     ///< index of time among the mapped columns
  std::size_t width_ = 0;                    ///< cells of the header
  RepeatedTimes repeated_;
  LastNumber last_number_;
  double shift_s_ = 0.0;  ///< added to the log's time since it started anew
  std::size_t rows_read_ = 0;
  std::size_t rows_of_table_ = 0;  ///< and those that were left out
  std::size_t first_row_ = 0;      ///< of the test that is being read
  Log out_;
};

}  // namespace

Result<FoundLayout> layout_of(std::istream& in, const LogLayout& given) {
  const std::istream::pos_type begin = in.tellg();
  std::string head(kHead_bytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  const bool whole = in.eof();
  const char line_break = line_break_of(head);
  in.clear();
  in.seekg(begin);
  if (!whole && head.find(line_break) == std::string::npos)
    return fail(error_at("row 1, column 1", {}, "the row is longer than " + std::to_string(kHead_bytes) + " bytes",
                         "a log has rows that end in a line feed"));
  if (!whole) head.resize(head.rfind(line_break) + 1);  // the last row may be cut
  return find_layout(head, given);
}

bool has_a_column_of(const FoundLayout& layout, const ChannelMap& map) {
  std::vector<OfferedColumn> offered;
  for (const std::string& text : layout.header) offered.push_back({text});
  return std::ranges::any_of(map.columns,
                             [&](const auto& entry) { return find_offered(offered, entry.second.column).has_value(); });
}

Result<Log> read_log(std::istream& in, const PlantDescription& plant, const ChannelMap& map) {
  Result<FoundLayout> layout = layout_of(in, map.log);
  if (!layout) return fail(layout.error());
  return LogReader(in, std::move(*layout), plant, map).read();
}

}  // namespace sealwatch
