// A life of one actuator on the bench: monthly partial stroke tests while its seal degrades.
//
// Everything follows from one seed. Each random part has its own stream, so that asking for missing months, say, does
// not change the seal or the loads.
#pragma once

#include <cstdint>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "sealwatch/forecast/degradation.hpp"
#include "services/virtual_bench/simulate_test.hpp"

namespace sealwatch::bench {

struct LifeSetting {
  std::uint64_t seed = 1;
  int months = 240;            ///< at most; a life ends with the first test at or below the asset's threshold
  UtcTime installed = {};      ///< theta = 1; the first test is a month later
  double day_scatter = 10.0;   ///< a test comes up to so many days after its month begins
  double load_range = 0.2;     ///< Phi is uniform in +- this
  double missing_share = 0.0;  ///< of the months: no test
  double cut_share = 0.0;      ///< of the tests: recording ends somewhere between a tenth and nine tenths
  forecast::DegradationSetting degradation = {};
  std::map<std::string, double> parameters = {};  ///< what is true of this actuator, see TestConditions
};

/// One month of a life, before anything is simulated.
struct PlannedTest {
  int month = 0;  ///< since installation
  UtcTime start_time = {};
  double condition = 1.0;           ///< theta
  double resistance_Pa_s_m3 = 0.0;  ///< R_CL
  double load_factor = 0.0;         ///< Phi
  double recorded_share = 1.0;      ///< below 1: cut; 0: missing
  std::uint64_t seed = 0;           ///< of the sensors' noise
};

/// The months of a life up to failure. An Error when the asset has no seal resistances.
[[nodiscard]] Result<std::vector<PlannedTest>> plan_life(const AssetConfig& asset, const LifeSetting& setting);

/// Shortens a recording to the first `share` of its samples (at least one).
void cut(TimeSeries& samples, double share);

/// Runs the asset's partial stroke test as planned; recording_id is "2031-04-12-PST-<asset>". Not for missing months.
[[nodiscard]] Result<Recording> simulate_planned(const AssetConfig& asset, const LifeSetting& life,
                                                 const PlannedTest& test, const TestSetting& setting);

struct LifeTest {
  PlannedTest plan;
  Recording recording;
};

/// All tests of a life that were recorded. `setting.seed` is not used: each test has its own.
[[nodiscard]] Result<std::vector<LifeTest>> simulate_life(const AssetConfig& asset, const LifeSetting& life,
                                                          const TestSetting& setting);

}  // namespace sealwatch::bench
