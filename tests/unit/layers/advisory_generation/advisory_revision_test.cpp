#include "services/advisory_generation/advisory_revision.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sealwatch::advisory_generation {
namespace {

using ::testing::ElementsAre;

constexpr std::int64_t kDay_ns = 86'400'000'000'000;

Recommendation booking(std::optional<std::int64_t> latest_by_ns) {
  Recommendation recommendation;
  recommendation.priority = AdvisoryPriority::high;
  recommendation.action = AdvisoryAction::book_vessel;
  recommendation.text = "Book a vessel.";
  if (latest_by_ns) recommendation.latest_by = UtcTime{*latest_by_ns};
  return recommendation;
}

Header test(const std::string& pst_id) {
  Header header;
  header.message_id = "remaining_life/" + pst_id;
  header.pst_id = pst_id;
  return header;
}

Advisory acknowledged(std::optional<std::int64_t> latest_by_ns) {
  Advisory advisory = revision_of({}, "A", booking(latest_by_ns), test("a1"));
  advisory.state = AdvisoryState::acknowledged;
  advisory.acknowledged_by = "J. Silva";
  return advisory;
}

AdvisoryState state_after(std::optional<std::int64_t> before_ns, std::optional<std::int64_t> now_ns) {
  return revision_of(acknowledged(before_ns), "A", booking(now_ns), test("a2")).state;
}

TEST(AdvisoryRevision, StaysAcknowledgedUntilItPressesMore) {
  EXPECT_EQ(state_after(30 * kDay_ns, 30 * kDay_ns), AdvisoryState::acknowledged);
  EXPECT_EQ(state_after(30 * kDay_ns, 60 * kDay_ns), AdvisoryState::acknowledged);
  EXPECT_EQ(state_after({}, {}), AdvisoryState::acknowledged);
  EXPECT_EQ(state_after(30 * kDay_ns, 29 * kDay_ns), AdvisoryState::active);
  EXPECT_EQ(state_after({}, 30 * kDay_ns), AdvisoryState::active);
  EXPECT_EQ(state_after(30 * kDay_ns, {}), AdvisoryState::active) << "as soon as may be, where there was a date";
}

TEST(AdvisoryRevision, WhatIsSaidAgainStillRestsOnWhatItRestedOn) {
  MaintenanceEvent event;
  event.asset_id = "A";
  event.kind = "seal_replaced";
  event.header.message_id = "maintenance_event/A/2011-01-01T00:00:00Z";
  const Advisory standing = revision_of({}, "A", booking(30 * kDay_ns), test("a1"));
  const Advisory again = after_late_replacement(standing, event);
  EXPECT_EQ(again.revision, standing.revision + 1);
  EXPECT_THAT(again.header.source_ids, ElementsAre(event.header.message_id, standing.header.message_id));
}

}  // namespace
}  // namespace sealwatch::advisory_generation
