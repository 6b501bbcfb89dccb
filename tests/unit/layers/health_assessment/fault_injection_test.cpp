// Faults put into the physics of synthetic tests, through state detection and health assessment: the right one is
// proposed first.
#include <gmock/gmock.h>

#include "services/health_assessment/health_assessment.hpp"
#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::Circumstances;
using synthetic::Condition;

/// Both layers in process.
class Chain {
 public:
  Chain() : detection_(assets(), nullptr), assessment_(assets()) {}

  const HealthReport& play(const Condition& condition, Circumstances circumstances = {}) {
    circumstances.number = number_++;
    const synthetic::Test test = synthetic::make(condition, circumstances);
    (void)detection_.receive(test.window);
    const Conclusion state = detection_.receive(test.features);
    (void)assessment_.receive(test.features);
    Conclusion health = assessment_.receive(state.outputs.front());
    report_ = std::get<HealthReport>(health.outputs.front());
    return report_;
  }
  /// A year of healthy tests under changing load.
  void run_in(Condition condition = {}) {
    for (int k = 0; k < 12; ++k) {
      condition.load_factor = 0.2 * std::sin(2.1 * k);
      play(condition);
    }
  }

 private:
  static const std::vector<AssetConfig>& assets() {
    static const std::vector<AssetConfig> all = {synthetic::asset()};
    return all;
  }
  StateDetection detection_;
  HealthAssessment assessment_;
  HealthReport report_;
  int number_ = 0;
};

struct Fault {
  std::string name;
  std::function<void(Condition&)> inject;
  FaultKind kind;
  std::vector<std::string> elements;  ///< any of them first: they have the same signature
};

class FaultInjection : public testing::TestWithParam<Fault> {};

TEST_P(FaultInjection, IsProposedFirst) {
  Chain chain;
  chain.run_in();
  Condition condition;
  condition.load_factor = 0.1;
  GetParam().inject(condition);
  const HealthReport& report = chain.play(condition);
  ASSERT_FALSE(report.ambiguity_group.empty());
  double right = 0.0;
  for (const ProposedFault& fault : report.ambiguity_group)
    if (testing::Value(fault.element, testing::AnyOfArray(GetParam().elements)) && fault.kind == GetParam().kind)
      right += fault.likelihood;
  const ProposedFault& first = report.ambiguity_group.front();
  EXPECT_EQ(first.kind, GetParam().kind) << first.element;
  EXPECT_THAT(first.element, testing::AnyOfArray(GetParam().elements));
  EXPECT_GT(right, 0.4);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, FaultInjection,
    testing::Values(
        Fault{"leakage", [](Condition& c) { c.theta = 0.64; }, FaultKind::internal_leakage, {"piston_seal"}},
        Fault{"friction",
              [](Condition& c) {
                c.friction_N = 3600;
                c.breakaway_extra_Pa = 1e5;
              },
              FaultKind::friction,
              {"piston"}},
        Fault{"sticking", [](Condition& c) { c.breakaway_extra_Pa = 1e6; }, FaultKind::friction, {"piston"}},
        Fault{"pump_wear", [](Condition& c) { c.slip = 4e-14; }, FaultKind::pump, {"pump"}},
        Fault{"pump_drag", [](Condition& c) { c.drag = 1.8e-3; }, FaultKind::pump, {"shaft"}},
        Fault{"load", [](Condition& c) { c.load_factor = 0.9; }, FaultKind::load, {"piston"}},
        Fault{"driver", [](Condition& c) { c.emf = 0.23; }, FaultKind::driver, {"driver"}},
        Fault{"flow_gain", [](Condition& c) { c.flow_gain = 1.12; }, FaultKind::sensor, {"sensor:flow"}},
        Fault{"speed_gain", [](Condition& c) { c.speed_gain = 0.9; }, FaultKind::sensor, {"sensor:shaft_speed"}},
        Fault{"position_gain", [](Condition& c) { c.position_gain = 1.12; }, FaultKind::sensor, {"sensor:position"}},
        Fault{"velocity_gain", [](Condition& c) { c.velocity_gain = 0.85; }, FaultKind::sensor, {"sensor:velocity"}},
        Fault{"current_gain", [](Condition& c) { c.current_gain = 1.3; }, FaultKind::sensor, {"sensor:motor_current"}},
        Fault{"pressure_bias",
              [](Condition& c) { c.pressure_a_bias = 5e6; },
              FaultKind::sensor,
              {"sensor:pressure_a", "sensor:pressure_b"}}),
    [](const auto& fault) { return fault.param.name; });

TEST(FaultChain, HealthyTestsProposeNothing) {
  Chain chain;
  for (int k = 0; k < 40; ++k) {
    Condition condition;
    condition.load_factor = 0.2 * std::sin(2.1 * k);
    const HealthReport& report = chain.play(condition);
    EXPECT_GT(report.no_fault_likelihood, 0.9) << "test " << k;
    EXPECT_TRUE(report.admissible_for_prognosis);
  }
}

TEST(FaultChain, NineYearsOfLeakageAreLeakageAndNothingElse) {
  Chain chain;
  double last_grade = 1.1;
  for (int k = 0; k < 108; ++k) {
    Condition condition;
    condition.load_factor = 0.2 * std::sin(2.1 * k);
    condition.theta = 0.97 - 0.36 * k / 107.0;
    const HealthReport& report = chain.play(condition);
    EXPECT_LE(report.health_grade, last_grade);
    last_grade = report.health_grade;
    for (const ProposedFault& fault : report.ambiguity_group)
      EXPECT_TRUE(fault.kind == FaultKind::internal_leakage || fault.likelihood < 0.2)
          << fault.element << " test " << k;
    if (condition.theta < 0.67) {
      EXPECT_GT(report.ambiguity_group.front().likelihood, 0.8) << "test " << k;
    } else if (condition.theta > 0.74) {
      EXPECT_GT(report.no_fault_likelihood, 0.9) << "test " << k;
    }
    if (k > 12) {
      EXPECT_TRUE(report.trend_known);
      EXPECT_NEAR(report.health_trend_per_year, -0.36 / 0.4 * 12 / 107.0, 0.01);
    }
  }
}

TEST(FaultChain, ASecondFaultBesideLeakageIsNotHidden) {
  Chain chain;
  chain.run_in();
  Condition condition;
  condition.theta = 0.63;
  condition.friction_N = 3600;
  condition.breakaway_extra_Pa = 1e5;
  const HealthReport& report = chain.play(condition);
  ASSERT_GE(report.ambiguity_group.size(), 2U);
  EXPECT_GT(report.ambiguity_group[0].likelihood + report.ambiguity_group[1].likelihood, 0.9);
  EXPECT_NE(report.ambiguity_group[0].kind, report.ambiguity_group[1].kind);
  EXPECT_GT(report.ambiguity_group[1].likelihood, 0.2);
}

TEST(FaultChain, AFailedSensorIsTheSensor) {
  Chain chain;
  chain.run_in();
  Circumstances circumstances;
  circumstances.failed_channel = "motor_current";
  const HealthReport& report = chain.play({}, circumstances);
  ASSERT_FALSE(report.ambiguity_group.empty());
  EXPECT_EQ(report.ambiguity_group.front().element, "sensor:motor_current");
  EXPECT_TRUE(report.admissible_for_prognosis);  // the cylinder circuit does without it
}

TEST(FaultChain, AdmissibilityHasReasons) {
  struct Case {
    std::function<void(Circumstances&)> make;
    std::string reason;
  };
  const std::vector<Case> cases = {
      {[](Circumstances& c) { c.cut_after_s = 7.4; }, "cut after 7.4 s"},
      {[](Circumstances& c) { c.aborted = true; }, "MCS command had priority"},
      {[](Circumstances& c) { c.test_kind = "other"; }, "not a stroke test"},
      {[](Circumstances& c) { c.temperature_deviation_K = 15; }, "off temperature: the oil was +15.0 K"},
      {[](Circumstances& c) { c.temperature_deviation_K = -7; }, "off temperature: the oil was -7.0 K"},
      {[](Circumstances& c) { c.drive_saturation = 0.3; }, "saturated: 30 % of the test"},
      {[](Circumstances& c) { c.missing_share = 0.2; }, "samples are missing: 20 %"},
      {[](Circumstances& c) { c.failed_channel = "pressure_b"; }, ""},
      {[](Circumstances& c) { c.failed_channel = "position"; }, ""},  // the velocity tells as well
      {[](Circumstances& c) {
         c.failed_channel = "position";
         c.absent_channel = "velocity";
       },
       "nothing measured the stroke"}};
  for (const Case& one : cases) {
    Chain chain;
    chain.run_in();
    Circumstances circumstances;
    one.make(circumstances);
    const HealthReport& report = chain.play({}, circumstances);
    EXPECT_EQ(report.admissible_for_prognosis, one.reason.empty()) << one.reason;
    ASSERT_EQ(report.inadmissible_reasons.empty(), one.reason.empty());
    const std::string first = one.reason.empty() ? "" : report.inadmissible_reasons.front();
    EXPECT_THAT(first, testing::HasSubstr(one.reason));
  }
}

TEST(FaultChain, AFailedTestHasACause) {
  Chain chain;
  chain.run_in();
  Condition condition;
  condition.stroke_m = 0.008;
  const HealthReport& report = chain.play(condition);
  EXPECT_EQ(report.health_grade, 0.0);
  EXPECT_LT(report.no_fault_likelihood, 0.02);
  ASSERT_FALSE(report.ambiguity_group.empty());
  EXPECT_EQ(report.ambiguity_group.front().kind, FaultKind::friction);
  for (const ProposedFault& fault : report.ambiguity_group)
    EXPECT_TRUE(fault.kind != FaultKind::sensor || fault.element == "sensor:position") << fault.element;
  EXPECT_THAT(report.ambiguity_group.front().evidence,
              testing::Contains(testing::HasSubstr("the test failed: the piston")));
}

TEST(FaultChain, AFailedTestWithMoreFrictionIsFriction) {
  Chain chain;
  chain.run_in();
  Condition condition;
  condition.stroke_m = 0.008;
  condition.friction_N = 5000;
  const HealthReport& report = chain.play(condition);
  EXPECT_EQ(report.ambiguity_group.front().kind, FaultKind::friction);
  EXPECT_GT(report.ambiguity_group.front().likelihood, 0.9);
}

TEST(FaultChain, SmallQualityLossesAreNoReason) {
  Chain chain;
  Circumstances circumstances;
  circumstances.temperature_deviation_K = 4;
  circumstances.missing_share = 0.05;
  circumstances.drive_saturation = 0.02;
  EXPECT_TRUE(chain.play({}, circumstances).admissible_for_prognosis);
}

TEST(FaultChain, AnUnjudgedTestCarriesTheLastGradeOver) {
  Chain chain;
  chain.run_in();
  Condition worn;
  worn.theta = 0.64;
  const HealthReport before = chain.play(worn);
  Circumstances cut;
  cut.cut_after_s = 7.4;
  const HealthReport& report = chain.play(worn, cut);
  EXPECT_EQ(report.health_grade, before.health_grade);
  EXPECT_EQ(report.no_fault_likelihood, before.no_fault_likelihood);
  ASSERT_FALSE(report.ambiguity_group.empty());
  EXPECT_THAT(report.ambiguity_group.front().evidence, testing::ElementsAre(testing::HasSubstr("carried over")));
}

}  // namespace
}  // namespace sealwatch
