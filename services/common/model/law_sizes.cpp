#include "sealwatch/model/law_sizes.hpp"

#include <algorithm>

#include "services/common/model/laws/power_law.hpp"
#include "services/common/model/plant_tables.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

// A sensor's and a recording's laws go by their channel; some laws of a site are never asked, as they see nothing there.
const LawSize* find_size(const PlantDescription& plant, std::string_view unit) {
  const auto size = std::ranges::find(plant.law_sizes, unit, &LawSize::unit);
  return size == plant.law_sizes.end() ? nullptr : &*size;
}

double size_of(const PlantDescription& plant, std::string_view unit) {
  const LawSize* const size = find_size(plant, unit);
  return size == nullptr ? 1.0 : size->factor;
}

bool is_of_a_file(const PlantDescription& plant) { return !plant.file.empty(); }

}  // namespace

double law_size(const PlantDescription& plant, const LawParameter& parameter) {
  return parameter.own_size ? 1.0 : size_of(plant, parameter.unit);
}

LawBounds law_bounds(const PlantDescription& plant, const LawParameter& parameter) {
  // Whoever describes a plant gives sizes by order of magnitude: a strength that ends at a bound made of them would leave
  // the rest of what it does to laws that are not there. What has no unit (a gain, a share, a clock's rate) has the same
  // bounds everywhere.
  constexpr double kRoom = 100.0;
  const bool guessed =
      parameter.strength && !parameter.own_size && is_of_a_file(plant) && find_size(plant, parameter.unit) != nullptr;
  const double size = law_size(plant, parameter) * (guessed ? kRoom : 1.0);
  const double least = parameter.place && is_of_a_file(plant) ? -parameter.max : parameter.min;
  return {size * least, size * parameter.max};
}

double law_start(const PlantDescription& plant, const LawParameter& parameter, std::size_t which) {
  const LawBounds bounds = law_bounds(plant, parameter);
  return std::clamp(law_size(plant, parameter) * parameter.start[which], bounds.min, bounds.max);
}

double significant_size(const PlantDescription& plant, const LawParameter& strength) {
  return law_size(plant, strength) * strength.significant;
}

Roundings roundings_of(const PlantDescription& plant, const Law& law) {
  Roundings widths{};
  for (std::size_t k = 0; k < law.roundings.size(); ++k)
    widths[k] = size_of(plant, law.roundings[k].unit) * law.roundings[k].width;
  return widths;
}

std::string in_sizes_of(const PlantDescription& plant, const Law& law, std::string_view text) {
  std::string words(text);
  for (const LawRounding& rounding : law.roundings) {
    const double factor = size_of(plant, rounding.unit);
    const std::size_t at = rounding.reference.empty() ? std::string::npos : words.find(rounding.reference);
    if (factor == 1.0 || at == std::string::npos) continue;
    const double reference = factor * rounding.width / laws::kCorner;
    words.replace(at, rounding.reference.size(), text::general(reference) + " " + std::string(rounding.unit));
  }
  return words;
}

std::vector<LawSize> reference_sizes() {
  std::vector<LawSize> sizes;
  for (const Law& law : all_laws())
    for (const LawParameter& parameter : law.parameters)
      if (law.plant.empty() && std::ranges::find(sizes, parameter.unit, &LawSize::unit) == sizes.end())
        sizes.push_back({parameter.unit, 1.0});
  return sizes;
}

Roundings roundings_of(const Law& law) { return roundings_of(PlantDescription{}, law); }

std::string missing_law_sizes(const PlantDescription& plant) {
  std::vector<std::string_view> units;
  for (const Site& site : plant.sites)
    for (const Law& law : all_laws())
      for (const LawParameter& parameter : law.parameters)
        if (law.plant.empty() && fits(law, site) && parameter.unit != "1") units.push_back(parameter.unit);
  std::string missing;
  for (auto unit = units.begin(); unit != units.end(); ++unit)
    if (std::find(units.begin(), unit, *unit) == unit &&
        std::ranges::find(plant.law_sizes, *unit, &LawSize::unit) == plant.law_sizes.end())
      text::add_to_list(missing, *unit);
  return missing;
}

}  // namespace sealwatch
