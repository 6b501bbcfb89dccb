#include "services/common/recording/vector_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/mat_container.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

/// Vectors that stand for a channel although something speaks against it are refused.
Status check_vector(const MatVariable& vector, const std::string& channel, const ChannelMap& map) {
  const std::string place = "channel " + channel;
  if (!vector.rule.empty()) return fail(error_at(place, vector.name, vector.rule, vector.advice));
  const auto mapping = map.columns.find(channel);
  const bool is_scaled = mapping != map.columns.end() &&
                         (mapping->second.is_scaled || mapping->second.scale != 1.0 || mapping->second.offset != 0.0);
  if (vector.scaling.empty() || is_scaled) return {};
  return fail(error_at(place, vector.name,
                       "has the attribute " + printable(vector.scaling) + ", so its numbers are scaled",
                       "give scale and offset in the map: unit = scale number + offset"));
}

/// Leaves out the samples at which a channel has no number.
void skip_incomplete(std::vector<std::vector<double>>& vectors) {
  std::vector<bool> is_complete(vectors.front().size(), true);
  for (const std::vector<double>& vector : vectors)
    for (std::size_t row = 0; row < vector.size(); ++row)
      if (std::isnan(vector[row])) is_complete[row] = false;
  for (std::vector<double>& vector : vectors) {
    std::size_t row = 0;
    std::erase_if(vector, [&](double) { return !is_complete[row++]; });
  }
}

/// The numbers of all mapped vectors as they are stored, each as long as time.
Result<std::vector<std::vector<double>>> numbers_of(std::vector<MatVariable>& vectors, const MappedColumns& mapped,
                                                    const ChannelMap& map) {
  std::vector<std::vector<double>> numbers;
  std::size_t rows = 0;
  for (const MappedColumn& found : mapped.columns) {
    if (found.index == kNoColumn) {
      std::vector<double>& counted = numbers.emplace_back(numbers.empty() ? 0 : numbers.front().size());
      std::iota(counted.begin(), counted.end(), 0.0);
      rows = counted.size();
      continue;
    }
    MatVariable& vector = vectors[found.index];
    if (const Status checked = check_vector(vector, found.column.name, map); !checked) return fail(checked.error());
    if (found.column.name == "time") rows = vector.values.size();
    numbers.push_back(std::move(vector.values));
  }
  if (rows == 0) return fail(error_at("channel time", {}, "holds no samples"));
  for (const auto& part : {mapped.day, mapped.fraction})
    if (part)
      return fail(error_at("channel time", vectors[*part].name,
                           "is a part of a time, which only logs of text have apart", "name one column"));
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (mapped.columns[k].index != kNoColumn && numbers[k].size() != rows)
      return fail(
          error_at("channel " + mapped.columns[k].column.name, vectors[mapped.columns[k].index].name,
                   "has " + std::to_string(numbers[k].size()) + " samples where time has " + std::to_string(rows),
                   "sample all channels at the same times"));
  if (map.log.incomplete_rows == "skip") skip_incomplete(numbers);
  return numbers;
}

Error sample_error(const std::string& channel, std::size_t row, double value, std::string rule) {
  const char* const advice = std::isnan(value) ? "log: {incomplete_rows: skip} leaves such rows out" : "";
  return error_at("row " + std::to_string(row + 1) + ", channel " + channel, text::exact(value), std::move(rule),
                  advice);
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

/// values, data, y: what many vectors are called, and their group says which they are.
bool says_nothing(const std::string& name) {
  static const std::set<std::string> kNames = {"value", "values", "Value", "Values", "data", "Data", "y", "Y"};
  return kNames.contains(name) || name.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::vector<OfferedColumn> offered_vectors(const std::vector<MatVariable>& vectors, const ChannelMap& map) {
  const auto last_part = [](const std::string& path) { return path.substr(path.rfind('/') + 1); };
  std::map<std::string, int> uses;
  for (const MatVariable& vector : vectors) ++uses[last_part(visible(vector.name))];
  std::vector<OfferedColumn> offered;
  for (const MatVariable& vector : vectors) {
    const std::string name = visible(vector.name);
    const std::string last = last_part(name);
    const auto is_named = [&](const std::string& one) {
      return std::ranges::any_of(map.columns, [&](const auto& entry) { return entry.second.column == one; });
    };
    const bool whole = uses[last] > 1 || is_named(name) || (says_nothing(last) && !is_named(last));
    offered.push_back({whole ? name : last, visible(vector.unit)});
  }
  return offered;
}

Result<Log> log_of_vectors(std::vector<MatVariable> vectors, const PlantDescription& plant, const ChannelMap& map) {
  Result<MappedColumns> mapped = map_columns(offered_vectors(vectors, map), plant, map);
  if (!mapped) return fail(mapped.error());
  Result<TimeFormat> format = time_format(*mapped);
  if (!format) return fail(format.error());
  std::vector<Column> columns;
  std::vector<std::vector<double>> values;
  Result<std::vector<std::vector<double>>> numbers = numbers_of(vectors, *mapped, map);
  if (!numbers) return fail(numbers.error());
  for (std::size_t k = 0; k < numbers->size(); ++k) {
    const Column& column = mapped->columns[k].column;
    Result<std::vector<double>> converted =
        column.name == "time" ? in_seconds((*numbers)[k], *format) : in_si(std::move((*numbers)[k]), column);
    if (!converted) return fail(converted.error());
    columns.push_back(column);
    values.push_back(std::move(*converted));
  }
  LogTest test{.read = assemble(std::move(columns), std::move(values)), .start_time = {}, .clock = {}, .first_row = 1};
  if (test.read.samples.time_s.empty()) return fail(error_at("channel time", {}, "holds no samples"));
  test.start_time = format->utc(test.read.samples.time_s.front());
  test.clock = format->clock(test.read.samples.time_s.front());
  return Log{
      .tests = {std::move(test)}, .left_aside = std::move(mapped->left_aside), .warnings = std::move(mapped->warnings)};
}

}  // namespace sealwatch
