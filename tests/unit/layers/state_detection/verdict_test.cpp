#include "services/state_detection/verdict.hpp"

#include <gmock/gmock.h>

#include "services/state_detection/indicators.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using testing::_;
using testing::ElementsAre;
using testing::HasSubstr;

Verdict judge(const synthetic::Condition& condition, const synthetic::Circumstances& circumstances) {
  const AssetConfig asset = synthetic::asset();
  const synthetic::Test test = synthetic::make(condition, circumstances);
  return judge_test(asset, test.features, test.window, condition_indicators(asset, test.features, test.window));
}

TEST(Verdict, HealthyTestPasses) {
  const Verdict verdict = judge({}, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::passed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("16.00 mm"), HasSubstr("closes in 60.1 s, 63.2 s are allowed"),
                                           "judged by the position"));
}

TEST(Verdict, ShortStrokeFails) {
  synthetic::Condition condition;
  condition.stroke_m = 0.012;
  const Verdict verdict = judge(condition, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::failed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("12.00 mm of the 16.0 mm"), "judged by the position"));
}

TEST(Verdict, APistonThatNeverMovedFails) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Test test = synthetic::make({}, {});
  std::erase_if(test.features.features,
                [](const Quantity& f) { return f.name == "travel" || f.name == "return_error"; });
  test.features.phases = {{PhaseKind::rest, 0.0, 31.0}};
  for (Series& series : test.window.samples.channels)
    if (series.name == "position") std::fill(series.values.begin(), series.values.end(), 0.06);
  const Verdict verdict = judge_test(asset, test.features, test.window, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::failed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("0.00 mm of the 16.0 mm"), _));
}

TEST(Verdict, SlowClosingFails) {
  synthetic::Condition condition;
  condition.speed_m_s = 1.1e-3;
  const Verdict verdict = judge(condition, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::failed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("72.7 s"), _));
}

TEST(Verdict, NotComingBackFails) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Test test = synthetic::make({}, {});
  for (Quantity& feature : test.features.features)
    if (feature.name == "return_error") feature.value = -2e-3;
  EXPECT_THAT(judge_test(asset, test.features, test.window, {}).reasons, ElementsAre(HasSubstr("2.00 mm away"), _));
  std::erase_if(test.features.features, [](const Quantity& f) { return f.name == "return_error"; });
  const Verdict verdict = judge_test(asset, test.features, test.window, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::failed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("did not come back"), _));
}

TEST(Verdict, CutTestIsNotJudged) {
  synthetic::Circumstances cut;
  cut.cut_after_s = 7.4;
  const Verdict verdict = judge({}, cut);
  EXPECT_EQ(verdict.verdict, PstVerdict::not_judged);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("cut after 7.4 s of about 31 s")));
}

TEST(Verdict, ATestThatBeginsInsideTheStrokeIsNotJudged) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Test test = synthetic::make({}, {});
  std::erase_if(test.features.phases, [](const Phase& phase) { return phase.begin_s < 4.0; });
  test.features.phases.insert(test.features.phases.begin(), {PhaseKind::out, 4.0, 13.0});
  for (Quantity& feature : test.features.features)
    if (feature.name == "travel") feature.value = 0.01249;
  std::erase_if(test.features.features, [](const Quantity& f) { return f.name == "return_error"; });
  for (const bool complete : {true, false}) {
    test.features.complete = complete;
    const Verdict verdict = judge_test(asset, test.features, test.window, {});
    EXPECT_EQ(verdict.verdict, PstVerdict::not_judged);
    EXPECT_THAT(verdict.reasons, ElementsAre("the recording begins inside the stroke"));
  }
}

TEST(Verdict, AbortedTestSaysWhy) {
  synthetic::Circumstances aborted;
  aborted.aborted = true;
  aborted.cut_after_s = 9.0;
  const Verdict verdict = judge({}, aborted);
  EXPECT_EQ(verdict.verdict, PstVerdict::aborted);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("MCS command had priority")));
}

TEST(Verdict, WithoutPositionItIsJudgedByTheVelocityAndSaysSo) {
  synthetic::Circumstances failed;
  failed.failed_channel = "position";
  const Verdict verdict = judge({}, failed);
  EXPECT_EQ(verdict.verdict, PstVerdict::passed);
  EXPECT_THAT(verdict.reasons,
              ElementsAre(HasSubstr("16.00 mm"), HasSubstr("closes in 60.2 s"),
                          "judged by the velocity, integrated: position is FAILED: frozen for 4.0 s from 2.0 s"));
  synthetic::Circumstances absent;
  absent.absent_channel = "position";
  EXPECT_EQ(judge({}, absent).reasons.back(), "judged by the velocity, integrated: position was not recorded");
  synthetic::Condition slow;
  slow.speed_m_s = 1.1e-3;
  EXPECT_EQ(judge(slow, failed).verdict, PstVerdict::failed);
  EXPECT_THAT(judge(slow, failed).reasons,
              ElementsAre(HasSubstr("closes in 72.8 s"), HasSubstr("judged by the velocity")));
}

TEST(Verdict, APistonThatNeverMovedFailsByTheVelocityToo) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Circumstances absent;
  absent.absent_channel = "position";
  synthetic::Test test = synthetic::make({}, absent);
  std::erase_if(test.features.features,
                [](const Quantity& f) { return f.name == "travel" || f.name == "return_error"; });
  test.features.phases = {{PhaseKind::rest, 0.0, 31.0}};
  for (Series& series : test.window.samples.channels)
    if (series.name == "velocity") std::fill(series.values.begin(), series.values.end(), 1e-5);  // its bias
  const Verdict verdict = judge_test(asset, test.features, test.window, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::failed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("0.31 mm of the 16.0 mm"), HasSubstr("judged by the velocity")));
}

TEST(Verdict, WhereNothingMeasuredTheStrokeItIsNotJudged) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Circumstances circumstances;
  circumstances.failed_channel = "position";
  circumstances.absent_channel = "velocity";
  synthetic::Test test = synthetic::make({}, circumstances);
  test.features.features.push_back({"travel", "m", 0.016, false, 0.0});  // whatever else may have given it
  const Verdict verdict = judge_test(asset, test.features, test.window, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::not_judged);
  EXPECT_THAT(verdict.reasons,
              ElementsAre(HasSubstr("nothing measured the stroke: position is FAILED: frozen for 4.0 s "
                                    "from 2.0 s, velocity was not recorded")));
}

TEST(Verdict, APositionInDoubtIsNamed) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Test test = synthetic::make({}, {});
  for (ChannelStatus& status : test.features.channel_status)
    if (status.channel == "position") status = {"position", ChannelState::UNKNOWN, "0.4 % out of range"};
  const Verdict verdict = judge_test(asset, test.features, test.window, {});
  EXPECT_EQ(verdict.verdict, PstVerdict::passed);
  EXPECT_THAT(verdict.reasons, ElementsAre(HasSubstr("16.00 mm"), "how fast it closes was not measured",
                                           "judged by the position, which is in doubt: 0.4 % out of range"));
}

TEST(Verdict, OtherRecordingsAreNotJudged) {
  synthetic::Circumstances circumstances;
  circumstances.test_kind = "other";
  EXPECT_EQ(judge({}, circumstances).verdict, PstVerdict::not_judged);
}

TEST(Verdict, FullStrokeMustReachTheFullStroke) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Test test = synthetic::make({}, {});
  test.features.test_kind = "full_stroke";
  EXPECT_EQ(judge_test(asset, test.features, test.window, {}).verdict, PstVerdict::failed);
  test.features.features.front().value = 0.0799;  // travel
  EXPECT_EQ(judge_test(asset, test.features, test.window, {}).verdict, PstVerdict::passed);
}

}  // namespace
}  // namespace sealwatch
