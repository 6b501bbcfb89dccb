#include "services/common/recording/columns.hpp"

#include <algorithm>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kLongestPrinted = 60;

struct NameAndUnit {
  std::string_view name;
  std::string_view unit;
};

/// "force[1].u" and "y[2]" are names, as simulators have them; "1" is the unit of a plain number.
NameAndUnit split_cell(std::string_view cell) {
  const std::size_t open = cell.find('[');
  const NameAndUnit whole{.name = cell, .unit = {}};
  if (open == std::string_view::npos || cell.back() != ']') return whole;
  const std::string_view unit = cell.substr(open + 1, cell.size() - open - 2);
  const bool index = !unit.empty() && unit != "1" && unit.find_first_not_of("0123456789,") == std::string_view::npos;
  return index ? whole : NameAndUnit{.name = cell.substr(0, open), .unit = unit};
}

/// SI unit of a channel, "" when the plant has no such channel.
std::string_view si_unit_of(std::string_view name, const PlantDescription& plant) {
  if (name == "time") return "s";
  for (const ChannelDescription& channel : plant.channels)
    if (channel.name == name) return channel.unit.empty() ? std::string_view("1") : std::string_view(channel.unit);
  return {};
}

/// The known name that was probably meant; "" when none is near.
std::string nearest_channel(std::string_view name, const PlantDescription& plant) {
  std::vector<std::string> names{"time"};
  for (const ChannelDescription& channel : plant.channels) names.push_back(channel.name);
  return nearest(name.substr(0, kLongestPrinted), names);
}

}  // namespace

bool is_utf8(std::string_view text) { return is_valid_utf8(text); }

std::string printable(std::string_view text) {
  std::size_t length = std::min(text.size(), kLongestPrinted);
  const auto goes_on = [&](std::size_t at) { return at < text.size() && (text[at] & 0xc0) == 0x80; };
  while (length > 0 && goes_on(length)) --length;  // no letter is cut
  std::string out(text.substr(0, length));
  if (is_visible(out)) return text.size() > length ? out + "..." : out;
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
    return fail(error_at({}, cell, "is not a channel of plant " + plant.name,
                         "cells are separated by commas; for a log in a layout of its own: sealwatch asset new --from "
                         "LOG (docs/logs.md)"));
  const auto [name, unit] = split_cell(cell);
  if (const auto open = cell.find('['); open != std::string_view::npos && name == cell && cell.back() != ']' &&
                                        !si_unit_of(cell.substr(0, open), plant).empty())
    return fail(error_at({}, cell, "a header cell must read channel[unit]"));
  if (name.empty()) return fail(error_at({}, cell, "a header cell must name its channel"));
  const std::string_view si_unit = si_unit_of(name, plant);
  if (si_unit.empty()) {
    if (const std::string meant = nearest_channel(name, plant); !meant.empty())
      return fail(
          error_at({}, cell, "is not a channel of plant " + plant.name,
                   "did you mean '" + meant + "'? Then name it so, or with a map (docs/logs.md); else take it out"));
    return Column{.name = printable(cell), .si_unit = {}, .to_si = {}, .known = false};
  }
  Result<UnitConversion> conversion = convert_unit(unit, si_unit);
  if (!conversion) {
    Error error =
        error_at({}, cell, "unit '" + printable(unit) + "' " + conversion.error().rule, conversion.error().advice);
    return fail(std::move(error));
  }
  return Column{.name = std::string(name), .si_unit = std::string(si_unit), .to_si = *conversion};
}

Result<std::vector<Column>> find_columns(std::span<const std::string_view> cells, const PlantDescription& plant) {
  std::vector<Column> columns;
  const auto recorded = [&columns](std::string_view name) {
    return std::any_of(columns.begin(), columns.end(),
                       [name](const Column& column) { return column.known && column.name == name; });
  };
  for (std::size_t index = 0; index < cells.size(); ++index) {
    Result<Column> column = find_column(cells[index], plant);
    if (column && column->known && recorded(column->name))
      column = fail(error_at({}, cells[index], "is recorded twice"));
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
    if (!columns[index].known) {
      out.left_aside.push_back(std::move(columns[index].name));
      continue;
    }
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
