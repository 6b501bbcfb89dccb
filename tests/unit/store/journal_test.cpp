// The journal's contract, on SQLite and, where there is one (place.hpp), on PostgreSQL.
#include "services/common/store/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sealwatch/message/blank.hpp"
#include "tests/unit/message/fill.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Message message(const std::string& id, const std::string& asset = "XT03-MV2", Topic topic = Topic::state_report) {
  if (topic == Topic::state_report) {
    StateReport report = testing::filled<StateReport>(2);
    report.asset_id = asset;
    report.header.message_id = id;
    return report;
  }
  TestFeatures features = testing::filled<TestFeatures>(2);
  features.asset_id = asset;
  features.header.message_id = id;
  return features;
}

Message without_stamps(Message m) {
  header_of(m).writer_id.clear();
  header_of(m).stream_sequence = 0;
  header_of(m).publishing_time_ns = 0;
  return m;
}

class JournalTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!place_.usable()) GTEST_SKIP() << place_.why_not();
  }
  Journal open(const std::string& service = "state_detection") {
    Result<Journal> journal = Journal::open(place_.connection(), service);
    EXPECT_TRUE(journal.has_value()) << journal.error().describe();
    return std::move(*journal);
  }
  /// Adds outputs of these ids in one batch and returns them as they would be published.
  std::vector<Message> conclude(Journal& journal, const std::vector<Message>& messages) {
    std::vector<Message> published;
    EXPECT_TRUE(journal.begin());
    for (const Message& m : messages) {
      const auto added = journal.add_output(m, UtcTime{77});
      EXPECT_TRUE(added.has_value()) << added.error().describe();
      if (added && *added) published.push_back(**added);
    }
    EXPECT_TRUE(journal.commit());
    return published;
  }
  void receive(Journal& journal, const Message& m, bool consumed) {
    EXPECT_TRUE(journal.begin());
    const Status added = journal.add_input(m, UtcTime{5}, consumed);
    EXPECT_TRUE(added) << added.error().describe();
    EXPECT_TRUE(journal.commit());
  }
  static std::vector<std::string> ids(const std::vector<Message>& messages) {
    std::vector<std::string> found;
    for (const Message& m : messages) found.push_back(header_of(m).message_id);
    return found;
  }
  static std::vector<Message> all_outputs(Journal& journal) {
    std::vector<Message> found;
    EXPECT_TRUE(journal.for_each_output([&](const Message& m) { return found.push_back(m), Status(); }));
    return found;
  }
  static std::vector<Message> open_inputs(Journal& journal) {
    std::vector<Message> found;
    EXPECT_TRUE(journal.for_each_open_input([&](const Message& m) { return found.push_back(m), Status(); }));
    return found;
  }

  Place place_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Backends, JournalTest, ::testing::Values("sqlite3", "postgresql"),
                         [](const auto& backend) { return backend.param; });

TEST_P(JournalTest, OutputsComeBackFieldByFieldInOrderAndStampedWhereTheyGoOut) {
  const Message first = message("a");
  const Message second = message("b", "XT04", Topic::test_features);
  const Message third = message("c");
  {
    Journal journal = open();
    const std::vector<Message> published = conclude(journal, {first, second, third});
    ASSERT_EQ(published.size(), 3U);
    EXPECT_EQ(header_of(published[0]).stream_sequence, 1U);
    EXPECT_EQ(header_of(published[1]).stream_sequence, 1U) << "each topic is a stream of its own";
    EXPECT_EQ(header_of(published[2]).stream_sequence, 2U);
    EXPECT_EQ(header_of(published[2]).writer_id, journal.writer_id());
    EXPECT_EQ(header_of(published[2]).publishing_time_ns, 77);
  }
  Journal journal = open();
  EXPECT_THAT(all_outputs(journal), ElementsAre(without_stamps(first), without_stamps(second), without_stamps(third)));
  const auto again = journal.outputs(Topic::state_report, 2, 9, 64);
  ASSERT_TRUE(again.has_value()) << again.error().describe();
  ASSERT_EQ(again->size(), 1U);
  EXPECT_EQ(header_of(again->front()).stream_sequence, 2U);
  EXPECT_EQ(header_of(again->front()).writer_id, journal.writer_id());
  EXPECT_EQ(header_of(again->front()).publishing_time_ns, 77);
}

Message of_test(Topic topic, const std::string& pst, const std::string& asset, std::int64_t time_ns) {
  Message made = blank_message(topic);
  std::visit([&](auto& content) { content.asset_id = asset; }, made);
  Header& header = header_of(made);
  header.message_id = std::string(name_of(topic)) + "/" + pst + "/" + std::to_string(time_ns);
  header.pst_id = pst;
  header.event_time_known = true;
  header.event_time_ns = time_ns;
  return made;
}

TEST_P(JournalTest, AnAssetsPastIsReadAloneAndOfATestThatIsToldByItsLastThatAlone) {
  Journal journal = open("data_manipulation");
  conclude(journal, {of_test(Topic::test_window, "1", "A", 10), of_test(Topic::test_features, "1", "A", 10),
                     of_test(Topic::test_window, "1b", "B", 11), of_test(Topic::sample_block, "2", "A", 20),
                     of_test(Topic::sample_block, "2", "A", 21), of_test(Topic::state_report, "", "A", 30),
                     of_test(Topic::state_report, "", "A", 31), of_test(Topic::sample_block, "3", "A", 40),
                     of_test(Topic::sample_block, "3", "A", 41)});
  const auto past_of = [&](const std::string& asset, const Journal::TellsAll& tells_all) {
    std::vector<std::string> found;
    EXPECT_TRUE(journal.for_each_output_of(
        asset,
        [&](const Message& m, const Journal::Place& place) {
          EXPECT_EQ(place.concluded.nanoseconds, 77);
          EXPECT_EQ(asset_of(m), asset);
          found.push_back(header_of(m).message_id + " " + std::to_string(place.sequence));
          return Status();
        },
        tells_all));
    return found;
  };
  const auto never = [](const Message&) { return false; };
  EXPECT_THAT(past_of("A", never),
              ElementsAre("test_window/1/10 1", "test_features/1/10 1", "sample_block/2/20 1", "sample_block/2/21 2",
                          "state_report//30 1", "state_report//31 2", "sample_block/3/40 3", "sample_block/3/41 4"));
  EXPECT_THAT(past_of("B", never), ElementsAre("test_window/1b/11 2"));
  EXPECT_THAT(past_of("C", never), IsEmpty());
  EXPECT_THAT(past_of("A", [](const Message& last) { return header_of(last).pst_id != "3"; }),
              ElementsAre("test_window/1/10 1", "test_features/1/10 1", "sample_block/2/21 2", "state_report//30 1",
                          "state_report//31 2", "sample_block/3/40 3", "sample_block/3/41 4"));
}

TEST_P(JournalTest, AssetsWithOpenInputsComeFirst) {
  Journal journal = open();
  conclude(journal, {message("a", "A"), message("b", "B"), message("c", "C"), message("d", "B")});
  receive(journal, message("x", "C", Topic::test_features), false);
  receive(journal, message("y", "D", Topic::test_features), false);
  receive(journal, message("z", "E", Topic::test_features), true);
  EXPECT_THAT(journal.assets().value(), ElementsAre("C", "D", "A", "B"));
}

TEST_P(JournalTest, TheSameConclusionTwiceIsKeptOnce) {
  Journal journal = open();
  EXPECT_EQ(conclude(journal, {message("a"), message("a")}).size(), 1U);
  EXPECT_THAT(conclude(journal, {message("a")}), IsEmpty());
  EXPECT_EQ(journal.written().at(Topic::state_report), 1U);
  EXPECT_EQ(header_of(conclude(journal, {message("b")}).at(0)).stream_sequence, 2U) << "no gap is left";
}

Message window(const std::string& id, const std::string& asset, std::size_t rows) {
  TestWindow made;
  made.asset_id = asset;
  made.header.message_id = id;
  made.header.pst_id = "pst-" + id;
  made.header.producer = "data_manipulation";
  made.header.event_time_known = true;
  made.header.event_time_ns = 4711;
  made.samples.time_s.assign(rows, 0.5);
  return made;
}

TEST_P(JournalTest, AnOutputThatExpiresKeepsAllButItsSamples) {
  constexpr std::size_t kRows = 20'000;
  {
    Journal journal = open();
    (void)conclude(journal, {window("a", "A", kRows), window("b", "B", kRows), window("c", "A", kRows)});
    const double before = journal.used_bytes().value();
    ASSERT_TRUE(journal.begin());
    for (const std::uint64_t sequence : {1U, 2U}) {
      const Status expired = journal.expire(Topic::test_window, sequence);
      ASSERT_TRUE(expired) << expired.error().describe();
    }
    ASSERT_TRUE(journal.commit());
    if (GetParam() == "sqlite3") {
      EXPECT_LT(journal.used_bytes().value(), before - 2 * 8 * kRows) << "it is used again";
    }
    const auto kept = journal.kept_samples(Topic::test_window, 0, 10).value();
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_EQ(kept[0].sequence, 3U);
    EXPECT_EQ(kept[0].asset_id, "A");
    EXPECT_EQ(kept[0].pst_id, "pst-c");
    EXPECT_EQ(kept[0].concluded, UtcTime{77});
    EXPECT_THAT(conclude(journal, {window("a", "A", kRows)}), IsEmpty()) << "known for ever";
  }
  place_.execute("UPDATE outputs SET payload = 'no message' WHERE message_id = 'b'");
  Journal journal = open();
  EXPECT_THAT(journal.quarantine().value(), IsEmpty()) << "what is left of it is not missed";
  const std::vector<Message> outputs = all_outputs(journal);
  EXPECT_THAT(ids(outputs), ElementsAre("a", "b", "c"));
  EXPECT_EQ(header_of(outputs[0]).producer, "expired: data_manipulation");
  EXPECT_EQ(header_of(outputs[0]).event_time_ns, 4711);
  EXPECT_EQ(asset_of(outputs[1]), "B");
  EXPECT_EQ(header_of(outputs[1]).pst_id, "pst-b");
  const auto again = journal.outputs(Topic::test_window, 1, 3, 64).value();
  ASSERT_EQ(again.size(), 3U);
  for (const std::size_t k : {0U, 1U}) {
    EXPECT_TRUE(std::get<TestWindow>(again[k]).samples.time_s.empty());
    EXPECT_TRUE(header_of(again[k]).producer.starts_with("expired: "));
    EXPECT_EQ(header_of(again[k]).stream_sequence, k + 1) << "readers count on";
  }
  EXPECT_EQ(std::get<TestWindow>(again[2]).samples.time_s.size(), kRows);
}

/// Of twenty years hardly any output has its samples: nobody waits until all of them are looked at.
TEST_P(JournalTest, ThoseThatExpiredArePassedOverLittleByLittle) {
  constexpr std::uint64_t kExpired = 600;
  Journal journal = open();
  std::vector<Message> all;
  for (std::uint64_t k = 0; k <= kExpired; ++k) all.push_back(window(std::to_string(k), "A", 1));
  (void)conclude(journal, all);
  place_.execute("UPDATE outputs SET checksum = 'expired' WHERE sequence <= " + std::to_string(kExpired));
  EXPECT_THAT(journal.kept_samples(Topic::test_window, 0, 10).value(), IsEmpty()) << "so far it does not look";
  std::uint64_t after = 0, looks = 0;
  for (; after < kExpired; ++looks) {
    const std::uint64_t last = journal.dropped_samples(Topic::test_window, after).value();
    ASSERT_GT(last, after);
    after = last;
  }
  EXPECT_GT(looks, 1U);
  EXPECT_EQ(journal.dropped_samples(Topic::test_window, after).value(), kExpired);
  const auto kept = journal.kept_samples(Topic::test_window, after, 10).value();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].sequence, kExpired + 1);
}

TEST_P(JournalTest, OpenInputsComeBackInOrderOfReceiptUntilConsumed) {
  {
    Journal journal = open();
    receive(journal, message("z"), false);
    receive(journal, message("a"), true);
    receive(journal, message("m"), false);
    EXPECT_EQ(journal.open_inputs(), 2U);
  }
  Journal journal = open();
  EXPECT_EQ(journal.open_inputs(), 2U);
  EXPECT_THAT(open_inputs(journal), ElementsAre(message("z"), message("m")));
  ASSERT_TRUE(journal.begin());
  ASSERT_TRUE(journal.consume("z"));
  ASSERT_TRUE(journal.consume("z"));
  ASSERT_TRUE(journal.consume("never received"));
  ASSERT_TRUE(journal.commit());
  EXPECT_EQ(journal.open_inputs(), 1U);
  EXPECT_THAT(ids(open_inputs(journal)), ElementsAre("m"));
  EXPECT_TRUE(journal.has_input("z").value()) << "its id is remembered";
  EXPECT_TRUE(journal.has_input("a").value());
  EXPECT_FALSE(journal.has_input("b").value());
}

TEST_P(JournalTest, MoreThanOnePageOfMessagesIsReadCompletely) {
  Journal journal = open();
  std::vector<Message> messages;
  std::vector<std::string> expected;
  for (int k = 0; k < 50; ++k) {
    messages.push_back(message("id " + std::to_string(k)));
    expected.push_back("id " + std::to_string(k));
    receive(journal, messages.back(), false);
  }
  conclude(journal, messages);
  EXPECT_EQ(ids(all_outputs(journal)), expected);
  EXPECT_EQ(ids(open_inputs(journal)), expected);
  const auto part = journal.outputs(Topic::state_report, 11, 40, 7);
  ASSERT_TRUE(part.has_value());
  EXPECT_EQ(ids(*part), std::vector<std::string>(expected.begin() + 10, expected.begin() + 17));
}

TEST_P(JournalTest, ABatchGivenUpLeavesNothingBehind) {
  Journal journal = open();
  conclude(journal, {message("kept")});
  ASSERT_TRUE(journal.begin());
  ASSERT_TRUE(journal.add_input(message("i"), UtcTime{}, false));
  ASSERT_TRUE(journal.add_output(message("o"), UtcTime{}));
  ASSERT_TRUE(journal.set_position({"raw_samples", "w", 9}));
  journal.rollback();
  EXPECT_FALSE(journal.has_input("i").value());
  EXPECT_EQ(journal.open_inputs(), 0U);
  EXPECT_THAT(journal.positions().value(), IsEmpty());
  EXPECT_EQ(journal.written().at(Topic::state_report), 1U);
  EXPECT_EQ(header_of(conclude(journal, {message("o")}).at(0)).stream_sequence, 2U);
}

TEST_P(JournalTest, AJournalThatEndsInsideABatchHasNothingOfIt) {
  {
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.add_output(message("o"), UtcTime{}));
  }
  Journal journal = open();
  EXPECT_THAT(all_outputs(journal), IsEmpty());
}

TEST_P(JournalTest, PositionsAndWriterIdSurvive) {
  std::string writer_id;
  {
    Journal journal = open();
    writer_id = journal.writer_id();
    EXPECT_THAT(writer_id, ::testing::MatchesRegex("state_detection-[0-9a-f]{16}"));
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.set_position({"test_features", "w1", 3}));
    ASSERT_TRUE(journal.set_position({"test_features", "w1", 4}));
    ASSERT_TRUE(journal.set_position({"raw_samples", "w2", 1}));
    ASSERT_TRUE(journal.commit());
  }
  Journal journal = open();
  EXPECT_EQ(journal.writer_id(), writer_id);
  const std::vector<StreamPosition> expected = {{"raw_samples", "w2", 1}, {"test_features", "w1", 4}};
  EXPECT_EQ(journal.positions().value(), expected);
}

TEST_P(JournalTest, TheLastInputOfNoStreamIsKnownByAsset) {
  Journal journal = open();
  Message foreign = message("foreign", "A");
  header_of(foreign).stream_sequence = 0;
  receive(journal, foreign, true);
  receive(journal, message("numbered", "A"), true);
  EXPECT_EQ(journal.last_unnumbered_input(Topic::state_report, "A").value(), "foreign");
  EXPECT_EQ(journal.last_unnumbered_input(Topic::state_report, "B").value(), "");
}

/// A file is moved aside (last_journal_test.cpp), a schema cannot be.
TEST_P(JournalTest, AJournalOfAnotherServiceIsRefused) {
  if (GetParam() == "sqlite3") GTEST_SKIP() << "is moved aside";
  open("state_detection");
  const Result<Journal> journal = Journal::open(place_.connection(), "health_assessment");
  ASSERT_FALSE(journal.has_value());
  EXPECT_THAT(journal.error().describe(), HasSubstr("'state_detection': must be 'health_assessment'"));
}

TEST_P(JournalTest, ANewerSchemaIsRefusedWithWhatToDo) {
  open();
  place_.execute("UPDATE meta SET value = '6' WHERE name = 'schema_version'");
  if (GetParam() == "sqlite3") place_.execute("PRAGMA user_version = 6");
  const Result<Journal> journal = Journal::open(place_.connection(), "state_detection");
  ASSERT_FALSE(journal.has_value());
  EXPECT_THAT(journal.error().describe(), HasSubstr("'6': must be at most 5, the version that this program knows"));
  EXPECT_THAT(journal.error().advice, HasSubstr("install the sealwatch that wrote this journal"));
}

/// On a file by the lock's own end, on a server by the end of the session that has it: then the other one may have it.
TEST_P(JournalTest, WhoLostItsLockWritesNoMore) {
  Journal first = open();
  conclude(first, {message("a")});
  if (GetParam() == "sqlite3")
    std::filesystem::remove(place_.directory() / "journal.db.lock");
  else
    place_.execute(
        "SELECT pg_terminate_backend(pid) FROM pg_locks WHERE locktype = 'advisory' AND objid::bigint ="
        " (hashtext('sealwatch journal ' || current_schema())::bigint & 4294967295)");
  Journal second = open();
  Status written = first.begin();
  if (written) written = first.set_position({"state_report", "w", 1});
  EXPECT_FALSE(written);
  conclude(second, {message("b")});
  EXPECT_EQ(all_outputs(second).size(), 2U);
}

/// Somebody dropped it: there is no other process to be stopped.
TEST_P(JournalTest, InASchemaThatIsNotThereSaysSo) {
  if (GetParam() == "sqlite3") GTEST_SKIP() << "a file has no schema";
  const Result<Journal> journal =
      Journal::open(place_.connection() + " options='-c search_path=sealwatch_nowhere'", "state_detection");
  ASSERT_FALSE(journal.has_value());
  EXPECT_THAT(journal.error().describe(), HasSubstr("its schema is not there"));
  EXPECT_THAT(journal.error().advice, HasSubstr("CREATE SCHEMA"));
}

TEST_P(JournalTest, IsOpenForOneAtATime) {
  {
    const Journal first = open();
    const Result<Journal> second = Journal::open(place_.connection(), "state_detection");
    ASSERT_FALSE(second.has_value());
    EXPECT_THAT(second.error().describe(), HasSubstr("another process works with this journal"));
    EXPECT_THAT(second.error().advice, HasSubstr("one machine"));
  }
  EXPECT_TRUE(Journal::open(place_.connection(), "state_detection").has_value());
}

}  // namespace
}  // namespace sealwatch
