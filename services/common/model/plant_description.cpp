#include "sealwatch/model/plant_description.hpp"

#include <algorithm>

#include "sealwatch/core/text.hpp"
#include "services/common/model/plant_tables.hpp"

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

const StateDescription* PlantDescription::find_state(std::string_view state) const { return find_row(states, state); }

double PlantDescription::law_size(std::string_view unit) const {
  const auto size = std::ranges::find(law_sizes, unit, &LawSize::unit);
  return size == law_sizes.end() ? 1.0 : size->factor;
}

std::deque<PlantDescription>& known_plants() {
  static std::deque<PlantDescription> plants = {describe_eha(), describe_eha_switched(), describe_emps(),
                                                describe_cascaded_tanks()};
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
