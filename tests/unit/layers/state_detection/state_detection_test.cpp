#include "services/state_detection/state_detection.hpp"

#include <gmock/gmock.h>

#include "services/common/message/json.hpp"
#include "services/state_detection/sensor_alarms.hpp"
#include "tests/unit/layers/given_again.hpp"
#include "tests/unit/layers/state_detection/fake_simulator.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::Circumstances;
using synthetic::Condition;
using testing::Contains;
using testing::HasSubstr;

std::shared_ptr<const Simulator> simulator() { return std::make_shared<synthetic::FakeSimulator>(1.5, 0.0, 1e13); }

StateDetection layer() {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1"), synthetic::asset("A2")};
  return StateDetection(assets, simulator());
}

/// Plays messages by the runner's contract and remembers what a journal would.
struct Journal {
  std::vector<Message> received;
  std::vector<Message> concluded;
  std::vector<std::string> consumed;

  void take(StateDetection& detection, const Message& input) {
    received.push_back(input);
    add(test::receive(detection, input, received));
  }
  void add(Conclusion conclusion) {
    for (Message& output : conclusion.outputs) concluded.push_back(std::move(output));
    for (std::string& id : conclusion.consumed) consumed.push_back(std::move(id));
  }
  /// A new layer as after a crash; what it concludes from unconsumed inputs is added.
  StateDetection restart() {
    StateDetection fresh = layer();
    for (const Message& output : concluded) fresh.restore(output);
    const std::vector<std::string> done = consumed;
    for (const Message& input : received)
      if (std::find(done.begin(), done.end(), header_of(input).message_id) == done.end())
        add(test::receive(fresh, input, received));
    return fresh;
  }
  [[nodiscard]] std::vector<std::string> text() const {
    std::vector<std::string> lines;
    for (const Message& output : concluded) lines.push_back(to_json(output, JsonForm::exact));
    return lines;
  }
};

MaintenanceEvent replacement(UtcTime time) {
  MaintenanceEvent event;
  event.asset_id = "A1";
  event.header.message_id = "maintenance_event/A1/" + format_utc(time);
  event.header.event_time_known = true;
  event.header.event_time_ns = time.nanoseconds;
  event.kind = "actuator_replaced";
  return event;
}

/// A life with everything in it: late and cut tests, friction that grows, a lost channel, a replacement, two assets.
std::vector<Message> eventful_life() {
  std::vector<Message> messages;
  for (int number = 0; number < 20; ++number) {
    if (number == 8) continue;
    if (number == 14) messages.emplace_back(replacement(synthetic::month(13, 20)));
    Condition condition;
    condition.load_factor = 0.2 * std::sin(1.7 * number);
    condition.theta = 0.8 - 0.012 * number;
    if (number > 9) condition.friction_N = 3600;
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.asset_id = number % 5 == 2 ? "A2" : "A1";
    if (number == 5) circumstances.cut_after_s = 7.4;
    if (number == 14) circumstances.aborted = true;
    if (number == 11) circumstances.failed_channel = "flow";
    const synthetic::Test test = synthetic::make(condition, circumstances);
    messages.emplace_back(test.window);
    messages.emplace_back(test.features);
  }
  return messages;
}

const StateReport& last_report(const Journal& journal) { return std::get<StateReport>(journal.concluded.back()); }

const RegionJudgement& judgement(const StateReport& report, const std::string& quantity, Reference reference) {
  for (const RegionJudgement& j : report.judgements)
    if (j.quantity == quantity && j.reference == reference) return j;
  ADD_FAILURE() << "no judgement of " << quantity;
  static const RegionJudgement none;
  return none;
}

void play(StateDetection& detection, Journal& journal, const Condition& condition, const Circumstances& circumstances) {
  const synthetic::Test test = synthetic::make(condition, circumstances);
  journal.take(detection, test.window);
  journal.take(detection, test.features);
}

TEST(StateDetection, KilledAnywhereItEndsWithTheSameReports) {
  const std::vector<Message> life = eventful_life();
  Journal undisturbed;
  StateDetection detection = layer();
  for (const Message& message : life) undisturbed.take(detection, message);
  for (std::size_t cut = 0; cut <= life.size(); ++cut) {
    Journal journal;
    StateDetection before = layer();
    for (std::size_t k = 0; k < cut; ++k) journal.take(before, life[k]);
    StateDetection after = journal.restart();
    for (std::size_t k = cut; k < life.size(); ++k) journal.take(after, life[k]);
    ASSERT_EQ(journal.text(), undisturbed.text()) << "cut at " << cut;
    EXPECT_EQ(journal.consumed, undisturbed.consumed) << "cut at " << cut;
  }
}

TEST(StateDetection, OrderOfArrivalOfTheWindowDoesNotMatter) {
  Journal in_order;
  Journal features_first;
  StateDetection one = layer();
  StateDetection other = layer();
  std::vector<Message> windows;
  for (const Message& message : eventful_life()) {
    in_order.take(one, message);
    if (std::holds_alternative<TestWindow>(message))
      windows.push_back(message);
    else
      features_first.take(other, message);
  }
  for (const Message& window : windows) features_first.take(other, window);
  std::vector<std::string> expected = in_order.text();
  std::vector<std::string> found = features_first.text();
  // The replacement comes before the tests here, which by event time it does not change.
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

/// Remembers whether it was called off.
class Obedient final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& /*asset*/, const TimeSeries& /*recorded*/,
                                            const std::stop_token& cancel) const override {
    called_off = cancel.stop_requested();
    return fail("nothing is simulated here");
  }
  mutable bool called_off = false;
};

TEST(StateDetection, TheSimulationsOfATestCanBeCalledOff) {
  const auto simulator = std::make_shared<const Obedient>();
  StateDetection detection(std::vector<AssetConfig>{synthetic::asset("A1")}, simulator);
  const synthetic::Test made = synthetic::make({}, {});
  std::stop_source stop;
  (void)detection.receive_until(made.features, stop.get_token());
  stop.request_stop();
  (void)detection.receive_until(made.window, stop.get_token());
  EXPECT_TRUE(simulator->called_off);
}

/// Counts how often it is asked.
class Counting final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& cancel) const override {
    ++simulations;
    return synthetic::FakeSimulator(1.5, 0.0, 1e13).simulate(asset, recorded, cancel);
  }
  mutable int simulations = 0;
};

/// A test that goes on at rest for hours.
synthetic::Test followed_by_rest(synthetic::Test test, double hours) {
  constexpr double kApart_s = 4.0;
  TimeSeries& samples = test.window.samples;
  while (samples.time_s.back() < 3600.0 * hours) {
    samples.time_s.push_back(samples.time_s.back() + kApart_s);
    for (Series& series : samples.channels) series.values.push_back(series.values.back());
  }
  test.features.duration_s = samples.time_s.back();
  return test;
}

StateReport report_on(StateDetection& detection, const synthetic::Test& test) {
  (void)detection.receive(test.features);
  const Conclusion conclusion = detection.receive(test.window);
  EXPECT_THAT(conclusion.consumed,
              testing::UnorderedElementsAre(test.features.header.message_id, test.window.header.message_id));
  EXPECT_EQ(conclusion.outputs.size(), 1U);
  return std::get<StateReport>(conclusion.outputs.at(0));
}

TEST(StateDetection, ATestOfManyHoursIsRefusedByNameAndTheNextIsJudged) {
  const auto simulator = std::make_shared<const Counting>();
  StateDetection detection(std::vector<AssetConfig>{synthetic::asset("A1")}, simulator);
  const StateReport refused = report_on(detection, followed_by_rest(synthetic::make({}, {}), 12.0));
  EXPECT_EQ(refused.verdict, PstVerdict::not_judged);
  ASSERT_FALSE(refused.verdict_reasons.empty());
  EXPECT_THAT(refused.verdict_reasons.front(),
              testing::AllOf(HasSubstr("is 43200 s long"), HasSubstr("cut the recording to the stroke")));
  EXPECT_TRUE(refused.judgements.empty());
  EXPECT_EQ(simulator->simulations, 0);

  Circumstances later;
  later.number = 1;
  const StateReport good = report_on(detection, synthetic::make({}, later));
  EXPECT_EQ(good.verdict, PstVerdict::passed);
  EXPECT_FALSE(good.residuals.empty());
  later.number = 2;
  EXPECT_EQ(report_on(detection, followed_by_rest(synthetic::make({}, later), 6.0)).verdict, PstVerdict::passed);
}

/// What no simulation is needed for is said of it: the valve did not close.
TEST(StateDetection, AFailedStrokeOfManyHoursHasFailed) {
  const auto simulator = std::make_shared<const Counting>();
  StateDetection detection(std::vector<AssetConfig>{synthetic::asset("A1")}, simulator);
  Condition stuck;
  stuck.stroke_m = 0.004;
  const StateReport failed = report_on(detection, followed_by_rest(synthetic::make(stuck, {}), 12.0));
  EXPECT_EQ(failed.verdict, PstVerdict::failed);
  EXPECT_THAT(failed.verdict_reasons.front(), HasSubstr("the piston moved"));
  EXPECT_THAT(failed.verdict_reasons, Contains(testing::AllOf(HasSubstr("no simulation residual: the test is"),
                                                              HasSubstr("cut the recording to the stroke"))));
  EXPECT_FALSE(failed.judgements.empty());
  EXPECT_TRUE(failed.residuals.empty());
  EXPECT_EQ(simulator->simulations, 0);
}

TEST(StateDetection, ATestWhoseOtherHalfNeverComesHoldsUpNoLaterOne) {
  Journal undisturbed, attacked;
  StateDetection one = layer(), other = layer();
  int number = 0;
  for (const Message& message : eventful_life()) {
    undisturbed.take(one, message);
    if (!std::holds_alternative<MaintenanceEvent>(message)) attacked.take(other, test::forged(message, number++));
    attacked.take(other, message);
    ASSERT_EQ(attacked.concluded.size(), undisturbed.concluded.size()) << "after " << header_of(message).message_id;
  }
  EXPECT_LE(other.held(), 4 * 16 + 2) << "of two assets, features and windows";
  EXPECT_GT(other.held(), 0U);
  EXPECT_TRUE(attacked.text() == undisturbed.text());
}

TEST(StateDetection, AnyNumberOfForgedHalvesTakesNoMoreMemory) {
  StateDetection detection = layer();
  const synthetic::Test made = synthetic::make({}, {});
  test::expect_flat_under_forged_halves(detection, {made.features, made.window});
  (void)detection.receive(made.features);
  EXPECT_EQ(detection.receive(made.window).outputs.size(), 1U);
}

TEST(StateDetection, ATestThatWasOvertakenIsConcludedWhenItsOtherHalfComes) {
  Journal journal;
  StateDetection detection = layer();
  Circumstances later;
  later.number = 1;
  const synthetic::Test first = synthetic::make({}, {}), second = synthetic::make({}, later);
  journal.take(detection, first.features);
  journal.take(detection, second.features);
  journal.take(detection, second.window);
  EXPECT_EQ(last_report(journal).header.pst_id, second.features.header.pst_id);
  EXPECT_EQ(detection.held(), 1U);
  detection = journal.restart();
  journal.take(detection, first.window);  // it had been set aside
  EXPECT_EQ(last_report(journal).header.pst_id, first.features.header.pst_id);
  EXPECT_EQ(detection.held(), 0U);
}

TEST(StateDetection, HeaderNamesTestSourcesAndTimes) {
  Journal journal;
  StateDetection detection = layer();
  Circumstances circumstances;
  circumstances.number = 3;
  circumstances.replay = true;
  play(detection, journal, {}, circumstances);
  const Header& header = last_report(journal).header;
  EXPECT_EQ(header.message_id, "state_report/A1-3");
  EXPECT_EQ(header.pst_id, "A1-3");
  EXPECT_EQ(header.producer, "state_detection 0.1.0");
  EXPECT_TRUE(header.replay);
  EXPECT_EQ(header.event_time_ns, synthetic::month(3).nanoseconds);
  EXPECT_THAT(header.source_ids, testing::ElementsAre("test_features/A1-3", "sample_block/A1-3/0", "test_window/A1-3"));
}

TEST(StateDetection, LoadVariationAloneRaisesNothing) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 40; ++number) {
    Condition condition;
    condition.load_factor = 0.2 * std::sin(2.3 * number);
    Circumstances circumstances;
    circumstances.number = number;
    play(detection, journal, condition, circumstances);
    EXPECT_EQ(last_report(journal).region, AlertRegion::normal) << "test " << number;
    EXPECT_EQ(last_report(journal).verdict, PstVerdict::passed);
  }
}

TEST(StateDetection, GrowingFrictionIsSeenAgainstTheOwnBaselineAfterTwoTests) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 12; ++number) {
    Condition condition;
    if (number >= 8) condition.friction_N = 3200;  // +33 %
    Circumstances circumstances;
    circumstances.number = number;
    play(detection, journal, condition, circumstances);
    const RegionJudgement& friction = judgement(last_report(journal), "friction_pressure", Reference::own_baseline);
    EXPECT_EQ(friction.raw_region, number < 8 ? AlertRegion::normal : AlertRegion::warning) << number;
    EXPECT_EQ(friction.region, number < 9 ? AlertRegion::normal : AlertRegion::warning) << number;
  }
  EXPECT_EQ(last_report(journal).region, AlertRegion::warning);
}

TEST(StateDetection, SealIsJudgedOnTheWayToItsThreshold) {
  Journal journal;
  StateDetection detection = layer();
  std::vector<AlertRegion> regions;
  int number = 0;
  for (const double theta : {0.95, 0.80, 0.72, 0.69, 0.69, 0.64, 0.64, 0.59, 0.59}) {
    Condition condition;
    condition.theta = theta;
    Circumstances circumstances;
    circumstances.number = number++;
    play(detection, journal, condition, circumstances);
    regions.push_back(last_report(journal).region);
  }
  using enum AlertRegion;
  EXPECT_THAT(regions,
              testing::ElementsAre(normal, normal, normal, normal, advisory, advisory, warning, warning, alarm));
}

TEST(StateDetection, ResidualsAreJudgedAgainstBothReferences) {
  Journal journal;
  StateDetection detection = layer();
  play(detection, journal, {}, {});
  const StateReport& report = last_report(journal);
  EXPECT_EQ(report.residuals.size(), 14U);
  EXPECT_EQ(judgement(report, "residual.pressure_a", Reference::nominal_model).unit, "%");
  EXPECT_NEAR(judgement(report, "residual.pressure_a", Reference::own_baseline).value, 1.5, 1e-6);
}

TEST(StateDetection, ALateTestSaysHowLate) {
  Journal journal;
  StateDetection detection = layer();
  play(detection, journal, {}, {});
  Circumstances late;
  late.number = 2;
  play(detection, journal, {}, late);
  EXPECT_TRUE(last_report(journal).pst_overdue);
  EXPECT_NEAR(last_report(journal).overdue_days, 30.4, 0.1);
  EXPECT_THAT(last_report(journal).verdict_reasons, Contains(HasSubstr("30 days after it was due on 2031-02-09")));
}

TEST(StateDetection, ACutTestDoesNotCountAsTested) {
  Journal journal;
  StateDetection detection = layer();
  play(detection, journal, {}, {});
  Circumstances cut;
  cut.number = 1;
  cut.cut_after_s = 7.4;
  play(detection, journal, {}, cut);
  EXPECT_FALSE(last_report(journal).pst_overdue);
  EXPECT_TRUE(last_report(journal).judgements.empty());
  Circumstances next;
  next.number = 2;
  play(detection, journal, {}, next);
  EXPECT_TRUE(last_report(journal).pst_overdue);
}

TEST(StateDetection, AReplayHoldsNoOverdueTestOfALiveAssetBack) {
  Journal journal;
  StateDetection detection = layer();
  play(detection, journal, {}, {});
  Circumstances played_back;
  played_back.number = -1;
  played_back.replay = true;
  play(detection, journal, {}, played_back);
  const Conclusion overdue = detection.tick(synthetic::month(2));
  ASSERT_EQ(overdue.outputs.size(), 1U);
  EXPECT_EQ(header_of(overdue.outputs.front()).message_id, "state_report/A1/overdue/2031-02-09");
  EXPECT_EQ(journal.restart().tick(synthetic::month(2)).outputs, overdue.outputs);
}

TEST(StateDetection, OverdueOncePerDueDateAndNotInReplay) {
  for (const bool replay : {false, true}) {
    Journal journal;
    StateDetection detection = layer();
    Circumstances circumstances;
    circumstances.replay = replay;
    play(detection, journal, {}, circumstances);
    EXPECT_TRUE(detection.tick(synthetic::month(1, 10)).outputs.empty());
    Conclusion overdue = detection.tick(synthetic::month(2));
    ASSERT_EQ(overdue.outputs.size(), replay ? 0U : 1U);
    if (replay) continue;
    const StateReport& report = std::get<StateReport>(overdue.outputs.front());
    EXPECT_EQ(report.header.message_id, "state_report/A1/overdue/2031-02-09");
    EXPECT_EQ(report.header.pst_id, "");
    EXPECT_TRUE(report.pst_overdue);
    EXPECT_EQ(report.region, AlertRegion::advisory);
    // Asked later, it would say the same.
    StateDetection later = layer();
    for (const Message& output : journal.concluded) later.restore(output);
    EXPECT_EQ(later.tick(synthetic::month(7)).outputs, overdue.outputs);
    // And it says it once, also after a restart.
    EXPECT_TRUE(detection.tick(synthetic::month(3)).outputs.empty());
    journal.add(overdue);
    StateDetection restarted = journal.restart();
    EXPECT_TRUE(restarted.tick(synthetic::month(9)).outputs.empty());
    // The next test opens a new due date.
    Circumstances next;
    next.number = 3;
    play(restarted, journal, {}, next);
    EXPECT_EQ(restarted.tick(synthetic::month(5)).outputs.size(), 1U);
  }
}

TEST(StateDetection, AnAssetThatWasNeverHeardIsOverdueFromItsCommissioning) {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1"), synthetic::asset("A2")};
  const auto commissioned_a1 = [&assets](UtcTime time) {
    return StateDetection(assets, simulator(), {.commissioned = {{"A1", time}}});
  };
  StateDetection detection = commissioned_a1(synthetic::month(0));
  EXPECT_TRUE(detection.tick(synthetic::month(1, 10)).outputs.empty()) << "within the grace";
  const Conclusion overdue = detection.tick(synthetic::month(30));
  ASSERT_EQ(overdue.outputs.size(), 1U) << "not A2, of which it is not known; and however long it was silent";
  const StateReport& report = std::get<StateReport>(overdue.outputs.front());
  EXPECT_EQ(report.asset_id, "A1");
  EXPECT_TRUE(report.pst_overdue);
  EXPECT_NE(
      report.verdict_reasons.front().find("since the asset was commissioned on " + format_date(synthetic::month(0))),
      std::string::npos)
      << report.verdict_reasons.front();
  EXPECT_TRUE(detection.tick(synthetic::month(31)).outputs.empty()) << "once";
  StateDetection restarted = commissioned_a1(synthetic::month(0));
  restarted.restore(report);
  EXPECT_TRUE(restarted.tick(synthetic::month(31)).outputs.empty()) << "once, also after a restart";

  // A first test years after the commissioning is no late one: from then on it counts from that.
  Journal journal;
  StateDetection monitored_later = commissioned_a1(add_months(synthetic::month(0), -60.0));
  play(monitored_later, journal, {}, {});
  EXPECT_FALSE(last_report(journal).pst_overdue);
  EXPECT_TRUE(monitored_later.tick(synthetic::month(1, 10)).outputs.empty());
  EXPECT_EQ(monitored_later.tick(synthetic::month(2)).outputs.size(), 1U);
}

/// Its live sender may never have worked.
TEST(StateDetection, ACommissionedAssetWhoseHistoryWasPlayedBackIsOverdueFromItsLastTest) {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1")};
  const auto make = [&assets] {
    return StateDetection(assets, simulator(), {.commissioned = {{"A1", add_months(synthetic::month(0), -60.0)}}});
  };
  Journal journal;
  StateDetection detection = make();
  Circumstances played_back;
  played_back.replay = true;
  play(detection, journal, {}, played_back);
  const UtcTime years_later = synthetic::month(17 * 12);
  EXPECT_TRUE(detection.tick(years_later).outputs.empty()) << "its next test may come";
  EXPECT_TRUE(detection.tick(add_seconds(years_later, 599.0)).outputs.empty());
  const Conclusion overdue = detection.tick(add_seconds(years_later, 600.0));
  ASSERT_EQ(overdue.outputs.size(), 1U);
  EXPECT_EQ(header_of(overdue.outputs.front()).message_id, "state_report/A1/overdue/2031-02-09");
  EXPECT_TRUE(detection.tick(add_seconds(years_later, 1200.0)).outputs.empty()) << "once";
  StateDetection restarted = make();
  for (const Message& output : journal.concluded) restarted.restore(output);
  static_cast<void>(restarted.tick(years_later));
  EXPECT_EQ(restarted.tick(add_seconds(years_later, 600.0)).outputs, overdue.outputs);
  Circumstances live;
  live.number = 3;
  play(detection, journal, {}, live);
  EXPECT_TRUE(detection.tick(years_later).outputs.empty()) << "old recordings that are taken in live";
}

TEST(StateDetection, OldRecordingsThatAreTakenInLiveAreNotOverdue) {
  Journal journal;
  StateDetection detection = layer();
  play(detection, journal, {}, {});
  EXPECT_TRUE(detection.tick(synthetic::month(17 * 12)).outputs.empty());
}

TEST(StateDetection, WarmOilMovesNoRegionAndTeachesNothing) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 10; ++number) {
    Condition condition;
    Circumstances circumstances;
    circumstances.number = number;
    const bool warm = number >= 5 && number < 8;
    if (warm) circumstances.temperature_deviation_K = 15;
    if (warm) condition.theta = 0.62;  // leaks as a worn seal would
    play(detection, journal, condition, circumstances);
    const RegionJudgement& seal = judgement(last_report(journal), "leakage_resistance", Reference::limit);
    EXPECT_EQ(seal.raw_region, warm ? AlertRegion::warning : AlertRegion::normal) << number;
    EXPECT_EQ(seal.region, AlertRegion::normal) << number;
  }
}

TEST(StateDetection, UnknownEventTimeIsNeverLate) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 12; ++number) {
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.event_time_known = false;
    play(detection, journal, {}, circumstances);
    EXPECT_EQ(last_report(journal).verdict, PstVerdict::passed);
    EXPECT_FALSE(last_report(journal).pst_overdue);
    EXPECT_FALSE(last_report(journal).header.event_time_known);
  }
  EXPECT_TRUE(detection.tick(synthetic::month(100)).outputs.empty());
}

TEST(StateDetection, ALostChannelIsStaleAndAnAdvisory) {
  for (const bool absent : {false, true}) {
    Journal journal;
    StateDetection detection = layer();
    for (int number = 0; number < 4; ++number) {
      Circumstances circumstances;
      circumstances.number = number;
      if (number >= 2) (absent ? circumstances.absent_channel : circumstances.failed_channel) = "flow";
      play(detection, journal, {}, circumstances);
      const StateReport& report = last_report(journal);
      EXPECT_EQ(report.stale_channels.size(), number >= 2 ? 1U : 0U);
      EXPECT_EQ(report.region, number >= 3 ? AlertRegion::advisory : AlertRegion::normal);
    }
    EXPECT_THAT(last_report(journal).stale_channels, testing::ElementsAre("flow"));
    EXPECT_THAT(last_report(journal).verdict_reasons,
                Contains(HasSubstr(absent ? "flow, OK in most earlier tests, was not recorded"
                                          : "is FAILED: frozen for 4.0 s")));
  }
}

TEST(StateDetection, ALostChannelIsAnAlarmFromItsFirstTestUntilItIsBack) {
  Journal journal;
  StateDetection detection = layer();
  LostSensors lost;
  for (int number = 0; number < 6; ++number) {
    Circumstances circumstances;
    circumstances.number = number;
    if (number == 3 || number == 4) circumstances.failed_channel = "flow";
    play(detection, journal, {}, circumstances);
    const auto said = lost.look(journal.concluded.back());
    ASSERT_TRUE(said) << number;
    EXPECT_EQ(said->asset_id, "A1");
    ASSERT_EQ(said->standing.size(), number == 3 || number == 4 ? 1U : 0U) << number;
    if (number != 3) continue;
    EXPECT_EQ(said->standing[0].kind, "sensor_lost");
    EXPECT_EQ(said->standing[0].subject, "flow");
    EXPECT_EQ(said->standing[0].since_ns, last_report(journal).header.event_time_ns);
    EXPECT_THAT(said->standing[0].text, HasSubstr("is FAILED: frozen for 4.0 s"));
  }
  EXPECT_FALSE(lost.look(journal.concluded[3])) << "an older test says nothing about today";
}

/// Adds a channel to a test as a recording with one more column would.
void record_also(synthetic::Test& test, const std::string& channel) {
  test.window.channel_status.push_back({channel, ChannelState::OK, ""});
  test.features.channel_status = test.window.channel_status;
}

TEST(StateDetection, ASensorThatIsDeadFromTheFirstTestOnIsStale) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 3; ++number) {
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.failed_channel = "flow";
    play(detection, journal, {}, circumstances);
    EXPECT_THAT(last_report(journal).stale_channels, testing::ElementsAre("flow")) << number;
    EXPECT_THAT(last_report(journal).verdict_reasons,
                Contains(HasSubstr("channel flow, never OK before, is FAILED: frozen for 4.0 s")));
  }
}

TEST(StateDetection, AChannelThatOneTestHadBesidesIsNotMissed) {
  for (const int with_it : {0, 1, 5}) {
    Journal journal;
    StateDetection detection = layer();
    for (int number = 0; number < 12; ++number) {
      Circumstances circumstances;
      circumstances.number = number;
      synthetic::Test test = synthetic::make({}, circumstances);
      if (number == with_it) record_also(test, "pressure_differential");
      journal.take(detection, test.window);
      journal.take(detection, test.features);
      const StateReport& report = last_report(journal);
      const bool after_the_first = with_it == 0 && number == 1;  // one of one: nobody can know better
      EXPECT_EQ(report.stale_channels.size(), after_the_first ? 1U : 0U) << number;
      EXPECT_EQ(report.region, AlertRegion::normal) << number;
    }
  }
}

TEST(StateDetection, AChannelThatIsGivenUpIsMissedForAYear) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 60; ++number) {
    Circumstances circumstances;
    circumstances.number = number;
    if (number >= 30) circumstances.absent_channel = "flow";
    play(detection, journal, {}, circumstances);
    const bool missed = number >= 30 && number < 42;
    EXPECT_EQ(last_report(journal).stale_channels.size(), missed ? 1U : 0U) << number;
    EXPECT_EQ(last_report(journal).region, missed && number > 30 ? AlertRegion::advisory : AlertRegion::normal)
        << number;
    if (number == 36 || number == 45) detection = journal.restart();
  }
}

TEST(StateDetection, AReplacementStartsTheBaselineAnew) {
  Journal journal;
  StateDetection detection = layer();
  for (int number = 0; number < 10; ++number) {
    if (number == 6) {
      journal.take(detection, replacement(synthetic::month(5, 20)));
      EXPECT_EQ(detection.held(), 1U) << "kept until a test of the new one is judged: nothing is waiting";
    }
    Condition condition;
    if (number >= 6) condition.friction_N = 4000;  // the new one is tighter
    Circumstances circumstances;
    circumstances.number = number;
    play(detection, journal, condition, circumstances);
    EXPECT_EQ(last_report(journal).region, AlertRegion::normal) << number;
  }
  EXPECT_THAT(journal.consumed, Contains(HasSubstr("maintenance_event/A1")));
  EXPECT_EQ(detection.held(), 0U);
}

TEST(StateDetection, AnAssetThatIsNotConfiguredIsNotJudged) {
  Journal journal;
  StateDetection detection = layer();
  Circumstances circumstances;
  circumstances.asset_id = "nobody";
  play(detection, journal, {}, circumstances);
  EXPECT_EQ(last_report(journal).verdict, PstVerdict::not_judged);
  EXPECT_THAT(last_report(journal).verdict_reasons, Contains(HasSubstr("'nobody' is not in the configuration")));
}

TEST(StateDetection, OptionsAreChecked) {
  EXPECT_TRUE(StateDetectionOptions{}.validate());
  StateDetectionOptions options;
  options.overdue_grace_share = -1;
  EXPECT_FALSE(options.validate());
  options = {};
  options.baseline.tests = 2;
  EXPECT_FALSE(options.validate());
}

}  // namespace
}  // namespace sealwatch
