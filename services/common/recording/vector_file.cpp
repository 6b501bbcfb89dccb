#include "services/common/recording/vector_file.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/recording/cells.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/mat_container.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

/// By the last part of the path where that is a name of one's own in the file, else by the whole path.
std::vector<OfferedColumn> offered_by(const std::vector<MatVariable>& vectors, const ChannelMap& map) {
  std::vector<OfferedColumn> offered;
  for (const MatVariable& vector : vectors) {
    const auto named = [&](const auto& entry) { return entry.second.column == vector.name; };
    const bool whole = std::ranges::any_of(map.columns, named);
    offered.push_back({whole ? vector.name : vector.name.substr(vector.name.rfind('/') + 1), vector.unit});
  }
  return offered;
}

Error sample_error(const std::string& channel, std::size_t row, double value, std::string rule) {
  return error_at("row " + std::to_string(row + 1) + ", channel " + channel, text::exact(value), std::move(rule));
}

Result<std::vector<double>> in_seconds(const std::vector<double>& numbers, TimeFormat& format) {
  std::vector<double> out;
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    const Result<double> time = format.seconds(numbers[row]);
    if (!time) return fail(sample_error("time", row, numbers[row], time.error().rule));
    if (!std::isfinite(*time)) return fail(sample_error("time", row, numbers[row], "must be a finite number"));
    if (row > 0 && *time <= out.back())
      return fail(sample_error("time", row, numbers[row], "time must increase from row to row"));
    out.push_back(*time);
  }
  return out;
}

Result<std::vector<double>> in_si(std::vector<double> numbers, const Column& column) {
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    numbers[row] = column.to_si.to_si(numbers[row]);
    if (!std::isfinite(numbers[row]))
      return fail(sample_error(column.name, row, numbers[row], "must be a finite number"));
  }
  return numbers;
}

}  // namespace

Result<Log> log_of_vectors(std::vector<MatVariable> vectors, const PlantDescription& plant, const ChannelMap& map) {
  Result<MappedColumns> mapped = map_columns(offered_by(vectors, map), plant, map);
  if (!mapped) return fail(mapped.error());
  Result<TimeFormat> format = TimeFormat::of(mapped->time_unit);
  if (!format) return fail(error_at("channel time", mapped->time_unit, format.error().rule));
  std::vector<Column> columns;
  std::vector<std::vector<double>> values;
  for (const MappedColumn& found : mapped->columns) {
    if (vectors[found.index].is_complex)
      return fail(error_at("channel " + found.column.name, printable(vectors[found.index].name), kIsComplex,
                           "store its real part, or its magnitude, under a name of its own"));
    const std::vector<double>& numbers = vectors[found.index].values;
    Result<std::vector<double>> converted =
        found.column.name == "time" ? in_seconds(numbers, *format) : in_si(numbers, found.column);
    if (!converted) return fail(converted.error());
    columns.push_back(found.column);
    values.push_back(std::move(*converted));
  }
  LogTest test{.read = assemble(std::move(columns), std::move(values)), .start_time = {}, .clock = {}, .first_row = 1};
  const std::size_t rows = test.read.samples.time_s.size();
  for (const Series& channel : test.read.samples.channels)
    if (channel.values.size() != rows)
      return fail(
          error_at("channel " + channel.name, {},
                   "has " + std::to_string(channel.values.size()) + " samples where time has " + std::to_string(rows)));
  if (rows == 0) return fail(error_at("channel time", {}, "holds no samples"));
  test.start_time = format->utc(test.read.samples.time_s.front());
  test.clock = format->clock(test.read.samples.time_s.front());
  return Log{
      .tests = {std::move(test)}, .left_aside = std::move(mapped->left_aside), .warnings = std::move(mapped->warnings)};
}

}  // namespace sealwatch
