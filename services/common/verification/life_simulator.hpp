// One life of the Monte Carlo verification, from the seal's degradation to the forecasters' answers.
#pragma once

#include <optional>

#include "sealwatch/forecast/oracle.hpp"
#include "services/common/verification/circuit_truth.hpp"
#include "services/common/verification/life_record.hpp"
#include "services/common/verification/setting.hpp"
#include "services/virtual_bench/simulate_life.hpp"

namespace sealwatch::verification {

class LifeSimulator {
 public:
  /// An Error for a setting that makes no sense.
  [[nodiscard]] static Result<LifeSimulator> make(VerificationSetting setting);

  /// Life number `life`, from 0. Depends on the setting and the number alone. Thread-safe.
  [[nodiscard]] Result<LifeRecord> run(std::uint32_t life) const;
  [[nodiscard]] const VerificationSetting& setting() const { return setting_; }

 private:
  LifeSimulator(VerificationSetting setting, CircuitTruth truth, forecast::ForecastPanel panel)
      : setting_(std::move(setting)), truth_(std::move(truth)), panel_(std::move(panel)) {}

  [[nodiscard]] Result<std::optional<forecast::ConditionSample>> estimate(const bench::LifeSetting& life,
                                                                          const bench::PlannedTest& test) const;
  void add_answers(const forecast::ForecastRequest& request, const forecast::TrueState& state,
                   LifeRecord& record) const;

  VerificationSetting setting_;
  CircuitTruth truth_;
  forecast::ForecastPanel panel_;
};

}  // namespace sealwatch::verification
