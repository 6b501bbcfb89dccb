// Threads, shards, interruptions and damaged files change no byte of the records.
#include "services/verification/lives/run_lives.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/verification/actuator.hpp"

namespace sealwatch::verification {
namespace {

namespace fs = std::filesystem;

class RunLives : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sealwatch_verification_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static VerificationSetting setting() {
    return {.asset = testing::actuator(),
            .lives = 6,
            .months = 48,
            .forecasters = {{.method = "ols", .window_months = 24}, {.method = "state_space", .window_months = 240}}};
  }
  static LifeSimulator simulator() { return LifeSimulator::make(setting()).value(); }
  [[nodiscard]] LifeStore store(const std::string& name, bool resume = false) const {
    return LifeStore::create((folder_ / name).string(), describe(setting()), resume).value();
  }
  static RunOutcome run(const LifeStore& store, const Shard& shard, int threads, std::size_t stop_after = 1000) {
    std::size_t steps = 0;
    return run_lives(simulator(), store, lives_of(shard, setting().lives), threads,
                     [&](std::size_t) { return ++steps < stop_after; })
        .value();
  }
  static std::vector<LifeRecord> all(const LifeCollection& lives) {
    std::vector<LifeRecord> records;
    for (std::uint32_t k = 0; k < lives.size(); ++k) records.push_back(lives.read(k).value());
    return records;
  }
  [[nodiscard]] std::vector<LifeRecord> whole_run() const {
    const LifeStore whole = store("whole");
    run(whole, {}, 1);
    return all(LifeCollection::make({whole}).value());
  }

  fs::path folder_;
};

TEST_F(RunLives, ThreadsChangeNothing) {
  const LifeStore three = store("three");
  EXPECT_EQ(run(three, {}, 3).simulated, 6U);
  EXPECT_EQ(all(LifeCollection::make({three}).value()), whole_run());
}

TEST_F(RunLives, ShardsPutTogetherAreTheWhole) {
  const LifeStore first = store("first"), second = store("second");
  EXPECT_EQ(run(first, {1, 2}, 1).simulated, 3U);
  EXPECT_EQ(run(second, {2, 2}, 1).simulated, 3U);
  EXPECT_EQ(all(LifeCollection::make({second, first}).value()), whole_run());
  EXPECT_TRUE(LifeCollection::make({first, second, first}));  // the same shard twice is no harm
  const auto half = LifeCollection::make({first});
  ASSERT_FALSE(half);
  EXPECT_NE(half.error().describe().find("3 of 6 lives are missing, the first is number 1"), std::string::npos);
}

TEST_F(RunLives, GoesOnWhereItWasInterrupted) {
  const LifeStore begun = store("begun");
  const RunOutcome outcome = run(begun, {}, 1, 2);
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_EQ(outcome.simulated, 2U);
  EXPECT_FALSE(LifeStore::create(begun.folder(), describe(setting()), false));  // without --resume
  std::ofstream((fs::path(begun.folder()) / "lives" / "000000.life").string(), std::ios::app) << "damage";
  const RunOutcome rest = run(store("begun", true), {}, 2);
  EXPECT_EQ(rest.found_before, 1U);
  EXPECT_EQ(rest.simulated, 5U);
  EXPECT_EQ(all(LifeCollection::make({begun}).value()), whole_run());
}

TEST_F(RunLives, RefusesToMixRuns) {
  const LifeStore begun = store("begun");
  run(begun, {1, 2}, 1);
  VerificationSetting other = setting();
  other.seed = 2;
  const auto resumed = LifeStore::create(begun.folder(), describe(other), true);
  ASSERT_FALSE(resumed);
  EXPECT_NE(resumed.error().describe().find("'seed = 1' against 'seed = 2'"), std::string::npos);
  const LifeStore foreign = LifeStore::create((folder_ / "foreign").string(), describe(other), false).value();
  const auto merged = LifeCollection::make({begun, foreign});
  ASSERT_FALSE(merged);
  EXPECT_NE(merged.error().describe().find("another run"), std::string::npos);
  EXPECT_FALSE(LifeCollection::make({}));
  EXPECT_FALSE(LifeStore::open((folder_ / "nowhere").string()));
}

TEST_F(RunLives, OtherLivesAreOtherLives) {
  const LifeSimulator lives = simulator();
  EXPECT_NE(lives.run(0)->end_of_life_months, lives.run(1)->end_of_life_months);
  VerificationSetting other = setting();
  other.seed = 2;
  EXPECT_NE(LifeSimulator::make(other)->run(0)->end_of_life_months, lives.run(0)->end_of_life_months);
  const LifeRecord life = lives.run(0).value();
  EXPECT_TRUE(life.censored);  // four years of service
  EXPECT_EQ(life.tests.size(), 48U);
  EXPECT_EQ(life.answers.size(), 3U);  // the oracle is the last
  EXPECT_EQ(life.answers[0][10].state, ForecastState::insufficient_history);
  EXPECT_EQ(life.answers[2][10].state, ForecastState::ok);
}

TEST_F(RunLives, EveryTruthTellsTheSameStory) {
  VerificationSetting short_life = setting();
  short_life.months = 13;
  std::vector<LifeRecord> records;
  for (const TruthKind truth : {TruthKind::circuit, TruthKind::actuator, TruthKind::condition}) {
    short_life.truth = truth;
    records.push_back(LifeSimulator::make(short_life)->run(3).value());
  }
  for (const LifeRecord& record : records) {
    EXPECT_EQ(record.end_of_life_months, records[0].end_of_life_months);
    ASSERT_EQ(record.tests.size(), 13U);
    for (std::size_t k = 0; k < record.tests.size(); ++k) {
      EXPECT_EQ(record.tests[k].condition, records[0].tests[k].condition);
      EXPECT_NEAR(record.tests[k].estimate, record.tests[k].condition, 5.0 * record.tests[k].estimate_std);
      // The estimator says the same of itself on the cheap truth, the bench, and where no test is simulated.
      EXPECT_NEAR(record.tests[k].estimate_std, records[0].tests[k].estimate_std,
                  0.15 * records[0].tests[k].estimate_std);
    }
  }
  short_life.truth = TruthKind::circuit;
  short_life.through_layers = true;
  const LifeRecord layered = LifeSimulator::make(short_life)->run(3).value();
  for (std::size_t k = 0; k < layered.tests.size(); ++k)
    EXPECT_NEAR(layered.tests[k].estimate, records[0].tests[k].estimate, 1e-6 * layered.tests[k].estimate_std);
}

TEST_F(RunLives, MissingAndCutTestsAreNoEstimates) {
  VerificationSetting gaps = setting();
  gaps.missing_share = 0.3;
  gaps.cut_share = 0.3;
  const LifeRecord life = LifeSimulator::make(gaps)->run(0).value();
  EXPECT_LT(life.tests.size(), 48U);
  EXPECT_GT(life.tests.size(), 20U);
  for (const RecordedTest& test : life.tests) {
    if (!test.usable) continue;
    EXPECT_NEAR(test.estimate, test.condition, 6.0 * test.estimate_std);
  }
}

TEST(Shard, IsAPartOfAWhole) {
  EXPECT_EQ(lives_of(shard_named("2/3").value(), 8), (std::vector<std::uint32_t>{1, 4, 7}));
  EXPECT_EQ(lives_of(shard_named("1/1").value(), 3), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(lives_of(shard_named("9/9").value(), 8).empty());
  for (const char* bad : {"3/2", "0/2", "1/0", "1", "", "/", "a/b", "1/2/3", "-1/2", "1.5/2", "9999999/9999999"})
    EXPECT_FALSE(shard_named(bad)) << bad;
}

TEST(Setting, BadInputIsNamed) {
  VerificationSetting good{.asset = testing::actuator(), .forecasters = {{.method = "ols", .window_months = 24}}};
  ASSERT_TRUE(validate(good));
  const auto bad = [&good](auto change) {
    VerificationSetting setting = good;
    change(setting);
    const auto made = LifeSimulator::make(setting);
    return made ? std::string() : made.error().describe();
  };
  EXPECT_NE(bad([](auto& s) { s.lives = 0; }).find("an empty fleet"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.months = 0; }).find("months"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.forecasters.clear(); }).find("forecaster"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.forecasters.push_back(s.forecasters[0]); }).find("twice"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.asset.condition.reset(); }).find("seal"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.asset.model = "emps"; }).find("emps"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.degradation.n_0 = 0.0; }).find("n_0"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.degradation.irregularity = {0.1, -0.1}; }).find("irregularity"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.sample_rate_Hz = 0.0; }).find("sample rate"), std::string::npos);
  EXPECT_NE(bad([](auto& s) { s.missing_share = 1.0; }).find("missing"), std::string::npos);
}

TEST(Setting, NamesAreUnderstoodOrRefused) {
  EXPECT_EQ(forecaster_named("ols:24")->window_months, 24);
  EXPECT_EQ(forecaster_named("state_space")->window_months, 240);
  for (const char* bad : {"olss", "ols:", "ols:x", "ols:-3", "ols:9999", ""})
    EXPECT_FALSE(forecaster_named(bad)) << bad;
  forecast::DegradationSetting degradation;
  EXPECT_TRUE(set_constant(degradation, "irregularity_max=0.3"));
  EXPECT_EQ(degradation.irregularity.max, 0.3);
  EXPECT_TRUE(set_constant(degradation, "published_t"));
  EXPECT_EQ(degradation.n_0, published_t().n_0);
  for (const char* bad : {"n0=3", "n_0", "n_0=", "n_0=abc", "n_0=nan", ""})
    EXPECT_FALSE(set_constant(degradation, bad)) << bad;
  EXPECT_FALSE(truth_named("circus"));
  for (const auto& forecaster : all_forecasters())
    EXPECT_TRUE(forecast::make_forecaster(forecaster)) << forecaster.method;
}

}  // namespace
}  // namespace sealwatch::verification
