// The table of plant `cascaded_tanks`. There is no datasheet: the defaults are of the size that tanks have which empty
// within a minute or two.
#include "sealwatch/model/cascaded_tanks.hpp"
#include "services/common/model/plant_tables.hpp"

namespace sealwatch {
namespace {

std::vector<ChannelDescription> channels() {
  return {
      {.name = "pump_voltage",
       .unit = "V",
       .meaning = "voltage of the pump that fills the upper tank",
       .input = true,
       .range_min = 0.0,
       .range_max = 10.0,
       .hold = true},
      {.name = "level_voltage",
       .unit = "V",
       .meaning = "level of the lower tank in volts of its sensor",
       .noise_std = 0.02,  // third differences of the published recording
       .range_min = 0.0,
       .range_max = 10.0},
  };
}

std::vector<ParameterDescription> parameters() {
  return {
      scale_parameter("k4", "1/s", 0.05, "rise of the upper level per pump voltage", true),
      scale_parameter("k1", "V^0.5/s", 0.05, "outlet of the upper tank", true),
      scale_parameter("k3", "V^0.5/s", 0.05, "outlet of the lower tank", true),
      scale_parameter(
          "area_ratio", "1", 1.0,
          "bottom area of the upper tank over that of the lower; the scale of the level that nobody measures"),
  };
}

std::vector<ElementDescription> elements() {
  return {
      {"pump", "flow into the upper tank from the pump's voltage"},  {"upper_tank", "volume balance of the upper tank"},
      {"upper_outlet", "flow from the upper to the lower tank"},     {"lower_tank", "volume balance of the lower tank"},
      {"lower_outlet", "flow from the lower tank to the reservoir"},
  };
}

}  // namespace

PlantDescription describe_cascaded_tanks() {
  PlantDescription plant{
      .name = "cascaded_tanks",
      .meaning = "two tanks with free outlets, one above the other, filled by a pump",
      .channels = channels(),
      .parameters = parameters(),
      .states = {{"level_upper", "V", "level of the upper tank"}, {"level_lower", "V", "level of the lower tank"}},
      .elements = elements(),
      .sites = {CascadedTanks::kSites.begin(), CascadedTanks::kSites.end()},
      .law_sizes = {{"V", 1.0}, {"V/s", 1.0}, {"1/s", 1.0}, {"V^0.5/s", 1.0}}};
  add_sensor_elements(plant);
  return plant;
}

}  // namespace sealwatch
