// Bits that a disk or a memory turned, in every table of a journal: noticed when it is opened, never read, and made
// again wherever that is possible.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "services/common/store/damaged_file.hpp"
#include "services/common/store/journal.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kService = "health_assessment";

Header header(const std::string& id, const std::string& pst_id) {
  Header made;
  made.message_id = id;
  made.pst_id = pst_id;
  return made;
}

/// From a neighbour's stream, and what is concluded of it.
Message features(int test) {
  TestFeatures made;
  made.asset_id = "XT03";
  made.header = header("features " + std::to_string(test), "test " + std::to_string(test));
  made.header.writer_id = "data_manipulation-1";
  made.header.stream_sequence = static_cast<std::uint64_t>(test);
  return made;
}

Message report(int test) {
  HealthReport made;
  made.asset_id = "XT03";
  made.header = header("report " + std::to_string(test), "test " + std::to_string(test));
  return made;
}

class Mend : public ::testing::Test {
 protected:
  Mend() {
    Journal journal = open();
    EXPECT_TRUE(journal.begin());
    for (int test = 1; test <= 3; ++test) {
      EXPECT_TRUE(journal.add_input(features(test), UtcTime{}, test < 3));
      EXPECT_TRUE(journal.set_position({"test_features", "data_manipulation-1", static_cast<std::uint64_t>(test)}));
      if (test < 3) {
        EXPECT_TRUE(journal.add_output(report(test), UtcTime{}).has_value());
      }
    }
    EXPECT_TRUE(journal.set_aside({"broken", "test_features", "XT03", "test 9", 5, "it failed"}));
    EXPECT_TRUE(journal.commit());
  }
  [[nodiscard]] Journal open() const {
    auto journal = Journal::open(place_.connection(), kService);
    if (!journal) throw std::runtime_error(journal.error().describe());
    return std::move(*journal);
  }
  /// Turns the lowest bit of the first letter of a field.
  void turn_bit(const std::string& table, const std::string& field, const std::string& where) const {
    std::string value;
    soci::session sql(place_.connection());
    sql << "SELECT " + field + " FROM " + table + " WHERE " + where, soci::into(value);
    ASSERT_FALSE(value.empty());
    value[0] = static_cast<char>(value[0] ^ 1);
    sql << "UPDATE " + table + " SET " + field + " = :value WHERE " + where, soci::use(value, "value");
  }
  static std::vector<std::string> outputs(Journal& journal) {
    std::vector<std::string> ids;
    EXPECT_TRUE(
        journal.for_each_output([&](const Message& m) { return ids.push_back(header_of(m).message_id), Status(); }));
    return ids;
  }
  static std::vector<std::string> open_inputs(Journal& journal) {
    std::vector<std::string> ids;
    EXPECT_TRUE(journal.for_each_open_input(
        [&](const Message& m) { return ids.push_back(header_of(m).message_id), Status(); }));
    return ids;
  }
  /// In a long history a start does not look at all: what is damaged there is noticed when it is read, and mended when
  /// the journal is opened next.
  void expect_not_read(const std::function<Status(Journal&)>& read) const {
    {
      Journal journal = open();
      turn_bit("outputs", "payload", "ordinal = 1");
      const Status seen = read(journal);
      ASSERT_FALSE(seen);
      EXPECT_THAT(seen.error().describe(), HasSubstr("not as it was written"));
    }
    Journal journal = open();
    EXPECT_THAT(outputs(journal), ElementsAre("report 2"));
    EXPECT_THAT(journal.quarantine().value(), SizeIs(2));
    EXPECT_TRUE(read(journal));
  }
  void statement(const std::string& text) const {
    soci::session sql(place_.connection());
    sql << "PRAGMA writable_schema = ON";
    sql << text;
  }
  /// What is written meanwhile, the index does not know.
  void without_index(const std::string& index, const std::function<void()>& write) const {
    statement("CREATE TABLE kept AS SELECT * FROM sqlite_master WHERE name = '" + index + "'");
    statement("DELETE FROM sqlite_master WHERE name = '" + index + "'");
    write();
    statement("INSERT INTO sqlite_master SELECT * FROM kept");
    statement("DROP TABLE kept");
  }
  static std::vector<std::string> reasons(Journal journal) {
    std::vector<std::string> found;
    const auto all = journal.quarantine().value();
    for (const SetAside& one : all) found.push_back(one.reason);
    return found;
  }
  static Status look(Journal& journal) {
    for (int looks = 0; looks < 30; ++looks) {
      const auto more = journal.check_some();
      if (!more) return fail(more.error());
      if (!*more) break;
    }
    return {};
  }
  void expect_found_and_mended(const std::string& index) const {
    {
      Journal journal = open();
      const Status looked = look(journal);
      ASSERT_FALSE(looked) << index;
      EXPECT_THAT(looked.error().describe(), HasSubstr("does not find it"));
    }
    Journal journal = open();
    EXPECT_TRUE(look(journal)) << index;
    EXPECT_THAT(journal.quarantine().value(), SizeIs(1)) << "no row was damaged";
  }
  static std::uint64_t position(Journal& journal) { return journal.positions().value().at(0).sequence; }

  Place place_;
};

TEST_F(Mend, WhatIsWholeStaysAsItIs) {
  Journal journal = open();
  EXPECT_THAT(outputs(journal), ElementsAre("report 1", "report 2"));
  EXPECT_THAT(open_inputs(journal), ElementsAre("features 3"));
  EXPECT_EQ(position(journal), 3U);
  EXPECT_THAT(journal.quarantine().value(), SizeIs(1));
}

TEST_F(Mend, AnOutputIsConcludedAgainInItsPlace) {
  for (const std::string field : {"payload", "asset_id", "topic"}) {
    SCOPED_TRACE(field);
    turn_bit("outputs", field, "ordinal = 1");
    Journal journal = open();
    EXPECT_THAT(outputs(journal), ElementsAre("report 2"));
    ASSERT_THAT(journal.quarantine().value(), SizeIs(2)) << "it is told";
    if (field == "payload") {
      EXPECT_FALSE(journal.has_input("features 1").value()) << "it is to come again";
      EXPECT_EQ(position(journal), 0U);
      EXPECT_TRUE(journal.has_input("features 2").value());
    }
    const auto sent_again = journal.outputs(field == "topic" ? Topic::test_features : Topic::health_report, 1, 1, 9);
    if (field != "topic") {
      EXPECT_THAT(header_of(sent_again.value().at(0)).message_id, ::testing::StartsWith("damaged/"));
    }
    if (field != "payload") place_.execute("UPDATE outputs SET asset_id = 'XT03', pst_id = 'test 1' WHERE ordinal = 1");
  }
}

TEST_F(Mend, WhatIsDamagedWhileTheJournalIsOpenIsNotRead) {
  expect_not_read([](Journal& journal) { return journal.for_each_output([](const Message&) { return Status(); }); });
}

TEST_F(Mend, NorAsAnAssetsPast) {
  expect_not_read([](Journal& journal) {
    return journal.for_each_output_of(
        "XT03", [](const Message&, const Journal::Place&) { return Status(); }, [](const Message&) { return false; });
  });
}

// A bit of the index, while the row is whole: the index is made anew, and nothing of the past is lost.
TEST_F(Mend, AnIndexThatSaysOtherwiseThanItsRowsIsMadeAnew) {
  const auto turned = [this] {  // the index keeps what stood in the row when it was last maintained
    statement("UPDATE outputs SET pst_id = 'uest 1' WHERE ordinal = 1");
    without_index("outputs_of_asset", [this] { statement("UPDATE outputs SET pst_id = 'test 1' WHERE ordinal = 1"); });
  };
  std::vector<std::string> past;
  const auto read = [&past](Journal& journal) {
    past.clear();
    return journal.for_each_output_of(
        "XT03",
        [&past](const Message& message, const Journal::Place&) {
          return past.push_back(header_of(message).message_id), Status();
        },
        [](const Message&) { return true; });
  };
  turned();
  {
    Journal journal = open();
    const Status seen = read(journal);
    ASSERT_FALSE(seen);
    EXPECT_THAT(seen.error().describe(), HasSubstr("not as it was written"));
  }
  Journal journal = open();
  ASSERT_TRUE(read(journal));
  EXPECT_THAT(past, ElementsAre("report 1", "report 2"));
  EXPECT_THAT(journal.quarantine().value(), SizeIs(1)) << "no row was damaged";
}

/// Rows that an index leaves out are found by looking, before anything is concluded twice or not at all.
TEST_F(Mend, AnIndexThatLeavesARowOutIsMadeAnew) {
  {
    Message of_no_stream = features(4);
    header_of(of_no_stream).stream_sequence = 0;
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.add_input(of_no_stream, UtcTime{}, true));
    ASSERT_TRUE(journal.commit());
  }
  for (const auto& [index, table, number, row] :
       {std::tuple{"outputs_of_asset", "outputs", "ordinal", "1"}, std::tuple{"inputs_open", "inputs", "receipt", "3"},
        std::tuple{"inputs_of_no_stream", "inputs", "receipt", "4"}}) {
    const auto move = [&, table = std::string(table), number = std::string(number)](const std::string& from,
                                                                                    const std::string& to) {
      statement("UPDATE " + table + " SET " + number + " = " + to + " WHERE " + number + " = " + from);
    };
    move(row, "-1");  // the index follows the row away, and not back
    without_index(index, [&] { move("-1", row); });
    expect_found_and_mended(index);
  }
}

TEST_F(Mend, NorIsOneOfFewRowsPassedOver) {
  without_index("inputs_kept", [this] {
    statement(
        "INSERT INTO inputs SELECT 9, topic, writer_id, 9, 'features 9', asset_id, 'test 9', received, 0, payload,"
        " NULL FROM inputs WHERE receipt = 3");
  });
  expect_found_and_mended("inputs_kept");
  without_index("outputs_damaged", [this] { statement("UPDATE outputs SET checksum = 'damaged' WHERE ordinal = 2"); });
  expect_found_and_mended("outputs_damaged");
}

TEST_F(Mend, NorToBeSentAgain) {
  expect_not_read([](Journal& journal) {
    const auto again = journal.outputs(Topic::health_report, 1, 9, 9);
    return again ? Status() : fail(again.error());
  });
}

TEST_F(Mend, TheRestIsLookedAtLittleByLittle) {
  Journal journal = open();
  ASSERT_TRUE(journal.begin());
  for (int test = 10; test < 30; ++test) ASSERT_TRUE(journal.add_output(report(test), UtcTime{}).has_value());
  ASSERT_TRUE(journal.commit());
  int looks = 1;
  for (; journal.check_some().value(); ++looks) EXPECT_LT(looks, 30);
  EXPECT_GT(looks, 3);
  ASSERT_TRUE(journal.begin());
  for (int test = 30; test < 40; ++test) ASSERT_TRUE(journal.add_output(report(test), UtcTime{}).has_value());
  ASSERT_TRUE(journal.commit());
  turn_bit("outputs", "payload", "message_id = 'report 38'");
  Result<bool> more = true;
  for (looks = 0; more && *more && looks < 30; ++looks) more = journal.check_some();
  ASSERT_FALSE(more);
  EXPECT_THAT(more.error().describe(), HasSubstr("report 38"));
}

TEST_F(Mend, AnOutputThatWasConcludedAgainHasItsOldNumber) {
  turn_bit("outputs", "payload", "ordinal = 1");
  {
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    const auto again = journal.add_output(report(1), UtcTime{7});
    ASSERT_TRUE(again.has_value() && *again);
    EXPECT_EQ(header_of(**again).stream_sequence, 1U);
    EXPECT_EQ(header_of(**again).writer_id, journal.writer_id());
    ASSERT_TRUE(journal.commit());
    EXPECT_THAT(outputs(journal), ElementsAre("report 1", "report 2"));
    EXPECT_THAT(journal.quarantine().value(), SizeIs(1));
  }
  Journal journal = open();
  EXPECT_THAT(outputs(journal), ElementsAre("report 1", "report 2"));
  EXPECT_EQ(header_of(journal.outputs(Topic::health_report, 1, 1, 9).value().at(0)).message_id, "report 1");
}

TEST_F(Mend, AnOpenInputComesAgain) {
  turn_bit("inputs", "payload", "receipt = 3");
  Journal journal = open();
  EXPECT_THAT(open_inputs(journal), IsEmpty());
  EXPECT_FALSE(journal.has_input("features 3").value());
  EXPECT_EQ(position(journal), 2U);
}

TEST_F(Mend, AnInputThatSeemsOpenAndHasNoMessageComesAgain) {
  place_.execute("UPDATE inputs SET consumed = 0 WHERE receipt = 2");
  Journal journal = open();
  EXPECT_THAT(open_inputs(journal), ElementsAre("features 3"));
  EXPECT_EQ(position(journal), 1U);
}

TEST_F(Mend, AnOpenInputFromOutsideIsToldAsLost) {
  {
    Journal journal = open();
    Message block = RawSamples();
    header_of(block).message_id = "raw 1";
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.add_input(block, UtcTime{}, false));
    ASSERT_TRUE(journal.commit());
  }
  turn_bit("inputs", "payload", "message_id = 'raw 1'");
  Journal journal = open();
  EXPECT_THAT(open_inputs(journal), ElementsAre("features 3"));
  ASSERT_THAT(journal.quarantine().value(), SizeIs(2));
  EXPECT_THAT(journal.quarantine().value().at(1).reason, HasSubstr("send it again"));
  EXPECT_FALSE(journal.has_input("raw 1").value()) << "what is sent again must not count as known";
}

TEST_F(Mend, WhatCameAgainOfADamagedTestStaysOpenUntilItIsConcluded) {
  turn_bit("outputs", "payload", "ordinal = 1");
  {
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.add_input(features(1), UtcTime{}, false));
    ASSERT_TRUE(journal.commit());
  }
  Journal journal = open();
  EXPECT_THAT(open_inputs(journal), Contains("features 1"));
}

TEST_F(Mend, AColumnIsPutRightByItsMessageAndAChecksumByItsRow) {
  turn_bit("outputs", "message_id", "ordinal = 1");
  turn_bit("outputs", "asset_id", "ordinal = 2");
  turn_bit("inputs", "checksum", "message_id = 'features 3'");
  Journal journal = open();
  EXPECT_THAT(outputs(journal), ElementsAre("report 1", "report 2"));
  EXPECT_EQ(position(journal), 3U) << "nothing is fetched again";
  EXPECT_THAT(journal.quarantine().value(), SizeIs(1)) << "nothing is lost";
}

TEST_F(Mend, AnInputWithItsMessageWasNotConsumed) {
  place_.execute("UPDATE inputs SET consumed = 1 WHERE message_id = 'features 3'");
  Journal journal = open();
  EXPECT_THAT(open_inputs(journal), ElementsAre("features 3"));
}

TEST_F(Mend, WhatPeopleWroteIsNoDamage) {
  const std::string file = Journal::file_of(place_.connection());
  EXPECT_TRUE(is_damage(file, "database disk image is malformed while executing \"insert\""));
  EXPECT_FALSE(is_damage(file, "database or disk is full while executing \"insert\" with :b=\"the card was corrupt\""));
}

TEST_F(Mend, APositionIsTheLastInputOfItsStream) {
  place_.execute("UPDATE positions SET sequence = 1000003");
  Journal journal = open();
  EXPECT_EQ(position(journal), 3U);
}

TEST_F(Mend, WhatADamagedRowSetAsideIsTriedAgain) {
  place_.execute("UPDATE inputs SET consumed = 2, pst_id = 'test 9' WHERE receipt = 2");
  turn_bit("quarantine", "reason", "message_id = 'broken'");
  Journal journal = open();
  EXPECT_THAT(journal.quarantine().value(), IsEmpty());
  EXPECT_FALSE(journal.has_input("features 2").value()) << "its message was gone: it comes again";
}

TEST_F(Mend, TheNameOfADamagedJournalIsNew) {
  const std::string before = open().writer_id();
  turn_bit("meta", "value", "name = 'service'");
  EXPECT_NE(open().writer_id(), before);
  const std::string second = open().writer_id();
  turn_bit("meta", "value", "name = 'writer_id'");
  EXPECT_NE(open().writer_id(), second);
}

TEST_F(Mend, ATurnedBitOfTheVersionIsNoNewerVersion) {
  place_.execute("UPDATE meta SET value = '7' WHERE name = 'schema_version'");
  EXPECT_FALSE(open().writer_id().empty());
  place_.execute("UPDATE meta SET value = 'r' WHERE name = 'schema_version'");
  EXPECT_FALSE(open().writer_id().empty());
}

/// A message that an index left out may have been written once more before anybody looked.
TEST_F(Mend, ATableThatWasRemovedOrRenamedIsTold) {
  for (const std::string table : {"quarantine", "alarms", "anchors", "acts"}) {
    statement("DROP TABLE " + table);
    ASSERT_THAT(reasons(open()), Contains(HasSubstr("table " + table))) << table;
  }
  for (const std::string table : {"meta", "inputs", "outputs", "positions"}) {
    statement("ALTER TABLE " + table + " RENAME TO was_" + table);
    EXPECT_THAT(reasons(open()), Contains(HasSubstr("damaged and is made again"))) << table;
  }
}

/// Its readers would wait for what is not there, or be sent another message under its number.
TEST_F(Mend, ConclusionsThatWereRemovedAreTold) {
  {
    Journal journal = open();
    ASSERT_TRUE(journal.begin());
    for (int test = 3; test <= 9; ++test) ASSERT_TRUE(journal.add_output(report(test), UtcTime{}));
    ASSERT_TRUE(journal.commit());
    ASSERT_TRUE(look(journal));
  }
  statement("DELETE FROM outputs WHERE ordinal IN (1, 4, 5)");
  {
    Journal journal = open();
    const Status looked = look(journal);
    ASSERT_FALSE(looked);
    EXPECT_THAT(looked.error().describe(), HasSubstr("one before it is missing"));
  }
  Journal journal = open();
  EXPECT_TRUE(look(journal));
  EXPECT_THAT(reasons(std::move(journal)),
              Contains(HasSubstr("3 conclusions were removed from the journal, the first of "
                                 "them health_report number 1")));
  Journal again = open();
  EXPECT_THAT(outputs(again), ElementsAre("report 2", "report 3", "report 6", "report 7", "report 8", "report 9"));
  const auto sent = again.outputs(Topic::health_report, 3, 6, 10).value();
  ASSERT_THAT(sent, SizeIs(4));
  EXPECT_EQ(header_of(sent[1]).message_id, "damaged/health_report/4");
  EXPECT_EQ(header_of(sent[3]).message_id, "report 6");
}

TEST_F(Mend, AMessageInTwoRowsHasTheFileMadeAgain) {
  const std::filesystem::path file = place_.directory() / "journal.db";
  long long page = 0, size = 0;
  {
    soci::session sql(place_.connection());
    sql << "SELECT rootpage FROM sqlite_master WHERE name = 'sqlite_autoindex_inputs_1'", soci::into(page);
    sql << "PRAGMA page_size", soci::into(size);
    sql << "PRAGMA wal_checkpoint(TRUNCATE)";
  }
  std::string bytes(static_cast<std::size_t>(size), ' ');
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg((page - 1) * size);
  stream.read(bytes.data(), size);
  const std::size_t place = bytes.find("features 1");
  ASSERT_NE(place, std::string::npos);
  bytes[place + 9] = '0';  // one bit
  stream.seekp((page - 1) * size);
  stream.write(bytes.data(), size);
  stream.close();
  place_.execute(
      "INSERT INTO inputs(topic, writer_id, sequence, message_id, asset_id, pst_id, received, consumed)"
      " SELECT topic, writer_id, sequence, message_id, asset_id, pst_id, received, 1 FROM inputs NOT INDEXED"
      " WHERE message_id = 'features 1'");
  {
    Journal journal = open();
    Status looked;
    for (int looks = 0; looked && looks < 30; ++looks)
      if (const auto more = journal.check_some(); !more) looked = fail(more.error());
    EXPECT_FALSE(looked);
  }
  Journal journal = open();
  EXPECT_TRUE(std::filesystem::exists(file.string() + ".damaged-1"));
  EXPECT_THAT(journal.quarantine().value(), SizeIs(1));
}

/// In the middle of a page that SQLite must read at the start, and in its header.
TEST_F(Mend, AFileThatIsNoDatabaseAnyMoreIsMadeAgain) {
  for (const std::streamoff place : {std::streamoff{0}, std::streamoff{1024 + 1}, std::streamoff{20}}) {
    SCOPED_TRACE(place);
    {
      Journal journal = open();
      ASSERT_TRUE(journal.begin());
      ASSERT_TRUE(journal
                      .record({.at = {},
                               .kind = "acknowledgement",
                               .asset_id = "XT03",
                               .who = "J. Silva",
                               .subject = "a",
                               .text = {},
                               .outcome = "taken"})
                      .has_value());
      ASSERT_TRUE(journal.commit());
    }
    const std::filesystem::path file = place_.directory() / "journal.db";
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(place);
    stream.write("\xff\xff", 2);
    stream.close();
    std::filesystem::remove(file.string() + "-wal");
    Journal journal = open();
    EXPECT_TRUE(std::filesystem::exists(file.string() + ".damaged-1"));
    ASSERT_THAT(journal.quarantine().value(), SizeIs(1));
    EXPECT_THAT(journal.quarantine().value().at(0).reason, HasSubstr("damaged-"));
  }
}

/// A user who has a directory with a journal in which somebody set owners and modes.
class Rights : public Mend {
 protected:
  static constexpr uid_t kNobody = 65534;

  Rights() : file_((place_.directory() / "journal.db").string()) {
    if (::geteuid() != 0) return;
    EXPECT_EQ(::chown(place_.directory().c_str(), kNobody, kNobody), 0);
    for (const auto& entry : std::filesystem::directory_iterator(place_.directory()))
      EXPECT_EQ(::chown(entry.path().c_str(), kNobody, kNobody), 0);
  }
  /// What he finds in it, and what is told of it: root may read everything.
  [[nodiscard]] std::string opened_by_the_user() const {
    const std::string said = (place_.directory() / "said").string();
    const pid_t child = ::fork();
    if (child == 0) {
      if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(1);
      auto journal = Journal::open(place_.connection(), kService);
      std::ofstream stream(said);
      if (!journal) stream << journal.error().describe();
      if (journal) stream << outputs(*journal).size() << " outputs";
      if (journal)
        for (const SetAside& one : journal->quarantine().value()) stream << "; " << one.reason;
      stream.close();
      ::_exit(0);
    }
    int status = 1;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    std::ifstream stream(said);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void make_it_roots(::mode_t mode) const {
    EXPECT_EQ(::chown(file_.c_str(), 0, 0), 0);
    EXPECT_EQ(::chmod(file_.c_str(), mode), 0);
  }
  std::string file_;
};

TEST_F(Rights, AFileOfNoRightsGetsItsUsersBack) {
  ASSERT_EQ(::chmod(file_.c_str(), 0), 0);
  EXPECT_THAT(opened_by_the_user(), AllOf(HasSubstr("2 outputs"), HasSubstr("have their rights back")));
  EXPECT_FALSE(std::filesystem::exists(file_ + ".damaged-1"));
  EXPECT_THAT(opened_by_the_user(), HasSubstr("2 outputs")) << "and stays so";
}

TEST_F(Rights, AnothersFileIsCopied) {
  if (::geteuid() != 0) GTEST_SKIP() << "it takes root to give a file to another user";
  make_it_roots(0644);
  EXPECT_THAT(opened_by_the_user(), AllOf(HasSubstr("2 outputs"), HasSubstr("a copy is in their place")));
  EXPECT_TRUE(std::filesystem::exists(file_ + ".damaged-1"));
}

TEST_F(Rights, AnothersFileThatMayNotBeReadIsKeptAsideAndMadeAgain) {
  if (::geteuid() != 0) GTEST_SKIP() << "it takes root to give a file to another user";
  make_it_roots(0600);
  EXPECT_THAT(opened_by_the_user(),
              AllOf(HasSubstr("0 outputs"), HasSubstr("may not be read by this user"), Not(HasSubstr("was removed"))));
  EXPECT_TRUE(std::filesystem::exists(file_ + ".damaged-1"));
  EXPECT_THAT(opened_by_the_user(), HasSubstr("0 outputs"));
  EXPECT_FALSE(std::filesystem::exists(file_ + ".damaged-2"));
}

/// The file as it is closed, without its log; each time from the beginning.
class Header100 : public Mend {
 protected:
  Header100() : file_(place_.directory() / "journal.db") {
    static_cast<void>(open());  // closed again, with its log in the file
    soci::session(place_.connection()) << "PRAGMA wal_checkpoint(TRUNCATE)";
    std::ifstream stream(file_, std::ios::binary);
    whole_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  /// Whether the service starts, with its own rows or the file moved aside, and writes: at the latest after it found
  /// while writing what it had not read before.
  void expect_start(const std::string& bytes) const {
    for (const auto& entry : std::filesystem::directory_iterator(place_.directory()))
      std::filesystem::remove(entry.path());
    std::ofstream(file_, std::ios::binary) << bytes;
    for (int start = 0; start < 3; ++start) {
      auto journal = Journal::open(place_.connection(), kService);
      ASSERT_TRUE(journal.has_value()) << journal.error().describe();
      const bool is_new = std::filesystem::exists(file_.string() + ".damaged-1");
      EXPECT_THAT(outputs(*journal), SizeIs(is_new ? 0 : 2));
      Status written = journal->begin();
      if (written) written = journal->add_input(features(10 + start), UtcTime{}, false);
      if (written) written = journal->commit();
      EXPECT_TRUE(written || start == 0) << written.error().describe();
    }
    EXPECT_FALSE(std::filesystem::exists(file_.string() + ".damaged-2"));
  }
  std::filesystem::path file_;
  std::string whole_;
};

TEST_F(Header100, EveryTurnedBitLeavesAServiceThatStarts) {
  for (std::size_t byte = 0; byte < 100; ++byte)
    for (int bit = 0; bit < 8; ++bit) {
      SCOPED_TRACE(std::to_string(byte) + "." + std::to_string(bit));
      std::string bytes = whole_;
      bytes[byte] = static_cast<char>(bytes[byte] ^ (1 << bit));
      expect_start(bytes);
    }
}

/// Also where nothing reads it before an alarm, an act or a message that is set aside comes.
TEST_F(Header100, ALostPageOfASmallTableOrItsIndexIsNoticedAtTheStart) {
  std::vector<std::pair<std::string, int>> pages;
  {
    soci::session sql(place_.connection());
    soci::rowset<soci::row> rows =
        (sql.prepare << "SELECT name, rootpage FROM sqlite_master WHERE rootpage > 0 AND tbl_name NOT IN"
                        " ('inputs', 'outputs', 'packed_outputs')");
    for (const soci::row& row : rows) pages.emplace_back(row.get<std::string>(0), row.get<int>(1));
  }
  ASSERT_THAT(pages, SizeIs(::testing::Ge(6U)));
  for (const auto& [name, page] : pages) {
    SCOPED_TRACE(name);
    for (const auto& entry : std::filesystem::directory_iterator(place_.directory()))
      std::filesystem::remove(entry.path());
    std::string bytes = whole_;
    std::fill_n(bytes.begin() + (page - 1) * 1024, 1024, '\0');
    std::ofstream(file_, std::ios::binary) << bytes;
    Journal journal = open();
    EXPECT_TRUE(std::filesystem::exists(file_.string() + ".damaged-1"));
    ASSERT_THAT(journal.quarantine().value(), SizeIs(1));
    EXPECT_THAT(journal.quarantine().value().at(0).reason, HasSubstr("damaged"));
  }
}

TEST_F(Header100, NorDoesALostPageOrFileKeepItFromStarting) {
  std::string bytes = whole_;
  std::fill_n(bytes.begin(), 1024, '\0');
  expect_start(bytes);
  expect_start(std::string(whole_.size(), '\0'));
  bytes = whole_;
  bytes.replace(0, 16, "\x8d\x11\xfe\x03\x5a\xc7\x90\x2b\xee\x71\x04\xb8\x3f\xd2\x66\xa9");
  expect_start(bytes);
  bytes.replace(16, 84, 84, '\xa7');
  expect_start(bytes);
}

}  // namespace
}  // namespace sealwatch
