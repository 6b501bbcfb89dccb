// What can be wrong with a journal's file, each with an error that says what to do.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "services/common/store/journal.hpp"
#include "services/common/store/journal_reader.hpp"
#include "tests/unit/message/fill.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

/// Whose files nobody may replace either.
constexpr auto kReadOnlyDirectory = std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec;

Message big_message(int number) {
  TestWindow window;
  window.header.message_id = "test_window/" + std::to_string(number);
  window.samples.time_s.assign(20'000, 1.0);
  return window;
}

TEST(JournalFile, IsInWriteAheadMode) {
  const Place place;
  const auto journal = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(journal.has_value()) << journal.error().describe();
  EXPECT_TRUE(std::filesystem::exists(place.directory() / "journal.db-wal"));
}

/// Asked between the batches, as the runner asks: a query that stayed open would keep the log from being emptied.
TEST(JournalFile, TheLogGoesIntoTheFileWhileTheJournalIsUsed) {
  const Place place;
  auto journal = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(journal.has_value());
  constexpr std::uintmax_t kWritten = 6000 * 4096;
  Message small = big_message(0);
  std::get<TestWindow>(small).samples.time_s.resize(500);
  for (int number = 0; number < 6000; ++number) {
    header_of(small).message_id = std::to_string(number);
    ASSERT_TRUE(journal->begin());
    ASSERT_TRUE(journal->add_output(small, UtcTime{}).has_value());
    ASSERT_TRUE(journal->commit());
    ASSERT_FALSE(journal->has_input("input " + std::to_string(number)).value());
    ASSERT_EQ(journal->last_unnumbered_input(Topic::raw_samples, "XT03").value(), "");
  }
  const auto size = [&] { return std::filesystem::file_size(place.directory() / "journal.db"); };
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (size() < kWritten / 2 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GE(size(), kWritten / 2);
}

TEST(JournalFile, APathWithSpacesIsOne) {
  const Place place;
  const std::filesystem::path file = place.directory() / "two words.db";
  const auto journal = Journal::open("sqlite3://" + file.string(), "state_detection");
  ASSERT_TRUE(journal.has_value()) << journal.error().describe();
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(JournalFile, ThatIsNoDatabaseIsMovedAsideWhole) {
  const Place place;
  const std::string text(5000, 'x');
  std::ofstream(place.directory() / "journal.db") << text;
  const auto journal = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(journal.has_value()) << journal.error().describe();
  EXPECT_EQ(std::filesystem::file_size(place.directory() / "journal.db.damaged-1"), text.size());
}

TEST(JournalFile, ThatThisUserMayNotWriteToIsNoDamage) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const Place place;
  const std::filesystem::path file = place.directory() / "journal.db";
  std::ofstream(file) << std::string(5000, 'x');
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  std::filesystem::permissions(place.directory(), kReadOnlyDirectory);
  EXPECT_FALSE(Journal::open(place.connection(), "state_detection").has_value());
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".damaged-1"));
}

TEST(JournalFile, InNoDirectoryNamesThePlace) {
  const auto journal = Journal::open("sqlite3:///nowhere/at/all/journal.db", "state_detection");
  ASSERT_FALSE(journal.has_value());
  EXPECT_THAT(journal.error().describe(), HasSubstr("/nowhere/at/all/journal.db"));
  EXPECT_THAT(journal.error().advice, HasSubstr("check that the directory exists"));
}

TEST(JournalFile, OfAnUnknownKindOfDatabaseIsRefused) {
  const auto journal = Journal::open("oracel://x", "state_detection");
  ASSERT_FALSE(journal.has_value());
  EXPECT_THAT(journal.error().describe(), HasSubstr("oracel"));
}

TEST(JournalPlace, IsTheSameHoweverTheFileIsWritten) {
  EXPECT_EQ(Journal::place_of("sqlite3:///var/lib/../j.db"), "sqlite3:///var/j.db");
  EXPECT_EQ(Journal::place_of("sqlite3://dbname=/var/j.db timeout=5"), "sqlite3:///var/j.db");
  EXPECT_EQ(Journal::place_of("sqlite3://j.db"), Journal::place_of("sqlite3://./j.db"));
  EXPECT_NE(Journal::place_of("sqlite3://a.db"), Journal::place_of("sqlite3://b.db"));
  EXPECT_EQ(Journal::place_of("postgresql://dbname=x"), "postgresql://dbname=x");
}

/// A link that leads back to itself, as a directory that may not be entered: where its files are cannot be found out.
TEST(JournalPlace, IsEachFilesOwnInADirectoryThatCannotBeLookedInto) {
  const Place place;
  const std::filesystem::path loop = place.directory() / "loop";
  std::filesystem::create_symlink("loop", loop);
  EXPECT_NE(Journal::place_of("sqlite3://" + (loop / "a.db").string()),
            Journal::place_of("sqlite3://" + (loop / "b.db").string()));
}

TEST(JournalPlace, IsAFileOrNoneYet) {
  const Place place;
  const std::string pipe = "sqlite3://" + (place.directory() / "pipe.db").string();
  ASSERT_EQ(::mkfifo(Journal::file_of(pipe).c_str(), 0600), 0);
  for (const std::string& no_file : {pipe, std::string("sqlite3:///dev/full")}) {
    const Status checked = Journal::check(no_file);
    ASSERT_FALSE(checked.has_value()) << no_file;
    EXPECT_EQ(checked.error().rule, "is not a file");
    const auto read = JournalReader::open(no_file, "state_detection");
    ASSERT_FALSE(read.has_value()) << no_file;
    EXPECT_THAT(read.error().rule, HasSubstr("is not a file"));
  }
  EXPECT_TRUE(Journal::check(place.connection()).has_value());
}

TEST(JournalServer, ThatDoesNotAnswerIsNoMatterOfDirectories) {
  const Status reached = Journal::check("postgresql://host=127.0.0.1 port=1 dbname=x password=secret");
  ASSERT_FALSE(reached.has_value());
  EXPECT_THAT(reached.error().describe(), ::testing::Not(HasSubstr("directory")));
  EXPECT_THAT(reached.error().describe(), ::testing::Not(HasSubstr("secret")));
  if (reached.error().rule.find("onnection") != std::string::npos) {  // SOCI's part for PostgreSQL is installed
    EXPECT_THAT(reached.error().advice, HasSubstr("check that the server answers there"));
  }
}

TEST(JournalFile, ThatAnotherProcessWritesToIsALockedErrorNotALoss) {
  const Place place;
  auto first = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(first.has_value());
  soci::session other(place.connection());
  other << "BEGIN IMMEDIATE";
  const Status refused = first->begin();  // after the busy timeout
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().describe(), HasSubstr("locked"));
  EXPECT_THAT(refused.error().advice, HasSubstr("another process is writing"));
  other << "ROLLBACK";
  EXPECT_TRUE(first->begin());
  first->rollback();
}

/// No file of this process may grow beyond this many bytes while it lives: a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(JournalFile, OnAFullDiskKeepsWhatWasCommitted) {
  const Place place;
  auto journal = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(journal.has_value());
  int committed = 0;
  Status status;
  {
    const FullDisk disk(3'000'000);
    while (status && committed < 100) {
      status = journal->begin();
      if (status) {
        const auto added = journal->add_output(big_message(committed), UtcTime{});
        if (!added) status = fail(added.error());
      }
      if (status) status = journal->commit();
      if (status) ++committed;
    }
    ASSERT_FALSE(status) << "the disk never filled";
    journal->rollback();
  }
  { const Journal closed = std::move(*journal); }
  EXPECT_GT(committed, 1);
  EXPECT_FALSE(status.error().describe().empty());
  auto reopened = Journal::open(place.connection(), "state_detection");
  ASSERT_TRUE(reopened.has_value()) << reopened.error().describe();
  EXPECT_EQ(reopened->written().at(Topic::test_window), static_cast<std::uint64_t>(committed));
}

TEST(JournalFile, ThatMayNotBeWrittenIsRefused) {
  const Place place;
  ASSERT_TRUE(Journal::open(place.connection(), "state_detection").has_value());
  if (::geteuid() == 0) {
    // Root may write anywhere, so the file itself is made read-only for the library.
    const auto journal =
        Journal::open("sqlite3://readonly=true dbname=" + (place.directory() / "other.db").string(), "state_detection");
    EXPECT_FALSE(journal.has_value());
    return;
  }
  std::filesystem::permissions(place.directory() / "journal.db", std::filesystem::perms::owner_read);
  std::filesystem::permissions(place.directory(), kReadOnlyDirectory);
  auto journal = Journal::open(place.connection(), "state_detection");
  const Status written = journal ? journal->begin() : fail(journal.error());
  const auto added = written ? journal->add_output(big_message(1), UtcTime{}) : fail(written.error());
  ASSERT_FALSE(added.has_value());
  EXPECT_THAT(added.error().advice, HasSubstr("may write"));
}

}  // namespace
}  // namespace sealwatch
