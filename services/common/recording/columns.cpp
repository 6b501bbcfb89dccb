#include "services/common/recording/columns.hpp"

#include <algorithm>

#include "sealwatch/core/text.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kLongestPrinted = 60;

struct NameAndUnit {
  std::string_view name;
  std::string_view unit;
};

Result<NameAndUnit> split_cell(std::string_view cell) {
  const std::size_t open = cell.find('[');
  if (open == std::string_view::npos) return NameAndUnit{.name = cell, .unit = {}};
  if (cell.back() != ']') return fail(error_at({}, cell, "a header cell must read channel[unit]"));
  return NameAndUnit{.name = cell.substr(0, open), .unit = cell.substr(open + 1, cell.size() - open - 2)};
}

/// SI unit of a channel, "" when the plant has no such channel.
std::string_view si_unit_of(std::string_view name, const PlantDescription& plant) {
  if (name == "time") return "s";
  for (const ChannelDescription& channel : plant.channels)
    if (channel.name == name) return channel.unit.empty() ? std::string_view("1") : std::string_view(channel.unit);
  return {};
}

std::string suggest_channel(std::string_view name, const PlantDescription& plant) {
  std::vector<std::string> names{"time"};
  for (const ChannelDescription& channel : plant.channels) names.push_back(channel.name);
  return suggest(name.substr(0, kLongestPrinted), names);
}

Result<UnitConversion> find_conversion(std::string_view unit, std::string_view si_unit) {
  if (unit.empty() || unit == si_unit) return UnitConversion{.scale = 1.0, .offset = 0.0, .si_unit = {}};
  if (unit.size() > kLongestPrinted) return fail("is not a known unit");
  Result<UnitConversion> known = find_unit(unit);
  if (known && known->si_unit != si_unit) {
    std::string units;
    for (const std::string& name : units_of(si_unit)) units.append(units.empty() ? "" : ", ").append(name);
    return fail("cannot be converted to " + std::string(si_unit), "units of this channel: " + units);
  }
  return known;
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    if (length == 0 || at + length > text.size()) return false;
    unsigned code = length == 1 ? lead : lead & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[at + k]);
      if ((next & 0xC0U) != 0x80U) return false;
      code = code << 6U | (next & 0x3FU);
    }
    const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    if (overlong || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return false;
    at += length;
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string out(text.substr(0, kLongestPrinted));
  for (char& letter : out)
    if (static_cast<unsigned char>(letter) < 0x20 || static_cast<unsigned char>(letter) >= 0x7f) letter = '?';
  return text.size() > kLongestPrinted ? out + "..." : out;
}

Error error_at(std::string place, std::string_view value, std::string rule, std::string advice) {
  return {.file = {},
          .place = std::move(place),
          .value = printable(value),
          .rule = std::move(rule),
          .advice = std::move(advice)};
}

Result<Column> find_column(std::string_view cell, const PlantDescription& plant) {
  if (cell.find(';') != std::string_view::npos)
    return fail(error_at({}, cell, "is not a channel of plant " + plant.name, "cells are separated by commas"));
  const Result<NameAndUnit> parts = split_cell(cell);
  if (!parts) return fail(parts.error());
  const std::string_view si_unit = si_unit_of(parts->name, plant);
  if (si_unit.empty())
    return fail(error_at({}, cell, "is not a channel of plant " + plant.name, suggest_channel(parts->name, plant)));
  Result<UnitConversion> conversion = find_conversion(parts->unit, si_unit);
  if (!conversion) {
    Error error = error_at({}, cell, "unit '" + printable(parts->unit) + "' " + conversion.error().rule,
                           conversion.error().advice);
    return fail(std::move(error));
  }
  return Column{.name = std::string(parts->name), .si_unit = std::string(si_unit), .to_si = *conversion};
}

Result<std::vector<Column>> find_columns(std::span<const std::string_view> cells, const PlantDescription& plant) {
  std::vector<Column> columns;
  const auto recorded = [&columns](std::string_view name) {
    return std::any_of(columns.begin(), columns.end(), [name](const Column& column) { return column.name == name; });
  };
  for (std::size_t index = 0; index < cells.size(); ++index) {
    Result<Column> column = find_column(cells[index], plant);
    if (column && recorded(column->name)) column = fail(error_at({}, cells[index], "is recorded twice"));
    if (!column) {
      Error error = std::move(column.error());
      error.place = "row 1, column " + std::to_string(index + 1);
      return fail(std::move(error));
    }
    columns.push_back(std::move(*column));
  }
  if (!recorded("time"))
    return fail(error_at("row 1, column time", {}, "is missing and required", "add a column time[s]"));
  return columns;
}

ColumnarSamples assemble(std::vector<Column> columns, std::vector<std::vector<double>> values) {
  ColumnarSamples out;
  for (std::size_t index = 0; index < columns.size(); ++index) {
    if (columns[index].name == "time") {
      out.samples.time_s = std::move(values[index]);
      continue;
    }
    out.samples.channels.push_back({.name = columns[index].name,
                                    .unit = columns[index].si_unit,
                                    .noise_std = 0.0,
                                    .values = std::move(values[index])});
    out.columns.push_back(std::move(columns[index]));
  }
  return out;
}

}  // namespace sealwatch
