#include "sealwatch/model/simulation.hpp"

#include <cassert>
#include <numeric>

#include "sealwatch/core/text.hpp"
#include "services/common/model/simulation_plants.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kInitialPrefix = "initial:";

Status check_recording(const PlantDescription& plant, const TimeSeries& recorded) {
  if (recorded.time_s.size() < 2) return fail("a simulation needs at least two recorded samples");
  bool output = false;
  for (const ChannelDescription& channel : plant.channels)
    output = output || (!channel.input && recorded.has(channel.name));
  if (!output) return fail("the recording has no channel that " + plant.name + " simulates");
  return {};
}

Status check_input(const TimeSeries& recorded, std::initializer_list<const char*> needed) {
  for (const char* name : needed)
    if (!recorded.has(name))
      return fail(Error{.file = {},
                        .place = {},
                        .value = name,
                        .rule = "drives the simulation and is not recorded",
                        .advice = "record it; plant eha takes the flow instead of the motor's voltage"});
  return {};
}

double mean_of(const std::vector<double>& values, std::size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

}  // namespace

double& FreeQuantity::in(ModelValues& values) const {
  if (kind == Kind::load_factor) return values.load_factor;
  return kind == Kind::parameter ? values.parameters[index] : values.initial_state[index];
}

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

Result<std::unique_ptr<PlantSimulation>> PlantSimulation::create(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto plant = find_plant(asset.model);
  if (!plant) return fail(plant.error());
  if (!asset.physics.empty())
    return fail(Error{.file = {},
                      .place = "asset " + asset.asset_id + ", key physics",
                      .value = asset.physics.front().id,
                      .rule = "is a law that this version cannot simulate yet",
                      .advice = "remove it: a fit without it would not be the model you mean"});
  if (const Status status = check_recording(**plant, recorded); !status) return fail(status.error());
  if (asset.model == "eha" && !recorded.has("motor_voltage") && recorded.has("flow"))
    return simulate_eha_circuit(**plant, asset, recorded);
  if (asset.model == "eha") {
    if (const Status status = check_input(recorded, {"motor_voltage"}); !status) return fail(status.error());
    return simulate_eha(**plant, asset, recorded);
  }
  if (const Status status = check_input(recorded, {"motor_duty", "valve_state"}); !status) return fail(status.error());
  return simulate_eha_switched(**plant, asset, recorded);
}

Result<FreeQuantity> PlantSimulation::find(std::string_view quantity) const {
  std::vector<std::string> names = {"load_factor"};
  if (quantity == names.front()) return FreeQuantity{FreeQuantity::Kind::load_factor, 0};
  const auto& parameters = plant().parameters;
  for (std::size_t index = 0; index < parameters.size(); ++index) {
    if (parameters[index].name == quantity) return FreeQuantity{FreeQuantity::Kind::parameter, index};
    names.push_back(parameters[index].name);
  }
  for (std::size_t index = 0; index < state_names().size(); ++index) {
    const std::string name = std::string(kInitialPrefix) + state_names()[index];
    if (name == quantity) return FreeQuantity{FreeQuantity::Kind::initial_state, index};
    names.push_back(name);
  }
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(quantity),
                    .rule = "is no quantity of " + plant().name,
                    .advice = suggest(quantity, names)});
}

}  // namespace sealwatch
