// The tables of the single plants and the shorthand in which they are written.
#pragma once

#include <string>
#include <utility>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

/// The tables of all plants, to which one's own are added.
[[nodiscard]] std::deque<PlantDescription>& known_plants();

/// Of a plant that is as large as `eha`, for which laws are written.
[[nodiscard]] std::vector<LawSize> reference_sizes();

/// A positive parameter without published bounds: a tenth to ten times its default.
[[nodiscard]] inline ParameterDescription scale_parameter(std::string name, std::string unit, double value,
                                                          std::string meaning, bool estimate = false) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .value = value,
          .min = value / 10.0,
          .max = value * 10.0,
          .meaning = std::move(meaning),
          .positive = true,
          .estimate = estimate};
}

/// A parameter with bounds of its own.
[[nodiscard]] inline ParameterDescription bounded_parameter(std::string name, std::string unit, double value,
                                                            double min, double max, std::string meaning,
                                                            bool estimate = false) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .value = value,
          .min = min,
          .max = max,
          .meaning = std::move(meaning),
          .positive = min > 0.0,
          .estimate = estimate};
}

inline void set_role(PlantDescription& plant, std::string_view parameter, ParameterRole role) {
  for (ParameterDescription& row : plant.parameters)
    if (row.name == parameter) row.role = role;
}

/// Adds "sensor:<channel>" for each measured channel.
inline void add_sensor_elements(PlantDescription& plant) {
  for (const ChannelDescription& channel : plant.channels)
    if (!channel.input) plant.elements.push_back({"sensor:" + channel.name, "measurement of " + channel.meaning});
}

}  // namespace sealwatch
