// One month's noise does not flap the advice: seeded lives with noisy forecasts.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "services/advisory_generation/advisory_generation.hpp"
#include "tests/unit/layers/advisory_generation/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::advisory_generation {
namespace {

using namespace sealwatch::test;

constexpr double kForecastNoise = 0.10;  // of the remaining life, from month to month, on top of the interval

std::vector<Advisory> advice_for_noisy_life(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kForecastNoise);
  auto tests = life_until(24, 110, 112.0);
  for (TestCase& one : tests)
    if (one.forecast == ForecastState::ok) one.rul_months = std::max(0.1, one.rul_months * (1.0 + noise(random)));
  const Configuration configuration = test::configuration();
  return of_kind<Advisory>(
      run_layer([&] { return AdvisoryGeneration::make(configuration).value(); }, inputs_of(tests)));
}

TEST(Flapping, ActionsOnlyGetMoreUrgentAsTheSealWears) {
  int changes = 0;
  int steps_back = 0;
  constexpr int kLives = 40;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    AdvisoryPriority last = AdvisoryPriority::information;
    AdvisoryAction action = AdvisoryAction::none;
    for (const Advisory& advisory : advice_for_noisy_life(seed)) {
      if (advisory.state == AdvisoryState::superseded) continue;
      changes += advisory.action != action || advisory.priority != last;
      steps_back += advisory.priority < last;
      last = advisory.priority;
      action = advisory.action;
    }
    EXPECT_EQ(action, AdvisoryAction::replace_now) << seed;
  }
  // Four steps are needed: plan, book, book at once, replace. Campaigns a year apart make a level come again now and
  // then.
  EXPECT_LE(changes, 6 * kLives);
  EXPECT_LE(steps_back, kLives);
}

/// Campaigns every other summer: when the probability of failure wavers about its limit, the date steps by two years.
TEST(Flapping, AReplacementOncePlannedIsNotWithdrawn) {
  int withdrawn = 0;
  constexpr int kLives = 40;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    bool planned = false;
    for (const Advisory& advisory : advice_for_noisy_life(seed)) {
      if (advisory.state == AdvisoryState::superseded) continue;
      withdrawn += planned && advisory.action == AdvisoryAction::none;
      planned = advisory.action != AdvisoryAction::none;
    }
  }
  EXPECT_LE(withdrawn, kLives / 20);
}

TEST(Flapping, DatesMoveSeldomAndNeverByLess) {
  std::size_t moves = 0;
  std::size_t advisories = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::optional<std::int64_t> last;
    for (const Advisory& advisory : advice_for_noisy_life(seed)) {
      if (advisory.state == AdvisoryState::superseded || advisory.request_for_work.empty()) continue;
      const RequestForWork& work = advisory.request_for_work.front();
      ++advisories;
      if (last && *last != work.start_before_ns) {
        ++moves;
        EXPECT_GT(std::abs(months_between({*last}, {work.start_before_ns})), Options{}.date_tolerance_months);
      }
      last = work.start_before_ns;
    }
  }
  EXPECT_LT(moves, advisories / 8);  // with the last test's own date it would be every second one
}

TEST(Flapping, OneOutlierForecastChangesNothing) {
  auto tests = life_until(24, 60, 140.0);
  tests[20].rul_months = 15.0;
  const Configuration configuration = test::configuration();
  const auto outputs =
      of_kind<Advisory>(run_layer([&] { return AdvisoryGeneration::make(configuration).value(); }, inputs_of(tests)));
  EXPECT_EQ(outputs.size(), tests.size());  // no superseding at all
  EXPECT_EQ(outputs.back().revision, static_cast<std::int32_t>(tests.size()));
}

}  // namespace
}  // namespace sealwatch::advisory_generation
