// What is set aside (journal.hpp): inputs in state set_aside, and why, in table quarantine.
#include "services/common/message/json.hpp"
#include "services/common/store/audit_rows.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

/// As the index of what is kept has it: the ids of twenty years are not looked through.
std::string kept_as(InputState state) {
  return " WHERE (payload IS NOT NULL OR consumed <> 1) AND consumed = " + std::to_string(static_cast<int>(state));
}

/// The inputs that go with a message: all of its test, or itself alone.
constexpr const char* kGoesWith = " AND (message_id = :id OR (pst_id = :pst AND pst_id <> '' AND asset_id = :asset))";

/// Moves them from one state to another and says how many there were.
long long move(soci::session& sql, const SetAside& message, InputState from, InputState to) {
  const std::string query =
      "UPDATE inputs SET consumed = " + std::to_string(static_cast<int>(to)) + kept_as(from) + kGoesWith;
  soci::statement statement =
      (sql.prepare << query, use(message.message_id, "id"), use(message.pst_id, "pst"), use(message.asset_id, "asset"));
  statement.execute(true);
  return statement.get_affected_rows();
}

}  // namespace

Result<std::vector<std::string>> Journal::open_inputs_of(const std::string& asset_id) {
  return database_->guard("looking for open inputs", [&] {
    std::vector<std::string> ids;
    std::string id;
    soci::statement statement = (database_->sql.prepare << "SELECT message_id FROM inputs WHERE consumed = 0 AND"
                                                           " asset_id = :asset ORDER BY receipt",
                                 use(asset_id, "asset"), into(id));
    statement.execute();
    while (statement.fetch()) ids.push_back(id);
    return ids;
  });
}

Result<std::optional<Message>> Journal::input(const std::string& message_id) {
  return database_->guard("reading an input", [&]() -> std::optional<Message> {
    std::string topic;
    std::string payload;
    soci::indicator there = soci::i_null;
    database_->sql << "SELECT topic, payload FROM inputs WHERE message_id = :id", use(message_id, "id"), into(topic),
        into(payload, there);
    if (!database_->sql.got_data() || there != soci::i_ok) return std::nullopt;
    const auto known = value_of<Topic>(topic);
    Result<Message> message = known ? message_from_json(*known, payload) : fail("message of an unknown topic");
    if (message) return std::move(*message);
    Error error = message.error();
    error.file = database_->name;
    throw error;
  });
}

Result<std::uint64_t> Journal::open_inputs_of_tests(const std::set<Test>& tests) {
  return database_->guard("counting open inputs", [&] {
    std::uint64_t found = 0;
    Test test;
    soci::statement statement =
        (database_->sql.prepare << "SELECT asset_id, pst_id FROM inputs WHERE consumed = 0 ORDER BY receipt",
         into(test.first), into(test.second));
    statement.execute();
    while (statement.fetch()) found += tests.contains(test) ? 1 : 0;
    return found;
  });
}

Result<std::vector<SetAside>> Journal::quarantine() {
  return database_->guard("reading the quarantine", [&] {
    std::vector<SetAside> found;
    SetAside row;
    long long since = 0;
    soci::statement statement =
        (database_->sql.prepare << "SELECT message_id, topic, asset_id, pst_id, since, reason FROM quarantine"
                                   " WHERE state <> 'released' ORDER BY since, message_id",
         into(row.message_id), into(row.topic), into(row.asset_id), into(row.pst_id), into(since), into(row.reason));
    statement.execute();
    while (statement.fetch()) {
      row.since_ns = since;
      found.push_back(row);
    }
    return found;
  });
}

Status Journal::set_aside(const SetAside& message) {
  return database_->guard("setting a message aside", [&] {
    const long long since = message.since_ns;
    const std::string checksum = row_checksum(
        {message.message_id, message.topic, message.asset_id, message.pst_id, std::to_string(since), message.reason});
    database_->sql << "INSERT INTO quarantine(message_id, topic, asset_id, pst_id, since, reason, state, asked_by,"
                      " asked, checksum) VALUES(:id, :topic, :asset, :pst, :since, :reason, 'set_aside', '', 0,"
                      " :checksum) ON CONFLICT(message_id) DO UPDATE SET topic = excluded.topic,"
                      " asset_id = excluded.asset_id, pst_id = excluded.pst_id, since = excluded.since,"
                      " reason = excluded.reason, state = 'set_aside', checksum = excluded.checksum",
        use(message.message_id, "id"), use(message.topic, "topic"), use(message.asset_id, "asset"),
        use(message.pst_id, "pst"), use(since, "since"), use(message.reason, "reason"), use(checksum, "checksum");
    const long long moved = move(database_->sql, message, InputState::open, InputState::set_aside);
    database_->open_inputs -= static_cast<std::uint64_t>(moved);
    ++database_->batch_rows;
  });
}

Status Journal::release(const SetAside& message) {
  return database_->guard("trying a message again", [&] {
    database_->sql << "UPDATE quarantine SET state = 'released' WHERE message_id = :id", use(message.message_id, "id");
    const long long moved = move(database_->sql, message, InputState::set_aside, InputState::open);
    database_->open_inputs += static_cast<std::uint64_t>(moved);
    ++database_->batch_rows;
  });
}

Result<std::vector<Journal::Awaiting>> Journal::awaiting() {
  auto rows = database_->guard("looking for acts that wait", [&] {
    std::vector<std::pair<std::string, long long>> found;
    std::string id;
    long long received = 0;
    soci::statement statement = (database_->sql.prepare << "SELECT message_id, received FROM inputs" +
                                                               kept_as(InputState::awaiting) + " ORDER BY receipt",
                                 into(id), into(received));
    statement.execute();
    while (statement.fetch()) found.emplace_back(id, received);
    return found;
  });
  if (!rows) return fail(rows.error());
  std::vector<Awaiting> waiting;
  for (const auto& [id, received] : *rows) {
    auto message = input(id);
    if (!message) return fail(message.error());
    if (*message) waiting.push_back({std::move(**message), UtcTime{received}});
  }
  return waiting;
}

Result<std::vector<Journal::Ahead>> Journal::acts_ahead() {
  return database_->guard("looking for acts that are ahead", [&] {
    std::vector<Ahead> found;
    Ahead one;
    long long received = 0;
    soci::statement statement = (database_->sql.prepare << "SELECT message_id, asset_id, received FROM inputs" +
                                                               kept_as(InputState::ahead) + " ORDER BY receipt",
                                 into(one.message_id), into(one.asset_id), into(received));
    statement.execute();
    while (statement.fetch()) {
      one.received = {received};
      found.push_back(one);
    }
    return found;
  });
}

Result<std::vector<std::string>> Journal::acts_ahead(const std::string& asset_id) {
  return database_->guard("looking for acts that are ahead", [&] {
    std::vector<std::string> ids;
    std::string id;
    soci::statement statement =
        (database_->sql.prepare << "SELECT message_id FROM inputs" + kept_as(InputState::ahead) +
                                       " AND asset_id = :asset ORDER BY receipt",
         use(asset_id, "asset"), into(id));
    statement.execute();
    while (statement.fetch()) ids.push_back(id);
    return ids;
  });
}

Status Journal::end_awaiting(const std::string& message_id, InputState state) {
  return database_->guard("ending an act's wait", [&] {
    const bool opened = state == InputState::open;
    const std::string change = opened ? "consumed = 0" : "consumed = 1, payload = NULL, checksum = NULL";
    soci::statement statement =
        (database_->sql.prepare << "UPDATE inputs SET " + change + " WHERE consumed IN (3, 4) AND message_id = :id",
         use(message_id, "id"));
    statement.execute(true);
    if (opened) database_->open_inputs += static_cast<std::uint64_t>(statement.get_affected_rows());
    ++database_->batch_rows;
  });
}

Status Journal::forget_awaiting(const std::string& message_id) {
  return database_->guard("forgetting an act that waited", [&] {
    database_->sql << "DELETE FROM inputs WHERE consumed IN (3, 4) AND message_id = :id", use(message_id, "id");
    ++database_->batch_rows;
  });
}

Result<std::vector<AuditEntry>> Journal::acts() {
  return database_->guard("reading what people did", [&] { return acts_in(database_->sql); });
}

Result<AuditAnchor> Journal::last_act() {
  return database_->guard("reading the last act", [&] {
    AuditAnchor last{.service = database_->service, .sequence = 0, .hash = {}};
    long long sequence = 0;
    database_->sql << "SELECT sequence, hash FROM acts WHERE sequence = (SELECT max(sequence) FROM acts)",
        into(sequence), into(last.hash);
    if (database_->sql.got_data()) last.sequence = sequence;
    return last;
  });
}

Result<bool> Journal::is_new() {
  return database_->guard("looking whether the journal is new", [&] { return !database_->meta(kNewJournal).empty(); });
}

Status Journal::no_longer_new() {
  return database_->guard("noting that the journal was compared", [&] {
    database_->sql << std::string("DELETE FROM meta WHERE name = '") + kNewJournal + "'";
    ++database_->batch_rows;
  });
}

Status Journal::keep_anchor(const AuditAnchor& heard) {
  return database_->guard("keeping what was heard of acts", [&] {
    if (add_anchor(database_->sql, heard))
      database_->set_meta(kAnchorsSum, with_anchor(database_->meta(kAnchorsSum), heard));
    ++database_->batch_rows;
  });
}

Result<std::vector<AuditAnchor>> Journal::anchors() {
  return database_->guard("reading what was heard of acts", [&] { return anchors_in(database_->sql); });
}

Result<AuditEntry> Journal::record(const OperatorAct& act) {
  return database_->guard("recording an act", [&] {
    ++database_->batch_rows;
    return append_act(database_->sql, database_->service, act);
  });
}

Result<std::vector<std::string>> Journal::asked_again() {
  return database_->guard("reading the quarantine", [&] {
    std::vector<std::string> ids;
    std::string id;
    soci::statement statement =
        (database_->sql.prepare << "SELECT message_id FROM quarantine WHERE state = 'retry' ORDER BY message_id",
         into(id));
    statement.execute();
    while (statement.fetch()) ids.push_back(id);
    return ids;
  });
}

}  // namespace sealwatch
