#include "sealwatch/estimation/pem_estimator.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/simulation.hpp"
#include "sealwatch/model/too_long_to_simulate.hpp"
#include "services/common/estimation/cannot_fit.hpp"

namespace sealwatch {
namespace {

class PemEstimator final : public Estimator {
 public:
  PemEstimator(ActuatorFitOptions actuator, CylinderCircuitOptions cylinder)
      : actuator_(std::move(actuator)), cylinder_(cylinder) {}

  [[nodiscard]] std::vector<FitReport> estimate(const AssetConfig& asset, const TimeSeries& samples,
                                                std::span<const Phase> phases,
                                                const std::stop_token& cancel) const override {
    const Deadline deadline(cancel);
    ActuatorFitOptions actuator = actuator_;
    actuator.deadline = &deadline;
    std::vector<FitReport> fits;
    if (auto why = too_long_to_simulate(samples.time_s))
      fits.push_back(cannot_fit(asset.model, std::move(*why)));
    else
      fits.push_back(fit_actuator(asset, {&samples, 1}, actuator).report);
    if (has_cylinder_circuit(asset)) fits.push_back(fit_cylinder_circuit(asset, samples, phases, cylinder_));
    // Driven by a measured flow the whole-record simulation takes the flow's own noise for the model's error: the
    // circuit's filter knows better.
    if (fits.size() == 2 && !simulated_part(asset, samples).inputs.empty()) std::swap(fits[0], fits[1]);
    std::stable_partition(fits.begin(), fits.end(), [](const FitReport& fit) { return fit.admissible; });
    return fits;
  }

 private:
  ActuatorFitOptions actuator_;
  CylinderCircuitOptions cylinder_;
};

}  // namespace

std::unique_ptr<Estimator> make_pem_estimator(ActuatorFitOptions actuator, CylinderCircuitOptions cylinder) {
  return std::make_unique<PemEstimator>(std::move(actuator), cylinder);
}

}  // namespace sealwatch
