#include "sealwatch/model/plant_description.hpp"

#include <algorithm>
#include <mutex>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/model/plant_tables.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace {

template <class Row>
const Row* find_row(const std::vector<Row>& rows, std::string_view name) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& candidate) { return candidate.name == name; });
  return row == rows.end() ? nullptr : &*row;
}

}  // namespace

const ChannelDescription* PlantDescription::find_channel(std::string_view channel) const {
  return find_row(channels, channel);
}

const ParameterDescription* PlantDescription::find_parameter(std::string_view parameter) const {
  return find_row(parameters, parameter);
}

const ParameterDescription* PlantDescription::find_parameter(ParameterRole role) const {
  const auto parameter = std::ranges::find(parameters, role, &ParameterDescription::role);
  return parameter == parameters.end() ? nullptr : &*parameter;
}

const StateDescription* PlantDescription::find_state(std::string_view state) const { return find_row(states, state); }

const ChannelDescription* PlantDescription::find_channel(ChannelRole role) const {
  const auto channel = std::ranges::find(channels, role, &ChannelDescription::role);
  return channel == channels.end() ? nullptr : &*channel;
}

std::string channel_name(const PlantDescription& plant, ChannelRole role) {
  const ChannelDescription* channel = plant.find_channel(role);
  return channel == nullptr ? std::string() : channel->name;
}

const Series* find_series(const TimeSeries& recorded, const PlantDescription& plant, ChannelRole role) {
  const ChannelDescription* channel = plant.find_channel(role);
  return channel == nullptr ? nullptr : recorded.find(channel->name);
}

const PlantDescription& plant_or_default(std::string_view name) {
  const auto plant = find_plant(name);
  return plant ? **plant : **find_plant(AssetConfig().model);
}

std::deque<PlantDescription>& known_plants() {
  static FreeInCopies mutex;
  const std::scoped_lock lock(mutex);  // a copy would wait for who makes them
  static std::deque<PlantDescription> plants = [] {
    std::deque<PlantDescription> native;
    for (const NativePlant& plant : native_plants()) native.push_back(plant.description);
    return native;
  }();
  return plants;
}

const std::deque<PlantDescription>& all_plants() { return known_plants(); }

Result<const PlantDescription*> find_plant(std::string_view name) {
  std::vector<std::string> names;
  for (const PlantDescription& plant : all_plants()) {
    if (plant.name == name) return &plant;
    names.push_back(plant.name);
  }
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(name),
                    .rule = "is not a known model",
                    .advice = suggest(name, names)});
}

}  // namespace sealwatch
