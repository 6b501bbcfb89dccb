#include "sealwatch/model/eha_circuit.hpp"
#include "sealwatch/model/eha_flow_driven.hpp"
#include "services/common/model/native_plant.hpp"
#include "services/common/model/plants/eha/model.hpp"

namespace sealwatch {

PlantDescription describe_eha();
std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms);
std::unique_ptr<PlantSimulation> simulate_eha_flow_driven(const PlantDescription& plant, const AssetConfig& asset,
                                                          const TimeSeries& recorded, PhysicsTerms terms);

// A noisy flow is integrated, so that the position's error grows like a random walk; so long it stays below the sensors'
// noise.
constexpr double kFlowWindow_s = 2.0;

// The pump turns round, and fills its ports, within some half a second.
constexpr double kPortsFilled_s = 1.0;

namespace plants {

NativePlant eha() {
  NativePlant plant = native_plant<EhaModel>(describe_eha());
  plant.simulator.alternatives = {{.part = {.inputs = {"flow", "pressure_b"}, .window_s = kFlowWindow_s},
                                   .sites = {EhaCircuit::kSites.begin(), EhaCircuit::kSites.end()},
                                   .simulate = &simulate_eha_circuit},
                                  {.part = {.inputs = {"flow"},
                                            .not_recorded = "what the pump moves before its valve opens",
                                            .record = "the pressures of both chambers, or the motor's voltage",
                                            .unseen_at_reversal_s = kPortsFilled_s},
                                   .sites = {EhaFlowDriven::kSites.begin(), EhaFlowDriven::kSites.end()},
                                   .simulate = &simulate_eha_flow_driven}};
  return plant;
}

}  // namespace plants
}  // namespace sealwatch
