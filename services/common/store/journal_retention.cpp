// What a journal drops when it has kept it for long enough: samples alone. The row stays, with its id, its number and all
// that the message says but its samples.
#include "services/common/message/json.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

namespace {

/// Outputs that are looked at at once: after twenty years hardly any of them has its samples.
constexpr int kSomeSamples = 256;

}  // namespace

Result<double> Journal::used_bytes() {
  return database_->guard("looking at its size", [&] {
    soci::session& sql = database_->sql;
    double bytes = 0.0;
    if (!database_->is_file()) {
      sql << "SELECT coalesce(sum(pg_column_size(payload)), 0) FROM outputs", into(bytes);
      return bytes;
    }
    long long pages = 0;
    long long unused = 0;
    long long size = 0;
    sql << "PRAGMA page_count", into(pages);
    sql << "PRAGMA freelist_count", into(unused);
    sql << "PRAGMA page_size", into(size);
    return static_cast<double>((pages - unused) * size);
  });
}

Result<std::uint64_t> Journal::dropped_samples(Topic topic, std::uint64_t after) {
  return database_->guard("passing over dropped samples", [&] {
    const std::string name(name_of(topic));
    auto last = static_cast<long long>(after);
    long long sequence = 0;
    std::string checksum;
    soci::indicator there = soci::i_null;
    soci::statement statement = (database_->sql.prepare << "SELECT sequence, checksum FROM outputs WHERE topic = :topic"
                                                           " AND sequence > :after ORDER BY sequence LIMIT " +
                                                               std::to_string(kSomeSamples),
                                 into(sequence), into(checksum, there), use(name, "topic"), use(last, "after"));
    statement.execute();
    bool is_dropped = true;
    while (statement.fetch()) {
      is_dropped = is_dropped && there == soci::i_ok && (checksum == kExpiredRow || checksum == kDamaged);
      if (is_dropped) last = sequence;
    }
    return static_cast<std::uint64_t>(last);
  });
}

Result<std::vector<Journal::Kept>> Journal::kept_samples(Topic topic, std::uint64_t after, std::size_t most) {
  return database_->guard("looking for old samples", [&] {
    const std::string name(name_of(topic));
    const auto begin = static_cast<long long>(after);
    const auto limit = static_cast<int>(most);
    std::vector<Kept> found;
    Kept row;
    long long sequence = 0;
    long long published = 0;
    soci::statement statement =
        (database_->sql.prepare << "SELECT sequence, asset_id, pst_id, published FROM (SELECT * FROM outputs WHERE"
                                   " topic = :topic AND sequence > :after ORDER BY sequence LIMIT " +
                                       std::to_string(kSomeSamples) +
                                       ") AS following WHERE coalesce(checksum, '') NOT IN ('expired', 'damaged')"
                                       " ORDER BY sequence LIMIT :most",
         into(sequence), into(row.asset_id), into(row.pst_id), into(published), use(name, "topic"), use(begin, "after"),
         use(limit, "most"));
    statement.execute();
    while (statement.fetch()) {
      row.sequence = static_cast<std::uint64_t>(sequence);
      row.concluded = {published};
      found.push_back(row);
    }
    return found;
  });
}

Status Journal::expire(Topic topic, std::uint64_t sequence) {
  return database_->guard("dropping old samples", [&] {
    const std::string name(name_of(topic));
    const auto number = static_cast<long long>(sequence);
    std::string payload;
    database_->sql << "SELECT payload FROM outputs WHERE topic = :topic AND sequence = :sequence", use(name, "topic"),
        use(number, "sequence"), into(payload);
    Result<Message> message = message_from_json(topic, payload);
    if (!message) throw message.error();
    payload = to_json(without_samples(std::move(*message)), JsonForm::exact);
    const std::string checksum = kExpiredRow;
    database_->sql << "UPDATE outputs SET payload = :payload, checksum = :checksum WHERE topic = :topic AND"
                      " sequence = :sequence",
        use(payload, "payload"), use(checksum, "checksum"), use(name, "topic"), use(number, "sequence");
    ++database_->batch_rows;
  });
}

}  // namespace sealwatch
