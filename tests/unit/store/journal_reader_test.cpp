// A journal seen from outside: what its service concluded is found by id, and nothing of it is changed.
#include "services/common/store/journal_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <soci/soci.h>

#include <filesystem>
#include <fstream>

#include "services/common/store/journal.hpp"
#include "tests/unit/message/fill.hpp"

namespace sealwatch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class JournalReaderTest : public ::testing::Test {
 protected:
  JournalReaderTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sealwatch reader_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~JournalReaderTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string connection() const { return "sqlite3://" + (folder_ / "state_detection.db").string(); }
  static StateReport report(const std::string& id, const std::string& asset) {
    StateReport report = testing::filled<StateReport>(2);
    report.asset_id = asset;
    report.header.message_id = id;
    report.header.writer_id.clear();
    report.header.stream_sequence = 0;
    report.header.publishing_time_ns = 0;
    return report;
  }
  static void conclude(Journal& journal, const std::vector<StateReport>& reports) {
    ASSERT_TRUE(journal.begin());
    for (const StateReport& one : reports) ASSERT_TRUE(journal.add_output(one, UtcTime{77}));
    ASSERT_TRUE(journal.commit());
  }

  std::filesystem::path folder_;
};

TEST_F(JournalReaderTest, FindsWhatARunningServiceConcluded) {
  Result<Journal> journal = Journal::open(connection(), "state_detection");
  ASSERT_TRUE(journal);
  conclude(*journal, {report("a/1", "A"), report("b/1", "B"), report("a/2", "A")});
  ASSERT_TRUE(journal->begin());
  ASSERT_TRUE(journal->add_input(report("input", "A"), UtcTime{1}, true));
  ASSERT_TRUE(journal->commit());

  Result<JournalReader> reader = JournalReader::open(connection(), "state_detection");  // the service still has it open
  ASSERT_TRUE(reader) << reader.error().describe();
  EXPECT_EQ(reader->output("a/1").value(), Message(report("a/1", "A")));
  EXPECT_EQ(reader->output("a/3").value(), std::nullopt);
  EXPECT_THAT(reader->outputs(Topic::state_report, "A").value(),
              ElementsAre(Message(report("a/1", "A")), Message(report("a/2", "A"))));
  EXPECT_THAT(reader->output_ids(Topic::state_report).value(), ElementsAre("a/1", "b/1", "a/2"));
  EXPECT_THAT(reader->output_ids(Topic::state_report, "B").value(), ElementsAre("b/1"));
  EXPECT_TRUE(reader->output_ids(Topic::advisory).value().empty());
  EXPECT_THAT(reader->assets(Topic::state_report).value(), ElementsAre("A", "B"));
  EXPECT_TRUE(reader->has_input("input").value());
  EXPECT_FALSE(reader->has_input("a/1").value()) << "is an output";

  conclude(*journal, {report("a/3", "A")});
  EXPECT_NE(reader->output("a/3").value(), std::nullopt) << "what comes later is seen too";
}

TEST_F(JournalReaderTest, MakesNoJournalAndRefusesAnothers) {
  const Result<JournalReader> none = JournalReader::open(connection(), "state_detection");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().describe(), HasSubstr("state_detection.db: does not exist"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_));

  ASSERT_TRUE(Journal::open(connection(), "state_detection"));
  const Result<JournalReader> another = JournalReader::open(connection(), "health_assessment");
  ASSERT_FALSE(another);
  EXPECT_THAT(another.error().describe(), HasSubstr("must be 'health_assessment'"));
}

/// A wrong figure must not be shown as what the service concluded.
TEST_F(JournalReaderTest, ShowsNothingThatIsNotAsItWasWritten) {
  {
    Result<Journal> journal = Journal::open(connection(), "state_detection");
    ASSERT_TRUE(journal);
    conclude(*journal, {report("a/1", "A"), report("b/1", "B")});
  }
  soci::session(connection())
      << R"(UPDATE outputs SET payload = replace(payload, '"overdue_days":', '"overdue_days":1')"
         R"() WHERE message_id = 'a/1')";
  Result<JournalReader> reader = JournalReader::open(connection(), "state_detection");
  ASSERT_TRUE(reader);
  const auto changed = reader->output("a/1");
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().describe(), HasSubstr("output 1: 'a/1': is not as it was written"));
  EXPECT_FALSE(reader->outputs(Topic::state_report, "A"));
  EXPECT_TRUE(reader->outputs(Topic::state_report, "B")) << "the rest is there";
}

TEST_F(JournalReaderTest, SaysThatAFileIsDamagedAndWhatToDo) {
  std::ofstream(folder_ / "state_detection.db") << std::string(8192, 'x');
  const Result<JournalReader> damaged = JournalReader::open(connection(), "state_detection");
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().describe(), ::testing::AllOf(HasSubstr("the journal is damaged"), HasSubstr("backup"),
                                                           ::testing::Not(HasSubstr("SELECT"))));
}

}  // namespace
}  // namespace sealwatch
