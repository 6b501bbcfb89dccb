// Runs of a plant with an FMU within the process that has the FMU's binary: the integration with its sensitivities takes
// place there, so that a run costs one request and not one for every value of the binary. What a run depends on is sent,
// trajectories come back. Columns that are injected from outside are asked for step by step, unless they are laws'.
#pragma once

#include <memory>
#include <vector>

#include "sealwatch/core/process_copy.hpp"
#include "services/common/fmi/host_process.hpp"
#include "services/common/fmi/lost_processes.hpp"
#include "services/common/fmi/run_wire.hpp"

namespace sealwatch::fmi {

class RunProcess : public HostProcess {
 public:
  [[nodiscard]] static Result<std::unique_ptr<RunProcess>> start(const std::string& fmu, const HostedPlant& plant,
                                                                 std::size_t heap_bytes, const ProcessLimits& limits);
  [[nodiscard]] Result<SimulatedOutputs> run(const RuntimeRun& run);
  [[nodiscard]] bool knows(std::uint64_t simulation) const;
  [[nodiscard]] std::size_t room_bytes() const { return heap().size(); }

 private:
  using HostProcess::HostProcess;
  /// Where the simulation stands in the process, told to it where it is not known there.
  [[nodiscard]] Result<std::uint64_t> place_of_simulation(const RuntimeRun& run);

  struct Known {
    std::uint64_t simulation = 0;
    std::uint64_t used = 0;  ///< when last, in runs
  };
  std::vector<Known> known_;
  std::uint64_t runs_ = 0;
};

/// The processes of one plant, one for each thread that runs simulations.
class HostedRuns {
 public:
  HostedRuns(std::string fmu, HostedPlant plant, const ProcessLimits& limits = {})
      : fmu_(std::move(fmu)), plant_(std::move(plant)), limits_(limits) {}
  [[nodiscard]] Result<SimulatedOutputs> run(const RuntimeRun& run);

 private:
  [[nodiscard]] Result<std::unique_ptr<RunProcess>> take(const RuntimeRun& run);

  std::string fmu_;
  HostedPlant plant_;
  ProcessLimits limits_;
  LostProcesses lost_;
  FreeInCopies mutex_;
  std::vector<std::unique_ptr<RunProcess>> idle_;
};

}  // namespace sealwatch::fmi
