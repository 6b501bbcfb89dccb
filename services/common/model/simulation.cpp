#include "sealwatch/model/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/eha_circuit.hpp"
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
  static std::deque<PlantSimulator> simulators = {
      {"eha", {"motor_voltage"}, &simulate_eha},
      {"eha_switched", {"motor_duty", "valve_state"}, &simulate_eha_switched},
      {"emps", {"motor_voltage"}, &simulate_emps},
      {"cascaded_tanks", {"pump_voltage"}, &simulate_cascaded_tanks}};
  return simulators;
}

/// The cylinder circuit knows nothing of the motor and the pump, and of their laws.
AssetConfig of_circuit(AssetConfig asset) {
  std::erase_if(asset.physics, [](const PhysicsTerm& term) {
    const auto at_element = [&term](const Site& site) { return site.element == term.element; };
    return std::ranges::any_of(Eha::kSites, at_element) && std::ranges::none_of(EhaCircuit::kSites, at_element);
  });
  return asset;
}

Status check_input(const PlantDescription& plant, const TimeSeries& recorded, const std::vector<std::string>& needed) {
  for (const std::string& name : needed)
    if (!recorded.has(name))
      return fail(Error{.file = {},
                        .place = {},
                        .value = name,
                        .rule = "drives the simulation and is not recorded",
                        .advice = plant.name == "eha" ? "record it, or the flow into chamber A" : "record it"});
  return {};
}

double mean_of(const std::vector<double>& values, std::size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
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
    case Kind::load_factor:
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

std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr) return std::nullopt;
  return mean_of(series->values, std::min<std::size_t>(3, series->values.size()));
}

std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr) return std::nullopt;
  return mean_of(series->values, series->values.size());
}

Status add_plant(PlantDescription description, PlantSimulator simulator) {
  if (find_plant(description.name))
    return fail(Error{.file = {},
                      .place = "add_plant",
                      .value = description.name,
                      .rule = "is the name of a plant that is known already",
                      .advice = "give it another"});
  known_plants().push_back(std::move(description));
  plant_simulators().push_back(std::move(simulator));
  return {};
}

Result<std::unique_ptr<PlantSimulation>> PlantSimulation::create(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto plant = find_plant(asset.model);
  if (!plant) return fail(plant.error());
  if (const Status status = check_recording(**plant, recorded); !status) return fail(status.error());
  const bool circuit = asset.model == "eha" && !recorded.has("motor_voltage") && recorded.has("flow");
  Result<PhysicsTerms> terms = circuit ? resolve_physics(**plant, EhaCircuit::kSites, of_circuit(asset))
                                       : resolve_physics(**plant, (*plant)->sites, asset);
  if (!terms) return fail(terms.error());
  if (circuit) return simulate_eha_circuit(**plant, asset, recorded, std::move(*terms));
  for (const auto& [model, inputs, simulate] : plant_simulators()) {
    if (asset.model != model) continue;
    if (const Status status = check_input(**plant, recorded, inputs); !status) return fail(status.error());
    return simulate(**plant, asset, recorded, std::move(*terms));
  }
  return fail("model " + asset.model + " cannot be simulated");
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
  for (std::size_t index = 0; index < channels().size(); ++index) {
    if (quantity == sensor_gain_name(channels()[index])) return FreeQuantity{FreeQuantity::Kind::sensor_gain, index};
    if (quantity == sensor_offset_name(channels()[index]))
      return FreeQuantity{FreeQuantity::Kind::sensor_offset, index};
  }
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(quantity),
                    .rule = "is no quantity of " + plant().name,
                    .advice = suggest(quantity, names)});
}

}  // namespace sealwatch
