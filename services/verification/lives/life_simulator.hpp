// One life of the Monte Carlo verification, from the seal's degradation to the forecasters' answers.
#pragma once

#include <optional>

#include "services/verification/lives/circuit_truth.hpp"
#include "services/verification/lives/life_record.hpp"
#include "services/verification/lives/oracle.hpp"
#include "services/verification/lives/setting.hpp"
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
  [[nodiscard]] Status add_answers(const forecast::ForecastRequest& request, const SealLife& seal, int month,
                                   LifeRecord& record) const;
  /// Dates, loads and what is missing of a life's tests.
  [[nodiscard]] bench::LifeSetting calendar(std::uint32_t life) const;

  VerificationSetting setting_;
  CircuitTruth truth_;
  forecast::ForecastPanel panel_;
};

}  // namespace sealwatch::verification
