// A trace beside a recording: known alterations of real recordings are found with their size, a friction is none of
// them, coloured noise is no difference.
#include "sealwatch/trace/trace_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <random>

#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/trace/smooth_course.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch::trace {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double kPi = 3.14159265358979;

/// A stroke out and back with a rest before, between and after, smooth: the simulation of these tests.
TimeSeries stroke(double duration_s = 30.0, double interval_s = 0.01) {
  TimeSeries out;
  Series position{.name = "position", .unit = "m", .values = {}},
      pressure{.name = "pressure", .unit = "Pa", .values = {}};
  const auto ramp = [](double x) { return x <= 0.0 ? 0.0 : x >= 1.0 ? 1.0 : 0.5 - 0.5 * std::cos(kPi * x); };
  for (int k = 0; k * interval_s < duration_s; ++k) {
    const double t = k * interval_s;
    out.time_s.push_back(t);
    const double out_and_back = ramp((t - 4.0) / 8.0) - ramp((t - 16.0) / 8.0);
    position.values.push_back(0.05 * out_and_back);
    pressure.values.push_back(5e5 + 2e6 * out_and_back + 4e5 * std::sin(0.7 * t) * std::exp(-0.1 * t));
  }
  out.channels = {position, pressure};
  return out;
}

/// Autoregressive noise of a standard deviation on every channel.
TimeSeries noisy(TimeSeries series, double share_of_range, double rho, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (Series& channel : series.channels) {
    const auto [low, high] = std::ranges::minmax(channel.values);
    const double std = share_of_range * (high - low);
    double e = std * normal(random);
    for (double& value : channel.values) {
      value += e;
      e = rho * e + std * std::sqrt(1.0 - rho * rho) * normal(random);
    }
  }
  return series;
}

TraceComparison compare(const TimeSeries& recorded, const TimeSeries& simulated) {
  Result<TraceComparison> result = compare_traces(recorded, simulated, {});
  EXPECT_TRUE(result) << result.error().describe();
  return result ? *result : TraceComparison{};
}

const Alteration& best(const TraceComparison& comparison, std::size_t channel = 0) {
  static const Alteration none;
  return comparison.channels[channel].alterations.empty() ? none : comparison.channels[channel].alterations.front();
}

TimeSeries changed(TimeSeries series, const std::function<double(double, double)>& change) {
  for (std::size_t k = 0; k < series.time_s.size(); ++k)
    series.channels[0].values[k] = change(series.channels[0].values[k], series.time_s[k]);
  return series;
}

// A misspelt output leaves the input alone in both files, which agrees by itself.
TEST(TraceComparison, InputsAloneAgreeWithNothing) {
  const TimeSeries simulated = stroke();
  for (const bool declared : {false, true}) {
    TimeSeries recorded = declared ? noisy(simulated, 0.01, 0.0, 1) : simulated;
    recorded.channels[1].name = "presure";
    Options options;
    if (declared) options.inputs = {"position"};
    const auto compared = compare_traces(recorded, simulated, options);
    ASSERT_FALSE(compared) << declared;
    EXPECT_THAT(compared.error().describe(), ::testing::HasSubstr("only the recording has presure"));
  }
}

// A gain of 10^5 would make metres of bar.
TEST(TraceComparison, OneNameForTwoQuantitiesIsRefused) {
  TimeSeries recorded = stroke();
  recorded.channels[1].unit = "V";
  const auto compared = compare_traces(recorded, stroke(), {});
  ASSERT_FALSE(compared);
  EXPECT_EQ(
      compared.error().describe(),
      "column pressure: 'V': is another quantity than the simulation's Pa; give both the same quantity, or different "
      "names");
  recorded.channels[1].unit = "1";
  EXPECT_TRUE(compare_traces(recorded, stroke(), {})) << "a column without a unit";
}

TEST(Trace, TheSameIsConsistent) {
  const TraceComparison same = compare(stroke(), stroke());
  EXPECT_TRUE(same.consistent);
  EXPECT_EQ(same.motion, "position");
  EXPECT_EQ(same.channels[0].nrmse_percent, 100.0);
}

/// False alarms, counted: noise from white to a correlation time of half a second, 240 comparisons of two channels.
TEST(Trace, ColouredNoiseIsNoDifference) {
  constexpr int kSeeds = 60;
  const TimeSeries simulated = stroke();
  int alarms = 0;
  for (const double rho : {0.0, 0.6, 0.9, 0.98})
    for (unsigned seed = 0; seed < kSeeds; ++seed)
      alarms += compare(noisy(simulated, 0.01, rho, seed + 1000), simulated).consistent ? 0 : 1;
  std::printf("false alarms: %d of %d\n", alarms, 4 * kSeeds);
  EXPECT_LE(alarms, 8) << "1 % is promised; 8 of 240 would be by chance in one of a thousand runs";
}

/// White noise in both, as of two recordings: 0.1 mm, and 40 mbar.
TraceComparison both_noisy(const TimeSeries& recorded, const TimeSeries& simulated, unsigned seed) {
  return compare(noisy(recorded, 0.002, 0.0, seed), noisy(simulated, 0.002, 0.0, seed + 500));
}

// The simulation's own noise is in the difference, and so it may not be in what the difference is held against.
TEST(Trace, NoiseInBothIsNoDifference) {
  constexpr unsigned kSeeds = 60;
  int alarms = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) alarms += both_noisy(stroke(), stroke(), seed).consistent ? 0 : 1;
  std::printf("false alarms: %d of %u\n", alarms, kSeeds);
  EXPECT_LE(alarms, 4) << "1 % is promised; 4 of 60 would be by chance in one of three hundred runs";
}

// A tenth of the noise, seven standard errors. A delay by half a sample, which lessens white noise, is none.
TEST(Trace, ASmallAlterationUnderNoiseInBothIsTold) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const TimeSeries shifted = changed(stroke(), [](double x, double) { return x + 2e-5; });
    const TraceComparison offset = both_noisy(shifted, stroke(), seed);
    ASSERT_THAT(offset.answer, SizeIs(1)) << seed;
    EXPECT_EQ(offset.answer[0].id, "sensor_bias");
    EXPECT_NEAR(offset.answer[0].parameters[0].value, 2e-5, 4.0 * offset.answer[0].parameters[0].std_error);
    EXPECT_GT(offset.answer[0].removed_share, 0.2);
    const TimeSeries longer = changed(stroke(), [](double x, double) { return 1.001 * x; });
    const TraceComparison gain = both_noisy(longer, stroke(), seed);
    ASSERT_FALSE(gain.answer.empty()) << seed;
    EXPECT_EQ(best(gain).id, "sensor_gain") << seed;
    TimeSeries late = stroke();
    for (double& time : late.time_s) time += 0.013;
    late.channels.resize(1);
    TimeSeries beside = stroke();
    beside.channels.resize(1);
    const TraceComparison delayed = both_noisy(late, beside, seed);
    ASSERT_FALSE(delayed.answer.empty()) << seed;
    EXPECT_EQ(best(delayed).id, "sensor_lag");
    EXPECT_NEAR(best(delayed).parameters[0].value, 0.013, 4.0 * best(delayed).parameters[0].std_error);
    EXPECT_LT(best(delayed).parameters[0].std_error, 0.003);
  }
}

// Slopes of slow courses are taken over wide windows, and the wider the more rows there are.
TEST(Trace, WorkGrowsAsTheRowsDo) {
  const auto cpu_s = [](double interval_s) {
    const TimeSeries simulated = stroke(30.0, interval_s);
    const TimeSeries recorded = noisy(changed(simulated, [](double x, double) { return 1.02 * x; }), 0.002, 0.5, 3);
    const std::clock_t begin = std::clock();
    EXPECT_FALSE(compare(recorded, simulated).consistent);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  constexpr double kTimesTheRows = 16.0, kCaches = 1.5;
  const double few = cpu_s(0.01), many = cpu_s(0.01 / kTimesTheRows);
  std::printf("3000 rows: %.3f s, 48000 rows: %.3f s\n", few, many);
  EXPECT_LT(many, kCaches * kTimesTheRows * few);
}

TEST(Trace, AGainIsFoundWithItsSizeAndError) {
  const TimeSeries recorded = noisy(changed(stroke(), [](double x, double) { return 1.02 * x; }), 0.002, 0.8, 1);
  const TraceComparison found = compare(recorded, stroke());
  ASSERT_FALSE(found.consistent);
  EXPECT_FALSE(found.channels[1].differs) << "only the position was altered";
  EXPECT_EQ(best(found).id, "sensor_gain");
  EXPECT_TRUE(best(found).would_do);
  EXPECT_NEAR(best(found).parameters[0].value, 1.02, 4.0 * best(found).parameters[0].std_error);
  EXPECT_LT(best(found).parameters[0].std_error, 0.002);
  EXPECT_GT(best(found).removed_share, 0.95);
  ASSERT_THAT(found.answer, SizeIs(1));
}

TEST(Trace, AnOffsetADelayASignAndAPair) {
  const auto altered = [](const std::function<double(double, double)>& change) {
    return compare(noisy(changed(stroke(), change), 0.002, 0.8, 2), stroke());
  };
  EXPECT_EQ(best(altered([](double x, double) { return x + 0.001; })).id, "sensor_bias");
  EXPECT_EQ(best(altered([](double x, double) { return -x; })).id, "sign");
  EXPECT_EQ(best(altered([](double x, double) { return 1.1 * x - 0.003; })).id, "sensor_gain and sensor_bias");
  TimeSeries late = stroke();
  for (double& time : late.time_s) time += 0.030;
  late.channels.resize(1);
  const TraceComparison delayed = compare(noisy(late, 0.002, 0.8, 3), stroke());
  EXPECT_EQ(best(delayed).id, "sensor_lag");
  EXPECT_NEAR(best(delayed).parameters[0].value, 0.030, 4.0 * best(delayed).parameters[0].std_error);
}

// Of two waves twice their size is an autoregressive noise, and of a wave with a curved sensor no alteration is all.
TEST(Trace, ASignThatIsReversedIsSeenWhateverElseThereIs) {
  TimeSeries waves = stroke();
  for (std::size_t k = 0; k < waves.time_s.size(); ++k) {
    const double t = waves.time_s[k];
    waves.channels[0].values[k] = 0.05 * std::sin(t) + 0.01 * std::sin(2.7 * t);
  }
  const auto recorded = [&](double curved) {
    TimeSeries turned = waves;
    for (double& value : turned.channels[0].values) value = -value - curved * value * value;
    return noisy(turned, 1e-4, 0.0, 9);
  };
  for (const double curved : {0.0, 2.0}) {
    const TraceComparison found = compare(recorded(curved), waves);
    ASSERT_FALSE(found.consistent) << curved;
    EXPECT_TRUE(found.channels[0].differs) << curved;
    EXPECT_TRUE(found.channels[0].sign_reversed) << curved;
    EXPECT_FALSE(found.channels[1].differs) << curved;
    EXPECT_FALSE(found.channels[1].sign_reversed) << curved;
  }
  TimeSeries weaker = waves;
  for (double& value : weaker.channels[0].values) value *= 0.5;
  EXPECT_FALSE(compare(noisy(weaker, 1e-4, 0.0, 10), waves).channels[0].sign_reversed);
}

TEST(Trace, AClockIsOneCauseOfAllChannels) {
  TimeSeries fast = stroke();
  for (double& time : fast.time_s) time *= 1.01;
  const TraceComparison found = compare(noisy(fast, 0.002, 0.8, 4), stroke());
  ASSERT_FALSE(found.consistent);
  ASSERT_THAT(found.answer, SizeIs(1));
  EXPECT_EQ(found.answer[0].id, "clock_rate");
  EXPECT_EQ(found.answer[0].where, "clock");
  EXPECT_NEAR(found.answer[0].parameters[0].value, 1.01, 4.0 * found.answer[0].parameters[0].std_error);
}

// The difference of two sines is one that comes and goes, as smooth noise does; on one clock there is none of it left.
TEST(Trace, AClockIsFoundWhereTheDriveIsASine) {
  const auto sine = [](double clock, unsigned seed) {
    TimeSeries out;
    Series position{.name = "position", .unit = "m", .values = {}};
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1e-5);
    for (int k = 0; k < 2000; ++k) {
      out.time_s.push_back(0.005 * k * clock);
      position.values.push_back(0.03 * std::sin(2.0 * kPi * 0.4 * 0.005 * k) + noise(random));
    }
    out.channels = {position};
    return out;
  };
  for (const double clock : {1.02, 0.98}) {
    const TraceComparison found = compare(sine(clock, 3), sine(1.0, 4));
    ASSERT_FALSE(found.consistent) << clock;
    ASSERT_THAT(found.answer, SizeIs(1));
    EXPECT_EQ(found.answer[0].id, "clock_rate");
    EXPECT_NEAR(found.answer[0].parameters[0].value, clock, 1e-5);
    EXPECT_LT(found.channels[0].p_value, 0.01);
  }
  int alarms = 0;
  for (unsigned seed = 10; seed < 30; ++seed)
    alarms += compare(sine(1.0, seed), sine(1.0, seed + 100)).consistent ? 0 : 1;
  EXPECT_LE(alarms, 1);
}

TEST(Trace, AnInputsDelayMovesAllThatItDrives) {
  TimeSeries late = stroke();
  for (double& time : late.time_s) time += 0.08;
  const TraceComparison found = compare(noisy(late, 0.002, 0.8, 5), stroke());
  ASSERT_THAT(found.answer, SizeIs(1));
  EXPECT_EQ(found.answer[0].id, "input_delay");
  EXPECT_NEAR(found.answer[0].parameters[0].value, 0.08, 4.0 * found.answer[0].parameters[0].std_error);
}

TimeSeries all_changed(TimeSeries series, const std::function<double(double, const Series&)>& change) {
  for (Series& channel : series.channels) {
    const Series before = channel;
    for (double& value : channel.values) value = change(value, before);
  }
  return series;
}

TEST(Trace, AnInputThatIsTurnedRoundMirrorsAllThatItDrives) {
  const auto mirrored = [](double value, const Series& of) { return 2.0 * of.values.front() - value; };
  const TraceComparison found = compare(noisy(all_changed(stroke(), mirrored), 0.002, 0.8, 7), stroke());
  ASSERT_THAT(found.answer, SizeIs(1));
  EXPECT_EQ(found.answer[0].id, "input_sign");
  EXPECT_EQ(found.answer[0].where, "input");
  EXPECT_EQ(found.answer[0].parameters[0].value, -1.0);
}

TEST(Trace, AnOffsetOfTheInputShiftsAllThatItDrives) {
  const auto shifted = [](double value, const Series& of) { return value + (of.name == "position" ? 0.004 : 2e5); };
  const TraceComparison found = compare(noisy(all_changed(stroke(), shifted), 0.002, 0.8, 8), stroke());
  ASSERT_THAT(found.answer, SizeIs(1));
  EXPECT_EQ(found.answer[0].id, "input_bias");
  ASSERT_THAT(found.answer[0].parameters, SizeIs(2));
  EXPECT_EQ(found.answer[0].parameters[0].name, "offset of position");
  EXPECT_NEAR(found.answer[0].parameters[0].value, 0.004, 4.0 * found.answer[0].parameters[0].std_error);
  EXPECT_NEAR(found.answer[0].parameters[1].value, 2e5, 4.0 * found.answer[0].parameters[1].std_error);
}

/// A drive in ramps with corners, as a controller commands it without noise, and a first-order lag behind it, exact.
TimeSeries driven(double interval_s, double clock = 1.0) {
  constexpr double kLag = 0.4, kLength = 30.0;
  const std::vector<std::pair<double, double>> ramps = {{2.0, 4.0},  {5.0, -4.0},  {7.0, -9.0},  {11.0, 9.0},
                                                        {14.0, 5.0}, {15.5, -5.0}, {21.0, -3.0}, {26.0, 3.0}};
  Series drive{.name = "drive", .unit = "V", .values = {}}, speed{.name = "speed", .unit = "m/s", .values = {}};
  TimeSeries out;
  for (int k = 0; k * interval_s <= kLength; ++k) {
    const double t = k * interval_s / clock;
    out.time_s.push_back(k * interval_s);
    double u = 0.0, v = 0.0;
    for (const auto& [begin, slope] : ramps) {
      const double since = std::max(t - begin, 0.0);
      u += slope * since, v += slope * (since - kLag * (1.0 - std::exp(-since / kLag)));
    }
    drive.values.push_back(u), speed.values.push_back(v);
  }
  out.channels = {drive, speed};
  return out;
}

/// Noise on the speed alone, and `drive_std` on the drive.
TimeSeries measured(TimeSeries series, double drive_std, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (double& value : series.channels[0].values) value += drive_std * normal(random);
  for (double& value : series.channels[1].values) value += 0.02 * normal(random);
  return series;
}

TraceComparison compare_driven(const TimeSeries& recorded, const TimeSeries& simulated) {
  Options options;
  options.inputs = {"drive"};
  const auto result = compare_traces(recorded, simulated, options);
  EXPECT_TRUE(result) << result.error().describe();
  return result ? *result : TraceComparison{};
}

// What lies between the simulation's samples is not known: at a corner no course through them finds it.
TEST(Trace, AnInputWithCornersThatIsSampledAtOtherTimesIsTheSame) {
  for (const double interval_s : {0.02, 0.0137, 0.05}) {
    EXPECT_TRUE(compare_driven(measured(driven(interval_s), 0.0, 3), driven(0.01)).consistent) << interval_s;
    EXPECT_TRUE(compare_driven(measured(driven(interval_s), 0.0, 4), driven(0.031)).consistent) << interval_s;
  }
}

TEST(Trace, NoiseOfARecordedInputIsNoDifference) {
  for (const double drive_std : {0.1, 1.0, 5.0}) {
    const TraceComparison found = compare_driven(measured(driven(0.01), drive_std, 5), driven(0.01));
    EXPECT_TRUE(found.consistent) << drive_std;
    EXPECT_NEAR(found.channels[0].noise_std, drive_std, 0.1 * drive_std);
  }
}

TEST(Trace, AClockIsOneCauseOfTheInputToo) {
  for (const double drive_std : {0.0, 0.02}) {
    const TraceComparison found = compare_driven(measured(driven(0.01, 1.02), drive_std, 6), driven(0.01));
    ASSERT_THAT(found.answer, SizeIs(1)) << drive_std;
    EXPECT_EQ(found.answer[0].id, "clock_rate");
    EXPECT_NEAR(found.answer[0].parameters[0].value, 1.02, 1e-4);
  }
}

/// Without the rows that `lost` says.
TimeSeries without(const TimeSeries& series, const std::function<bool(std::size_t)>& lost) {
  TimeSeries out;
  for (const Series& channel : series.channels) out.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (std::size_t k = 0; k < series.time_s.size(); ++k) {
    if (lost(k)) continue;
    out.time_s.push_back(series.time_s[k]);
    for (std::size_t c = 0; c < out.channels.size(); ++c)
      out.channels[c].values.push_back(series.channels[c].values[k]);
  }
  return out;
}

/// A voltage that moves fast, the same in both files: a line across a gap is far from it.
TimeSeries with_drive(TimeSeries series) {
  Series drive{.name = "drive", .unit = "V", .values = {}};
  for (const double t : series.time_s) drive.values.push_back(5.0 * std::sin(3.0 * t + 0.1 * t * t));
  series.channels.push_back(std::move(drive));
  return series;
}

// What lies in a gap is not compared, with lost rows in one place, in many, or in the simulation.
TEST(Trace, LostRowsAreNoDifference) {
  const TimeSeries simulated = with_drive(stroke());
  Options options;
  options.inputs = {"drive"};
  const auto judged = [&](const TimeSeries& recorded, const TimeSeries& beside) {
    const auto result = compare_traces(recorded, beside, options);
    EXPECT_TRUE(result) << result.error().describe();
    return result ? *result : TraceComparison{};
  };
  std::mt19937 random(21);
  std::vector<bool> one_in_ten(simulated.time_s.size());
  for (std::size_t k = 1; k + 1 < one_in_ten.size(); ++k) one_in_ten[k] = random() % 10 == 0;
  const auto in_one_place = [](std::size_t k) { return k > 700 && k < 1300; };
  const auto in_many = [&](std::size_t k) { return one_in_ten[k]; };
  for (const double rho : {0.0, 0.8}) {
    TimeSeries recorded = noisy(stroke(), 0.005, rho, 31);
    recorded = with_drive(recorded);
    EXPECT_TRUE(judged(without(recorded, in_one_place), simulated).consistent) << rho;
    EXPECT_TRUE(judged(without(recorded, in_many), simulated).consistent) << rho;
    const TraceComparison beside = judged(recorded, without(simulated, in_one_place));
    EXPECT_TRUE(beside.consistent) << rho;
    EXPECT_THAT(beside.remarks, ::testing::ElementsAre("599 of 3000 samples lie in gaps and are not compared"));
  }
}

TEST(Trace, BesideLostRowsAnAlterationIsFound) {
  const TimeSeries simulated = with_drive(stroke());
  Options options;
  options.inputs = {"drive"};
  TimeSeries recorded = noisy(changed(stroke(), [](double x, double) { return 1.02 * x; }), 0.002, 0.8, 33);
  recorded = without(with_drive(recorded), [](std::size_t k) { return k > 700 && k < 1300; });
  const auto found = compare_traces(recorded, simulated, options);
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_THAT(found->answer, SizeIs(1));
  EXPECT_EQ(found->answer[0].id, "sensor_gain");
  EXPECT_NEAR(found->answer[0].parameters[0].value, 1.02, 4.0 * found->answer[0].parameters[0].std_error);
}

// A gain of 0 would make every simulation every dead channel.
TEST(Trace, ADeadChannelIsExplainedByNothing) {
  for (const double value : {0.0, 0.02}) {
    for (const double noise : {0.0, 1e-5}) {
      TimeSeries dead = changed(stroke(), [value](double, double) { return value; });
      std::mt19937 random(11);
      std::normal_distribution<double> normal;
      for (double& sample : dead.channels[0].values) sample += noise * normal(random);
      const TraceComparison found = compare(dead, stroke());
      ASSERT_FALSE(found.consistent);
      EXPECT_TRUE(found.channels[0].stands_still) << value << " with noise " << noise;
      EXPECT_TRUE(found.channels[0].alterations.empty());
      EXPECT_FALSE(found.channels[1].stands_still);
      EXPECT_TRUE(found.answer.empty() && found.equally.empty());
      EXPECT_TRUE(std::ranges::none_of(found.common, &Alteration::would_do));
    }
  }
}

// With one output that the input drives, late is late: no trace tells the sensor's delay from the input's.
TEST(Trace, WhatWouldDoAsWellIsNamed) {
  TimeSeries late = stroke();
  for (double& time : late.time_s) time += 0.05;
  late = noisy(late, 0.002, 0.8, 12);
  TimeSeries recorded = stroke();
  const Course between(late.time_s, late.channels[0].values);
  for (std::size_t k = 0; k < recorded.time_s.size(); ++k)
    recorded.channels[0].values[k] = between.at(recorded.time_s[k]).first;
  Options options;
  options.inputs = {"pressure"};
  const auto found = compare_traces(recorded, stroke(), options);
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_THAT(found->answer, SizeIs(1));
  EXPECT_EQ(found->answer[0].id, "sensor_lag");
  ASSERT_THAT(found->equally, SizeIs(1));
  EXPECT_EQ(found->equally[0].id, "input_delay");
  EXPECT_NEAR(found->equally[0].parameters.at(0).value, 0.05, 4.0 * found->equally[0].parameters.at(0).std_error);
}

TEST(Trace, AFrictionIsNoneOfThese) {
  TimeSeries recorded = stroke();
  for (std::size_t k = 1; k + 1 < recorded.time_s.size(); ++k) {
    const double way = recorded.channels[0].values[k + 1] - recorded.channels[0].values[k - 1];
    recorded.channels[1].values[k] += way > 1e-9 ? 1.5e5 : way < -1e-9 ? -1.5e5 : 0.0;
  }
  const TraceComparison found = compare(noisy(recorded, 0.005, 0.8, 6), stroke());
  ASSERT_FALSE(found.consistent);
  EXPECT_FALSE(found.channels[0].differs);
  EXPECT_FALSE(best(found, 1).would_do) << best(found, 1).id;
  EXPECT_TRUE(found.answer.empty());
  EXPECT_THAT(found.channels[1].by, ::testing::Contains("a mean that differs with motion or level"));
}

TEST(Trace, WhatCannotBeComparedIsSaid) {
  TimeSeries other = stroke();
  other.channels[0].name = "x", other.channels[1].name = "p";
  const std::string no_channel = compare_traces(stroke(), other, {}).error().describe();
  EXPECT_THAT(no_channel, HasSubstr("the files share no channel: the recording has "));
  EXPECT_THAT(no_channel, HasSubstr("the simulation x, p"));
  EXPECT_THAT(no_channel, HasSubstr("--map"));
  TimeSeries later = stroke();
  for (double& time : later.time_s) time += 28.0;
  EXPECT_THAT(compare_traces(stroke(), later, {}).error().describe(), HasSubstr("less than a quarter"));
  EXPECT_THAT(compare_traces(stroke(0.5), stroke(), {}).error().describe(), HasSubstr("too few samples"));
}

/// Real recordings with the same alterations made by hand: the answer is the alteration, with its size.
class RealRecording : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  void SetUp() override {
    const auto [file, plant] = GetParam();
    const std::filesystem::path path = std::filesystem::path(SEALWATCH_SHARED_DATA) / file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Result<Recording> read = read_recording(path.string(), **find_plant(plant));
    ASSERT_TRUE(read) << read.error().describe();
    for (const Series& channel : read->samples.channels)
      if (channel.name == "position" || channel.name == "pressure_a" || channel.name == "level_voltage")
        recorded_.channels.push_back(channel);
    recorded_.time_s = read->samples.time_s;
  }
  TimeSeries recorded_;
};

TEST_P(RealRecording, KnownAlterationsAreTheAnswer) {
  const auto answer = [&](const TimeSeries& altered) {
    const TraceComparison found = compare(altered, recorded_);
    EXPECT_FALSE(found.consistent);
    return found.answer.empty() ? Alteration{} : found.answer.front();
  };
  const Alteration gain = answer(changed(recorded_, [](double x, double) { return 1.02 * x; }));
  EXPECT_EQ(gain.id, "sensor_gain");
  EXPECT_NEAR(gain.parameters.at(0).value, 1.02, 1e-4);
  EXPECT_EQ(answer(changed(recorded_, [](double x, double) { return -x; })).id, "sign");
  TimeSeries fast = recorded_;
  for (double& time : fast.time_s) time *= 1.01;
  const Alteration clock = answer(fast);
  EXPECT_EQ(clock.id, "clock_rate");
  ASSERT_FALSE(clock.parameters.empty());
  EXPECT_NEAR(clock.parameters[0].value, 1.01, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Shared, RealRecording,
                         ::testing::Values(std::pair{"bench_cases/consistent/fit_0.csv", "eha"},
                                           std::pair{"bench_eha/oct21_load2_stroke3.csv", "eha_switched"}),
                         [](const auto& recording) { return std::string(recording.param.second); });

}  // namespace
}  // namespace sealwatch::trace
