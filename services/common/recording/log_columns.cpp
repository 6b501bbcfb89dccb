#include "services/common/recording/log_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <set>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/log_layout.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch {
namespace {

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Error of_channel(const std::string& channel, const std::string& value, const Error& why) {
  return error_at("channel " + channel, value, why.rule, why.advice);
}

/// si = to_si(scale number + offset).
Result<Column> mapped(const std::string& channel, const std::string& si_unit, const std::string& unit,
                      const ColumnMapping& mapping) {
  const Result<UnitConversion> conversion = convert_unit(unit, si_unit);
  if (!conversion) return fail(of_channel(channel, unit, conversion.error()));
  return Column{.name = channel,
                .si_unit = si_unit,
                .to_si = {.scale = conversion->scale * mapping.scale,
                          .offset = conversion->scale * mapping.offset + conversion->offset,
                          .si_unit = {}}};
}

bool is_same(const UnitConversion& a, const UnitConversion& b) {
  constexpr double kClose = 1e-6;  // of two spellings, each with digits of its own
  return std::abs(a.scale - b.scale) <= kClose * std::abs(a.scale) &&
         std::abs(a.offset - b.offset) <= kClose * std::max(std::abs(a.offset), std::abs(a.scale));
}

/// Whether what stands behind a column's name without square brackets may go on with it: chamber "(A)", "(rod)", which
/// is a length, or a minimum.
bool may_be_a_name(std::string_view text, std::string_view said) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  if (trim(text).ends_with(']') || !std::ranges::all_of(said, is_letter)) return false;
  return said.size() == 1 || said == "min" || !find_unit(said);
}

class Mapper {
 public:
  Mapper(const std::vector<OfferedColumn>& offered, const PlantDescription& plant, const ChannelMap& map)
      : offered_(offered), plant_(plant), map_(map) {}

  Result<MappedColumns> run() {
    for (const auto& [channel, mapping] : map_.columns)
      if (const Status named = take_named(channel, mapping); !named) return fail(named.error());
    for (std::size_t index = 0; index < offered_.size(); ++index)
      if (const Status own = take_own_name(index); !own) return fail(own.error());
    if (!taken_.contains("time"))
      return fail(error_at("channel time", {}, "is missing and required", "name its column under channels: time"));
    for (std::size_t index = 0; index < offered_.size(); ++index)
      if (!used_.contains(index) && !offered_[index].text.empty()) out_.left_aside.push_back(offered_[index].text);
    std::ranges::sort(out_.columns, {}, &MappedColumn::index);  // in the order of the file
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string si_unit_of(const std::string& channel) const {
    const auto known = std::ranges::find(plant_.channels, channel, &ChannelDescription::name);
    return known == plant_.channels.end() || known->unit.empty() ? "1" : known->unit;
  }

  /// Of "Date + Time + ms" the column of the time; that of the day before it and that of the fraction behind it are
  /// noted. A last part in a unit of time is added, any other is read with the part before it.
  Result<std::size_t> find_time(std::string_view wanted) {
    std::vector<std::size_t> parts;
    for (bool more = true; more;) {
      const std::size_t plus = wanted.find(kDayAndTime);
      const Result<std::size_t> part = find_offered(offered_, std::string(wanted.substr(0, plus)));
      if (!part) return fail(part.error());
      if (std::ranges::find(parts, *part) != parts.end()) return fail("is one column twice", "give its name once");
      parts.push_back(*part);
      more = plus != std::string_view::npos;
      if (more) wanted.remove_prefix(plus + kDayAndTime.size());
    }
    used_.insert(parts.begin(), parts.end());
    if (const auto fraction = seconds_of_one(offered_[parts.back()])) {
      out_.fraction = parts.back(), out_.fraction_to_s = *fraction;
      parts.pop_back();
    }
    if (parts.size() > 2) return fail("is more than a day, a time and its fraction", "name up to three columns");
    if (parts.size() == 2) out_.day = parts.front();
    return parts.back();
  }

  /// The column that a mapping means.
  Result<std::size_t> find_named(const std::string& channel, const ColumnMapping& mapping) {
    Result<std::size_t> index = find_offered(offered_, mapping.column);
    if (index || channel != "time") return index;
    if (mapping.column.find(kDayAndTime) != std::string::npos) return find_time(mapping.column);
    if (mapping.column != kCountOfRows) return index;
    if (!mapping.is_scaled && mapping.scale == 1.0)
      return fail("counts the rows, which needs the time between two", "{column: row, unit: s, scale: SECONDS}");
    return kNoColumn;
  }

  Status take_named(const std::string& channel, const ColumnMapping& mapping) {
    const Result<std::size_t> index = find_named(channel, mapping);
    if (!index) return fail(of_channel(channel, mapping.column, index.error()));
    if (*index == kNoColumn) return take(channel, *index, mapping.unit, mapping);
    const auto same = std::ranges::find(out_.columns, *index, &MappedColumn::index);
    if (same != out_.columns.end())
      return fail(error_at("channel " + channel, mapping.column,
                           "is the column of channel " + same->column.name + " too",
                           "give each channel a column of its own"));
    if (Status units = compare_units(channel, offered_[*index], mapping); !units) return units;
    return take(channel, *index, unit_for(channel, offered_[*index], mapping), mapping);
  }

  /// The map's unit against the log's. With a scale or an offset the map's is that of what they make of the numbers.
  Status compare_units(const std::string& channel, const OfferedColumn& column, const ColumnMapping& mapping) {
    if (mapping.unit.empty() || mapping.is_scaled || mapping.scale != 1.0 || mapping.offset != 0.0) return {};
    const std::string si_unit = channel == "time" ? "s" : si_unit_of(channel);
    const Result<UnitConversion> wanted = convert_unit(mapping.unit, si_unit);
    if (!wanted) return {};  // a clock, or refused where it is converted
    std::set<std::string> all = {column.unit, split_header_cell(column.text).unit};
    if (unit_of(column).empty() && column.text != channel) all.insert(unit_at_the_end(column.text, si_unit));
    for (const std::string& said : all) {
      if (said.empty() || said == "1") continue;  // which stands for no unit as well
      const Result<UnitConversion> own = convert_unit(said, si_unit);
      const bool doubtful = said != column.unit && may_be_a_name(column.text, said);
      if (!own && is_unit(said) && !doubtful)
        return fail(error_at("channel " + channel, column.text,
                             "is in " + printable(said) + " by the log and in " + mapping.unit +
                                 " by the map, which is another quantity",
                             "correct the unit in the map; with a scale it is the unit of the scaled number"));
      if (own && !is_same(*own, *wanted) && !(doubtful && said.size() > 1))
        out_.warnings.push_back("column '" + printable(column.text) + "', channel " + channel + ": the log's unit is " +
                                printable(said) + " and the map's " + mapping.unit +
                                ": the map is followed; correct it where the log is right");
    }
    return {};
  }

  /// A channel's own name is no unit, whatever it ends in.
  [[nodiscard]] std::string unit_for(const std::string& channel, const OfferedColumn& column,
                                     const ColumnMapping& mapping) const {
    if (!mapping.unit.empty()) return mapping.unit;
    std::string said = unit_of(column);
    if (!said.empty() || column.text == channel) return said;
    return unit_at_the_end(column.text, channel == "time" ? "s" : si_unit_of(channel));
  }

  Status take_own_name(std::size_t index) {
    const NameAndUnitText cell = split_header_cell(offered_[index].text);
    const bool known = cell.name == "time" || std::ranges::find(plant_.channels, cell.name,
                                                                &ChannelDescription::name) != plant_.channels.end();
    if (!known || map_.columns.contains(cell.name) || used_.contains(index)) return {};
    if (taken_.contains(cell.name))
      return fail(error_at("channel " + cell.name, offered_[index].text, "is recorded twice"));
    return take(cell.name, index, unit_of(offered_[index]), {});
  }

  Status take(const std::string& channel, std::size_t index, const std::string& unit, const ColumnMapping& mapping) {
    Result<Column> column =
        Column{.name = channel, .si_unit = "s", .to_si = {.scale = 1.0, .offset = 0.0, .si_unit = {}}};
    if (channel == "time")
      out_.time_unit = unit, out_.time_scale = mapping.scale, out_.time_offset = mapping.offset;
    else
      column = mapped(channel, si_unit_of(channel), unit, mapping);
    if (!column) return fail(column.error());
    out_.columns.push_back({index, std::move(*column)});
    used_.insert(index);
    taken_.insert(channel);
    return {};
  }

  const std::vector<OfferedColumn>& offered_;
  const PlantDescription& plant_;
  const ChannelMap& map_;
  MappedColumns out_;
  std::set<std::size_t> used_;
  std::set<std::string> taken_;
};

}  // namespace

std::string place_name(std::size_t index) { return "column " + std::to_string(index + 1); }

std::string unit_of(const OfferedColumn& column) {
  return column.unit.empty() ? split_header_cell(column.text).unit : column.unit;
}

namespace {

/// "V" of "U/V" and "m/s" of "v/(m/s)"; a flow or a speed, "l/min", is a unit itself and has none behind its slash.
std::string_view unit_behind_a_slash(std::string_view text, const std::string& si_unit) {
  for (const char* rate : {"m/s", "rad/s", "m3/s"})
    if (text.find(' ') == std::string_view::npos && convert_unit(text, rate)) return {};
  for (std::size_t at = text.find('/'); at != std::string_view::npos; at = text.find('/', at + 1)) {
    std::string_view unit = trim(text.substr(at + 1));
    if (unit.starts_with('(') && unit.ends_with(')')) unit = trim(unit.substr(1, unit.size() - 2));
    if (at > 0 && !unit.empty() && convert_unit(unit, si_unit)) return unit;
  }
  return {};
}

/// "V" of "Drive (V) (raw)" and "Drive[V]{1}": the last in brackets; "ms" of "Zeit (ms seit Start)", where words
/// follow.
std::string_view unit_in_brackets(std::string_view text, const std::string& si_unit) {
  for (std::size_t open = text.find_last_of("[("); open != std::string_view::npos && open > 0;
       open = text.find_last_of("[(", open - 1)) {
    const std::size_t close = text.find(text[open] == '[' ? ']' : ')', open);
    if (close == std::string_view::npos) continue;
    const std::string_view unit = trim(text.substr(open + 1, close - open - 1));
    for (const std::string_view said : {unit, unit.substr(0, unit.find_first_of(" ,;"))})
      if (!said.empty() && convert_unit(said, si_unit)) return said;
  }
  return {};
}

}  // namespace

std::string unit_at_the_end(std::string_view text, const std::string& si_unit) {
  const std::size_t begin = text.find_last_of(" _");
  const std::string_view last = begin == std::string_view::npos ? std::string_view() : text.substr(begin + 1);
  const bool plain = si_unit.empty() || si_unit == "1",
             number = last == "%" || last == "pct" || last == "counts" || last == "count";
  const bool fits = number || (!plain && last.size() > 1 && convert_unit(last, si_unit).has_value());
  if (fits || plain) return std::string(fits ? last : std::string_view());
  const std::string_view behind = unit_behind_a_slash(text, si_unit);
  return std::string(behind.empty() ? unit_in_brackets(text, si_unit) : behind);
}

std::optional<double> seconds_of_one(const OfferedColumn& column) {
  for (const std::string& said : {unit_of(column), unit_at_the_end(column.text, "s"), column.text})
    if (!said.empty())
      if (const Result<UnitConversion> unit = convert_unit(said, "s")) return unit->scale;
  return std::nullopt;
}

Result<std::size_t> find_offered(const std::vector<OfferedColumn>& offered, const std::string& wanted) {
  const auto matches = [&](const std::function<bool(const OfferedColumn&)>& same) {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < offered.size(); ++k)
      if (same(offered[k])) found.push_back(k);
    return found;
  };
  const std::string small = lower(wanted);
  const std::function<bool(const OfferedColumn&)> ways[] = {
      [&](const OfferedColumn& column) { return column.text == wanted; },
      [&](const OfferedColumn& column) { return split_header_cell(column.text).name == wanted; },
      [&](const OfferedColumn& column) { return lower(column.text) == small; },
      [&](const OfferedColumn& column) { return lower(split_header_cell(column.text).name) == small; }};
  for (const auto& way : ways) {
    const std::vector<std::size_t> found = matches(way);
    if (found.size() == 1) return found.front();
    if (found.size() > 1)
      return fail("stands over columns " + std::to_string(found[0] + 1) + " and " + std::to_string(found[1] + 1),
                  "give the whole header cell, or its place: column " + std::to_string(found[0] + 1));
  }
  for (std::size_t k = 0; k < offered.size(); ++k)
    if (small == place_name(k)) return k;
  std::vector<std::string> texts;
  for (const OfferedColumn& column : offered)
    if (!column.text.empty()) texts.push_back(column.text);
  return fail("is not a column of this log", suggest(wanted, texts));
}

Result<TimeFormat> time_format(const MappedColumns& mapped) {
  Result<TimeFormat> format = TimeFormat::of(mapped.time_unit);
  if (!format)
    return fail(error_at("channel time", mapped.time_unit, format.error().rule,
                         "of a count of samples: {unit: s, scale: SECONDS_BETWEEN_SAMPLES}"));
  if (const Status scaled = format->scale_by(mapped.time_scale, mapped.time_offset); !scaled)
    return fail(error_at("channel time", mapped.time_unit, scaled.error().rule, scaled.error().advice));
  return format;
}

Result<MappedColumns> map_columns(const std::vector<OfferedColumn>& offered, const PlantDescription& plant,
                                  const ChannelMap& map) {
  return Mapper(offered, plant, map).run();
}

}  // namespace sealwatch
