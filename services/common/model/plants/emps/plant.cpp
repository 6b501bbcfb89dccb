#include "services/common/model/measured_input.hpp"
#include "services/common/model/native_plant.hpp"
#include "services/common/model/plants/emps/model.hpp"

namespace sealwatch {
namespace {

std::unique_ptr<PlantSimulation> simulate_emps(const PlantDescription& plant, const AssetConfig& asset,
                                               const TimeSeries& recorded, PhysicsTerms terms) {
  if (recorded.input_hold) return simulate_as<EmpsModel>(plant, asset, recorded, std::move(terms));
  TimeSeries smoothed = recorded;
  for (Series& channel : smoothed.channels)
    if (channel.name == "motor_voltage") channel.values = means_of_neighbours(channel.values);
  return simulate_as<EmpsModel>(plant, asset, smoothed, std::move(terms));
}

}  // namespace

PlantDescription describe_emps();

namespace plants {

NativePlant emps() { return native_plant<EmpsModel>(describe_emps(), &simulate_emps); }

}  // namespace plants
}  // namespace sealwatch
