// The record of what people did shows whoever changes it.
#include "services/common/store/audit_trail.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/store/journal.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kService = "advisory_generation";

OperatorAct act(int number) {
  return {.at = {1'900'000'000'000'000'000 + number},
          .kind = "acknowledgement",
          .asset_id = "XT03",
          .who = "J. Silva",
          .subject = "acknowledgement/XT03/" + std::to_string(number),
          .text = "vessel is booked",
          .outcome = "taken"};
}

class AuditTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!place_.usable()) GTEST_SKIP() << Place::why_not();
    auto journal = Journal::open(place_.connection(), kService);
    ASSERT_TRUE(journal) << journal.error().describe();
    for (int number = 1; number <= 5; ++number) {
      ASSERT_TRUE(journal->begin());
      const auto entry = journal->record(act(number));
      ASSERT_TRUE(entry) << entry.error().describe();
      hashes_.push_back(entry->hash);
      ASSERT_TRUE(journal->commit());
    }
    // Who changes a record can remove what guards it in the database, too.
    if (std::string(GetParam()) == "sqlite3")
      for (const char* guard : {"UPDATE", "DELETE"}) place_.execute(std::string("DROP TRIGGER acts_no_") + guard);
  }
  std::vector<AuditEntry> entries() {
    auto read = read_audit_trail(place_.connection(), kService);
    EXPECT_TRUE(read) << read.error().describe();
    return *read;
  }
  std::optional<AuditBreak> look() { return find_break(kService, entries()); }
  /// Changes the record and expects it to be seen at this entry.
  void expect_seen(const std::string& change, std::int64_t sequence, const std::string& why) {
    place_.execute(change);
    const auto found = look();
    ASSERT_TRUE(found) << change;
    EXPECT_EQ(found->sequence, sequence) << change;
    EXPECT_THAT(found->why, HasSubstr(why)) << change;
  }

  Place place_{GetParam()};
  std::vector<std::string> hashes_;
};

TEST_P(AuditTest, IsWholeAsItWasWrittenAlsoByANewProcess) {
  EXPECT_FALSE(look());
  ASSERT_THAT(entries(), SizeIs(5));
  EXPECT_EQ(entries()[2].act.subject, act(3).subject);
  EXPECT_EQ(entries()[2].act.at, act(3).at);
  auto again = Journal::open(place_.connection(), kService);
  ASSERT_TRUE(again->begin());
  ASSERT_TRUE(again->record(act(6)));
  ASSERT_TRUE(again->commit());
  EXPECT_FALSE(look());
  EXPECT_EQ(entries().back().previous, hashes_.back());
}

TEST_P(AuditTest, WhatIsRolledBackWasNeverThere) {
  auto journal = Journal::open(place_.connection(), kService);
  ASSERT_TRUE(journal->begin());
  ASSERT_TRUE(journal->record(act(6)));
  journal->rollback();
  EXPECT_THAT(entries(), SizeIs(5));
  EXPECT_FALSE(look());
}

TEST_P(AuditTest, AChangeInAnyFieldIsSeen) {
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"at", "at + 1"},         {"kind", "'retraction'"},  {"asset_id", "'XT04'"},  {"who", "'somebody else'"},
      {"subject", "'another'"}, {"remark", "'no vessel'"}, {"outcome", "'refused'"}};
  for (const auto& [field, value] : changes) {
    const auto before = entries()[2];
    expect_seen("UPDATE acts SET " + field + " = " + value + " WHERE sequence = 3", 3, "not what was written");
    place_.execute("UPDATE acts SET at = " + std::to_string(before.act.at.nanoseconds) + ", kind = '" +
                   before.act.kind + "', asset_id = 'XT03', who = 'J. Silva', subject = '" + before.act.subject +
                   "', remark = 'vessel is booked', outcome = 'taken' WHERE sequence = 3");
    ASSERT_FALSE(look()) << "as it was";
  }
}

TEST_P(AuditTest, AWordThatMovesFromOneFieldToTheNextIsSeen) {
  expect_seen("UPDATE acts SET who = 'J. Silvavessel', remark = ' is booked' WHERE sequence = 2", 2,
              "not what was written");
}

TEST_P(AuditTest, AnEntryChangedWithAHashOfItsOwnBreaksTheNext) {
  AuditEntry forged = entries()[2];
  forged.act.who = "nobody";
  expect_seen("UPDATE acts SET who = 'nobody', hash = '" + audit_hash(forged) + "' WHERE sequence = 3", 4,
              "does not follow");
}

TEST_P(AuditTest, ARemovedEntryIsSeenFirstAndInBetween) {
  expect_seen("DELETE FROM acts WHERE sequence = 4", 4, "it was removed");
  expect_seen("DELETE FROM acts WHERE sequence = 1", 1, "it was removed");
}

TEST_P(AuditTest, ARemovedEntryIsSeenAlsoWhereTheOthersMoveUp) {
  place_.execute("DELETE FROM acts WHERE sequence = 2");
  for (const char* next : {"3", "4", "5"})
    place_.execute(std::string("UPDATE acts SET sequence = sequence - 1 WHERE sequence = ") + next);
  const auto found = look();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->sequence, 2);
  EXPECT_THAT(found->why, HasSubstr("does not follow"));
}

TEST_P(AuditTest, TwoEntriesInEachOthersPlaceAreSeen) {
  place_.execute("UPDATE acts SET sequence = 9 WHERE sequence = 2");
  place_.execute("UPDATE acts SET sequence = 2 WHERE sequence = 3");
  expect_seen("UPDATE acts SET sequence = 3 WHERE sequence = 9", 2, "does not follow");
}

TEST_P(AuditTest, AnotherServicesRecordIsNoneOfThisOne) {
  EXPECT_TRUE(find_break("state_detection", entries()));
  EXPECT_FALSE(find_break("state_detection", {}));
}

TEST_P(AuditTest, AnEndThatIsCutOffIsKnownByAHashThatWasNoted) {
  place_.execute("DELETE FROM acts WHERE sequence = 5");
  EXPECT_FALSE(look()) << "what is left is whole";
  for (const AuditEntry& entry : entries()) EXPECT_NE(entry.hash, hashes_.back());
}

/// Whoever cuts a record off would take away first what others heard of it.
TEST_P(AuditTest, WhatOtherServicesHeardIsMissedWhereItWasRemovedOrRenamed) {
  for (const std::string change :
       {"DELETE FROM anchors WHERE sequence = 2", "DELETE FROM anchors", "DROP TABLE anchors",
        "ALTER TABLE anchors RENAME TO other_anchors", "UPDATE anchors SET service = 'nobody' WHERE sequence = 4"}) {
    const Place neighbours{GetParam()};
    const auto open = [&] { return std::move(*Journal::open(neighbours.connection(), "state_detection")); };
    {
      Journal neighbour = open();
      ASSERT_TRUE(neighbour.begin());
      for (const std::int64_t heard : {2, 4, 4})
        ASSERT_TRUE(neighbour.keep_anchor({kService, heard, hashes_[static_cast<std::size_t>(heard) - 1]}));
      ASSERT_TRUE(neighbour.commit());
    }
    ASSERT_TRUE(read_audit_anchors(neighbours.connection(), "state_detection").value().are_whole);
    EXPECT_THAT(open().quarantine().value(), ::testing::IsEmpty());
    neighbours.execute(change);
    EXPECT_FALSE(read_audit_anchors(neighbours.connection(), "state_detection").value().are_whole) << change;
    Journal started = open();
    ASSERT_THAT(started.quarantine().value(), SizeIs(1)) << change;
    EXPECT_THAT(started.quarantine().value()[0].reason, HasSubstr("table anchors")) << change;
    EXPECT_TRUE(read_audit_anchors(neighbours.connection(), "state_detection").value().are_whole) << "it was told";
  }
}

TEST_P(AuditTest, AnEndThatIsCutOffIsKnownByWhatOtherServicesHeard) {
  const Place neighbours{GetParam()};
  {
    auto neighbour = Journal::open(neighbours.connection(), "state_detection");
    ASSERT_TRUE(neighbour->begin());
    for (const std::int64_t heard : {2, 4, 4}) {
      const AuditAnchor anchor{kService, heard, hashes_[static_cast<std::size_t>(heard) - 1]};
      ASSERT_TRUE(neighbour->keep_anchor(anchor));
    }
    ASSERT_TRUE(neighbour->commit());
  }
  const auto heard = read_audit_anchors(neighbours.connection(), "state_detection").value().heard;
  ASSERT_THAT(heard, SizeIs(2));
  EXPECT_FALSE(find_cut(kService, entries(), heard));
  place_.execute("DELETE FROM acts WHERE sequence = 5");
  EXPECT_FALSE(find_cut(kService, entries(), heard)) << "nobody had heard of it";
  place_.execute("DELETE FROM acts WHERE sequence > 3");
  EXPECT_FALSE(look()) << "what is left is whole";
  ASSERT_TRUE(find_cut(kService, entries(), heard));
  EXPECT_EQ(find_cut(kService, entries(), heard)->sequence, 4);
  EXPECT_FALSE(find_cut("state_detection", entries(), heard)) << "of another service";
  // Whoever writes others in their place makes a chain that is whole, and another.
  auto journal = Journal::open(place_.connection(), kService);
  ASSERT_TRUE(journal->begin());
  for (const int number : {44, 45, 46}) ASSERT_TRUE(journal->record(act(number)));
  EXPECT_EQ(journal->last_act()->sequence, 6);
  ASSERT_TRUE(journal->commit());
  EXPECT_FALSE(look());
  ASSERT_TRUE(find_cut(kService, entries(), heard));
  EXPECT_THAT(find_cut(kService, entries(), heard)->why, HasSubstr("another entry in its place"));
}

TEST_P(AuditTest, AJournalOfAnOlderProgramGetsTheTableWhenItsServiceStarts) {
  place_.execute("DROP TABLE acts");
  EXPECT_THAT(entries(), IsEmpty());
  ASSERT_TRUE(Journal::open(place_.connection(), kService));
  auto journal = Journal::open(place_.connection(), kService);
  ASSERT_TRUE(journal->begin());
  EXPECT_TRUE(journal->record(act(1)));
  ASSERT_TRUE(journal->commit());
  EXPECT_THAT(entries(), SizeIs(1));
}

INSTANTIATE_TEST_SUITE_P(Databases, AuditTest, ::testing::Values("sqlite3", "postgresql"),
                         [](const auto& database) { return std::string(database.param); });

/// Not what stops an attacker, but what stops a slip.
TEST(AuditTable, SqliteRefusesToChangeARow) {
  const Place place;
  auto journal = Journal::open(place.connection(), kService);
  ASSERT_TRUE(journal->begin());
  ASSERT_TRUE(journal->record(act(1)));
  ASSERT_TRUE(journal->commit());
  for (const char* change : {"UPDATE acts SET who = 'x'", "DELETE FROM acts"}) try {
      place.execute(change);
      ADD_FAILURE() << change;
    } catch (const std::exception& refused) {
      EXPECT_THAT(refused.what(), HasSubstr("acts are only added"));
    }
}

}  // namespace
}  // namespace sealwatch
