// The journal of many assets and years, made of that of some monthly tests of one asset: its rows with other names and
// dates, and with the checksums that the product gives them. Samples older than the last month are dropped, as retention
// does.
//   long_history ONE.db MANY.db ASSET ASSETS TURNS    the assets are A0000, A0001 ..., each with all the tests in each
//                                                     turn; the last test was yesterday
#include <soci/soci.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/blank.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/common/message/json.hpp"
#include "services/common/store/row_checksum.hpp"
#include "services/common/store/rows.hpp"
#include "services/common/store/statements.hpp"
#include "services/common/text/format.hpp"

namespace {

using namespace sealwatch;
using soci::into;
using soci::use;

constexpr long long kDay_ns = 86'400LL * 1'000'000'000;
constexpr long long kMonth_ns = 2'629'746LL * 1'000'000'000;

struct InputRow {
  std::string topic, writer_id, message_id, pst_id;
};

struct Test {
  std::vector<MessageRow> outputs;
  std::vector<InputRow> inputs;
};

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

long long now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Message at_another_time(Message message, long long by_ns, bool keeps_samples) {
  Header& header = header_of(message);
  header.event_time_ns += by_ns;
  header.replay = false;
  auto* const block = std::get_if<SampleBlock>(&message);
  auto* const window = std::get_if<TestWindow>(&message);
  if (keeps_samples || (block == nullptr && window == nullptr)) return message;
  if (block != nullptr) block->samples = {};
  if (window != nullptr) window->samples = {};
  header.producer.insert(0, kExpired);
  return message;
}

/// The tests of a journal in the order in which they were concluded.
std::vector<Test> tests_in(const std::string& journal) {
  soci::session sql("sqlite3", journal);
  std::vector<Test> tests;
  std::map<std::string, std::size_t> of_test;
  for (const MessageRow& row : rows_of(sql, std::string(kOutput) + "ordinal > :after ORDER BY ordinal", 0)) {
    if (row.pst_id.empty()) continue;
    if (of_test.try_emplace(row.pst_id, tests.size()).second) tests.emplace_back();
    tests[of_test.at(row.pst_id)].outputs.push_back(row);
  }
  if (tests.empty()) throw std::runtime_error("no tests are in " + journal);
  InputRow row;
  soci::statement statement =
      (sql.prepare << "SELECT topic, writer_id, message_id, pst_id FROM inputs WHERE sequence > 0 AND"
                      " (pst_id <> '' OR topic = 'raw_samples') ORDER BY receipt",
       into(row.topic), into(row.writer_id), into(row.message_id), into(row.pst_id));
  statement.execute();
  std::vector<InputRow> of_none;
  while (statement.fetch()) {
    const auto test = of_test.find(row.pst_id);
    (test == of_test.end() ? of_none : tests[test->second].inputs).push_back(row);
  }
  for (std::size_t k = 0; k < of_none.size(); ++k)
    tests[k * tests.size() / of_none.size()].inputs.push_back(of_none[k]);
  return tests;
}

/// The ids of messages and tests as another asset has them in another turn: no two tests have the same.
struct Names {
  std::string from, to;
  int turn = 0;

  [[nodiscard]] std::string operator()(const std::string& text) const {
    const std::string of_turn = std::to_string(turn) + "-2";
    const std::string tests = replaced(text, from + "-2", to + "-" + of_turn);
    return replaced(replaced(tests, from + "/2", to + "/" + of_turn), from, to);
  }
};

class LongJournal {
 public:
  LongJournal(const std::string& one, const std::string& file) {
    soci::session("sqlite3", one) << "VACUUM INTO '" + file + "'";  // with what is in its log
    sql_.open("sqlite3", file);
    std::string answer;
    sql_ << "PRAGMA journal_mode = OFF", into(answer);
    for (const char* setting : {"synchronous = OFF", "cache_size = -400000"}) sql_ << std::string("PRAGMA ") + setting;
    sql_ << "BEGIN";
    for (const char* table : {"outputs", "inputs", "positions", "alarms", "packed_outputs"})
      sql_ << std::string("DELETE FROM ") + table;
    statements_.emplace(sql_);
  }

  void add(const InputRow& row, const Names& named) {
    Message message = blank_message(value_of<Topic>(row.topic).value());
    header_of(message).message_id = named(row.message_id);
    header_of(message).pst_id = named(row.pst_id);
    std::visit([&](auto& content) { content.asset_id = named.to; }, message);
    const StreamPosition stream{row.topic, row.writer_id, ++received_[{row.topic, row.writer_id}]};
    statements_->add_input(++receipt_, message, stream, UtcTime{now_ns()}, InputState::consumed);
  }

  void add(Topic topic, const std::string& payload, const Names& named) {
    const auto message = message_from_json(topic, named(payload));
    if (!message) throw std::runtime_error(message.error().describe());
    (void)statements_->add_output(++ordinal_, *message, ++written_[topic], UtcTime{now_ns()});
  }

  void commit() {
    for (const auto& [stream, sequence] : received_) statements_->set_position({stream.first, stream.second, sequence});
    sql_ << "UPDATE outputs SET checksum = 'expired' WHERE topic IN ('sample_block', 'test_window') AND payload LIKE"
            " '%\"producer\":\"expired: %'";
    sql_ << "COMMIT";
    statements_.reset();
    std::string answer;
    sql_ << "PRAGMA journal_mode = WAL", into(answer);
    std::printf("%lld %lld\n", ordinal_, receipt_);
  }

 private:
  soci::session sql_;
  std::optional<JournalStatements> statements_;
  long long receipt_ = 0, ordinal_ = 0;
  std::map<Topic, std::uint64_t> written_;
  std::map<std::pair<std::string, std::string>, std::uint64_t> received_;
};

/// In the order of time: the tests of a month of all assets beside each other.
void multiply(const std::vector<Test>& tests, const std::string& asset, int assets, int turns, LongJournal& journal) {
  const Message last = message_of(tests.back().outputs.front(), "the journal of one asset");
  const long long to_yesterday_ns = now_ns() - kDay_ns - header_of(last).event_time_ns;
  for (int turn = 0; turn < turns; ++turn) {
    const long long later_ns = (turns - 1 - turn) * static_cast<long long>(tests.size()) * kMonth_ns;
    const long long by_ns = to_yesterday_ns - later_ns;
    for (const Test& test : tests) {
      const bool is_last = turn + 1 == turns && &test == &tests.back();
      std::vector<std::pair<Topic, std::string>> outputs;
      for (const MessageRow& row : test.outputs) {
        const Message moved = at_another_time(message_of(row, "the journal of one asset"), by_ns, is_last);
        outputs.emplace_back(topic_of(moved), to_json(moved, JsonForm::exact));
      }
      for (int number = 0; number < assets; ++number) {
        const Names named{asset, text::format("A{:04}", number), turn};
        for (const InputRow& row : test.inputs) journal.add(row, named);
        for (const auto& [topic, payload] : outputs) journal.add(topic, payload, named);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) throw std::runtime_error("usage: long_history ONE.db MANY.db ASSET ASSETS TURNS");
  const std::vector<Test> tests = tests_in(argv[1]);
  LongJournal journal(argv[1], argv[2]);
  multiply(tests, argv[3], std::atoi(argv[4]), std::atoi(argv[5]), journal);
  journal.commit();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
