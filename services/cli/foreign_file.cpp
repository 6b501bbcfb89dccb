#include "services/cli/foreign_file.hpp"

#include <algorithm>
#include <set>

#include "sealwatch/model/plant_description.hpp"
#include "services/cli/log_offer.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/log_layout.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::cli {
namespace {

/// The SI unit that a unit belongs to; the unit itself where it is none that is known.
std::string si_of(const std::string& unit) {
  if (unit.empty()) return "1";
  for (const char* si : {"1", "Pa", "m", "m/s", "m3/s", "rad/s", "rad", "N", "V", "A", "K", "s", "N m", "m/s2",
                         "rad/s2", "kg", "kg/s", "W", "m3"})
    if (convert_unit(unit, si)) return si;
  return unit;
}

/// All columns of numbers as the channels of a plant that nobody described.
PlantDescription plant_of(const Offer& offer, const ChannelMap& map) {
  PlantDescription plant;
  plant.name = "of this file";
  const auto add = [&plant](const std::string& name, const std::string& unit) {
    ChannelDescription channel;
    channel.name = name, channel.unit = si_of(unit);
    plant.channels.push_back(std::move(channel));
  };
  std::set<std::string> renamed;
  for (const auto& [channel, mapping] : map.columns) {
    const Result<std::size_t> index = find_offered(offer.columns, mapping.column);
    if (!index) continue;  // the reader says so
    const OfferedColumn& column = offer.columns[*index];
    renamed.insert(column.text);
    const std::string beside = column.unit.empty() ? split_header_cell(column.text).unit : column.unit;
    if (channel != "time") add(channel, mapping.unit.empty() ? beside : mapping.unit);
  }
  for (std::size_t k = 0; k < offer.columns.size(); ++k) {
    const NameAndUnitText cell = split_header_cell(offer.columns[k].text);
    if (renamed.contains(offer.columns[k].text) || cell.name.empty() || cell.name == "time") continue;
    if (has_numbers(offer, k)) add(cell.name, offer.columns[k].unit.empty() ? cell.unit : offer.columns[k].unit);
  }
  return plant;
}

Result<Recording> read_offered(const std::string& file, const Offer& offer, ChannelMap map) {
  const auto is_time = [](const OfferedColumn& column) { return split_header_cell(column.text).name == "time"; };
  if (!map.columns.contains("time") && std::ranges::none_of(offer.columns, is_time))
    map.columns["time"] = guess_time(offer);
  return read_recording(file, plant_of(offer, map), map);
}

/// Whether the time's first cell is what the map says: a pattern of dates does not fit a count of seconds.
bool fits_time(const Offer& offer, std::size_t column, const ColumnMapping& mapping) {
  Result<TimeFormat> format = TimeFormat::of(mapping.unit.empty() ? "s" : mapping.unit);
  const std::vector<std::string>& cells = offer.cells[column];
  return format && (cells.empty() || format->seconds(cells.front(), offer.layout.decimal));
}

/// Whether the file has what a row of a map of another file tells of.
bool fits(const Offer& offer, const std::string& channel, const ColumnMapping& mapping) {
  if (channel != "time") return find_offered(offer.columns, mapping.column).has_value();
  if (mapping.column == kCountOfRows) return !has_time(offer);
  std::string_view rest = mapping.column;
  const bool whole = rest.find(kDayAndTime) == std::string_view::npos;
  for (std::size_t plus = 0; plus != std::string_view::npos;) {
    plus = rest.find(kDayAndTime);
    const Result<std::size_t> part = find_offered(offer.columns, std::string(rest.substr(0, plus)));
    if (!part || (whole && offer.text && !fits_time(offer, *part, mapping))) return false;
    if (plus != std::string_view::npos) rest.remove_prefix(plus + kDayAndTime.size());
  }
  return true;
}

}  // namespace

Result<Recording> read_any_channels(const std::string& file, const ChannelMap& given) {
  ChannelMap map = given;
  Result<Offer> offer = offer_of(file, map.log);
  const auto is_absent = [&](const auto& entry) { return !find_offered(offer->columns, entry.second.column); };
  if (!map.columns.empty() && (!offer || std::ranges::all_of(map.columns, is_absent)))
    if (Result<Offer> without = offer_of(file, {})) {  // a map of the other file
      map = {};
      offer = std::move(without);
    }
  if (!offer) return fail(offer.error());
  return read_offered(file, *offer, std::move(map));
}

Result<Recording> read_simulated_channels(const std::string& file, const ChannelMap& of_recording) {
  ChannelMap map = of_recording;
  Result<Offer> offer = offer_of(file, map.log);
  const auto is_foreign = [&](const auto& entry) { return !fits(*offer, entry.first, entry.second); };
  if (!offer || std::ranges::any_of(map.columns, is_foreign))
    if (Result<Offer> without = offer_of(file, {})) {  // laid out by another tool
      map.log = {};
      offer = std::move(without);
    }
  if (!offer) return fail(offer.error());
  std::erase_if(map.columns, is_foreign);
  return read_offered(file, *offer, std::move(map));
}

}  // namespace sealwatch::cli
