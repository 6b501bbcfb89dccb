#include "services/common/fmi/run_wire.hpp"

#include <utility>

namespace sealwatch::fmi {
namespace {

void put_count(Packer& packer, std::size_t count) { packer.put(static_cast<std::uint64_t>(count)); }
std::size_t get_count(Unpacker& unpacker) { return static_cast<std::size_t>(unpacker.get<std::uint64_t>()); }
void put_values(Packer& packer, const std::vector<double>& values) { packer.put_list(std::span<const double>(values)); }

void put_matrix(Packer& packer, const RowMatrix& matrix) {
  put_count(packer, static_cast<std::size_t>(matrix.rows()));
  put_count(packer, static_cast<std::size_t>(matrix.cols()));
  packer.put_numbers({matrix.data(), static_cast<std::size_t>(matrix.size())});
}
RowMatrix get_matrix(Unpacker& unpacker) {
  const auto rows = static_cast<Eigen::Index>(get_count(unpacker)),
             columns = static_cast<Eigen::Index>(get_count(unpacker));
  const std::span<const double> numbers = unpacker.numbers(static_cast<std::size_t>(rows * columns));
  return Eigen::Map<const RowMatrix>(numbers.data(), rows, columns);
}

}  // namespace

void put_plant(Packer& packer, const HostedPlant& plant) {
  for (const std::string* text : {&plant.file, &plant.hash, &plant.fmu_folder}) packer.put_text(*text);
}

HostedPlant get_plant(Unpacker& unpacker) {
  HostedPlant plant;
  for (std::string* text : {&plant.file, &plant.hash, &plant.fmu_folder}) *text = unpacker.text();
  return plant;
}

void put_simulation(Packer& packer, const AssetConfig& asset, const TimeSeries& recorded) {
  packer.put_text(asset.model);
  put_count(packer, asset.parameters.size());
  for (const auto& [name, setting] : asset.parameters) packer.put_text(name), packer.put(setting.value);
  put_count(packer, asset.sensors.size());
  for (const auto& [name, sensor] : asset.sensors) packer.put_text(name), packer.put(sensor);
  put_count(packer, asset.physics.size());
  for (const PhysicsTerm& term : asset.physics) {
    packer.put_text(term.id);
    packer.put_text(term.element);
    put_count(packer, term.parameters.size());
    for (const auto& [name, setting] : term.parameters) packer.put_text(name), packer.put(setting);
  }
  put_values(packer, recorded.time_s);
  put_count(packer, recorded.channels.size());
  for (const Series& channel : recorded.channels) {
    packer.put_text(channel.name);
    packer.put_text(channel.unit);
    packer.put(channel.noise_std);
    put_values(packer, channel.values);
  }
  packer.put(static_cast<std::uint64_t>(recorded.input_hold));
}

HostedSimulation get_simulation(Unpacker& unpacker) {
  HostedSimulation simulation;
  AssetConfig& asset = simulation.asset;
  asset.model = unpacker.text();
  for (std::size_t left = get_count(unpacker); left > 0; --left) {
    const std::string name = unpacker.text();
    asset.parameters[name].value = unpacker.get<double>();
  }
  for (std::size_t left = get_count(unpacker); left > 0; --left) {
    const std::string name = unpacker.text();
    asset.sensors[name] = unpacker.get<SensorSetting>();
  }
  for (std::size_t left = get_count(unpacker); left > 0; --left) {
    PhysicsTerm& term = asset.physics.emplace_back();
    term.id = unpacker.text();
    term.element = unpacker.text();
    for (std::size_t parameters = get_count(unpacker); parameters > 0; --parameters) {
      const std::string name = unpacker.text();
      term.parameters[name] = unpacker.get<ParameterSetting>();
    }
  }
  TimeSeries& recorded = simulation.recorded;
  recorded.time_s = unpacker.list<double>();
  for (std::size_t left = get_count(unpacker); left > 0; --left) {
    Series& channel = recorded.channels.emplace_back();
    channel.name = unpacker.text();
    channel.unit = unpacker.text();
    channel.noise_std = unpacker.get<double>();
    channel.values = unpacker.list<double>();
  }
  recorded.input_hold = unpacker.get<std::uint64_t>() != 0;
  return simulation;
}

namespace {

// A law is known by its id and its parameters' names, as in an asset.
void put_laws(Packer& packer, const std::vector<LawColumn>& laws) {
  put_count(packer, laws.size());
  for (const LawColumn& column : laws) {
    packer.put_text(column.law->id);
    put_count(packer, column.law->parameters.size());
    for (const LawParameter& parameter : column.law->parameters) packer.put_text(parameter.name);
    packer.put_list(std::span<const std::size_t>(column.sites));
    put_values(packer, column.parameters);
    put_count(packer, column.strength);
    packer.put(column.unit);
    packer.put(column.hidden);
  }
}

Result<std::vector<LawColumn>> get_laws(Unpacker& unpacker, const PlantDescription& plant) {
  std::vector<LawColumn> laws(get_count(unpacker));
  for (LawColumn& column : laws) {
    const std::string id = unpacker.text();
    std::vector<std::string> names(get_count(unpacker));
    for (std::string& name : names) name = unpacker.text();
    const auto law = find_law(id, names, plant.name);
    if (!law) return fail(law.error());
    column.law = *law;
    column.sites = unpacker.list<std::size_t>();
    column.parameters = unpacker.list<double>();
    column.strength = get_count(unpacker);
    column.unit = unpacker.get<double>();
    column.hidden = unpacker.get<double>();
  }
  return laws;
}

}  // namespace

void put_run(Packer& packer, const RuntimeRun& run) {
  put_values(packer, run.input.times());
  put_count(packer, run.input.channels().size());
  for (const InputChannel& channel : run.input.channels()) {
    put_values(packer, channel.values);
    put_values(packer, channel.slopes);
    packer.put(static_cast<std::uint64_t>(channel.hold));
    packer.put(static_cast<std::uint64_t>(channel.cubic));
    packer.put(channel.delay_s);
    packer.put(channel.clock_rate);
  }
  put_values(packer, run.values.parameters);
  packer.put(run.values.load_factor);
  for (const auto* list : {&run.values.initial_state, &run.values.sensor_gain, &run.values.sensor_offset})
    put_values(packer, *list);
  packer.put_list(run.free);
  packer.put(run.options.relative_tolerance);
  packer.put(run.options.maximum_step_s);
  put_count(packer, run.options.maximum_steps);
  packer.put(run.options.held_within_s);
  packer.put(static_cast<std::uint64_t>(run.injected != nullptr));
  if (run.injected == nullptr) return;
  put_count(packer, run.injected->columns());
  packer.put_list(run.injected->entries());
  const auto* laws = dynamic_cast<const LawColumns*>(run.injected);
  put_laws(packer, laws == nullptr ? std::vector<LawColumn>{} : laws->laws());
}

Result<HostedRun> get_run(Unpacker& unpacker, const PlantDescription& plant) {
  std::vector<double> times = unpacker.list<double>();
  std::vector<InputChannel> channels(get_count(unpacker));
  for (InputChannel& channel : channels) {
    channel.values = unpacker.list<double>();
    channel.slopes = unpacker.list<double>();
    channel.hold = unpacker.get<std::uint64_t>() != 0;
    channel.cubic = unpacker.get<std::uint64_t>() != 0;
    channel.delay_s = unpacker.get<double>();
    channel.clock_rate = unpacker.get<double>();
  }
  HostedRun run{.input = {std::move(times), std::move(channels)},
                .values = {},
                .free = {},
                .options = {},
                .entries = {},
                .laws = {}};
  run.values.parameters = unpacker.list<double>();
  run.values.load_factor = unpacker.get<double>();
  for (auto* list : {&run.values.initial_state, &run.values.sensor_gain, &run.values.sensor_offset})
    *list = unpacker.list<double>();
  run.free = unpacker.list<FreeQuantity>();
  run.options.relative_tolerance = unpacker.get<double>();
  run.options.maximum_step_s = unpacker.get<double>();
  run.options.maximum_steps = get_count(unpacker);
  run.options.held_within_s = unpacker.get<double>();
  run.injected = unpacker.get<std::uint64_t>() != 0;
  if (!run.injected) return run;
  run.injected_columns = get_count(unpacker);
  run.entries = unpacker.list<InjectedColumns::Entry>();
  Result<std::vector<LawColumn>> laws = get_laws(unpacker, plant);
  if (!laws) return fail(laws.error());
  run.laws = std::move(*laws);
  return run;
}

void put_outputs(Packer& packer, const Result<SimulatedOutputs>& outputs) {
  packer.put(static_cast<std::uint64_t>(outputs.has_value()));
  if (!outputs) {
    const Error& error = outputs.error();
    for (const std::string* text : {&error.file, &error.place, &error.value, &error.rule, &error.advice})
      packer.put_text(*text);
    return;
  }
  put_matrix(packer, outputs->values);
  put_matrix(packer, outputs->sensitivities);
  put_count(packer, outputs->steps);
  put_count(packer, outputs->points);
  put_count(packer, outputs->linearisations);
}

Result<SimulatedOutputs> get_outputs(Unpacker& unpacker) {
  if (unpacker.get<std::uint64_t>() == 0) {
    Error error;
    for (std::string* text : {&error.file, &error.place, &error.value, &error.rule, &error.advice})
      *text = unpacker.text();
    return fail(std::move(error));
  }
  SimulatedOutputs outputs;
  outputs.values = get_matrix(unpacker);
  outputs.sensitivities = get_matrix(unpacker);
  outputs.steps = get_count(unpacker);
  outputs.points = get_count(unpacker);
  outputs.linearisations = get_count(unpacker);
  return outputs;
}

}  // namespace sealwatch::fmi
