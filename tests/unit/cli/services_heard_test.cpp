#include "services/cli/services_heard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/cli/service_alarms.hpp"
#include "services/cli/status_overview.hpp"

namespace sealwatch::cli {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

ServiceStatus beat(const std::string& service, std::int32_t process, const std::string& state = "running") {
  ServiceStatus status;
  status.service = service;
  status.process_id = process;
  status.state = state;
  return status;
}

const UtcTime kNow{1'900'000'000'000'000'000};

class Listening : public ::testing::Test {
 protected:
  [[nodiscard]] std::string line(std::size_t k) const { return one_line(heard_.list(now_)[k]); }

  ServicesHeard heard_{{"data_acquisition", "health_assessment"}};
  ServicesHeard::Clock::time_point now_{std::chrono::hours(1)};
};

TEST_F(Listening, NamesAServiceThatIsNotHeard) {
  EXPECT_TRUE(heard_.none());
  heard_.take(beat("data_acquisition", 7), now_);
  EXPECT_FALSE(heard_.all_well(now_));
  EXPECT_EQ(line(1), "health_assessment  no heartbeat");
  heard_.take(beat("health_assessment", 8), now_);
  EXPECT_TRUE(heard_.all_well(now_));
  EXPECT_THAT(line(1), HasSubstr("health_assessment  running  pid 8"));
}

TEST_F(Listening, KnowsThatOthersMayStillBeFound) {
  EXPECT_FALSE(heard_.incomplete()) << "nothing runs: nobody is waited for";
  heard_.take(beat("data_acquisition", 7), now_);
  EXPECT_TRUE(heard_.incomplete());
  heard_.take(beat("health_assessment", 8), now_);
  EXPECT_FALSE(heard_.incomplete());
}

/// On a busy machine a heartbeat comes before what the service has concluded.
TEST_F(Listening, KnowsThatWhatAServiceHasConcludedIsStillToCome) {
  ServicesHeard heard({"health_assessment"}, {Topic::health_report});
  ServiceStatus status = beat("health_assessment", 8);
  status.writer_id = "health_assessment-1";
  status.written = {{"health_report", status.writer_id, 0}, {"act_record", status.writer_id, 3}};
  heard.take(status, now_);
  EXPECT_FALSE(heard.awaits_conclusions()) << "it has concluded nothing";
  status.written[0].sequence = 2;
  heard.take(status, now_);
  EXPECT_TRUE(heard.awaits_conclusions());
  HealthReport report;
  report.header.writer_id = "somebody else";
  heard.take(Message(report));
  EXPECT_TRUE(heard.awaits_conclusions());
  report.header.writer_id = status.writer_id;
  heard.take(Message(report));
  EXPECT_FALSE(heard.awaits_conclusions());
}

TEST_F(Listening, NamesAServiceThatFallsSilent) {
  heard_.take(beat("data_acquisition", 7), now_);
  heard_.take(beat("health_assessment", 8), now_ - milliseconds(4000));
  EXPECT_FALSE(heard_.all_well(now_));
  EXPECT_THAT(line(1), HasSubstr("no heartbeat for 4 s"));
  EXPECT_TRUE(heard_.all_well(now_ - milliseconds(2000)));
}

TEST_F(Listening, NamesAServiceThatStartsAgainAndAgainOrStops) {
  heard_.take(beat("data_acquisition", 7), now_);
  heard_.take(beat("data_acquisition", 9), now_);
  heard_.take(beat("health_assessment", 8, "stopping"), now_);
  EXPECT_THAT(line(0), HasSubstr("heard from 2 processes"));
  EXPECT_THAT(line(1), HasSubstr("health_assessment  stopping"));
  EXPECT_FALSE(heard_.all_well(now_));
}

TEST_F(Listening, TellsWhyAServiceStartsAgainAndAgain) {
  heard_.take(beat("data_acquisition", 7), now_);
  ServiceStatus last = beat("data_acquisition", 7, "stopping");
  last.last_error = "database or disk is full";
  heard_.take(last, now_);
  heard_.take(beat("data_acquisition", 9), now_);
  EXPECT_THAT(line(0), HasSubstr("runs twice; the last to end said: database or disk is full"));
}

TEST_F(Listening, ListsAServiceThatIsNotExpectedHereWithoutAskingForIt) {
  heard_.take(beat("data_acquisition", 7), now_);
  heard_.take(beat("health_assessment", 8), now_);
  heard_.take(beat("advisory_generation", 9, "stopping"), now_);
  ASSERT_EQ(heard_.list(now_).size(), 3U);
  EXPECT_FALSE(heard_.list(now_)[2].expected);
  EXPECT_TRUE(heard_.all_well(now_));
}

TEST_F(Listening, TellsWhatServicesCannotMendByThemselvesWithItsCategory) {
  ServiceStatus status = beat("data_acquisition", 7);
  status.alarms = {{.kind = "set_aside",
                    .asset_id = "A",
                    .subject = "raw_samples/R/1",
                    .pst_id = {},
                    .text = "no such phase",
                    .since_ns = 1'900'000'000'000'000'000}};
  status.alarm_count = 4;
  heard_.take(status, now_);
  const std::vector<HeardAlarm> alarms = alarms_of(heard_.list(now_));
  ASSERT_EQ(alarms.size(), 2U);
  EXPECT_EQ(lines_of(alarms[0], kNow),
            "ALARM (failure)  data_acquisition  A  set aside after two failures since 2030-03-17T17:46:40Z: "
            "raw_samples/R/1: no\n  such phase; and 3 more: sealwatch quarantine list\n"
            "  (sealwatch quarantine retry raw_samples/R/1 --by NAME)\n");
  EXPECT_EQ(lines_of(alarms[1], kNow), "ALARM (failure)  health_assessment  is not heard: no heartbeat\n");
  heard_.take(beat("data_acquisition", 7), now_);
  heard_.take(beat("health_assessment", 8), now_);
  EXPECT_TRUE(alarms_of(heard_.list(now_)).empty()) << "it is over";
}

TEST_F(Listening, OnlyWhatIsNotSeenNowCountsAsBlind) {
  ServiceStatus status = beat("data_acquisition", 7);
  const auto alarm_of = [&](const std::string& kind) {
    status.alarms = {{.kind = kind, .asset_id = {}, .subject = {}, .pst_id = {}, .text = "why", .since_ns = 0}};
    status.alarm_count = 1;
    heard_.take(status, now_);
    heard_.take(beat("health_assessment", 8), now_);
    return alarms_of(heard_.list(now_));
  };
  EXPECT_EQ(lines_of(alarm_of("clock_unsynchronised")[0], kNow),
            "ALARM (maintenance required)  data_acquisition  clock is not synchronised: why\n");
  EXPECT_FALSE(is_blind(alarm_of("clock_unsynchronised"), kNow)) << "it is right still, and will not be for ever";
  for (const char* kind : {"sensor_lost", "future_test", "refused_test", "unknown_writer", "unknown_asset",
                           "refused_right", "flood", "clock_step", "rival", "set_aside"})
    EXPECT_TRUE(is_blind(alarm_of(kind), kNow)) << kind;
  EXPECT_EQ(category_of("sensor_lost"), Ne107::failure);
  EXPECT_EQ(category_of("refused_right"), Ne107::out_of_specification);
}

TEST_F(Listening, SaysTheStateThatAdvisoryGenerationKeepsOfAnAlarm) {
  const ServiceAlarm lost{
      .kind = "sensor_lost", .asset_id = "A", .subject = "flow", .pst_id = {}, .text = "flat", .since_ns = 0};
  ServiceStatus status = beat("data_acquisition", 7);
  status.alarms = {lost};
  status.alarm_count = 1;
  heard_.take(status, now_);
  const auto line_with = [&](const AlarmEntry& entry) {
    ServiceStatus desk = beat("health_assessment", 8);
    desk.desk = {entry};
    heard_.take(desk, now_);
    const auto alarms = alarms_of(heard_.list(now_));
    EXPECT_EQ(alarms.size(), 1U);
    return std::pair(lines_of(alarms[0], kNow), is_blind(alarms, kNow));
  };
  const std::string rest = " (failure)  data_acquisition  A  sensor lost: flow: flat\n";
  AlarmEntry entry;
  entry.service = "data_acquisition";
  entry.alarm = lost;
  EXPECT_EQ(line_with(entry), std::pair("ALARM" + rest, true));
  entry.acknowledged_by = "J. Silva";
  EXPECT_EQ(line_with(entry), std::pair("ALARM, acknowledged by J. Silva" + rest, true));
  entry.suppressed_by = "rival";
  EXPECT_EQ(line_with(entry), std::pair("SUPPRESSED by rival" + rest, false));
  entry.shelved_by = "M. Okoye";
  entry.shelved_reason = "ordered";
  entry.shelved_until_ns = kNow.nanoseconds + 1'000'000'000;
  EXPECT_EQ(line_with(entry), std::pair("SHELVED until 2030-03-17T17:46:41Z by M. Okoye, ordered" + rest, false));
  entry.shelved_until_ns = kNow.nanoseconds;
  entry.suppressed_by.clear();
  EXPECT_EQ(line_with(entry).second, true) << "its shelf has ended";
  entry.out_of_service_by = "R. Fitter";
  EXPECT_EQ(line_with(entry), std::pair("OUT OF SERVICE by R. Fitter" + rest, false));
}

TEST_F(Listening, ListsWhatReturnedUnseenAndLeavesAdviceToItsAdvisory) {
  heard_.take(beat("data_acquisition", 7), now_);
  ServiceStatus status = beat("health_assessment", 8);
  AlarmEntry returned;
  returned.service = "state_detection";
  returned.alarm = {
      .kind = "sensor_lost", .asset_id = "A", .subject = "flow", .pst_id = {}, .text = "flat", .since_ns = 0};
  returned.ended_ns = kNow.nanoseconds;
  AlarmEntry advice;
  advice.service = "advisory_generation";
  advice.alarm = {
      .kind = "advice", .asset_id = "A", .subject = "recommendation/x", .pst_id = {}, .text = "Book", .since_ns = 0};
  status.desk = {returned, advice};
  heard_.take(status, now_);
  const auto alarms = alarms_of(heard_.list(now_));
  ASSERT_EQ(alarms.size(), 2U);
  EXPECT_EQ(lines_of(alarms[0], kNow),
            "ENDED 2030-03-17T17:46:40Z, not acknowledged (failure)  state_detection  A  sensor lost: flow: flat\n"
            "  (sealwatch acknowledge A sensor_lost/flow --by NAME)\n");
  EXPECT_EQ(status_overview(heard_.list(now_), alarms, {}, kNow),
            "2 of 2 services well, no alarm, 1 ended alarm to acknowledge\n");
  Advisory book;
  book.asset_id = "A";
  book.action = AdvisoryAction::book_vessel;
  book.priority = AdvisoryPriority::high;
  std::map<std::string, AssetView> assets;
  assets["A"].take(Message(book));
  EXPECT_THAT(status_overview(heard_.list(now_), alarms, assets, kNow), HasSubstr("\nA: HIGH, book vessel\n"));
  book.action = AdvisoryAction::none;
  assets["A"].take(Message(book));
  EXPECT_THAT(status_overview(heard_.list(now_), alarms, assets, kNow), HasSubstr("\nno actuator asks for action\n"));
  EXPECT_FALSE(is_blind(alarms, kNow));
  EXPECT_FALSE(stands_in_advisory(alarms[0], kNow));
  EXPECT_TRUE(stands_in_advisory(alarms[1], kNow));
}

}  // namespace
}  // namespace sealwatch::cli
