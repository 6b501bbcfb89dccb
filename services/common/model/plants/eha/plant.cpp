#include "sealwatch/model/eha_circuit.hpp"
#include "services/common/model/native_plant.hpp"
#include "services/common/model/plants/eha/model.hpp"

namespace sealwatch {

PlantDescription describe_eha();
std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms);

namespace plants {

NativePlant eha() {
  NativePlant plant = native_plant<EhaModel>(describe_eha());
  plant.simulator.alternatives = {{.inputs = {"flow"},
                                   .also = {"pressure_b"},
                                   .sites = {EhaCircuit::kSites.begin(), EhaCircuit::kSites.end()},
                                   .simulate = &simulate_eha_circuit}};
  return plant;
}

}  // namespace plants
}  // namespace sealwatch
