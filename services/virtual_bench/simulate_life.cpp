#include "services/virtual_bench/simulate_life.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {

void cut(TimeSeries& samples, double share) {
  const auto kept =
      std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(samples.time_s.size())));
  samples.time_s.resize(kept);
  for (Series& channel : samples.channels) channel.values.resize(kept);
}

Result<std::vector<PlannedTest>> plan_life(const AssetConfig& asset, const LifeSetting& setting) {
  if (!asset.condition)
    return fail(Error{.file = {},
                      .place = "asset " + asset.asset_id + ", key seal",
                      .value = {},
                      .rule = "is needed to simulate a life",
                      .advice = "give resistance_100 and resistance_60"});
  forecast::Degradation seal(sub_seed(setting.seed, "seal"), setting.degradation);
  forecast::UniformRandom dates(sub_seed(setting.seed, "dates")), loads(sub_seed(setting.seed, "loads"));
  forecast::UniformRandom missing(sub_seed(setting.seed, "missing")), cuts(sub_seed(setting.seed, "cuts"));
  std::vector<PlannedTest> tests;
  while (seal.month() < setting.months && seal.condition() > asset.condition->threshold) {
    PlannedTest test;
    test.condition = seal.advance();
    test.month = seal.month();
    // Whole seconds, as a control system would start a test.
    const double scatter_s = std::floor(dates.between(0.0, setting.day_scatter * kSecondsPerDay));
    test.start_time = add_seconds(setting.installed, std::floor(test.month * kSecondsPerMonth) + scatter_s);
    test.resistance_Pa_s_m3 = asset.condition->value(test.condition);
    test.load_factor = loads.between(-setting.load_range, setting.load_range);
    const bool is_cut = cuts.unit() < setting.cut_share;
    const double share = cuts.between(0.1, 0.9);
    test.recorded_share = missing.unit() < setting.missing_share ? 0.0 : is_cut ? share : 1.0;
    test.seed = sub_seed(setting.seed, "noise of month " + std::to_string(test.month));
    tests.push_back(test);
  }
  return tests;
}

Result<Recording> simulate_planned(const AssetConfig& asset, const LifeSetting& life, const PlannedTest& test,
                                   const TestSetting& setting) {
  TestConditions conditions{.parameters = life.parameters, .load_factor = test.load_factor};
  conditions.parameters["R_CL"] = test.resistance_Pa_s_m3;
  TestSetting own = setting;
  own.seed = test.seed;
  Result<Recording> recording = simulate_test(asset, pst_profile(asset.pst), conditions, own);
  if (!recording) return recording;
  recording->recording_id = format_date(test.start_time) + "-PST-" + asset.asset_id;
  recording->start_time = test.start_time;
  if (test.recorded_share < 1.0) cut(recording->samples, test.recorded_share);
  return recording;
}

Result<std::vector<LifeTest>> simulate_life(const AssetConfig& asset, const LifeSetting& life,
                                            const TestSetting& setting) {
  const Result<std::vector<PlannedTest>> plan = plan_life(asset, life);
  if (!plan) return fail(plan.error());
  std::vector<LifeTest> tests;
  for (const PlannedTest& test : *plan) {
    if (test.recorded_share <= 0.0) continue;
    Result<Recording> recording = simulate_planned(asset, life, test, setting);
    if (!recording) return fail(recording.error());
    tests.push_back({.plan = test, .recording = std::move(*recording)});
  }
  return tests;
}

}  // namespace sealwatch::bench
