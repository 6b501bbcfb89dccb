// One run of a run-time plant's simulation, with all that it depends on, for equations that run it elsewhere.
#pragma once

#include <cstdint>

#include "sealwatch/model/simulation.hpp"
#include "services/common/model/recorded_input.hpp"

namespace sealwatch {

struct RuntimeRun {
  std::uint64_t simulation = 0;  ///< its number, by which it is known again
  const AssetConfig& asset;
  const TimeSeries& recorded;
  std::size_t channels = 0;  ///< that are simulated
  const RecordedInput& input;
  const ModelValues& values;
  std::span<const FreeQuantity> free;
  const SimulationOptions& options;
  InjectedColumns* injected = nullptr;
  std::size_t sites = 0;
};

}  // namespace sealwatch
