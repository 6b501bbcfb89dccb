#include "services/data_manipulation/asset_view.hpp"

namespace sealwatch {

std::optional<double> AssetView::parameter(ParameterRole role) const {
  const ParameterDescription* described = this->described().find_parameter(role);
  if (described == nullptr) return std::nullopt;
  if (asset) {
    const auto found = asset->parameters.find(described->name);
    if (found != asset->parameters.end()) return found->second.value;
  }
  return plant ? std::optional(described->value) : std::nullopt;
}

/// Plants give the area on the side that pushes down, or its ratio to the other; equal by default.
signal::Cylinder AssetView::cylinder() const {
  signal::Cylinder cylinder;
  cylinder.area_a_m2 = parameter(ParameterRole::area_up);
  cylinder.area_ratio = parameter(ParameterRole::area_ratio).value_or(1.0);
  if (const auto area_down = parameter(ParameterRole::area_down); area_down && cylinder.area_a_m2)
    cylinder.area_ratio = *area_down / *cylinder.area_a_m2;
  cylinder.dead_volume_m3 = parameter(ParameterRole::dead_volume);
  cylinder.bulk_modulus_Pa = parameter(ParameterRole::bulk_modulus);
  cylinder.displacement_m3_rad = parameter(ParameterRole::displacement);
  cylinder.stroke_m = parameter(ParameterRole::stroke).value_or(0.0);
  return cylinder;
}

double AssetView::time_constant_s(const std::string& channel) const {
  if (asset) {
    const auto found = asset->sensors.find(channel);
    if (found != asset->sensors.end()) return found->second.time_constant_s;
  }
  const ChannelDescription* described = plant ? plant->find_channel(channel) : nullptr;
  return described ? described->time_constant_s : 0.0;
}

double AssetView::noise_std(const std::string& channel) const {
  if (asset) {
    const auto found = asset->sensors.find(channel);
    if (found != asset->sensors.end() && found->second.noise_std > 0.0) return found->second.noise_std;
  }
  const ChannelDescription* described = plant ? plant->find_channel(channel) : nullptr;
  return described ? described->noise_std : 0.0;
}

bool AssetView::is_input(const std::string& channel) const {
  const ChannelDescription* described = plant ? plant->find_channel(channel) : nullptr;
  return described && described->input;
}

}  // namespace sealwatch
