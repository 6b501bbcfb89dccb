// The bench as a process without a network: schedule, requests, the control system's priority.
#include "services/virtual_bench/bench_service.hpp"

#include <gtest/gtest.h>

#include "tests/unit/port/in_memory_bus.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

using namespace std::chrono_literals;

const UtcTime kInstalled = parse_utc("2030-01-01").value();
constexpr double kTest_s = 31.1;  // length of the default test

class Bench : public ::testing::Test {
 protected:
  Bench() { (void)listener_.subscribe(std::array{Topic::raw_samples}); }

  static ActuatorSetting setting(double commands_per_month = 0.0) {
    ActuatorSetting out;
    out.installed = kInstalled;
    out.commands_per_month = commands_per_month;
    out.block_s = 5.0;
    out.test.sample_rate_Hz = 20.0;
    return out;
  }
  /// Sets the time and returns what the bench publishes.
  std::vector<RawSamples> step_to(BenchService& service, UtcTime time) {
    clock_.set(time);
    EXPECT_TRUE(service.step(0ms));
    std::vector<RawSamples> blocks;
    for (const BusItem& item : listener_.receive(0ms, 10000))
      blocks.push_back(std::get<RawSamples>(std::get<Message>(item)));
    return blocks;
  }
  void ask(double due_s, const std::string& id) {
    PstRequest request;
    request.asset_id = "XT03-MV2";
    request.header.message_id = id;
    request.due_time_ns = add_seconds(kInstalled, due_s).nanoseconds;
    ASSERT_TRUE(listener_.publish(Message(request)));
  }
  static UtcTime at(double seconds) { return add_seconds(kInstalled, seconds); }

  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus bus_{network_};
  InMemoryBus listener_{network_};
  ManualClock clock_{kInstalled};
};

TEST_F(Bench, TestsByItsOwnScheduleWhereNobodyAsks) {
  BenchService service(bus_, clock_, {nominal_asset()}, setting());
  ASSERT_TRUE(service.start());
  EXPECT_TRUE(step_to(service, add_months(kInstalled, 0.999)).empty());
  const std::vector<RawSamples> blocks = step_to(service, add_seconds(add_months(kInstalled, 1.0), kTest_s));
  ASSERT_EQ(blocks.size(), 7U);  // 31 s in blocks of 5 s
  EXPECT_EQ(blocks.front().boundary, BlockBoundary::begin);
  EXPECT_EQ(blocks.back().boundary, BlockBoundary::end);
  EXPECT_EQ(blocks.front().start_time_ns, add_months(kInstalled, 1.0).nanoseconds);
  EXPECT_EQ(blocks.front().test_kind, "pst");
  EXPECT_EQ(blocks.front().asset_id, "XT03-MV2");
  EXPECT_LT(service.actuators().front().condition(), 1.0);
}

TEST_F(Bench, ARequestSetsTheTimeOfTheTest) {
  BenchService service(bus_, clock_, {nominal_asset()}, setting());
  ASSERT_TRUE(service.start());
  ask(100.0, "pst_request/1");
  EXPECT_TRUE(step_to(service, at(99.0)).empty());
  const std::vector<RawSamples> begun = step_to(service, at(105.0));
  ASSERT_EQ(begun.size(), 1U);  // the test runs: its first block alone
  EXPECT_EQ(begun[0].header.source_ids, std::vector<std::string>{"pst_request/1"});
  EXPECT_EQ(step_to(service, at(100.0 + kTest_s)).back().boundary, BlockBoundary::end);
  ask(100.0, "pst_request/1");  // the same again, as a late subscriber gets it: no second test
  EXPECT_TRUE(step_to(service, at(1000.0)).empty());
}

TEST_F(Bench, ACommandAbortsARunningTest) {
  BenchService service(bus_, clock_, {nominal_asset()}, setting());
  ASSERT_TRUE(service.start());
  ask(100.0, "pst_request/1");
  (void)step_to(service, at(90.0));
  service.actuators().front().command(at(112.0));
  const std::vector<RawSamples> blocks = step_to(service, at(113.0));
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_FALSE(blocks[1].aborted);
  EXPECT_TRUE(blocks[2].aborted);
  EXPECT_EQ(blocks[2].boundary, BlockBoundary::end);
  EXPECT_EQ(blocks[2].abort_reason, "MCS command had priority");
  EXPECT_LE(blocks[2].samples.time_s.back(), 12.0);
  // The command is carried out, then the test is repeated after the deferral.
  const std::vector<RawSamples> command = step_to(service, at(300.0));
  ASSERT_FALSE(command.empty());
  EXPECT_EQ(command.front().test_kind, "full_stroke");
  EXPECT_EQ(command.front().start_time_ns, at(112.0).nanoseconds);
  EXPECT_EQ(command.back().boundary, BlockBoundary::end);
  const double free_s = 112.0 + command.back().samples.time_s.back();
  EXPECT_TRUE(step_to(service, at(free_s + 3590.0)).empty());
  const std::vector<RawSamples> repeated = step_to(service, at(free_s + 3600.0 + kTest_s));
  ASSERT_FALSE(repeated.empty());
  EXPECT_EQ(repeated.front().test_kind, "pst");
  EXPECT_FALSE(repeated.back().aborted);
}

TEST_F(Bench, ATestThatFallsDueDuringACommandIsDeferred) {
  BenchService service(bus_, clock_, {nominal_asset()}, setting());
  ASSERT_TRUE(service.start());
  service.actuators().front().command(at(95.0));
  ask(100.0, "pst_request/1");
  const std::vector<RawSamples> blocks = step_to(service, at(600.0));
  ASSERT_FALSE(blocks.empty());
  for (const RawSamples& block : blocks) EXPECT_EQ(block.test_kind, "full_stroke");
  const std::vector<RawSamples> deferred = step_to(service, at(95.0 + 3600.0 + 300.0));
  ASSERT_FALSE(deferred.empty());
  EXPECT_EQ(deferred.front().test_kind, "pst");
  EXPECT_EQ(deferred.front().header.source_ids, std::vector<std::string>{"pst_request/1"});
}

TEST_F(Bench, AFullStrokeClosesTheValveInSixtySeconds) {
  BenchService service(bus_, clock_, {quiet_asset()}, setting());
  ASSERT_TRUE(service.start());
  service.actuators().front().command(at(0.0));
  double closed_at_s = 0.0;
  for (const RawSamples& block : step_to(service, at(200.0))) {
    const Series& position = *block.samples.find("position");
    for (std::size_t k = 0; k < position.values.size(); ++k)
      if (closed_at_s == 0.0 && position.values[k] < 2.1e-3) closed_at_s = block.samples.time_s[k];
  }
  EXPECT_GT(closed_at_s, 0.0);
  EXPECT_LT(closed_at_s, 60.0);
}

TEST_F(Bench, OneLongStepGivesTheSameTestsAsManyShortOnes) {
  const UtcTime end = add_months(kInstalled, 6.0);
  const auto tests_of = [this, end](int steps) {
    std::vector<std::string> tests;
    ActuatorSetting own = setting(2.0);
    SimulatedActuator actuator(nominal_asset(), own);
    for (int k = 1; k <= steps; ++k) {
      const UtcTime now = add_seconds(kInstalled, seconds_between(kInstalled, end) * k / steps);
      const std::vector<RawSamples> blocks = actuator.advance(now).value();
      for (const RawSamples& block : blocks)
        if (block.boundary == BlockBoundary::end)
          tests.push_back(block.header.message_id + (block.aborted ? " aborted" : ""));
    }
    return tests;
  };
  const std::vector<std::string> once = tests_of(1);
  EXPECT_GT(once.size(), 8U);  // five or six tests by schedule, some twelve commands
  EXPECT_EQ(tests_of(500), once);
}

TEST_F(Bench, ReplacementStartsANewLife) {
  BenchService service(bus_, clock_, {nominal_asset()}, setting());
  ASSERT_TRUE(service.start());
  (void)step_to(service, add_months(kInstalled, 100.5));
  const double worn = service.actuators().front().condition();
  EXPECT_LT(worn, 0.9);
  MaintenanceEvent event;
  event.asset_id = "XT03-MV2";
  event.kind = "seal_replaced";
  event.header.message_id = "maintenance_event/1";
  event.header.event_time_ns = add_months(kInstalled, 100.5).nanoseconds;
  ASSERT_TRUE(listener_.publish(Message(event)));
  (void)step_to(service, add_months(kInstalled, 101.2));
  EXPECT_GT(service.actuators().front().condition(), worn);
}

TEST_F(Bench, LeavesOtherPlantsAlone) {
  AssetConfig other = nominal_asset();
  other.model = "emps";
  BenchService service(bus_, clock_, {other}, setting());
  ASSERT_TRUE(service.start());
  EXPECT_TRUE(service.actuators().empty());
}

TEST(AcceleratedClock, PassesFaster) {
  ManualClock real(parse_utc("2026-01-01").value());
  const AcceleratedClock clock(real, kInstalled, 1000.0);
  real.advance(2.5);
  EXPECT_NEAR(seconds_between(kInstalled, clock.now()), 2500.0, 1e-6);
}

}  // namespace
}  // namespace sealwatch::bench
