#include "services/common/estimation/own_jumps.hpp"

#include <algorithm>

#include "sealwatch/signal/jumps.hpp"
#include "services/common/model/runtime_simulation.hpp"

namespace sealwatch {

std::vector<std::size_t> own_jumps(const PlantSimulation& simulation, const Series& channel) {
  return may_jump(simulation) ? signal::find_jumps(channel.values) : std::vector<std::size_t>();
}

bool has_own_jumps(const PlantSimulation& simulation, const TimeSeries& recorded) {
  return std::ranges::any_of(simulation.channels(), [&](const std::string& channel) {
    return !own_jumps(simulation, *recorded.find(channel)).empty();
  });
}

}  // namespace sealwatch
