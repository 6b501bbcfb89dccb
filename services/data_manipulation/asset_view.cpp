#include "services/data_manipulation/asset_view.hpp"

namespace sealwatch {

std::optional<double> AssetView::parameter(const std::string& name) const {
  if (asset) {
    const auto found = asset->parameters.find(name);
    if (found != asset->parameters.end()) return found->second.value;
  }
  const ParameterDescription* described = plant ? plant->find_parameter(name) : nullptr;
  return described ? std::optional(described->value) : std::nullopt;
}

/// Plants name the piston's areas A_C and area_ratio (equal areas by default), or A_A and A_B.
signal::Cylinder AssetView::cylinder() const {
  signal::Cylinder cylinder;
  cylinder.area_a_m2 = parameter("A_C");
  cylinder.area_ratio = parameter("area_ratio").value_or(1.0);
  if (const auto area_a = parameter("A_A")) {
    cylinder.area_a_m2 = area_a;
    cylinder.area_ratio = parameter("A_B").value_or(*area_a) / *area_a;
  }
  cylinder.dead_volume_m3 = parameter("V_0");
  cylinder.bulk_modulus_Pa = parameter("beta");
  cylinder.displacement_m3_rad = parameter("alpha_P");
  cylinder.stroke_m = parameter("x_C").value_or(0.0);
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
