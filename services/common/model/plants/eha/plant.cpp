#include "sealwatch/model/eha_circuit.hpp"
#include "services/common/model/plants/eha/model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace plants {
NativePlant eha();
}

namespace {

std::unique_ptr<PlantSimulation> simulate_eha(const PlantDescription& plant, const AssetConfig& asset,
                                              const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace

PlantDescription describe_eha();
std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms);

NativePlant plants::eha() {
  return {.description = describe_eha(),
          .simulator = {.model = "eha",
                        .inputs = {"motor_voltage"},
                        .simulate = &simulate_eha,
                        .alternatives = {{.inputs = {"flow"},
                                          .also = {"pressure_b"},
                                          .sites = {EhaCircuit::kSites.begin(), EhaCircuit::kSites.end()},
                                          .simulate = &simulate_eha_circuit}}}};
}

}  // namespace sealwatch
