// Standard tests of 31 s at 100 Hz of a given actuator, simulated, with seeded noise.
#pragma once

#include <random>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/mismatch/telling.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch::mismatch {

/// Outputs of `samples`, whose input is given, simulated. `noise_share`: of the noise of each channel's sensor.
/// `clean`: where to leave the recording without noise, or null.
inline TimeSeries simulated(const AssetConfig& truth, TimeSeries samples, double noise_share,
                            TimeSeries* clean = nullptr) {
  constexpr SimulationOptions tight = {.relative_tolerance = 1e-7, .maximum_step_s = 0.02};
  const auto simulation = PlantSimulation::create(truth, samples).value();
  const auto outputs = simulation->run(simulation->start(), {}, tight).value();
  std::mt19937 random(20310412);
  std::normal_distribution<double> normal;
  if (clean != nullptr) *clean = samples;
  for (std::size_t c = 0; c < simulation->channels().size(); ++c)
    for (std::size_t k = 0; k < samples.channels.size(); ++k) {
      Series& series = samples.channels[k];
      if (series.name != simulation->channels()[c]) continue;
      series.noise_std = truth.sensors.at(series.name).noise_std;
      for (std::size_t row = 0; row < series.values.size(); ++row) {
        const double value = outputs.values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c));
        if (clean != nullptr) clean->channels[k].values[row] = value;
        series.values[row] = value + noise_share * series.noise_std * normal(random);
      }
    }
  return samples;
}

inline TimeSeries simulated_test(const AssetConfig& truth, double noise_share, TimeSeries* clean = nullptr) {
  return simulated(truth, standard_pst(truth, 100.0), noise_share, clean);
}

/// A test under `load` times the actuator's, as a recording of that name. `course`: changes the standard test's input.
template <class Course>
Recording recording_of(const AssetConfig& truth, double load, Course course) {
  AssetConfig loaded = truth;
  loaded.parameters.at("phi").value *= load;
  TimeSeries samples = standard_pst(loaded, 100.0);
  course(samples);
  Recording recording;
  recording.asset_id = truth.asset_id;
  recording.file = recording.recording_id = recording.content_hash = number(load);
  recording.samples = simulated(loaded, std::move(samples), 1.0);
  return recording;
}

inline Recording recording_of(const AssetConfig& truth, double load) {
  return recording_of(truth, load, [](TimeSeries&) {});
}

}  // namespace sealwatch::mismatch
