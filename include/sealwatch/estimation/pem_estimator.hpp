// The port Estimator by prediction-error minimisation.
#pragma once

#include <memory>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "sealwatch/port/estimator.hpp"

namespace sealwatch {

/// Whole actuator (fit_actuator), then the cylinder circuit (fit_cylinder_circuit) for plants that have one. The first
/// that is admissible stands first, so that the fit to trust is always the front one.
[[nodiscard]] std::unique_ptr<Estimator> make_pem_estimator(ActuatorFitOptions actuator = {},
                                                            CylinderCircuitOptions cylinder = {});

}  // namespace sealwatch
