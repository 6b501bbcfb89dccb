// Looking for damage little by little, while the service runs: rows that are not as they were written, and indexes that
// leave rows out. An index has no checksum, and what it does not find nobody misses: an open input would never be
// concluded from, an output would be concluded twice. Server databases look after their indexes themselves.
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

namespace {

/// Outputs that are looked at at once: some of them hold samples.
constexpr int kFew = 4;
/// Rows whose places in the indexes are looked at at once.
constexpr int kSome = 64;

/// The last of the next rows, and the first of them that an index does not find where the row says it is.
struct Indexed {
  std::optional<long long> last;
  std::optional<long long> missing;
  long long rows = 0;
};

Indexed look_up(soci::session& sql, const std::string& number, const std::string& found, const std::string& rows,
                long long after) {
  Indexed indexed;
  long long last = 0, missing = 0;
  soci::indicator has_last = soci::i_null, has_missing = soci::i_null;
  sql << "SELECT count(*), max(" + number + "), min(CASE WHEN " + found + " THEN NULL ELSE " + number + " END) FROM (" +
             rows + " NOT INDEXED WHERE " + number + " > :after ORDER BY " + number + " LIMIT " +
             std::to_string(kSome) + ") AS one",
      use(after, "after"), into(indexed.rows), into(last, has_last), into(missing, has_missing);
  if (has_last == soci::i_ok) indexed.last = last;
  if (has_missing == soci::i_ok) indexed.missing = missing;
  return indexed;
}

Indexed look_up_outputs(soci::session& sql, long long after) {
  return look_up(sql, "ordinal",
                 "EXISTS(SELECT 1 FROM outputs INDEXED BY outputs_of_asset WHERE asset_id = one.asset_id"
                 " AND ordinal = one.ordinal AND pst_id = one.pst_id AND topic = one.topic)"
                 " AND EXISTS(SELECT 1 FROM outputs WHERE message_id = one.message_id AND +ordinal = one.ordinal)"
                 " AND EXISTS(SELECT 1 FROM outputs WHERE topic = one.topic AND sequence = one.sequence"
                 " AND +ordinal = one.ordinal)"
                 " AND (coalesce(one.checksum, '') <> 'damaged' OR EXISTS(SELECT 1 FROM outputs INDEXED BY"
                 " outputs_damaged WHERE checksum = 'damaged' AND asset_id = one.asset_id AND pst_id = one.pst_id"
                 " AND ordinal = one.ordinal))",
                 "SELECT ordinal, topic, sequence, message_id, asset_id, pst_id, checksum FROM outputs", after);
}

Indexed look_up_inputs(soci::session& sql, long long after) {
  return look_up(sql, "receipt",
                 "EXISTS(SELECT 1 FROM inputs WHERE message_id = one.message_id AND +receipt = one.receipt)"
                 " AND (one.consumed <> 0 OR EXISTS(SELECT 1 FROM inputs INDEXED BY inputs_open WHERE consumed = 0"
                 " AND asset_id = one.asset_id AND receipt = one.receipt))"
                 " AND (one.sequence <> 0 OR EXISTS(SELECT 1 FROM inputs INDEXED BY inputs_of_no_stream"
                 " WHERE sequence = 0 AND topic = one.topic AND asset_id = one.asset_id AND receipt = one.receipt))"
                 " AND (NOT one.kept OR EXISTS(SELECT 1 FROM inputs INDEXED BY inputs_kept WHERE (payload IS NOT NULL"
                 " OR consumed <> 1) AND receipt = one.receipt))",
                 "SELECT receipt, message_id, topic, asset_id, consumed, sequence, payload IS NOT NULL OR consumed <> 1"
                 " AS kept FROM inputs",
                 after);
}

}  // namespace

Result<bool> Journal::check_some() {
  return database_->guard("looking for damage", [&] {
    const std::string query = std::string(kOutput) + "ordinal > :after ORDER BY ordinal LIMIT " + std::to_string(kFew);
    const std::vector<MessageRow> rows = rows_of(database_->sql, query, database_->checked);
    for (const MessageRow& row : rows) {
      database_->check(row);
      database_->checked = row.order;
    }
    const bool more_indexed = database_->check_indexes();
    return !rows.empty() || more_indexed;
  });
}

bool Journal::Database::check_indexes() {
  if (!is_file()) return false;
  const Indexed outputs = look_up_outputs(sql, outputs_looked_up);
  if (outputs.missing) must_be_mended(*outputs.missing, "an index does not find it");
  if (outputs.last && *outputs.last - outputs_looked_up != outputs.rows)
    must_be_mended(*outputs.last, "one before it is missing");
  outputs_looked_up = outputs.last.value_or(outputs_looked_up);
  const Indexed inputs = look_up_inputs(sql, inputs_looked_up);
  if (inputs.missing) must_be_mended(*inputs.missing, "an index of inputs does not find it");
  inputs_looked_up = inputs.last.value_or(inputs_looked_up);
  return outputs.last || inputs.last;
}

void Journal::Database::check(const MessageRow& output) {
  if (!is_as_written(output)) must_be_mended(output.order, output.message_id);
}

void Journal::Database::must_be_mended(long long ordinal, const std::string& whose) {
  set_meta(kToBeMended, "1");
  throw Error{.file = name,
              .place = "output " + std::to_string(ordinal),
              .value = whose,
              .rule = "is not as it was written: a disk or a memory turned a bit",
              .advice = "the service starts again, and makes it anew from the neighbours' messages"};
}

}  // namespace sealwatch
