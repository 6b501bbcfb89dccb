// Pressure of chamber A simulated from flow, motion and the other chamber's pressure.
#pragma once

#include "services/common/model/plants/eha/estimation/volume_balance.hpp"

namespace sealwatch {

struct SimulatedPressure {
  std::vector<double> pressure_a_Pa;
  std::vector<double>
      standard_deviation_Pa;  // of the difference to the sensor: its noise, and the inputs' noise summed up
};

/// From its first recorded value, with conductance 1/R_CL [m3/(Pa s)] and compressibility 1/beta [1/Pa].
[[nodiscard]] SimulatedPressure simulate_pressure_a(const CylinderSignals& signals, double conductance,
                                                    double compressibility);

}  // namespace sealwatch
