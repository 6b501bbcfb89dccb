// Journals of version 1 go on in this one; copies of running journals, and their way back.
#include "services/common/store/backup.hpp"
#include "services/common/store/damaged_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "services/common/message/json.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/journal_reader.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kService = "state_detection";

Message report(const std::string& id) {
  StateReport made;
  made.header.message_id = id;
  made.asset_id = "XT03";
  return made;
}

std::vector<std::string> ids_of(Journal& journal) {
  std::vector<std::string> ids;
  EXPECT_TRUE(
      journal.for_each_output([&](const Message& m) { return ids.push_back(header_of(m).message_id), Status(); }));
  return ids;
}

void conclude(Journal& journal, const std::string& id) {
  ASSERT_TRUE(journal.begin());
  ASSERT_TRUE(journal.add_output(report(id), UtcTime{}).has_value());
  ASSERT_TRUE(journal.commit());
}

/// The tables as version 1 made them, letter by letter.
void write_version_1(const Place& place) {
  soci::session sql(place.connection());
  for (const char* statement :
       {"CREATE TABLE meta(name VARCHAR(64) PRIMARY KEY, value TEXT NOT NULL)",
        "CREATE TABLE inputs(receipt INTEGER PRIMARY KEY, topic VARCHAR(64) NOT NULL, writer_id TEXT NOT NULL, "
        "sequence "
        "BIGINT NOT NULL, message_id TEXT NOT NULL UNIQUE, asset_id TEXT NOT NULL, pst_id TEXT NOT NULL, received "
        "BIGINT "
        "NOT NULL, consumed INTEGER NOT NULL, payload TEXT)",
        "CREATE INDEX inputs_open ON inputs(receipt) WHERE consumed = 0",
        "CREATE INDEX inputs_of_no_stream ON inputs(topic, asset_id, receipt) WHERE sequence = 0",
        "CREATE TABLE outputs(ordinal INTEGER PRIMARY KEY, topic VARCHAR(64) NOT NULL, sequence BIGINT NOT NULL, "
        "message_id TEXT NOT NULL UNIQUE, asset_id TEXT NOT NULL, pst_id TEXT NOT NULL, published BIGINT NOT NULL, "
        "payload TEXT NOT NULL, UNIQUE(topic, sequence))",
        "CREATE TABLE positions(topic VARCHAR(64) NOT NULL, writer_id TEXT NOT NULL, sequence BIGINT NOT NULL, PRIMARY "
        "KEY(topic, writer_id))",
        "INSERT INTO meta VALUES('schema_version', '1'), ('service', 'state_detection'), ('writer_id', "
        "'state_detection-00000000000000aa')",
        "INSERT INTO positions VALUES('test_features', 'w', 3)"})
    sql << statement;
  const std::string output = to_json(report("old"), JsonForm::exact);
  sql << "INSERT INTO outputs VALUES(1, 'state_report', 1, 'old', 'XT03', '', 5, :payload)",
      soci::use(output, "payload");
  sql << "INSERT INTO inputs VALUES(1, 'state_report', 'w', 3, 'waits', 'XT03', '', 5, 0, :payload)",
      soci::use(output, "payload");
}

TEST(JournalMigration, OfVersion1KeepsEverythingAndGoesOn) {
  const Place place;
  write_version_1(place);
  ASSERT_TRUE(JournalReader::open(place.connection(), kService).has_value()) << "it is looked into as it is, too";
  {
    auto journal = Journal::open(place.connection(), kService);
    ASSERT_TRUE(journal.has_value()) << journal.error().describe();
    EXPECT_EQ(journal->writer_id(), "state_detection-00000000000000aa");
    EXPECT_THAT(ids_of(*journal), ElementsAre("old"));
    EXPECT_EQ(journal->open_inputs(), 1U);
    EXPECT_EQ(journal->positions().value().at(0).sequence, 3U);
    conclude(*journal, "new");
  }
  auto journal = Journal::open(place.connection(), kService);
  ASSERT_TRUE(journal.has_value()) << journal.error().describe();
  EXPECT_THAT(ids_of(*journal), ElementsAre("old", "new"));
  EXPECT_EQ(header_of(journal->outputs(Topic::state_report, 2, 2, 1).value().at(0)).stream_sequence, 2U);
}

class Backup : public ::testing::Test {
 protected:
  [[nodiscard]] std::string copy() const { return (place_.directory() / "copy.db").string(); }
  Place place_;
};

TEST_F(Backup, OfARunningJournalIsAsItWasAtThatMoment) {
  auto journal = Journal::open(place_.connection(), kService);
  conclude(*journal, "a");
  ASSERT_TRUE(journal->begin());
  ASSERT_TRUE(journal->add_output(report("not yet"), UtcTime{}).has_value());
  const Status done = back_up_journal(place_.connection(), kService, copy());
  ASSERT_TRUE(done) << done.error().describe();
  ASSERT_TRUE(journal->commit());
  auto backup = Journal::open("sqlite3://" + copy(), kService);
  ASSERT_TRUE(backup.has_value());
  EXPECT_THAT(ids_of(*backup), ElementsAre("a"));
  EXPECT_EQ(backup->writer_id(), journal->writer_id());
  EXPECT_FALSE(back_up_journal(place_.connection(), kService, copy())) << "no backup is written over";
}

TEST_F(Backup, ComesBackOnceTheServiceHasStopped) {
  {
    auto journal = Journal::open(place_.connection(), kService);
    conclude(*journal, "a");
    ASSERT_TRUE(back_up_journal(place_.connection(), kService, copy()));
    conclude(*journal, "b");
    const auto running = restore_journal(copy(), place_.connection(), kService);
    ASSERT_FALSE(running.has_value());
    EXPECT_THAT(running.error().describe(), HasSubstr("another process works with this journal"));
  }
  note_damage(Journal::file_of(place_.connection()));  // of the journal that is replaced
  const auto aside = restore_journal(copy(), place_.connection(), kService);
  ASSERT_TRUE(aside.has_value()) << aside.error().describe();
  auto restored = Journal::open(place_.connection(), kService);
  EXPECT_THAT(ids_of(*restored), ElementsAre("a"));
  auto before = Journal::open("sqlite3://" + *aside, kService);
  EXPECT_THAT(ids_of(*before), ElementsAre("a", "b"));
}

TEST_F(Backup, OfAnotherServiceOrDamagedIsRefusedBeforeAnythingChanges) {
  { ASSERT_TRUE(Journal::open("sqlite3://" + copy(), "health_assessment").has_value()); }
  auto restored = restore_journal(copy(), place_.connection(), kService);
  ASSERT_FALSE(restored.has_value());
  EXPECT_THAT(restored.error().describe(), HasSubstr("must be 'state_detection'"));
  std::fstream damaged(copy(), std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(5 * 1024);  // a page that nobody reads to look who wrote the journal
  damaged.write("\xff\xff\xff\xff\xff\xff\xff\xff", 8);
  damaged.close();
  restored = restore_journal(copy(), place_.connection(), "health_assessment");
  ASSERT_FALSE(restored.has_value());
  EXPECT_THAT(restored.error().describe(), HasSubstr("is damaged"));
  EXPECT_FALSE(std::filesystem::exists(place_.directory() / "journal.db"));
}

}  // namespace
}  // namespace sealwatch
