// The catalogue of laws: every law as one would check a new one. Derivatives against central differences, absent at
// strength zero, proportional to its strengths, finite, well formed, named in docs/laws.md. Energy:
// physics_law_energy_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "sealwatch/model/law_sizes.hpp"
#include "tests/unit/model/physics_law_for_tests.hpp"

namespace sealwatch::law_test {
namespace {

using ::testing::HasSubstr;

/// Two outputs, contribution and rate, of the law as functions of one direction.
std::array<double, 2> values(const LawOutput& output) { return {output.contribution.value, output.rate.value}; }

/// Central differences of two steps, extrapolated (Richardson): the error is of fourth order in the step.
std::array<double, 2> difference(const Law& law, const Point& point, std::size_t direction, double step) {
  const auto slope = [&](double h) {
    Point up = point;
    Point down = point;
    up.direction(direction) += h;
    down.direction(direction) -= h;
    const auto a = values(output_at(law, up));
    const auto b = values(output_at(law, down));
    return std::array{(a[0] - b[0]) / (2.0 * h), (a[1] - b[1]) / (2.0 * h)};
  };
  const auto coarse = slope(step);
  const auto fine = slope(0.5 * step);
  return {(4.0 * fine[0] - coarse[0]) / 3.0, (4.0 * fine[1] - coarse[1]) / 3.0};
}

/// The step in a direction: small beside the value there and, at zero, beside the widths over which laws are rounded.
double step_of(const Law& law, const Point& point, std::size_t direction) {
  constexpr double kStep = 1e-4;
  constexpr double kStepAtZero = 1e-9;
  Point at = point;
  const double size = std::abs(at.direction(direction));
  if (size > 0.0) return kStep * size;
  if (direction < kSiteSignals) return kStepAtZero * signal_scales(law.kind)[direction];
  return kStep *
         (direction == kSiteSignals ? law.hidden->scale : law.parameters[direction - kSiteSignals - 1].start[0]);
}

/// What a bend at zero, as of a |a| (its slope is continuous), leaves in a difference there: a slope of this size.
double slope_left_by_bends(const Law& law, const Point& point, std::size_t direction, std::size_t output) {
  constexpr double kBend = 1e-8;  // a few times the step
  Point at = point;
  if (at.direction(direction) != 0.0 || direction >= kSiteSignals) return 0.0;
  const double scale = signal_scales(law.kind)[direction];
  at.direction(direction) = scale;
  return kBend * std::abs(values(output_at(law, at))[output]) / scale;
}

// Of the extrapolated differences, relative to the slope, beside the cancellation of values over the step.
constexpr double kDifferenceError = 1e-5;
constexpr double kRounding = 1e-13;
constexpr double kNothing = 1e-100;  // the far end of a bell, where differences lose their digits

void expect_slopes(const Law& law, const Point& point) {
  const LawOutput output = output_at(law, point);
  const auto value = values(output);
  for (std::size_t k = 0; k < kSiteSignals + 1 + law.parameters.size(); ++k) {
    if (k == kSiteSignals && !law.hidden) continue;
    const double step = step_of(law, point, k);
    const auto expected = difference(law, point, k, step);
    const std::array slope{output.contribution.derivative[k], output.rate.derivative[k]};
    for (std::size_t m = 0; m < 2; ++m)
      EXPECT_NEAR(slope[m], expected[m],
                  kNothing + kDifferenceError * std::abs(expected[m]) + kRounding * std::abs(value[m]) / step +
                      slope_left_by_bends(law, point, k, m))
          << name_of(law) << (m == 0 ? " contribution" : " rate") << ", direction " << k;
  }
}

TEST(PhysicsLaws, DerivativesAgreeWithDifferences) {
  std::mt19937 random(20310412);
  for (const Law* law : evaluated_laws())
    for (int repeat = 0; repeat < 20; ++repeat) expect_slopes(*law, random_point(*law, random));
}

TEST(PhysicsLaws, DerivativesAgreeWithDifferencesWhereASignalIsZero) {
  std::mt19937 random(3);
  for (const Law* law : evaluated_laws())
    for (std::size_t zero = 0; zero < kSiteSignals; ++zero)
      for (int repeat = 0; repeat < 3; ++repeat) expect_slopes(*law, random_point(*law, random, zero));
}

// A plant that knows of no pressure gives laws a pressure of zero: one that grows with it must not stand in for another.
TEST(PhysicsLaws, OfFrictionUnderPressureAreAbsentWithoutIt) {
  std::mt19937 random(11);
  int asked = 0;
  for (const Law* law : evaluated_laws()) {
    if (law->id != "pressure_dependent_friction" || law->closed_form) continue;
    Point point = random_point(*law, random);
    point.signal[2] = point.signal[3] = 0.0;
    EXPECT_EQ(output_at(*law, point).contribution.value, 0.0) << name_of(*law);
    ++asked;
  }
  EXPECT_GE(asked, 2);
}

TEST(PhysicsLaws, AreAbsentAtStrengthZeroAndProportionalToTheirStrengths) {
  std::mt19937 random(7);
  for (const Law* law : evaluated_laws()) {
    const Point point = random_point(*law, random);
    Point absent = point;
    Point half = point;
    for (std::size_t k = 0; k < law->parameters.size(); ++k) {
      if (!law->parameters[k].strength) continue;
      absent.parameter[k] = 0.0;
      half.parameter[k] *= 0.5;
    }
    const LawOutput whole = output_at(*law, point);
    EXPECT_EQ(output_at(*law, absent).contribution.value, 0.0) << name_of(*law);
    EXPECT_DOUBLE_EQ(output_at(*law, half).contribution.value, 0.5 * whole.contribution.value) << name_of(*law);
    EXPECT_EQ(output_at(*law, half).rate.value, whole.rate.value)
        << name_of(*law) << ": the hidden state knows strength";
    EXPECT_EQ(law->hidden.has_value(), whole.rate.value != 0.0) << name_of(*law);
  }
}

TEST(PhysicsLaws, AreFiniteWithTheirDerivativesForAnySignals) {
  for (const Law* law : evaluated_laws())
    for (const double size : {-1e12, -1e4, -1.0, 0.0, 1.0, 1e4, 1e12})
      for (const double hidden : {-100.0, 0.0, 100.0}) {
        std::mt19937 random(11);
        Point point = random_point(*law, random);
        point.signal.fill(size);
        if (law->hidden) point.hidden = hidden * law->hidden->scale;
        const LawOutput output = output_at(*law, point);
        for (const LawScalar& scalar : {output.contribution, output.rate}) {
          EXPECT_TRUE(std::isfinite(scalar.value)) << name_of(*law) << " at " << size;
          for (const double slope : scalar.derivative)
            EXPECT_TRUE(std::isfinite(slope)) << name_of(*law) << " at " << size;
        }
      }
}

void expect_well_formed(const LawParameter& p, const std::string& law) {
  EXPECT_FALSE(p.name.empty() || p.unit.empty() || p.meaning.empty()) << law;
  EXPECT_LT(p.min, p.max) << law << " " << p.name;
  ASSERT_FALSE(p.start.empty()) << law << " " << p.name;
  for (const double start : p.start) {
    EXPECT_GE(start, p.min) << law << " " << p.name;
    EXPECT_LE(start, p.max) << law << " " << p.name;
  }
  EXPECT_EQ(p.significant > 0.0, p.strength && !law.ends_with("_bias") && law != "sensor_drift")
      << law << " " << p.name;
}

TEST(PhysicsLaws, HaveParametersWithinTheirBoundsAndAtLeastOneStrength) {
  for (const Law& law : all_laws()) {
    const std::string name = name_of(law);
    EXPECT_LE(law.parameters.size(), kLawParameters) << name;
    EXPECT_TRUE(std::ranges::any_of(law.parameters, &LawParameter::strength)) << name;
    EXPECT_FALSE(law.equation.empty() || law.meaning.empty() || law.energy.empty() || law.source.empty()) << name;
    for (const LawParameter& p : law.parameters) expect_well_formed(p, name);
    for (const LawParameter& p : law.parameters)
      EXPECT_THAT(std::string(law.equation), HasSubstr(std::string(p.name))) << name;
    EXPECT_EQ(law.evaluate == nullptr, is_sensor(law.kind) || is_of_recording(law.kind)) << name;
  }
}

TEST(PhysicsLaws, AreFoundByIdAndNamesOfTheirParameters) {
  std::set<std::string> names;
  for (const Law& law : all_laws()) {
    EXPECT_TRUE(names.insert(name_of(law)).second) << name_of(law) << " twice";
    std::vector<std::string> parameters;
    for (const LawParameter& p : law.parameters) parameters.emplace_back(p.name);
    std::ranges::reverse(parameters);  // the order does not matter
    const Result<const Law*> found = find_law(law.id, parameters);
    ASSERT_TRUE(found.has_value()) << name_of(law);
    EXPECT_EQ(*found, &law) << name_of(law) << " has the same id and parameter names as " << name_of(**found);
  }
}

TEST(PhysicsLaws, OfAnUnknownIdOrParameterAreErrorsWithTheNearest) {
  const auto misspelt = find_law("coulomb_frction", {"F_c", "v_s"});
  ASSERT_FALSE(misspelt.has_value());
  EXPECT_THAT(misspelt.error().advice, HasSubstr("coulomb_friction"));
  const auto wrong_names = find_law("coulomb_friction", {"F_c", "speed"});
  ASSERT_FALSE(wrong_names.has_value());
  EXPECT_THAT(wrong_names.error().rule, HasSubstr("F_c, v_s"));
}

TEST(PhysicsLaws, HoldEveryIdThatUsersScriptAgainst) {
  std::set<std::string_view> ids;
  for (const Law& law : all_laws()) ids.insert(law.id);
  for (const std::string_view id : {"driver_dead_time",
                                    "winding_heating",
                                    "shaft_coulomb_friction",
                                    "pressure_dependent_shaft_friction",
                                    "cogging_torque",
                                    "torque_saturation",
                                    "turbulent_pump_slip",
                                    "speed_dependent_pump_slip",
                                    "line_resistance",
                                    "valve_hysteresis",
                                    "hose_compliance",
                                    "external_leakage",
                                    "turbulent_seal_leakage",
                                    "coulomb_friction",
                                    "stribeck_friction",
                                    "pressure_dependent_friction",
                                    "presliding_friction",
                                    "quadratic_drag",
                                    "spring_load",
                                    "position_dependent_load",
                                    "hysteretic_load",
                                    "backlash",
                                    "entrained_air",
                                    "viscosity_warm_up",
                                    "sensor_bias",
                                    "sensor_gain",
                                    "sensor_lag",
                                    "sensor_drift",
                                    "sensor_saturation"})
    EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(PhysicsLaws, StandInTheDocumentation) {
  std::ostringstream overview;
  overview << std::ifstream(SEALWATCH_SOURCE_DIR "/docs/laws.md").rdbuf();
  for (const Law& law : all_laws()) {
    if (law.closed_form) continue;
    EXPECT_NE(overview.str().find("`" + std::string(law.id) + "`"), std::string::npos)
        << "docs/laws.md lacks " << law.id;
  }
}

TEST(LawSizes, EveryPlantGivesThoseOfTheLawsThatFitItsSites) {
  for (const PlantDescription& plant : all_plants()) EXPECT_EQ(missing_law_sizes(plant), "") << plant.name;
}

TEST(LawSizes, NumbersOfALawGrowWithItsUnit) {
  const Law& dry = **find_law("coulomb_friction", {"F_c", "v_s"});
  const LawParameter &force = dry.parameters[0], &speed = dry.parameters[1];
  PlantDescription large;
  large.law_sizes = {{"N", 1000.0}, {"m/s", 10.0}, {"V", 5.0}};
  EXPECT_EQ(law_bounds(large, force).max, 1000.0 * force.max);
  EXPECT_EQ(law_start(large, speed), 10.0 * speed.start.front());
  EXPECT_EQ(significant_size(large, force), 1000.0 * force.significant);
  const Law& dead = **find_law("pump_dead_voltage", {"V_0", "u_0"});
  EXPECT_EQ(roundings_of(large, dead)[0], 5.0 * roundings_of(dead)[0]);
  LawParameter own = force;
  own.own_size = true;
  EXPECT_EQ(law_bounds(large, own).max, force.max) << "a plant's own law has its numbers already";
}

/// In a tank of a few kPa a turbulent leak is one, and a leak by any power has its exponent.
TEST(LawSizes, CornersGoWithTheSizeOfWhatTheyRound) {
  PlantDescription tank;
  tank.law_sizes = {{"Pa", 1e-3}};
  const auto ratio = [&](const Law& law, std::vector<double> parameters) {
    const auto at = [&](double pressure) {
      const std::array<double, kSiteSignals> signals{pressure, 0.0, 0.0, 0.0};
      return law.evaluate(law_input(signals, 0.0, parameters, roundings_of(tank, law))).contribution.value;
    };
    return at(4e3) / at(1e3);
  };
  EXPECT_NEAR(ratio(**find_law("external_leakage", {"G_t"}), {1e-7}), 2.0, 0.01);
  EXPECT_NEAR(ratio(**find_law("external_leakage", {"q_o", "a_o"}), {1e-3, 2.0}), 16.0, 0.5);
  EXPECT_NEAR(ratio(**find_law("external_leakage", {"G_o", "p_o"}), {1e-7, 500.0}), 7.0, 0.01);
}

/// Sizes in a plant's file are orders of magnitude: a friction of 6 times the largest of the catalogue's is still found.
TEST(LawSizes, AStrengthHasRoomWhereAPlantsFileGivesItsSize) {
  const Law& dry = **find_law("coulomb_friction", {"F_c", "v_s"});
  const LawParameter &force = dry.parameters[0], &speed = dry.parameters[1];
  PlantDescription own;
  own.law_sizes = {{"N", 0.1}, {"m/s", 10.0}};
  own.file = "press.yaml";
  EXPECT_GE(law_bounds(own, force).max, 6.0 * 0.1 * force.max);
  EXPECT_EQ(law_bounds(own, force).min, 0.0) << "it still takes energy only";
  EXPECT_EQ(law_bounds(own, speed).max, 10.0 * speed.max) << "a shape has no room";
  const LawParameter& rate = (**find_law("clock_rate", {"c"})).parameters[0];
  EXPECT_EQ(law_bounds(own, rate).max, rate.max) << "a clock that runs six times as fast is none";
}

TEST(LawSizes, TextsOfAPowerLawSayThePlantsReferenceSize) {
  PlantDescription plant;
  plant.law_sizes = {{"m/s", 50.0}};
  const Law& law = **find_law("unlisted", {"k_v", "a_v"});
  EXPECT_EQ(in_sizes_of(plant, law, law.equation), "k_v sgn(v) abs(v / 0.05 m/s)^a_v");
  EXPECT_EQ(in_sizes_of(plant, law, law.parameters[0].meaning), "force at 0.05 m/s");
  EXPECT_EQ(in_sizes_of({}, law, law.parameters[0].meaning), "force at 1 mm/s");
}

}  // namespace
}  // namespace sealwatch::law_test
