#include "sealwatch/model/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <mutex>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/common/model/plant_tables.hpp"
#include "services/common/model/simulation_plants.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kInitialPrefix = "initial:";
constexpr std::string_view kLoadFactor = "load_factor";

Status check_recording(const PlantDescription& plant, const TimeSeries& recorded) {
  if (recorded.time_s.size() < 2) return fail("a simulation needs at least two recorded samples");
  bool output = false;
  for (const ChannelDescription& channel : plant.channels)
    output = output || (!channel.input && recorded.has(channel.name));
  if (!output) return fail("the recording has no channel that " + plant.name + " simulates");
  return {};
}

std::deque<PlantSimulator>& plant_simulators() {
  static FreeInCopies mutex;
  const std::scoped_lock lock(mutex);  // a copy would wait for who makes them
  static std::deque<PlantSimulator> simulators = [] {
    std::deque<PlantSimulator> native;
    for (const NativePlant& plant : native_plants()) native.push_back(plant.simulator);
    return native;
  }();
  return simulators;
}

bool has_all(const TimeSeries& recorded, const std::vector<std::string>& channels) {
  return std::ranges::all_of(channels, [&](const std::string& name) { return recorded.has(name); });
}

/// The first whose inputs are recorded; nullptr: none.
const AlternativeSimulator* that_is_driven(const PlantSimulator& simulator, const TimeSeries& recorded) {
  const auto found = std::ranges::find_if(
      simulator.alternatives, [&](const AlternativeSimulator& of) { return has_all(recorded, of.part.inputs); });
  return found == simulator.alternatives.end() ? nullptr : &*found;
}

/// A part of the plant knows nothing of the rest and of its laws.
AssetConfig of_part(AssetConfig asset, const PlantDescription& plant, const std::vector<Site>& sites) {
  std::erase_if(asset.physics, [&](const PhysicsTerm& term) {
    const auto at_element = [&term](const Site& site) { return site.element == term.element; };
    return std::ranges::any_of(plant.sites, at_element) && std::ranges::none_of(sites, at_element);
  });
  return asset;
}

Error without_input(const PlantDescription& plant, const PlantSimulator& simulator, const TimeSeries& recorded) {
  const auto missing = std::ranges::find_if(simulator.inputs, [&](const auto& name) { return !recorded.has(name); });
  std::string advice = "record it";
  for (const AlternativeSimulator& other : simulator.alternatives)
    if (const auto& inputs = other.part.inputs; inputs.size() == 1)
      advice.append(", or the ").append(plant.find_channel(inputs.front())->meaning);
  if (!plant.file.empty())
    advice.append(", or take it out of the inputs in ").append(plant.file).append(": an FMU then keeps its own value");
  return {.file = {},
          .place = {},
          .value = *missing,
          .rule = "drives the simulation and is not recorded",
          .advice = advice};
}

}  // namespace

double& FreeQuantity::in(ModelValues& values) const {
  switch (kind) {
    case Kind::parameter:
      return values.parameters[index];
    case Kind::initial_state:
      return values.initial_state[index];
    case Kind::sensor_gain:
      return values.sensor_gain[index];
    case Kind::sensor_offset:
      return values.sensor_offset[index];
    default:  // the load factor; a recording's own are no values
      break;
  }
  return values.load_factor;
}

std::string sensor_gain_name(std::string_view channel) { return "sensor:" + std::string(channel) + ".gain_error"; }
std::string sensor_offset_name(std::string_view channel) { return "sensor:" + std::string(channel) + ".offset_error"; }

double FreeQuantity::in(const ModelValues& values) const { return in(const_cast<ModelValues&>(values)); }

std::vector<double> parameter_values(const PlantDescription& plant, const AssetConfig& asset) {
  std::vector<double> values;
  for (const ParameterDescription& parameter : plant.parameters) {
    const auto setting = asset.parameters.find(parameter.name);
    values.push_back(setting == asset.parameters.end() ? parameter.value : setting->second.value);
  }
  return values;
}

double parameter_value(const PlantDescription& plant, const ModelValues& values, std::string_view name) {
  const ParameterDescription* parameter = plant.find_parameter(name);
  assert(parameter != nullptr);
  return values.parameters[static_cast<std::size_t>(parameter - plant.parameters.data())];
}

Status add_plant(PlantDescription description, PlantSimulator simulator) {
  if (find_plant(description.name))
    return fail(Error{.file = {},
                      .place = "add_plant",
                      .value = description.name,
                      .rule = "is the name of a plant that is known already",
                      .advice = "give it another"});
  if (description.file.empty())  // what is read from a file names its line
    if (const std::string missing = missing_law_sizes(description); !missing.empty())
      return fail(Error{.file = {},
                        .place = "add_plant, law_sizes of " + description.name,
                        .value = missing,
                        .rule = "is missing: units of laws that fit the plant's sites",
                        .advice = "say how many times larger each is here than in eha"});
  known_plants().push_back(std::move(description));
  plant_simulators().push_back(std::move(simulator));
  return {};
}

Result<std::unique_ptr<PlantSimulation>> PlantSimulation::create(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto plant = find_plant(asset.model);
  if (!plant) return fail(plant.error());
  if (const Status status = check_recording(**plant, recorded); !status) return fail(status.error());
  const auto simulator = std::ranges::find(plant_simulators(), asset.model, &PlantSimulator::model);
  if (simulator == plant_simulators().end()) return fail("model " + asset.model + " cannot be simulated");
  if (has_all(recorded, simulator->inputs)) {
    Result<PhysicsTerms> terms = resolve_physics(**plant, (*plant)->sites, asset);
    if (!terms) return fail(terms.error());
    return simulator->simulate(**plant, asset, recorded, std::move(*terms));
  }
  if (const AlternativeSimulator* of = that_is_driven(*simulator, recorded)) {
    Result<PhysicsTerms> terms = resolve_physics(**plant, of->sites, of_part(asset, **plant, of->sites));
    if (!terms) return fail(terms.error());
    return of->simulate(**plant, asset, recorded, std::move(*terms));
  }
  return fail(without_input(**plant, *simulator, recorded));
}

PlantPart simulated_part(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto simulator = std::ranges::find(plant_simulators(), asset.model, &PlantSimulator::model);
  if (simulator == plant_simulators().end()) return {};
  if (has_all(recorded, simulator->inputs)) return simulator->whole;
  const AlternativeSimulator* of = that_is_driven(*simulator, recorded);
  return of ? of->part : PlantPart{};
}

namespace {

// Between two samples, on the mean, where they are closest together. One short distance alone says nothing of the
// plant; a burst of samples in a slow log has something to show.
double shortest_distance_s(std::span<const double> times_s) {
  constexpr std::size_t kBurst = 8;
  if (times_s.size() < 2) return 0.0;
  const std::size_t burst = std::min(kBurst, times_s.size() - 1);
  double shortest = times_s.back() - times_s.front();
  for (std::size_t row = burst; row < times_s.size(); ++row)
    shortest = std::min(shortest, times_s[row] - times_s[row - burst]);
  return shortest / static_cast<double>(burst);
}

}  // namespace

double longest_step_s(std::span<const double> times_s) {
  constexpr double kShareOfDistance = 1.0 / 16.0;  // laws have corners, which longer steps run over
  return std::max(kLongestStep_s, kShareOfDistance * shortest_distance_s(times_s));
}

Result<FreeQuantity> PlantSimulation::find(std::string_view quantity) const {
  std::vector<std::string> names;
  if (plant().has_load()) {
    if (quantity == kLoadFactor) return FreeQuantity{FreeQuantity::Kind::load_factor, 0};
    names.emplace_back(kLoadFactor);
  }
  const auto& parameters = plant().parameters;
  for (std::size_t index = 0; index < parameters.size(); ++index) {
    if (parameters[index].name == quantity) return FreeQuantity{FreeQuantity::Kind::parameter, index};
    names.push_back(parameters[index].name);
  }
  for (std::size_t index = 0; index < physics_parameters().size(); ++index) {
    const std::string& name = physics_parameters()[index].name;
    if (name == quantity) return FreeQuantity{FreeQuantity::Kind::parameter, parameters.size() + index};
    names.push_back(name);
  }
  for (std::size_t index = 0; index < state_names().size(); ++index) {
    const std::string name = std::string(kInitialPrefix) + state_names()[index];
    if (name == quantity) return FreeQuantity{FreeQuantity::Kind::initial_state, index};
    names.push_back(name);
  }
  for (std::size_t index = 0; index < sensors().size(); ++index) {
    if (quantity == sensor_gain_name(sensors()[index])) return FreeQuantity{FreeQuantity::Kind::sensor_gain, index};
    if (quantity == sensor_offset_name(sensors()[index])) return FreeQuantity{FreeQuantity::Kind::sensor_offset, index};
  }
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(quantity),
                    .rule = "is not a quantity of " + plant().name,
                    .advice = suggest(quantity, names)});
}

}  // namespace sealwatch
