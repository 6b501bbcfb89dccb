// A simulator that returns the recording with a chosen error on each channel, larger the further the asset's seal is
// from the true one.
#pragma once

#include <cmath>

#include "sealwatch/port/estimator.hpp"

namespace sealwatch::synthetic {

class FakeSimulator final : public Simulator {
 public:
  /// Error of each output channel: `noises` times its noise, plus `per_seal` times |R_CL / true - 1|.
  FakeSimulator(double noises, double per_seal, double true_resistance)
      : noises_(noises), per_seal_(per_seal), true_resistance_(true_resistance) {}

  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& /*cancel*/) const override {
    if (!recorded.has("motor_voltage")) return fail("motor_voltage is not recorded");
    const double seal = std::abs(asset.parameter("R_CL") / true_resistance_ - 1.0);
    TimeSeries simulated = recorded;
    std::erase_if(simulated.channels, [](const Series& series) { return series.name == "motor_voltage"; });
    for (Series& series : simulated.channels)
      for (double& value : series.values) value += (noises_ + per_seal_ * seal) * series.noise_std;
    return simulated;
  }

 private:
  double noises_, per_seal_, true_resistance_;
};

}  // namespace sealwatch::synthetic
