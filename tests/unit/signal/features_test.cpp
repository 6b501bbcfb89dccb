#include "sealwatch/signal/features.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "sealwatch/signal/test_record.hpp"
#include "tests/unit/signal/synthetic_pst.hpp"

namespace sealwatch::signal {
namespace {

using sealwatch::test::only;
using sealwatch::test::SyntheticPst;

Cylinder cylinder_of(const SyntheticPst& pst) {
  return {.area_a_m2 = pst.area_m2,
          .area_ratio = 1.0,
          .dead_volume_m3 = pst.dead_volume_m3,
          .bulk_modulus_Pa = pst.bulk_modulus_Pa,
          .displacement_m3_rad = pst.displacement_m3_rad,
          .stroke_m = 0.08};
}

std::map<std::string, Feature> features_of(const SyntheticPst& pst, const TimeSeries& samples) {
  std::map<std::string, Feature> result;
  const TestRecord record(samples, cylinder_of(pst), plant_or_default({}));
  for (const Feature& feature : compute_features(record)) result[feature.name] = feature;
  return result;
}

MotionKind kind_at(const TestRecord& record, double time_s) {
  for (const MotionPhase& phase : record.phases())
    if (time_s >= phase.begin_s && time_s < phase.end_s) return phase.kind;
  return MotionKind::rest;
}

TEST(Phases, FollowTheStrokes) {
  for (const double rate_Hz : {50.0, 200.0}) {
    for (const double stroke_m : {-0.016, 0.016}) {
      const SyntheticPst pst{.rate_Hz = rate_Hz, .stroke_m = stroke_m};
      const TimeSeries samples = pst.record();
      const TestRecord record(samples, cylinder_of(pst), plant_or_default({}));
      ASSERT_EQ(record.phases().size(), 6U) << rate_Hz << " Hz";
      const MotionKind expected[] = {MotionKind::rest, MotionKind::breakaway, MotionKind::out,
                                     MotionKind::hold, MotionKind::back,      MotionKind::hold};
      for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(record.phases()[i].kind, expected[i]) << i;
      // The smoothing reaches 0.15 s, a ramp of 0.6 s passes the thresholds of 5 and 10 % within 0.15 s.
      EXPECT_NEAR(record.phases()[1].begin_s, pst.out_begin_s(), 0.2);
      EXPECT_NEAR(record.phases()[2].begin_s, pst.out_begin_s() + 0.5 * pst.ramp_s, 0.05);  // half the speed
      EXPECT_NEAR(record.phases()[3].begin_s, pst.hold_begin_s(), 0.2);
      EXPECT_NEAR(record.phases()[4].begin_s, pst.back_begin_s(), 0.2);
      EXPECT_NEAR(record.phases()[5].begin_s, pst.back_end_s(), 0.2);
      for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(record.phases()[i].begin_s, record.phases()[i - 1].end_s);
    }
  }
}

TEST(Phases, OfACutTestEndWhereItWasCut) {
  const SyntheticPst pst{.duration_s = 7.4};
  const TimeSeries samples = pst.record();
  const TestRecord record(samples, cylinder_of(pst), plant_or_default({}));
  ASSERT_EQ(record.phases().size(), 3U);
  EXPECT_EQ(record.phases().back().kind, MotionKind::out);
  const auto features = features_of(pst, samples);
  EXPECT_FALSE(features.contains("stroke_time_out"));
  EXPECT_FALSE(features.contains("running_pressure_back"));
  EXPECT_TRUE(features.contains("running_pressure_out"));
}

TEST(Phases, AreAbsentWhereThePistonStands) {
  const SyntheticPst pst{.stroke_m = 1e-9};
  const TimeSeries samples = pst.record();
  EXPECT_TRUE(TestRecord(samples, cylinder_of(pst), plant_or_default({})).phases().empty());
}

TEST(Phases, OfTheSourcesChannelSetAreTheSame) {
  const SyntheticPst pst;
  const TimeSeries samples = pst.record();
  TimeSeries source = only(samples, {"flow", "position", "velocity"});
  Series differential{"pressure_differential", "Pa", 1.4e4, samples.find("pressure_a")->values};
  for (std::size_t i = 0; i < differential.values.size(); ++i)
    differential.values[i] -= samples.find("pressure_b")->values[i];
  source.channels.push_back(differential);
  const TestRecord all(samples, cylinder_of(pst), plant_or_default({}));
  const TestRecord few(source, cylinder_of(pst), plant_or_default({}));
  for (const double time_s : {0.5, 5.0, 15.0, 22.0, 30.5}) EXPECT_EQ(kind_at(few, time_s), kind_at(all, time_s));
  const TimeSeries velocity_alone = only(samples, {"velocity"});
  EXPECT_EQ(TestRecord(velocity_alone, cylinder_of(pst), plant_or_default({})).phases().size(), 6U);
}

/// What the synthetic test must give. Systematic errors of the smoothing are allowed for by `least`.
struct Expected {
  const char* name;
  double value;
  double least;
};

std::vector<Expected> expected_features(const SyntheticPst& pst) {
  const double running_s = std::abs(pst.stroke_m) / pst.speed_m_s;
  const double load_Pa = pst.load_N / pst.area_m2;
  const double friction_Pa = pst.friction_N_s_m * pst.speed_m_s / pst.area_m2;
  const double sign = pst.stroke_m > 0.0 ? 1.0 : -1.0;
  return {
      {"travel", std::abs(pst.stroke_m), 1e-5},
      {"return_error", 0.0, 1e-6},
      // Speed ramps lie within the 5 % at either end: the rest runs at full speed.
      {"stroke_time_out", 0.9 * running_s, 0.01},
      {"stroke_time_back", 0.9 * running_s, 0.01},
      {"speed_out", pst.speed_m_s, 1e-7},
      {"speed_back", pst.speed_m_s, 1e-7},
      {"rest_pressure", load_Pa, 1e2},
      {"running_pressure_out", load_Pa + sign * friction_Pa, 1e2},
      {"running_pressure_back", load_Pa - sign * friction_Pa, 1e2},
      {"friction_pressure", friction_Pa, 1e2},
      {"hold_pressure", load_Pa, 1e2},
      {"hold_decay", 0.0, 1e2},
      {"leakage_flow", load_Pa / pst.resistance_Pa_s_m3, 2e-9},
      {"leakage_flow_rest", load_Pa / pst.resistance_Pa_s_m3, 2e-9},
      {"leakage_flow_hold", load_Pa / pst.resistance_Pa_s_m3, 2e-9},
      {"leakage_flow_out", (load_Pa + sign * friction_Pa) / pst.resistance_Pa_s_m3, 1e-10},
      {"leakage_flow_back", (load_Pa - sign * friction_Pa) / pst.resistance_Pa_s_m3, 1e-10},
      {"leakage_resistance", pst.resistance_Pa_s_m3, 1e-3 * pst.resistance_Pa_s_m3},
      {"peak_current", 2.0, 0.02},  // the largest of some noise
      {"running_current_out", 1.0 + sign, 1e-3},
      {"running_current_back", 1.0 - sign, 1e-3},
      {"running_shaft_speed_out", sign * pst.area_m2 * pst.speed_m_s / pst.displacement_m3_rad, 0.02},
      {"running_voltage_out", 0.2 * sign * pst.area_m2 * pst.speed_m_s / pst.displacement_m3_rad, 1e-3},
      {"volumetric_efficiency_out", 1.0, 1e-4},
      {"volumetric_efficiency_back", 1.0, 1e-4},
      {"drive_saturation", 0.0, 1e-12},
  };
}

TEST(Features, AreRightWithinTheirErrors) {
  for (const double stroke_m : {-0.016, 0.016}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const SyntheticPst pst{.seed = seed, .start_m = 0.040, .stroke_m = stroke_m, .resistance_Pa_s_m3 = 1e13};
      const auto features = features_of(pst, pst.record());
      for (const Expected& expected : expected_features(pst)) {
        ASSERT_TRUE(features.contains(expected.name)) << expected.name;
        const Feature& feature = features.at(expected.name);
        // 26 features of 6 tests: one in 10^4 of Gaussian ones lies beyond 4 standard errors.
        EXPECT_NEAR(feature.value, expected.value, expected.least + 4.0 * feature.std_error) << expected.name;
        EXPECT_LT(feature.std_error, 0.05 * std::abs(expected.value) + 4.0 * expected.least + 1e-9 * feature.value +
                                         (std::string(expected.name) == "hold_decay" ? 5e3 : 0.0))
            << expected.name;
      }
    }
  }
}

TEST(Features, BreakawayPressureSeesAPeak) {
  const SyntheticPst pst{.noise = 0.2};
  TimeSeries samples = pst.record();
  for (Series& channel : samples.channels) {
    if (channel.name != "pressure_a") continue;
    for (std::size_t i = 0; i < samples.time_s.size(); ++i) {
      const double t = samples.time_s[i] - pst.out_begin_s();
      channel.values[i] -= 1.5e6 * std::exp(-0.5 * t * t / 0.01);  // stiction: 1.5 MPa for 0.1 s, towards -x
    }
  }
  const auto features = features_of(pst, samples);
  // The low-pass at 5 Hz takes some of a peak of 0.1 s standard deviation, viscous friction adds some.
  EXPECT_NEAR(features.at("breakaway_pressure").value, 1.4e6, 0.15e6);
  EXPECT_GT(features.at("breakaway_pressure").value, 2.0 * features.at("friction_pressure").value);
}

TEST(Features, HoldDecayIsTheRateOfTheFall) {
  const SyntheticPst pst;
  TimeSeries samples = pst.record();
  for (Series& channel : samples.channels)
    if (channel.name == "pressure_a")
      for (std::size_t i = 0; i < samples.time_s.size(); ++i)
        channel.values[i] -= 5e4 * std::max(0.0, samples.time_s[i] - pst.hold_begin_s());
  const Feature decay = features_of(pst, samples).at("hold_decay");
  EXPECT_NEAR(decay.value, 5e4, 4.0 * decay.std_error);
  EXPECT_LT(decay.std_error, 2e3);
}

TEST(Features, SaturationIsAStandingExtreme) {
  const SyntheticPst pst;
  TimeSeries samples = pst.record();
  for (Series& channel : samples.channels)
    if (channel.name == "motor_voltage")
      for (double& value : channel.values) value = std::clamp(value, -20.0, 60.0);
  const auto features = features_of(pst, samples);
  const double out_s = pst.stroke_time_s();
  EXPECT_EQ(features.at("drive_saturation").value, 0.0) << "the way back goes higher";
  for (Series& channel : samples.channels)
    if (channel.name == "motor_voltage")
      for (double& value : channel.values) value = std::clamp(value, -20.0, 20.0);
  // Both strokes but for their ramps.
  EXPECT_NEAR(features_of(pst, samples).at("drive_saturation").value, 2.0 * out_s / pst.duration_s, 0.05);
}

TEST(Features, WhatCannotBeHadIsAbsent) {
  const SyntheticPst pst;
  const auto features = features_of(pst, only(pst.record(), {"position"}));
  EXPECT_TRUE(features.contains("stroke_time_out"));
  for (const char* name : {"leakage_flow", "rest_pressure", "peak_current", "drive_saturation"})
    EXPECT_FALSE(features.contains(name)) << name;
}

TEST(Features, TableNamesEachOnce) {
  std::set<std::string_view> names;
  for (const FeatureDescription& feature : kFeatures) {
    EXPECT_TRUE(names.insert(feature.name).second) << feature.name;
    EXPECT_FALSE(feature.unit.empty());
    EXPECT_EQ(find_feature(feature.name), &feature);
  }
  EXPECT_EQ(find_feature("no_such_feature"), nullptr);
}

/// Whatever a window holds, its phases and features end. Who takes samples in marks such values (core/test_limits.hpp);
/// these loops do not rely on it.
TEST(Features, OfWildNumbersEnd) {
  const SyntheticPst pst;
  for (const double wild :
       {1e308, -1e308, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 5e-324}) {
    for (const char* channel : {"position", "velocity", "motor_voltage", "pressure_a", "flow"}) {
      TimeSeries samples = pst.record();
      for (Series& series : samples.channels)
        if (series.name == channel) series.values[0] = series.values[700] = series.values[701] = wild;
      for (const auto& [name, feature] : features_of(pst, samples)) {
        EXPECT_TRUE(std::isfinite(feature.value)) << name;
        EXPECT_TRUE(std::isfinite(feature.std_error)) << name;
      }
    }
  }
}

}  // namespace
}  // namespace sealwatch::signal
