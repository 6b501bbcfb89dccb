// Health after a retraction is that of an actuator which never had the test: grade, trend, faults, and the tests that the
// mismatch analysis is given.
#include "sealwatch/message/retraction.hpp"

#include <gmock/gmock.h>

#include "services/common/message/json.hpp"
#include "services/health_assessment/health_assessment.hpp"
#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/state_detection/fake_simulator.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::Circumstances;
using synthetic::Condition;

constexpr const char* kAsset = "A1";

/// Says which tests it was given, and is never at a loss.
class Recorder final : public Explainer {
 public:
  ModelDiscrepancy explain(const AssetConfig& /*asset*/, std::span<const Recording> fit,
                           std::span<const Recording> holdout, const std::stop_token& /*stop*/) const override {
    ModelDiscrepancy found;
    found.summary = std::to_string(fit.size()) + " fitted, " + std::to_string(holdout.size()) + " held out";
    return found;
  }
};

/// State detection and health assessment behind it, with health assessment's journal.
class Chain {
 public:
  explicit Chain(double misfit = 1.5) : misfit_(misfit) {}
  /// The last health report that comes of it.
  HealthReport take(const Message& input) {
    HealthReport last;
    for (const Message& output : detection_->receive(input).outputs) last = take_in_health(output);
    return last;
  }
  HealthReport test(int number, const Condition& condition = {}, Circumstances circumstances = {}) {
    circumstances.number = number;
    circumstances.asset_id = kAsset;
    const synthetic::Test made = synthetic::make(condition, circumstances);
    take_in_health(made.window);
    take_in_health(made.features);
    take(made.window);
    return take(made.features);
  }
  /// By the virtual bench.
  HealthReport made_up_test(int number, const Condition& condition) {
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.asset_id = kAsset;
    const synthetic::Test made = synthetic::make_up(condition, circumstances);
    take_in_health(made.window);
    take_in_health(made.features);
    take(made.window);
    return take(made.features);
  }
  HealthReport retract(const std::string& pst_id, int month) { return say(kTestRetracted, pst_id, month); }
  HealthReport say(std::string_view kind, const std::string& what, int month,
                   const std::vector<std::string>& tests = {}) {
    MaintenanceEvent event;
    event.asset_id = kAsset;
    event.kind = kind;
    event.reported_by = "J. Silva";
    event.header.event_time_known = true;
    event.header.event_time_ns = synthetic::month(month, 20).nanoseconds;
    event.header.message_id = last_said_ = retraction_id(kAsset, kind, what, {event.header.event_time_ns});
    event.tests_known = !tests.empty();
    event.test_ids = tests;
    return take(event);
  }
  std::string replaced(int month) {
    MaintenanceEvent event;
    event.asset_id = kAsset;
    event.kind = "seal_replaced";
    event.header.event_time_known = true;
    event.header.event_time_ns = synthetic::month(month, 20).nanoseconds;
    event.header.message_id = "maintenance_event/" + event.asset_id + "/" + format_utc(synthetic::month(month, 20));
    take(event);
    return event.header.message_id;
  }
  void restart_health() {
    health_ = make();
    for (const Message& output : concluded_) health_->restore(output);
    for (const Message& input : std::vector(received_))
      if (!std::ranges::count(consumed_, header_of(input).message_id)) add(health_->receive(input));
  }
  [[nodiscard]] const std::string& last_said() const { return last_said_; }
  [[nodiscard]] std::vector<ModelDiscrepancy> analyses() const {
    std::vector<ModelDiscrepancy> found;
    for (const Message& output : concluded_)
      if (const auto* analysis = std::get_if<ModelDiscrepancy>(&output)) found.push_back(*analysis);
    return found;
  }

  HealthReport take_in_health(const Message& input) {
    received_.push_back(input);
    return add(health_->receive(input));
  }

 private:
  std::unique_ptr<HealthAssessment> make() const {
    const std::vector<AssetConfig> assets = {synthetic::asset(kAsset)};
    return std::make_unique<HealthAssessment>(assets, HealthAssessmentOptions{}, std::make_shared<Recorder>());
  }
  HealthReport add(Conclusion conclusion) {
    conclusion = completed(std::move(conclusion));
    HealthReport last;
    for (const Message& output : conclusion.outputs) {
      concluded_.push_back(output);
      if (const auto* report = std::get_if<HealthReport>(&output)) last = *report;
    }
    for (const std::string& id : conclusion.consumed) consumed_.push_back(id);
    return last;
  }

  double misfit_;
  std::vector<AssetConfig> assets_ = {synthetic::asset(kAsset)};
  std::unique_ptr<StateDetection> detection_ =
      std::make_unique<StateDetection>(assets_, std::make_shared<synthetic::FakeSimulator>(misfit_, 0.0, 1e13));
  std::unique_ptr<HealthAssessment> health_ = make();
  std::vector<Message> received_, concluded_;
  std::vector<std::string> consumed_;
  std::string last_said_;
};

Condition leaky(double theta) {
  Condition condition;
  condition.theta = theta;
  return condition;
}

std::string text(const HealthReport& report) { return to_json(Message(report), JsonForm::exact); }

/// What is said of the actuator, without what says how it came about.
std::string said(HealthReport report) {
  report.header = {};
  return text(report);
}

TEST(HealthAfterRetraction, TrendAndGradeAreThoseWithoutTheTest) {
  for (const bool restarted : {false, true}) {
    Chain deceived, undisturbed;
    std::string wrong;
    HealthReport before, never;
    for (int number = 0; number < 12; ++number) {
      if (number == 9) wrong = deceived.test(60, leaky(0.62)).header.pst_id;
      before = deceived.test(number, leaky(0.9 - 0.005 * number));
      never = undisturbed.test(number, leaky(0.9 - 0.005 * number));
    }
    ASSERT_NE(said(before), said(never)) << "it would not show";
    const HealthReport answer = deceived.retract(wrong, 12);
    EXPECT_TRUE(answer.header.pst_id.empty());
    EXPECT_EQ(answer.header.source_ids.front(), deceived.last_said());
    EXPECT_EQ(said(answer), said(never)) << "at once";
    if (restarted) deceived.restart_health();
    for (int number = 13; number < 20; ++number)
      ASSERT_EQ(text(deceived.test(number, leaky(0.8))), text(undisturbed.test(number, leaky(0.8)))) << number;
  }
}

/// Whatever is known when it is fetched back (message/act_record.hpp).
TEST(HealthAfterRetraction, OfAllSinceADateMeansTheTestsThatAreNamed) {
  for (const bool restarted : {false, true}) {
    Chain deceived, undisturbed;
    std::string wrong;
    for (int number = 0; number < 12; ++number) {
      if (number == 9) wrong = deceived.test(60, leaky(0.62)).header.pst_id;
      deceived.test(number, leaky(0.9 - 0.005 * number));
      undisturbed.test(number, leaky(0.9 - 0.005 * number));
    }
    const HealthReport answer = deceived.say(kTestsRetracted, format_utc(synthetic::month(5, 25)), 12, {wrong});
    EXPECT_EQ(answer.retracted_test_ids, std::vector<std::string>{wrong});
    if (restarted) deceived.restart_health();
    for (int number = 13; number < 20; ++number)
      ASSERT_EQ(text(deceived.test(number, leaky(0.8))), text(undisturbed.test(number, leaky(0.8)))) << number;
  }
}

TEST(HealthAfterRetraction, IsAnsweredBehindAReportThatWasOvertaken) {
  Chain chain;
  const HealthReport first = chain.test(0);
  StateReport forged;
  forged.asset_id = kAsset;
  forged.header.pst_id = "forged";
  forged.header.message_id = "state_report/forged";
  chain.take_in_health(forged);
  const HealthReport second = chain.test(1);
  EXPECT_EQ(second.header.event_time_ns, synthetic::month(1).nanoseconds) << "the forged one waits alone";
  EXPECT_EQ(said(chain.retract(second.header.pst_id, 2)), said(first));
}

TEST(HealthAfterRetraction, ATestThatDoesNotTellRepeatsTheLastThatCounts) {
  Chain deceived, undisturbed;
  std::string wrong;
  for (int number = 0; number < 8; ++number) {
    deceived.test(number, leaky(0.9));
    undisturbed.test(number, leaky(0.9));
  }
  wrong = deceived.test(8, leaky(0.62)).header.pst_id;
  Circumstances cut;
  cut.cut_after_s = 7.4;
  const HealthReport blind = deceived.test(9, {}, cut);
  const HealthReport never = undisturbed.test(9, {}, cut);
  ASSERT_NE(said(blind), said(never)) << "it would not show";
  deceived.retract(wrong, 10);
  EXPECT_EQ(said(deceived.test(11, {}, cut)), said(undisturbed.test(11, {}, cut)));
}

TEST(HealthAfterRetraction, WithdrawnItIsAsItWas) {
  Chain changed, undisturbed;
  std::string wrong;
  for (int number = 0; number < 10; ++number) {
    const HealthReport report = changed.test(number, leaky(number == 4 ? 0.62 : 0.9));
    if (number == 4) wrong = report.header.pst_id;
    undisturbed.test(number, leaky(number == 4 ? 0.62 : 0.9));
  }
  changed.retract(wrong, 10);
  changed.say(kRetractionWithdrawn, changed.last_said(), 11);
  EXPECT_EQ(text(changed.test(12, leaky(0.85))), text(undisturbed.test(12, leaky(0.85))));
}

TEST(HealthAfterRetraction, AReplacementThatWasNoneIsUndone) {
  for (const bool restarted : {false, true}) {
    Chain changed, undisturbed;
    HealthReport with, without;
    for (int number = 0; number < 10; ++number) {
      changed.test(number, leaky(0.9 - 0.01 * number));
      without = undisturbed.test(number, leaky(0.9 - 0.01 * number));
    }
    const std::string wrong = changed.replaced(9);
    for (int number = 10; number < 12; ++number) {
      with = changed.test(number, leaky(0.75));
      without = undisturbed.test(number, leaky(0.75));
    }
    ASSERT_NE(said(with), said(without)) << "it would not show";
    const HealthReport answer = changed.say(kRetractionWithdrawn, wrong, 12);
    EXPECT_EQ(answer.trend_known, without.trend_known);
    EXPECT_EQ(answer.health_trend_per_year, without.health_trend_per_year);
    if (restarted) changed.restart_health();
    for (int number = 13; number < 18; ++number) {
      with = changed.test(number, leaky(0.7));
      without = undisturbed.test(number, leaky(0.7));
      ASSERT_EQ(with.health_trend_per_year, without.health_trend_per_year) << number;
      ASSERT_EQ(with.trend_known, without.trend_known) << number;
    }
  }
}

TEST(HealthAfterRetraction, TheMismatchAnalysisIsGivenNoTestThatIsRetracted) {
  for (const bool restarted : {false, true}) {
    Chain chain(400.0);  // every test deviates from the model
    const std::string wrong = chain.test(0).header.pst_id;
    chain.test(1);
    chain.retract(wrong, 1);
    if (restarted) chain.restart_health();
    chain.test(2);
    EXPECT_TRUE(chain.analyses().empty()) << "two tests are no row of three";
    chain.test(3);
    ASSERT_EQ(chain.analyses().size(), 1U);
    for (const std::string& pst_id : chain.analyses()[0].fit_tests) EXPECT_NE(pst_id, wrong);
  }
}

TEST(HealthAfterRetraction, AnAnalysisOfARetractedTestIsMadeAnewWithoutIt) {
  Chain chain(400.0);
  const std::string wrong = chain.test(0).header.pst_id;
  chain.test(1);
  chain.test(2);
  ASSERT_EQ(chain.analyses().size(), 1U);
  chain.retract(wrong, 2);
  chain.test(3);
  ASSERT_EQ(chain.analyses().size(), 2U);
  EXPECT_EQ(chain.analyses()[1].version, 2);
  for (const std::string& pst_id : chain.analyses()[1].fit_tests) EXPECT_NE(pst_id, wrong);
}

TEST(HealthAfterRetraction, MadeUpTestsAreForgottenOnceOneIsRecorded) {
  for (const bool restarted : {false, true}) {
    Chain tried, undisturbed;
    Condition worn;
    worn.friction_N = 3600;
    for (int number = 0; number < 12; ++number) tried.made_up_test(number, worn);
    for (int number = 20; number < 30; ++number) {
      ASSERT_EQ(to_json(Message(tried.test(number)), JsonForm::exact),
                to_json(Message(undisturbed.test(number)), JsonForm::exact))
          << number;
      if (restarted) tried.restart_health();
    }
  }
}

}  // namespace
}  // namespace sealwatch
