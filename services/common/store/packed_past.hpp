// An asset's past once more, in few bytes (message/packed.hpp): a start need not read the JSON of years. It stands in the
// journal beside what it was made of, so that a backup has both, and a kill leaves both as they were.
//
// Table packed_outputs has rows of an asset, each about the outputs behind the last row's. A row counts where its
// checksum holds, where the same version made it, and where the rows before it count; and all of them
// only while as many outputs are in the journal as they were made of. What does not count is made again. Whoever changes
// an output that is packed forgets what was packed of its asset.
#pragma once

#include <soci/soci.h>

#include <string>
#include <vector>

#include "services/common/store/journal.hpp"

namespace sealwatch {

inline constexpr const char* kPackedOutputs =
    "CREATE TABLE IF NOT EXISTS packed_outputs(asset_id VARCHAR(512) NOT NULL, behind BIGINT NOT NULL,"
    " ends BIGINT NOT NULL, outputs BIGINT NOT NULL, layout VARCHAR(16) NOT NULL, body TEXT NOT NULL,"
    " checksum VARCHAR(16) NOT NULL, PRIMARY KEY(asset_id, ends))";

/// What is remembered of an output.
struct PastOutput {
  Message message;
  Journal::Place place;
};

struct PackedPast {
  std::vector<PastOutput> outputs;  ///< in the order of conclusion
  long long ends = 0;               ///< ordinal of the last output that it was made of; 0: none
  std::string refused;              ///< why there is not more, where something is there that does not count; ""
};

struct PackedOf {
  const std::string& asset_id;
  const std::string& version;  ///< of the program: another may lay out messages, or leave some out, otherwise
};

[[nodiscard]] PackedPast packed_past(soci::session& sql, const PackedOf& whose);

/// Packs what is remembered of the next so many outputs, in place of what does not count.
void pack_more(soci::session& sql, const PackedOf& whose, long long behind, long long ends, long long outputs,
               const std::vector<PastOutput>& remembered);

void forget_packed(soci::session& sql, const std::string& asset_id);
void forget_all_packed(soci::session& sql);

}  // namespace sealwatch
