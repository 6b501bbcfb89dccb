// How a simulation, a run of it and what comes of it go between sealwatch and sealwatch-fmu-host (host_protocol.hpp):
// put on the one side, got on the other, in the same order.
#pragma once

#include <string>
#include <vector>

#include "services/common/fmi/host_protocol.hpp"
#include "services/common/model/law_columns.hpp"
#include "services/common/model/runtime_run.hpp"

namespace sealwatch::fmi {

/// The plant that a process simulates, from its file; the FMU in it is unpacked already.
struct HostedPlant {
  std::string file;        ///< plant file
  std::string hash;        ///< of its content when it was read
  std::string fmu_folder;  ///< where its FMU is unpacked
};
void put_plant(Packer& packer, const HostedPlant& plant);
[[nodiscard]] HostedPlant get_plant(Unpacker& unpacker);

/// A simulation is what an asset and a recording make it; of both as much as a run depends on.
struct HostedSimulation {
  AssetConfig asset;
  TimeSeries recorded;
};
void put_simulation(Packer& packer, const AssetConfig& asset, const TimeSeries& recorded);
[[nodiscard]] HostedSimulation get_simulation(Unpacker& unpacker);

/// A run as the process gets it. Injected columns of laws come as what they are and are weighed there; others are asked
/// for step by step.
struct HostedRun {
  RecordedInput input;
  ModelValues values;
  std::vector<FreeQuantity> free;
  SimulationOptions options;
  std::vector<InjectedColumns::Entry> entries;
  std::size_t injected_columns = 0;
  bool injected = false;
  std::vector<LawColumn> laws;
};
void put_run(Packer& packer, const RuntimeRun& run);
/// An Error where the plant has not the laws of the columns.
[[nodiscard]] Result<HostedRun> get_run(Unpacker& unpacker, const PlantDescription& plant);

void put_outputs(Packer& packer, const Result<SimulatedOutputs>& outputs);
[[nodiscard]] Result<SimulatedOutputs> get_outputs(Unpacker& unpacker);

}  // namespace sealwatch::fmi
