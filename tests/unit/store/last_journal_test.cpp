// Another journal than the one that was used last: none, an older copy, one whose log was cut, or another's.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <future>

#include "services/common/store/backup.hpp"
#include "services/common/store/journal.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kService = "state_detection";

class LastJournal : public ::testing::Test {
 protected:
  LastJournal() { conclude(place_, kService, {"a"}); }
  static Journal open(const Place& place, const std::string& service = kService) {
    auto journal = Journal::open(place.connection(), service);
    if (!journal) throw std::runtime_error(journal.error().describe());
    return std::move(*journal);
  }
  static void conclude(const Place& place, const std::string& service, const std::vector<std::string>& ids) {
    Journal journal = open(place, service);
    ASSERT_TRUE(journal.begin());
    for (const std::string& id : ids) {
      StateReport made;
      made.header.message_id = id;
      made.asset_id = "XT03";
      ASSERT_TRUE(journal.add_output(made, UtcTime{}).has_value());
    }
    ASSERT_TRUE(journal.commit());
  }
  [[nodiscard]] std::string file() const { return (place_.directory() / "journal.db").string(); }
  /// What is told of the journal as it is opened next, and the time after that.
  [[nodiscard]] std::vector<std::string> told() const {
    std::vector<std::string> reasons;
    const std::vector<SetAside> found = open(place_).quarantine().value();
    for (const SetAside& one : found) reasons.push_back(one.message_id + ": " + one.reason);
    EXPECT_EQ(open(place_).quarantine().value().size(), reasons.size());
    return reasons;
  }
  [[nodiscard]] std::vector<std::string> outputs() const {
    std::vector<std::string> ids;
    Journal journal = open(place_);
    EXPECT_TRUE(
        journal.for_each_output([&](const Message& m) { return ids.push_back(header_of(m).message_id), Status(); }));
    return ids;
  }
  Place place_;
};

TEST_F(LastJournal, ThatIsThereIsNothingToTell) {
  EXPECT_THAT(told(), IsEmpty());
  conclude(place_, kService, {"b"});
  EXPECT_THAT(told(), IsEmpty());
}

TEST_F(LastJournal, ThatWasRemovedIsTold) {
  fs::remove(file());
  EXPECT_THAT(told(), ElementsAre(AllOf(HasSubstr("journal/state_detection"), HasSubstr("removed"))));
  fs::resize_file(file(), 0);
  EXPECT_THAT(told(), ElementsAre(HasSubstr("removed")));
}

/// As by "rm state/*.db*", after which no neighbour knows of a journal before its own either.
TEST_F(LastJournal, ThatWasRemovedWithItsLockIsTold) {
  for (const char* end : {"", "-wal", "-shm", ".lock"}) fs::remove(file() + end);
  EXPECT_THAT(told(), ElementsAre(AllOf(HasSubstr("journal/state_detection"), HasSubstr("removed"))));
  EXPECT_THAT(outputs(), IsEmpty());
}

/// Who removes the mark, too, begins anew.
/// Somebody may have made one of anything that is in the state directory; nobody need ever read it.
TEST_F(LastJournal, WhoseMarkIsAPipeIsOpenedWithoutIt) {
  fs::remove(file() + ".lock");
  const std::string mark = (place_.directory() / "journal.mark").string();
  fs::remove(mark);
  ASSERT_EQ(::mkfifo(mark.c_str(), 0600), 0);
  auto opened = std::async(std::launch::async, [this] { return open(place_).writer_id(); });
  const bool done = opened.wait_for(std::chrono::seconds(20)) == std::future_status::ready;
  const int other_end = ::open(mark.c_str(), O_RDWR | O_CLOEXEC);  // lets go of who waits
  EXPECT_TRUE(done);
  EXPECT_FALSE(opened.get().empty());
  ::close(other_end);
}

TEST_F(LastJournal, OfWhichNothingIsLeftIsNotMissed) {
  for (const auto& entry : fs::directory_iterator(place_.directory())) fs::remove(entry);
  EXPECT_THAT(told(), IsEmpty());
}

/// As after a power cut, all of a young journal is in its log.
TEST_F(LastJournal, WhoseLogWasRemovedIsTold) {
  fs::remove(file());
  {
    const Journal journal = open(place_);
    fs::copy_file(file(), file() + ".beginning");
  }
  fs::remove(file());
  fs::rename(file() + ".beginning", file());
  EXPECT_THAT(told(), ElementsAre(HasSubstr("removed")));
}

TEST_F(LastJournal, OfWhichAnOlderCopyIsInItsPlaceIsTold) {
  fs::copy_file(file(), file() + ".older");
  conclude(place_, kService, {"b", "c"});
  fs::remove(file() + "-wal");
  fs::rename(file() + ".older", file());
  EXPECT_THAT(told(), ElementsAre(AllOf(HasSubstr("ends at conclusion 1"), HasSubstr("went to 3"))));
  EXPECT_THAT(outputs(), ElementsAre("a"));
}

/// It is moved aside whole: what it says is of other assets, or of another layer.
TEST_F(LastJournal, InWhosePlaceIsAnothersIsMadeAgain) {
  for (const std::string service : {kService, "health_assessment"}) {
    SCOPED_TRACE(service);
    const Place other;
    conclude(other, service, {"of another site"});
    fs::copy_file(other.directory() / "journal.db", file(), fs::copy_options::overwrite_existing);
    fs::remove(file() + "-wal");
    EXPECT_THAT(told(), ElementsAre(AllOf(HasSubstr("the journal of " + service), HasSubstr("damaged-"))));
    EXPECT_THAT(outputs(), IsEmpty());
  }
  EXPECT_TRUE(fs::exists(file() + ".damaged-2"));
}

/// Who restores a backup says so; how much is missing, the neighbours know.
TEST_F(LastJournal, InWhosePlaceABackupWasRestoredIsNoOther) {
  const std::string copy = file() + ".backup";
  ASSERT_TRUE(back_up_journal(place_.connection(), kService, copy));
  fs::remove(file());
  EXPECT_THAT(told(), ElementsAre(HasSubstr("removed"))) << "another writer's from now on";
  ASSERT_TRUE(restore_journal(copy, place_.connection(), kService).has_value());
  EXPECT_THAT(told(), IsEmpty());
  EXPECT_THAT(outputs(), ElementsAre("a"));
}

}  // namespace
}  // namespace sealwatch
