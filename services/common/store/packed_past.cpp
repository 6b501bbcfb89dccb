#include "services/common/store/packed_past.hpp"

#include <utility>

#include "services/common/message/base64.hpp"
#include "services/common/message/packed.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

/// Where an output stands, as it is packed before it.
struct PackedPlace {
  std::uint64_t sequence = 0;
  std::int64_t concluded_ns = 0;
  SEALWATCH_FIELDS(PackedPlace, sequence, concluded_ns)
};

struct Row {
  long long behind = 0;
  long long ends = 0;
  long long outputs = 0;
  std::string layout;
  std::string body;
  std::string checksum;

  [[nodiscard]] std::string expected(const std::string& asset_id) const {
    return row_checksum(
        {asset_id, std::to_string(behind), std::to_string(ends), std::to_string(outputs), layout, body});
  }
};

std::vector<Row> rows_of_asset(soci::session& sql, const std::string& asset_id) {
  std::vector<Row> rows;
  Row row;
  soci::statement statement =
      (sql.prepare << "SELECT behind, ends, outputs, layout, body, checksum FROM packed_outputs WHERE asset_id = :asset"
                      " ORDER BY ends",
       into(row.behind), into(row.ends), into(row.outputs), into(row.layout), into(row.body), into(row.checksum),
       use(asset_id, "asset"));
  statement.execute();
  while (statement.fetch()) rows.push_back(row);
  return rows;
}

std::string layout_of(const PackedOf& whose) { return content_hash(packed_layout() + " " + whose.version); }

std::string body_of(const std::vector<PastOutput>& outputs) {
  std::string bytes;
  Packer packer(bytes);
  PackedPlace last_place;
  LastOfTopics last;
  for (const PastOutput& output : outputs) {
    const PackedPlace place{output.place.sequence, output.place.concluded.nanoseconds};
    packer.pack(place, std::exchange(last_place, place));
    pack(output.message, last, bytes);
  }
  std::string body;
  append_base64(bytes, body);
  return body;
}

/// False where the body is none, of at most so many outputs.
bool take_body(const std::string& body, long long most, std::vector<PastOutput>& outputs) {
  std::string bytes;
  if (!from_base64(body, bytes)) return false;
  std::vector<std::size_t> last_index(std::variant_size_v<MessageAlternatives>);
  LastOfTopics last(last_index.size());
  PackedPlace place;
  for (Unpacker unpacker(bytes); !unpacker.is_at_end(); --most) {
    for (std::size_t topic = 0; topic < last.size(); ++topic)  // they move as the row grows
      last[topic] = last_index[topic] == 0 ? nullptr : &outputs[last_index[topic] - 1].message;
    auto message = most > 0 && unpacker.unpack(place) ? unpack(unpacker, last) : std::nullopt;
    if (!message) return false;
    outputs.push_back({std::move(*message), {place.sequence, UtcTime{place.concluded_ns}}});
    last_index[outputs.back().message.index()] = outputs.size();
  }
  return true;
}

long long outputs_until(soci::session& sql, const std::string& asset_id, long long ends) {
  long long outputs = 0;
  sql << "SELECT count(*) FROM outputs WHERE asset_id = :asset AND ordinal <= :ends", use(asset_id, "asset"),
      use(ends, "ends"), into(outputs);
  return outputs;
}

}  // namespace

PackedPast packed_past(soci::session& sql, const PackedOf& whose) {
  const std::string& asset_id = whose.asset_id;
  const std::string layout = layout_of(whose);
  PackedPast past;
  long long outputs = 0;
  for (const Row& row : rows_of_asset(sql, asset_id)) {
    const std::size_t before = past.outputs.size();
    if (row.checksum != row.expected(asset_id) || row.behind != past.ends)
      past.refused = "it is not as it was written";
    else if (row.layout != layout)
      past.refused = "another version made it";
    else if (!take_body(row.body, row.outputs, past.outputs))
      past.refused = "it cannot be read";
    if (!past.refused.empty()) {
      past.outputs.erase(past.outputs.begin() + static_cast<std::ptrdiff_t>(before), past.outputs.end());
      break;
    }
    past.ends = row.ends;
    outputs += row.outputs;
  }
  if (outputs == outputs_until(sql, asset_id, past.ends)) return past;
  return {.outputs = {}, .ends = 0, .refused = "other outputs are there than it was made of"};
}

void pack_more(soci::session& sql, const PackedOf& whose, long long behind, long long ends, long long outputs,
               const std::vector<PastOutput>& remembered) {
  const std::string& asset_id = whose.asset_id;
  const Row row{behind, ends, outputs, layout_of(whose), body_of(remembered), {}};
  const std::string checksum = row.expected(asset_id);
  sql << "DELETE FROM packed_outputs WHERE asset_id = :asset AND ends > :behind", use(asset_id, "asset"),
      use(behind, "behind");
  sql << "INSERT INTO packed_outputs(asset_id, behind, ends, outputs, layout, body, checksum) VALUES(:asset, :behind,"
         " :ends, :outputs, :layout, :body, :checksum)",
      use(asset_id, "asset"), use(row.behind, "behind"), use(row.ends, "ends"), use(row.outputs, "outputs"),
      use(row.layout, "layout"), use(row.body, "body"), use(checksum, "checksum");
}

void forget_packed(soci::session& sql, const std::string& asset_id) {
  sql << "DELETE FROM packed_outputs WHERE asset_id = :asset", use(asset_id, "asset");
}

void forget_all_packed(soci::session& sql) { sql << "DELETE FROM packed_outputs"; }

}  // namespace sealwatch
