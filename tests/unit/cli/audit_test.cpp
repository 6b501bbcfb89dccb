// `sealwatch audit` over journals on disk: what it lists, and its exit status when somebody changed them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <soci/soci.h>

#include "services/cli/commands.hpp"
#include "services/common/store/journal.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;

class AuditCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.config = std::string(SEALWATCH_SOURCE_DIR) + "/config";
    options_.state_directory = place_.directory().string();
    for (const char* service : {"state_detection", "advisory_generation"}) {
      auto journal = Journal::open(connection(service), service);
      ASSERT_TRUE(journal) << journal.error().describe();
      for (int number = 1; number <= 3; ++number) {
        ASSERT_TRUE(journal->begin());
        last_hash_ = journal
                         ->record({.at = {1'900'000'000'000'000'000},
                                   .kind = "seal_replaced",
                                   .asset_id = "XT0" + std::to_string(number),
                                   .who = "J. Silva \x1b[2J",
                                   .subject = "maintenance_event/" + std::to_string(number),
                                   .text = {},
                                   .outcome = "taken"})
                         ->hash;
        ASSERT_TRUE(journal->commit());
      }
    }
  }
  std::string connection(const std::string& service) const {
    return "sqlite3://" + (place_.directory() / (service + ".db")).string();
  }
  void tamper(const std::string& statement) const {
    soci::session sql(connection("state_detection"));
    for (const char* guard : {"UPDATE", "DELETE"}) sql << std::string("DROP TRIGGER IF EXISTS acts_no_") + guard;
    sql << statement;
  }
  int run() {
    ::testing::internal::CaptureStdout();
    const int status = run_audit(options_);
    said_ = ::testing::internal::GetCapturedStdout();
    return status;
  }

  Place place_;
  AuditOptions options_;
  std::string last_hash_;
  std::string said_;
};

TEST_F(AuditCommand, ListsWhatEachServiceReceived) {
  EXPECT_EQ(run(), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("state_detection 2  seal_replaced  XT02  by J. Silva"));
  EXPECT_THAT(said_, HasSubstr("advisory_generation: 3 acts, as they were written; last hash " + last_hash_));
  EXPECT_EQ(said_.find('\x1b'), std::string::npos) << "no escape reaches the terminal";
  options_.asset_id = "XT03";
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(said_.find("XT02"), std::string::npos);
}

TEST_F(AuditCommand, SaysWhereARecordIsBroken) {
  tamper("UPDATE acts SET who = 'nobody' WHERE sequence = 2");
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(said_, HasSubstr("state_detection: BROKEN at entry 2"));
  options_.json = true;
  options_.asset_id = "XT03";  // the whole record is checked all the same
  EXPECT_EQ(run(), 1);
  EXPECT_THAT(said_, HasSubstr("\"entry\": 2"));
  EXPECT_THAT(said_, HasSubstr("\"whole\": false"));
}

TEST_F(AuditCommand, MissesTheEndOfARecordByAHashThatWasNoted) {
  auto entries = read_audit_trail(connection("state_detection"), "state_detection").value();
  options_.contains = entries.back().hash;
  EXPECT_EQ(run(), 0);
  tamper("DELETE FROM acts WHERE sequence = 3");
  EXPECT_EQ(run(), 1);
  options_.contains.clear();
  EXPECT_EQ(run(), 0) << "by itself a shorter record is whole";
}

TEST_F(AuditCommand, IsBadInputWhereThereIsNoJournal) {
  options_.state_directory = (place_.directory() / "none").string();
  EXPECT_EQ(run(), 2);
}

}  // namespace
}  // namespace sealwatch::cli
