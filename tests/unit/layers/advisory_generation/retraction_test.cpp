// Advice after a retraction: it stands, says who and why, and the next test is judged with those that count.
#include "sealwatch/message/retraction.hpp"

#include <gmock/gmock.h>

#include "services/advisory_generation/advisory_generation.hpp"
#include "tests/unit/layers/advisory_generation/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::advisory_generation {
namespace {

using namespace sealwatch::test;
using testing::HasSubstr;

MaintenanceEvent event(std::string_view kind, const std::string& what, double month) {
  MaintenanceEvent said;
  said.asset_id = kAsset;
  said.kind = kind;
  said.reported_by = "J. Silva";
  said.remark = "wrong clock";
  said.header.event_time_known = true;
  said.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  said.header.message_id = retraction_id(kAsset, kind, what, {said.header.event_time_ns});
  return said;
}

class AdviceAfterRetraction : public testing::Test {
 protected:
  std::vector<Message> run(const std::vector<Message>& inputs, std::optional<std::size_t> death_after = {}) const {
    return run_layer([this] { return AdvisoryGeneration::make(configuration_).value(); }, inputs, death_after);
  }
  Advisory last_of(const std::vector<Message>& inputs) const { return of_kind<Advisory>(run(inputs)).back(); }

  Configuration configuration_ = configuration();
};

std::vector<Message> joined(std::vector<Message> inputs, const std::vector<Message>& more) {
  inputs.insert(inputs.end(), more.begin(), more.end());
  return inputs;
}

/// One test of a wrong year silences all that follow, until it is retracted.
TEST_F(AdviceAfterRetraction, ATestOfTheFutureNoLongerHidesTheOthers) {
  const auto before = inputs_of(life_until(24, 30, 120.0));
  const auto deceived = joined(before, inputs_of(life_until(118, 118, 120.0)));
  const auto after = inputs_of(life_until(31, 34, 120.0));
  EXPECT_NE(last_of(joined(deceived, after)).header.pst_id, TestCase{.month = 34}.pst_id());
  const auto mended = joined(deceived, {event(kTestRetracted, TestCase{.month = 118}.pst_id(), 30.5)});
  const Advisory answer = last_of(mended);
  EXPECT_THAT(answer.reasons.front(), HasSubstr("retracted by J. Silva (wrong clock): this advice stands until"));
  EXPECT_EQ(answer.header.message_id, "advisory/" + header_of(mended.back()).message_id);
  const Advisory now = last_of(joined(mended, after));
  const Advisory undisturbed = last_of(joined(before, after));
  EXPECT_EQ(now.header.pst_id, undisturbed.header.pst_id);
  EXPECT_EQ(now.action, undisturbed.action);
  EXPECT_EQ(now.priority, undisturbed.priority);
  EXPECT_EQ(now.reasons, undisturbed.reasons);
}

TEST_F(AdviceAfterRetraction, WithdrawnItIsAsItWas) {
  const auto before = inputs_of(life_until(24, 40, 60.0));
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 29.5)), 40.1);
  const auto both = joined(before, {since, event(kRetractionWithdrawn, since.header.message_id, 40.2)});
  const auto next = inputs_of(life_until(41, 41, 60.0));
  EXPECT_EQ(last_of(joined(both, next)).reasons, last_of(joined(before, next)).reasons);
}

TEST_F(AdviceAfterRetraction, DeathAnywhereChangesNothing) {
  auto inputs = inputs_of(life_until(60, 80, 100.0));
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 66.5)), 70.1);
  inputs.insert(inputs.begin() + 20, event(kTestRetracted, TestCase{.month = 75}.pst_id(), 65.1));
  inputs.insert(inputs.begin() + 45, since);
  inputs.insert(inputs.begin() + 60, event(kRetractionWithdrawn, since.header.message_id, 75.0));
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

}  // namespace
}  // namespace sealwatch::advisory_generation
