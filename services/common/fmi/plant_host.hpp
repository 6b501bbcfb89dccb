// The other work of sealwatch-fmu-host: simulations of a plant whose FMU is loaded into this process (hosted_runs.hpp).
#pragma once

#include <memory>
#include <stop_token>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/run_wire.hpp"

namespace sealwatch::fmi {

/// With the process that asks: requests and answers in turn, and the binary's calls written down for it.
class Conversation {
 public:
  virtual ~Conversation() = default;
  /// Asks something of the asker: what stands in the heap; returns when its answer does.
  virtual void ask() = 0;
  [[nodiscard]] virtual std::span<std::byte> heap() = 0;
};

class PlantHost {
 public:
  explicit PlantHost(Conversation& conversation) : conversation_(conversation) {}
  /// Throws Failure where the plant cannot be read.
  void load(Unpacker request);
  void make_simulation(Unpacker request);
  void run(Unpacker request);
  /// The run that is under way shall end.
  void stop() { stop_.request_stop(); }

 private:
  Conversation& conversation_;
  std::vector<std::unique_ptr<PlantSimulation>> simulations_;
  std::stop_source stop_;
};

}  // namespace sealwatch::fmi
