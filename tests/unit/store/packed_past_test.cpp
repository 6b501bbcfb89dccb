// An asset's past comes the same, bit for bit, whether it is read from what was packed or from JSON; and from JSON where
// what was packed is not what it should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "sealwatch/message/blank.hpp"
#include "services/common/message/json.hpp"
#include "services/common/store/journal.hpp"
#include "tests/unit/message/fill.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kTests = 40;

using Past = std::vector<std::string>;

Message report(const std::string& asset, int test, std::size_t length = 3) {
  auto made = testing::filled<StateReport>(length);
  made.asset_id = asset;
  made.overdue_days = 1.0 / test;
  made.header.pst_id = asset + " test " + std::to_string(test);
  made.header.message_id = "state_report/" + made.header.pst_id;
  made.header.event_time_ns = 1'000'000'007LL * test;
  return made;
}

template <class Content>
Message of_test(const std::string& asset, int test, const std::string& id, std::size_t samples) {
  auto made = testing::filled<Content>(samples);
  made.asset_id = asset;
  made.header.pst_id = asset + " test " + std::to_string(test);
  made.header.message_id = id + "/" + made.header.pst_id;
  return made;
}

class PackedPasts : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!place_.usable()) GTEST_SKIP() << Place::why_not();
    Journal journal = open();
    for (int test = 1; test <= kTests; ++test)
      conclude(journal, {report("A", test), report("B", test, 1), report("A", test + 1000)});
  }
  [[nodiscard]] Journal open(const std::string& build = "1") const {
    auto journal = Journal::open(place_.connection(), "state_detection");
    if (!journal) throw std::runtime_error(journal.error().describe());
    journal->pack_for(build);
    return std::move(*journal);
  }
  static void conclude(Journal& journal, const std::vector<Message>& outputs) {
    ASSERT_TRUE(journal.begin());
    for (const Message& output : outputs)
      ASSERT_TRUE(journal.add_output(output, UtcTime{77 * header_of(output).event_time_ns}).value().has_value());
    ASSERT_TRUE(journal.commit());
  }
  static Past past(
      Journal& journal, const std::string& asset = "A",
      const Journal::TellsAll& tells_all = [](const Message&) { return false; }) {
    Past found;
    const Status read = journal.for_each_output_of(
        asset,
        [&](const Message& output, const Journal::Place& place) {
          found.push_back(std::to_string(place.sequence) + " " + std::to_string(place.concluded.nanoseconds) + " " +
                          to_json(output, JsonForm::exact));
          return Status();
        },
        tells_all);
    EXPECT_TRUE(read) << read.error().describe();
    return found;
  }
  [[nodiscard]] long long count(const std::string& query) const {
    long long number = 0;
    soci::session(place_.connection()) << query, soci::into(number);
    return number;
  }
  [[nodiscard]] long long packed(const std::string& asset = "A") const {
    return count("SELECT count(*) FROM packed_outputs WHERE asset_id = '" + asset + "'");
  }
  /// Of a damage to what is packed: nothing of it is seen but that it is told, once, and packed again.
  void expect_same_without(const Past& whole, const std::string& why) const {
    Journal journal = open();
    EXPECT_EQ(past(journal), whole);
    const auto refused = journal.take_packed_refused();
    ASSERT_TRUE(refused.has_value());
    EXPECT_THAT(*refused, AllOf(HasSubstr("A: "), HasSubstr(why)));
    EXPECT_FALSE(journal.take_packed_refused().has_value()) << "once";
    EXPECT_EQ(past(journal), whole);
    journal = open_anew(std::move(journal));
    EXPECT_EQ(past(journal), whole);
    EXPECT_FALSE(journal.take_packed_refused().has_value()) << "it was packed again";
  }
  [[nodiscard]] Journal open_anew(Journal journal) const {
    { const Journal closed = std::move(journal); }
    return open();
  }

  Place place_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Backends, PackedPasts, ::testing::Values("sqlite3", "postgresql"),
                         [](const auto& backend) { return backend.param; });

TEST_P(PackedPasts, ComeTheSameAndAreReadInPlaceOfTheOutputs) {
  Journal journal = open();
  const Past whole = past(journal);
  EXPECT_THAT(whole, SizeIs(2 * kTests));
  EXPECT_EQ(packed(), 1);
  EXPECT_EQ(packed("B"), 0) << "each its own";
  EXPECT_EQ(past(journal), whole);
  journal = open_anew(std::move(journal));
  place_.execute("UPDATE outputs SET payload = 'nobody reads it' WHERE ordinal = 4");
  EXPECT_EQ(past(journal), whole);
  EXPECT_FALSE(journal.take_packed_refused().has_value());
}

TEST_P(PackedPasts, GoOnWithWhatIsConcludedMeanwhile) {
  Journal journal = open();
  static_cast<void>(past(journal));
  Past whole;
  for (int test = 101; test < 101 + kTests; ++test) {
    conclude(journal, {report("A", test)});
    const Past now = past(journal);
    ASSERT_EQ(Past(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(whole.size())), whole);
    ASSERT_EQ(now.size(), 2U * kTests + static_cast<std::size_t>(test - 100));
    whole = now;
  }
  EXPECT_EQ(packed(), 3);
  place_.execute("DELETE FROM packed_outputs");
  EXPECT_EQ(past(journal), whole);
}

TEST_P(PackedPasts, AreNotUsedWhereTheyAreDamaged) {
  Journal journal = open();
  const Past whole = past(journal);
  static_cast<void>(past(journal, "B"));
  for (const std::string change :
       {"behind = behind + 1", "ends = ends + 1", "outputs = outputs - 1", "layout = 'x'", "body = 'AAAA'", "body = ''",
        "checksum = 'damaged'", "body = (SELECT body FROM packed_outputs WHERE asset_id = 'B')"}) {
    SCOPED_TRACE(change);
    place_.execute("UPDATE packed_outputs SET " + change + " WHERE asset_id = 'A'");
    { const Journal closed = std::move(journal); }
    expect_same_without(whole, "not as it was written");
    journal = open();
  }
}

TEST_P(PackedPasts, AreUsedUpToTheFirstThatIsDamaged) {
  Journal journal = open();
  static_cast<void>(past(journal));
  for (int test = 101; test < 101 + kTests; ++test) conclude(journal, {report("A", test)});
  const Past whole = past(journal);
  ASSERT_EQ(packed(), 2);
  place_.execute("UPDATE packed_outputs SET body = 'AAAA' WHERE behind > 0");
  { const Journal closed = std::move(journal); }
  EXPECT_GT(count("SELECT min(outputs) FROM packed_outputs"), 0);
  expect_same_without(whole, "not as it was written");
  EXPECT_EQ(packed(), 2);
}

TEST_P(PackedPasts, OfAnotherBuildAreMadeAgain) {
  Journal journal = open("0");
  const Past whole = past(journal);
  { const Journal closed = std::move(journal); }
  expect_same_without(whole, "another version made it");
}

TEST_P(PackedPasts, MayBeRemovedOrRenamed) {
  Journal journal = open();
  const Past whole = past(journal);
  for (const std::string what : {"DROP TABLE packed_outputs", "ALTER TABLE packed_outputs RENAME TO removed"}) {
    place_.execute(what);
    journal = open_anew(std::move(journal));
    EXPECT_THAT(journal.quarantine().value(), IsEmpty()) << "nothing is lost";
    EXPECT_EQ(past(journal), whole);
    EXPECT_EQ(packed(), 1);
  }
}

/// A part of an older copy; and who removes conclusions has them missing, not back.
TEST_P(PackedPasts, OfOutputsThatAreNotThereAreNotUsed) {
  Journal journal = open();
  const Past whole = past(journal);
  place_.execute("DELETE FROM outputs WHERE ordinal > 100");
  { const Journal closed = std::move(journal); }
  const auto left = static_cast<std::ptrdiff_t>(count("SELECT count(*) FROM outputs WHERE asset_id = 'A'"));
  expect_same_without(Past(whole.begin(), whole.begin() + left), "other outputs are there");
}

/// By what a test is told follows from its last output.
TEST_P(PackedPasts, OfATestOfWhichMoreComesAreMadeAgain) {
  const auto told_by_life = [](const Message& last) { return topic_of(last) == Topic::remaining_life; };
  Journal journal = open();
  const Past before = past(journal, "A", told_by_life);
  conclude(journal, {of_test<RemainingLife>("A", 3, "remaining_life", 1)});
  const Past after = past(journal, "A", told_by_life);
  place_.execute("DELETE FROM packed_outputs");
  EXPECT_EQ(past(journal, "A", told_by_life), after);
  EXPECT_THAT(after, SizeIs(before.size() + 1));
  EXPECT_NE(after.at(4), before.at(4)) << "its report comes with its id alone";
  EXPECT_EQ(after.at(3), before.at(3));
}

TEST_P(PackedPasts, HaveNoSamplesAndNoTestThatHasSomeLeft) {
  const auto tells_all = [](const Message& last) { return topic_of(last) == Topic::test_features; };
  Journal journal = open();
  for (int test = 1; test <= kTests; ++test) {
    if (test != 30) conclude(journal, {of_test<TestWindow>("C", test, "window", 9)});
    if (test == 30) conclude(journal, {of_test<SampleBlock>("C", test, "open", 9)});
    if (test != 30) conclude(journal, {of_test<TestFeatures>("C", test, "features", 2)});
  }
  const Past whole = past(journal, "C", tells_all);
  EXPECT_EQ(packed("C"), 1);
  EXPECT_EQ(past(journal, "C", tells_all), whole);
  EXPECT_EQ(count("SELECT outputs FROM packed_outputs WHERE asset_id = 'C'"), 2 * 29);
  EXPECT_THAT(whole.at(2 * 29), HasSubstr("open/C test 30"));
}

TEST_P(PackedPasts, OfADamagedTestComeAsItIsConcludedAgain) {
  Past whole;
  {
    Journal journal = open();
    whole = past(journal);
    place_.execute("UPDATE outputs SET payload = 'turned' WHERE ordinal = 4");
    EXPECT_EQ(past(journal), whole);
  }
  Journal journal = open();
  whole.erase(whole.begin() + 2);
  EXPECT_EQ(past(journal), whole);
  Message again = report("A", 2);
  std::get<StateReport>(again).overdue_days = 99.5;
  conclude(journal, {again});
  const Past now = past(journal);
  EXPECT_THAT(now, SizeIs(whole.size() + 1));
  EXPECT_THAT(now.at(2), AllOf(HasSubstr("state_report/A test 2\""), HasSubstr("\"overdue_days\":99.5")));
  EXPECT_EQ(past(journal), now);
}

TEST_P(PackedPasts, OfABatchThatIsGivenUpAreGivenUpToo) {
  Journal journal = open();
  const Past whole = past(journal, "D");
  ASSERT_TRUE(journal.begin());
  for (int test = 1; test <= kTests; ++test) ASSERT_TRUE(journal.add_output(report("D", test), UtcTime{}).has_value());
  EXPECT_THAT(past(journal, "D"), SizeIs(kTests));
  journal.rollback();
  EXPECT_EQ(past(journal, "D"), whole);
  EXPECT_EQ(packed("D"), 0);
}

/// The whole file is not made again because of it.
TEST(PackedPastsFile, ThatHaveLostTheirPagesAreDoneWithout) {
  const Place place;
  const auto open = [&] { return Journal::open(place.connection(), "state_detection").value(); };
  const auto read = [](Journal& journal) {
    Past ids;
    EXPECT_TRUE(journal.for_each_output_of(
        "A",
        [&](const Message& output, const Journal::Place&) {
          return ids.push_back(to_json(output, JsonForm::exact)), Status();
        },
        [](const Message&) { return false; }));
    return ids;
  };
  Past whole;
  long long root = 0;
  {
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    for (int test = 1; test <= kTests; ++test)
      EXPECT_TRUE(journal.add_output(report("A", test), UtcTime{}).has_value());
    ASSERT_TRUE(journal.commit());
    whole = read(journal);
  }
  {
    soci::session sql(place.connection());
    sql << "PRAGMA wal_checkpoint(TRUNCATE)";
    sql << "SELECT rootpage FROM sqlite_master WHERE name = 'packed_outputs'", soci::into(root);
  }
  {
    std::fstream file(place.directory() / "journal.db", std::ios::binary | std::ios::in | std::ios::out);
    file.seekp((root - 1) * 1024);
    file << std::string(1024, '\0');
  }
  for (int start = 0; start < 2; ++start) {
    Journal journal = open();
    EXPECT_EQ(read(journal), whole);
    EXPECT_EQ(read(journal), whole);
    EXPECT_THAT(journal.take_packed_refused().value_or(""), HasSubstr("cannot be read"));
    EXPECT_THAT(journal.quarantine().value(), IsEmpty());
  }
  EXPECT_FALSE(std::filesystem::exists(place.directory() / "journal.db.damaged-1"));
}

}  // namespace
}  // namespace sealwatch
