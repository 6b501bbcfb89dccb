// What may go wrong in a life on its way to failure: which seal is in at which month, how it ages, and what its tests
// show. Everything follows from the life's seed; what a scenario draws has a stream of its own, so that loads, dates,
// noise and, but for what the scenario changes, the seal are those of the same life of the reference.
//
//   reference      nothing
//   outliers       one test in twenty shows a condition that is 0.02 to 0.10 off, up or down
//   missing        one month in four has no test
//   aborted        one test in four is cut short, after a tenth to nine tenths
//   replaced       a new seal at a month within 36 .. 72 (at most four fifths of the first seal's life), unannounced
//   load_change    the load is higher by 0.3 of its nominal value from a month within 0.3 .. 0.6 of the life on
//   contamination  the seal ages 1.5 times as fast from such a month on: all of gamma, Gamma and Upsilon
//                  (degradation.hpp)
//
// A change is scored from half a year after it: nobody can foresee it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "services/verification/lives/oracle.hpp"
#include "services/virtual_bench/simulate_life.hpp"

namespace sealwatch::verification {

enum class Scenario { reference, outliers, missing, aborted, replaced, load_change, contamination };

[[nodiscard]] std::string_view name_of(Scenario scenario);
[[nodiscard]] Result<Scenario> scenario_named(const std::string& name);
/// All, the reference first.
[[nodiscard]] std::vector<Scenario> all_scenarios();

struct ScenarioShares {
  double missing = 0.0;  ///< of the months
  double cut = 0.0;      ///< of the tests
};
/// Shares of missing and cut tests that belong to a scenario.
[[nodiscard]] ScenarioShares shares_of(Scenario scenario);

/// The seal that is in, month by month since the first installation, up to the failure that is forecast.
struct SealLife {
  std::vector<forecast::TrueState> months;  ///< element n is month n; TrueState::month is the age of the seal then in
  double end_of_life_months = 0.0;          ///< since the first installation
  double installed_months = 0.0;            ///< when the seal that fails was put in
  double change_months = 0.0;               ///< last month before the change; 0: none
  double scored_from_months = 0.0;
  forecast::DegradationSetting law;  ///< of the ageing to come
};
[[nodiscard]] SealLife seal_life(std::uint64_t life_seed, const forecast::DegradationSetting& setting, double threshold,
                                 Scenario scenario);

/// The test of a month as this life has it: condition and resistance are what the test shows.
[[nodiscard]] bench::PlannedTest as_it_comes(bench::PlannedTest test, const ConditionSetting& seal,
                                             const SealLife& life, std::uint64_t life_seed, Scenario scenario);

}  // namespace sealwatch::verification
