// No law is a source of energy: each keeps the condition that it states, alone or over a closed path, and laws with
// memory do what their meaning says. A new law is named here with its condition.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/unit/model/physics_law_for_tests.hpp"

namespace sealwatch::law_test {
namespace {

/// Laws without memory that dissipate: the signal s with contribution * s >= 0 for any signals.
const std::map<std::string, std::size_t> kDissipate = {
    {"coulomb_friction", 0},
    {"coulomb_friction (rounded)", 0},
    {"stribeck_friction", 0},
    {"pressure_dependent_friction (sum)", 0},
    {"pressure_dependent_friction (difference)", 0},
    {"pressure_dependent_friction (sum_rounded)", 0},
    {"pressure_dependent_friction (difference_rounded)", 0},
    {"quadratic_drag", 0},
    {"shaft_coulomb_friction", 0},
    {"shaft_coulomb_friction (rounded)", 0},
    {"pressure_dependent_shaft_friction", 0},
    {"torque_saturation (knee)", 2},
    {"torque_saturation (cubic)", 2},
    {"torque_saturation (power)", 2},
    {"torque_saturation (froehlich)", 2},
    {"driver_dead_time (voltage_loss)", 0},
    {"driver_dead_time (dead_zone)", 1},
    {"driver_dead_time (delay)", 2},
    {"driver_saturation", 1},
    {"turbulent_pump_slip", 0},
    {"speed_dependent_pump_slip (rising)", 0},
    {"speed_dependent_pump_slip (falling)", 0},
    {"speed_dependent_pump_slip (fading)", 0},
    {"speed_dependent_pump_slip (drag)", 1},
    {"speed_dependent_pump_slip (filling)", 1},
    {"turbulent_seal_leakage", 0},
    {"external_leakage (laminar)", 0},
    {"external_leakage (turbulent)", 0},
    {"linear_outflow", 0},
    {"unlisted (speed_power)", 0},
    {"unlisted (directional_friction)", 0},
    {"pressure_dependent_friction (power)", 0},
    {"unlisted (tight_spot)", 0},
    {"unlisted (position_drag)", 0},
    {"pressure_dependent_friction (drag)", 0},
    {"unlisted (leakage_power)", 0},
    {"unlisted (leakage_opening)", 0},
    {"unlisted (slip_opening)", 0},
    {"external_leakage (opening)", 0},
    {"unlisted (local_leakage)", 0},
    {"unlisted (moving_leakage)", 0},
    {"unlisted (slip_power)", 0},
    {"speed_dependent_pump_slip (power)", 0},
    {"unlisted (torque_power)", 0},
    {"pressure_dependent_shaft_friction (power)", 0},
    {"unlisted (resistance_power)", 0},
    {"unlisted (command_power)", 1},
    {"external_leakage (power)", 0},
};

/// Laws without memory whose contribution has one sign: +1 or -1, for levels that are positive.
const std::map<std::string, double> kOneSign = {
    {"hose_compliance (constant)", 1.0}, {"hose_compliance (stiffening)", 1.0}, {"entrained_air (isothermal)", 1.0},
    {"entrained_air (polytropic)", 1.0}, {"entrained_air (dissolving)", 1.0},   {"tank_overflow", 1.0},
    {"outflow_exponent", 1.0},           {"outlet_level_offset", 1.0},          {"pump_dead_voltage", 1.0},
    {"hose_compliance (power)", 1.0},
};

/// Forces of position alone: the same work both ways, whatever their sign.
const std::set<std::string> kOfPositionAlone = {"spring_load",
                                                "spring_load (power)",
                                                "position_dependent_load (bump)",
                                                "position_dependent_load (bell)",
                                                "position_dependent_load (quadratic)",
                                                "position_dependent_load (step)",
                                                "constant_force",
                                                "unlisted (periodic_load)",
                                                "unlisted (decaying_load)"};

/// Forces of speed that take towards one side what they return towards the other.
const std::set<std::string> kEvenInSpeed = {"directional_drag"};

void expect_energy_condition(const Law& law, const Point& point) {
  const std::string name = name_of(law);
  const LawScalar contribution = output_at(law, point).contribution;
  if (const auto found = kDissipate.find(name); found != kDissipate.end()) {
    EXPECT_GE(contribution.value * point.signal[found->second], 0.0) << name;
  } else if (const auto sign = kOneSign.find(name); sign != kOneSign.end()) {
    Point wet = point;
    if (law.kind == SiteKind::tank_flow) wet.signal = {std::abs(point.signal[0]), std::abs(point.signal[1]), 0.0, 0.0};
    EXPECT_GE(output_at(law, wet).contribution.value * sign->second, 0.0) << name;
  } else if (kEvenInSpeed.contains(name)) {
    Point back = point;
    back.signal[0] = -point.signal[0];
    EXPECT_EQ(output_at(law, back).contribution.value, contribution.value) << name;
    for (const std::size_t other : {1, 2, 3}) EXPECT_EQ(contribution.derivative[other], 0.0) << name;
  } else {
    EXPECT_TRUE(kOfPositionAlone.contains(name)) << name << ": say in this test which energy condition it keeps";
    for (const std::size_t other : {0, 2, 3}) EXPECT_EQ(contribution.derivative[other], 0.0) << name;
  }
}

TEST(PhysicsLaws, WithoutMemoryKeepTheirEnergyCondition) {
  std::mt19937 random(13);
  for (const Law* law : evaluated_laws())
    for (int repeat = 0; !law->hidden && repeat < 50; ++repeat)
      expect_energy_condition(*law, random_point(*law, random));
}

/// What a law does while its signals run through `periods` of `signals_at(phase)`, phase from 0 to 2 pi in a second:
/// the work contribution * conjugate over the last period, and the extremes of the hidden state.
struct Cycle {
  double work = 0.0;
  double lowest = 0.0;
  double highest = 0.0;
};
template <class Signals>
Cycle run_cycles(const Law& law, std::span<const double> parameters, const Signals& signals_at) {
  constexpr int kSteps = 100000;  // a period, explicit Euler
  constexpr int kPeriods = 3;
  constexpr double kStep_s = 1.0 / kSteps;
  Cycle cycle;
  double hidden = 0.0;
  for (int step = 0; step < kPeriods * kSteps; ++step) {
    const auto signals = signals_at(2.0 * M_PI * step * kStep_s);
    const LawOutput output = law.evaluate(law_input(signals, hidden, parameters, roundings_of(law)));
    if (step >= (kPeriods - 1) * kSteps) cycle.work += output.contribution.value * signals[0] * kStep_s;
    hidden += output.rate.value * kStep_s;
    cycle.lowest = std::min(cycle.lowest, hidden);
    cycle.highest = std::max(cycle.highest, hidden);
  }
  return cycle;
}

const Law& law_of(std::string_view id, const std::vector<std::string>& names) {
  const Result<const Law*> found = find_law(id, names);
  EXPECT_TRUE(found.has_value()) << id;
  return **found;
}

/// Speed of a stroke of +-1 mm in a second, at 0.05 m.
std::array<double, 4> strokes(double phase) {
  return {2.0 * M_PI * 1e-3 * std::cos(phase), 0.05 + 1e-3 * std::sin(phase), 1e7, 1e6};
}

TEST(PhysicsLaws, FrictionWithMemoryCostsItsForceTimesTheWay) {
  constexpr double kWay_m = 4e-3;
  // Less than slid friction: after each reversal the bristles first bend, over a few times 5e-5 m of the 2 mm.
  const Cycle dahl = run_cycles(law_of("presliding_friction", {"F_c", "delta"}), std::array{1e3, 5e-5}, strokes);
  EXPECT_NEAR(dahl.work, 1e3 * kWay_m, 0.1 * 1e3 * kWay_m);
  EXPECT_LT(dahl.work, 1e3 * kWay_m);
  EXPECT_GE(dahl.lowest, -1.0 - 1e-3);
  EXPECT_LE(dahl.highest, 1.0 + 1e-3);
  const Cycle lugre =
      run_cycles(law_of("presliding_friction", {"F_c", "delta", "sigma_1"}), std::array{1e3, 5e-5, 1e5}, strokes);
  EXPECT_GT(lugre.work, dahl.work);
  const Cycle hysteresis = run_cycles(law_of("hysteretic_load", {"F_h", "x_y"}), std::array{1e3, 2e-4}, strokes);
  EXPECT_GT(hysteresis.work, 0.5 * 1e3 * kWay_m);
  EXPECT_LT(hysteresis.work, 1e3 * kWay_m);
  EXPECT_LE(hysteresis.highest, 1.0 + 1e-3);
}

TEST(PhysicsLaws, LineResistanceDissipatesWithItsLag) {
  const auto flow = [](double phase) { return std::array{8e-6 * std::cos(phase), 0.0, 0.0, 0.0}; };
  EXPECT_NEAR(run_cycles(law_of("line_resistance", {"R"}), std::array{2e10}, flow).work, 0.5 * 2e10 * 6.4e-11, 1e-3);
  EXPECT_GT(run_cycles(law_of("line_resistance", {"k"}), std::array{3e15}, flow).work, 0.0);
  EXPECT_GT(run_cycles(law_of("line_resistance", {"D_q", "a_q"}), std::array{2e5, 1.5}, flow).work, 0.0);
}

TEST(PhysicsLaws, FrictionThatWearsOffCostsItsForceTimesTheWayOverWhichItDoes) {
  const Law& law = law_of("unlisted", {"F_r", "s_r", "v_r"});
  const std::array parameters{2e3, 1e-3, 1e-4};
  const auto onward = [](double) {
    return std::array{1e-3, 0.05, 0.0, 0.0};
  };  // 3 mm in all, the last in the last second
  const Cycle cycle = run_cycles(law, parameters, onward);
  EXPECT_NEAR(cycle.highest, 1.0 - std::exp(-3.0), 1e-3);
  const double last_mm = 2e3 * 1e-3 * (std::exp(-2.0) - std::exp(-3.0));
  EXPECT_NEAR(cycle.work, last_mm, 1e-3 * last_mm);
}

TEST(PhysicsLaws, BacklashLosesTheLoadOnlyWhileTheClearanceIsCrossed) {
  const Law& law = law_of("backlash", {"F_b", "b"});
  const std::array parameters{5e3, 2e-4};
  const auto loss = [&](double place) {
    return law.evaluate(law_input(std::array{1e-3, 0.05, 0.0, 0.0}, place, parameters, roundings_of(law)))
        .contribution.value;
  };
  EXPECT_EQ(loss(0.0), 0.0);
  EXPECT_EQ(loss(0.5), -5e3);
  EXPECT_EQ(loss(1.0), 0.0);
  // Driven on by +x it stays on its flank; strokes that are long beside the clearance carry it to either flank.
  const auto onward = [](double) { return std::array{1e-3, 0.05, 0.0, 0.0}; };
  EXPECT_NEAR(run_cycles(law, parameters, onward).highest, 0.0, 1e-9);
  const Cycle cycle = run_cycles(law, parameters, strokes);
  EXPECT_NEAR(cycle.highest, 1.0, 0.01);
  EXPECT_NEAR(cycle.lowest, 0.0, 1e-3);
  // The load is missing once in each direction, so that over a period the work nearly cancels.
  EXPECT_LT(std::abs(cycle.work), 0.1 * 5e3 * 2e-4);
}

TEST(PhysicsLaws, OilAndWindingWarmTowardsTheirSteadyState) {
  const auto steady = [](double first) { return std::array{first, 0.0, 0.0, 0.0}; };
  const Law& winding = law_of("winding_heating", {"k", "tau"});
  const LawInput hot = law_input(steady(5.0), 25.0, std::array{2e-3, 60.0}, {});
  EXPECT_EQ(winding.evaluate(hot).rate.value, 0.0);
  EXPECT_DOUBLE_EQ(winding.evaluate(hot).contribution.value, 2e-3 * 25.0 * 5.0);
  const Law& oil = law_of("viscosity_warm_up", {"b", "tau"});
  EXPECT_EQ(oil.evaluate(law_input(steady(100.0), 1.0, std::array{0.9, 30.0}, {})).rate.value, 0.0);
  for (const double warmth : {0.0, 0.5, 2.0, 1e3})
    EXPECT_GE(oil.evaluate(law_input(steady(100.0), warmth, std::array{0.9, 30.0}, {})).contribution.value, -0.9);
  const Law& by_time = law_of("viscosity_warm_up", {"b_t", "tau_t"});
  const LawOutput end = by_time.evaluate(law_input(steady(0.0), 1.0, std::array{0.9, 30.0}, {}));
  EXPECT_EQ(end.rate.value, 0.0);
  EXPECT_DOUBLE_EQ(end.contribution.value, -0.9);
}

TEST(PhysicsLaws, ValveMemoryNeverLowersTheCrackingPressureBelowZero) {
  for (const auto& names : {std::vector<std::string>{"dp_h", "tau", "D_o"}, {"dp_f", "tau_f"}}) {
    const Law& law = law_of("valve_hysteresis", names);
    std::vector<double> parameters{law.parameters[0].max};
    for (std::size_t k = 1; k < law.parameters.size(); ++k) parameters.push_back(law.parameters[k].start[0]);
    const auto open_and_close = [](double phase) { return std::array{1e5 * std::sin(phase), 0.0, 0.0, 0.0}; };
    const Cycle cycle = run_cycles(law, parameters, open_and_close);
    for (const double memory : {cycle.lowest, cycle.highest}) {
      const double lowered =
          law.evaluate(law_input(open_and_close(0.0), memory, parameters, roundings_of(law))).contribution.value;
      EXPECT_LE(lowered, 5e4);
    }
  }
}

TEST(PhysicsLaws, FreeAirIsWorthItsVolume) {
  // 1 % of air makes 0.01 p_a / p^2 at 2 MPa; halved where half of it has dissolved.
  constexpr double kPressure_Pa = 2e6;
  const double expected = 0.01 * 101325.0 / (kPressure_Pa * kPressure_Pa);
  const std::array signals{kPressure_Pa, 0.0, 0.0, 0.0};
  const auto softness = [&](const std::vector<std::string>& names, std::span<const double> parameters) {
    const Law& air = law_of("entrained_air", names);
    return air.evaluate(law_input(signals, 0.0, parameters, roundings_of(air))).contribution.value;
  };
  EXPECT_NEAR(softness({"alpha"}, std::array{0.01}), expected, 1e-9 * expected);
  EXPECT_NEAR(softness({"alpha", "n"}, std::array{0.01, 1.0}), expected, 1e-9 * expected);
  EXPECT_NEAR(softness({"alpha", "p_d"}, std::array{0.01, kPressure_Pa}), 0.5 * expected, 1e-9 * expected);
}

}  // namespace
}  // namespace sealwatch::law_test
