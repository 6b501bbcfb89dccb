// What a Monte Carlo verification of the remaining useful life is to do. Two runs with the same setting give the same
// records, whatever their threads, shards and interruptions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/forecast/degradation.hpp"
#include "sealwatch/forecast/forecaster.hpp"
#include "services/verification/lives/scenario.hpp"

namespace sealwatch::verification {

/// What plays the actuator: `circuit` the cylinder circuit (circuit_truth.hpp), `actuator` the nine-state bench,
/// `condition` nothing: the estimate is theta with the standard error that the estimator has at 50 Hz. That is for the
/// calibration of the degradation's constants, which needs thousands of runs.
enum class TruthKind { circuit, actuator, condition };

/// Constants of the degradation, calibrated on lifetimes and on window 36 alone so that a line over ln t, or over t,
/// does what the source reports of its window 36 (docs/records/verification.md, "Calibration"). Frozen.
[[nodiscard]] forecast::DegradationSetting published_ln_t();
[[nodiscard]] forecast::DegradationSetting published_t();

struct VerificationSetting {
  AssetConfig asset;
  int lives = 1000;
  std::uint64_t seed = 1;
  int months = 240;  ///< of service; a life that has not failed by then is censored
  TruthKind truth = TruthKind::circuit;
  double sample_rate_Hz = 50.0;
  bool through_layers = false;  ///< recordings go through data acquisition and data manipulation (estimate_test.hpp)
  double load_range = 0.2;      ///< Phi of each test is uniform in +- this
  double missing_share = 0.0;   ///< of the months: no test
  double cut_share = 0.0;       ///< of the tests: recording cut short
  Scenario scenario = Scenario::reference;
  forecast::DegradationSetting degradation = published_ln_t();
  std::vector<forecast::ForecasterSettings> forecasters = {};
};

[[nodiscard]] std::string_view name_of(TruthKind kind);
[[nodiscard]] Result<TruthKind> truth_named(const std::string& name);

[[nodiscard]] Status validate(const VerificationSetting& setting);

/// Every known method: the default panel first, lines over 24, 36 and 48 months, the laws over the whole life.
[[nodiscard]] std::vector<forecast::ForecasterSettings> all_forecasters();
/// "ols:24", or "state_space" with the window that all_forecasters() has for it first.
[[nodiscard]] Result<forecast::ForecasterSettings> forecaster_named(const std::string& text);
/// "ols 36"; the oracle is "oracle".
[[nodiscard]] std::string label_of(const forecast::ForecasterSettings& forecaster);
/// Labels of the forecasters in their order, the oracle last: the columns of a record.
[[nodiscard]] std::vector<std::string> method_labels(const VerificationSetting& setting);

/// Sets one constant of the degradation, "steepening_limit_max=0.004", or all by the name of a set: "published_ln_t",
/// "published_t", or "bench", the constants that the virtual bench's lives have. Names: docs/records/verification.md.
[[nodiscard]] Status set_constant(forecast::DegradationSetting& degradation, const std::string& assignment);

/// All that results depend on, a line each, "key = value"; two settings are the same when their texts are.
[[nodiscard]] std::string describe(const VerificationSetting& setting);

}  // namespace sealwatch::verification
