#include "services/common/recording/csv_reader.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/recording/cells.hpp"
#include "services/common/recording/csv_rows.hpp"
#include "services/common/recording/last_number.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/recording/repeated_times.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

/// Its byte order mark, or a NUL beside the first letter (RFC 4180 knows neither).
bool is_utf16(std::string_view first_cell) {
  using namespace std::string_view_literals;
  return first_cell.starts_with("\xFF\xFE"sv) || first_cell.starts_with("\xFE\xFF"sv) ||
         first_cell.substr(0, 2).find('\0') != std::string_view::npos;
}

class CsvReader {
 public:
  CsvReader(std::istream& in, const PlantDescription& plant, bool jumps) : rows_(in), plant_(plant), jumps_(jumps) {}

  Result<ColumnarSamples> read() {
    if (const Status header = read_header(); !header) return fail(header.error());
    for (;;) {
      const Result<bool> more = rows_.next(cells_);
      if (!more) return fail(more.error());
      if (!*more) break;
      if (const Status row = read_row(); !row) return fail(row.error());
    }
    if (values_[time_].empty()) return fail(error_at("row 2, column time", {}, "no samples follow the header"));
    ColumnarSamples out = assemble(std::move(columns_), std::move(values_));
    out.content_hash = rows_.content_hash();
    return out;
  }

 private:
  Status read_header() {
    const Result<bool> header = rows_.next(cells_);
    if (!header) return fail(header.error());
    if (!*header) return fail(error_at("row 1, column 1", {}, "the file is empty", "a header row must come first"));
    if (is_utf16(cells_.front()))
      return fail(error_at("row 1, column 1", {}, "the file is UTF-16 text", "save it as UTF-8"));
    for (std::string_view& cell : cells_) cell = trim(cell);
    Result<std::vector<Column>> columns = find_columns(cells_, plant_);
    if (!columns) return fail(columns.error());
    columns_ = std::move(*columns);
    values_.resize(columns_.size());
    const auto is_time = [](const Column& column) { return column.known && column.name == "time"; };
    time_ = static_cast<std::size_t>(std::find_if(columns_.begin(), columns_.end(), is_time) - columns_.begin());
    return {};
  }

  Status read_row() {
    if (const bool blank = cells_.size() == 1 && trim(cells_[0]).empty(); blank && columns_.size() > 1) {
      blank_row_ = blank_row_ > 0 ? blank_row_ : rows_.row();
      return {};  // blank lines at the end are harmless
    }
    if (blank_row_ > 0)
      return fail(error_in("1", {}, "follows a blank row", "take out row " + std::to_string(blank_row_)));
    if (cells_.size() != columns_.size()) return fail(wrong_cell_count());
    if ((values_[time_].size() + 1) * columns_.size() > kMostNumbers) return fail(too_many());
    for (std::size_t index = 0; index < cells_.size(); ++index) {
      if (!columns_[index].known) continue;
      const Result<double> number = parse_number(cells_[index]);
      if (!number) return fail(bad_number(index, number.error()));
      const double value = columns_[index].to_si.to_si(*number);
      if (!std::isfinite(value))
        return fail(error_in(columns_[index].name, cells_[index], "is out of a double's range"));
      values_[index].push_back(value);
    }
    const Status time = check_time();
    return time ? check_last_row() : time;
  }

  Status check_time() {
    const std::vector<double>& time = values_[time_];
    if (time.size() < 2 || time.back() > time[time.size() - 2]) return {};
    const double before = time[time.size() - 2];
    const bool repeats = time.back() == before;
    if (repeats && jumps_ && repeated_.settle(values_, time_)) return {};
    return fail(
        error_in("time", cells_[time_],
                 repeats ? "time repeats" : text::format("time goes back: the row before is at {:.9g} s", before),
                 repeats ? kRepeatAdvice : "time must increase from row to row: sort the rows"));
  }

  Status check_last_row() {
    if (!last_number_.is_cut(cells_.back(), '.', rows_.has_line_break())) return {};
    return fail(error_in(columns_.back().name, trim(cells_.back()), kCutNumber, kWholeRow));
  }

  Error error_in(std::string_view column, std::string_view value, std::string rule, std::string advice = {}) const {
    return error_at("row " + std::to_string(rows_.row()) + ", column " + std::string(column), value, std::move(rule),
                    std::move(advice));
  }
  Error bad_number(std::size_t index, const Error& why) const {
    const bool cut = !rows_.has_line_break() && index + 1 == columns_.size();
    return error_in(columns_[index].name, cells_[index], cut ? why.rule + ": the last line is cut off" : why.rule,
                    why.advice);
  }
  Error wrong_cell_count() const {
    const bool few = cells_.size() < columns_.size();
    const std::string column = few ? columns_[cells_.size()].name : std::to_string(columns_.size() + 1);
    const std::string count =
        std::to_string(cells_.size()) + " cells where the header has " + std::to_string(columns_.size());
    if (few && !rows_.has_line_break()) return error_in(column, cells_.back(), "the last line is cut off: " + count);
    return error_in(column, cells_.back(), "the row has " + count);
  }
  Error too_many() const {
    return error_in(columns_.back().name, {}, "the file holds more than " + std::to_string(kMostNumbers) + " numbers",
                    "one recording is one test: split the file");
  }

  CsvRows rows_;
  const PlantDescription& plant_;
  std::vector<std::string_view> cells_;
  std::vector<Column> columns_;
  std::vector<std::vector<double>> values_;  ///< by column
  std::size_t time_ = 0;                     ///< index of the column time
  bool jumps_;
  RepeatedTimes repeated_;
  std::size_t blank_row_ = 0;  ///< first blank row, 0: none yet
  LastNumber last_number_;
};

}  // namespace

Result<ColumnarSamples> read_csv(std::istream& in, const PlantDescription& plant, bool jumps) {
  return CsvReader(in, plant, jumps).read();
}

}  // namespace sealwatch
