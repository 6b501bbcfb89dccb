// Tables `acts` and `anchors` (audit_trail.hpp) in a database that is open, for those who write to it.
#pragma once

#include <soci/soci.h>

#include "services/common/store/audit_trail.hpp"

namespace sealwatch {

/// Makes the table where there is none. SQLite then refuses to change or remove a row.
void make_acts_table(soci::session& sql);
/// All entries, in order. Throws what SOCI throws.
[[nodiscard]] std::vector<AuditEntry> acts_in(soci::session& sql);
/// All anchors, service by service, in order. Throws what SOCI throws.
[[nodiscard]] std::vector<AuditAnchor> anchors_in(soci::session& sql);
/// Whether it was not there yet. Throws what SOCI throws.
bool add_anchor(soci::session& sql, const AuditAnchor& heard);
/// What table meta keeps of them: "NUMBER SUM", the sum that of checksum_of_anchor.
[[nodiscard]] std::string sum_of(const std::vector<AuditAnchor>& anchors);
[[nodiscard]] std::string with_anchor(const std::string& sum, const AuditAnchor& added);
/// Between begin and commit. Returns the entry. Throws what SOCI throws.
AuditEntry append_act(soci::session& sql, const std::string& service, const OperatorAct& act);

}  // namespace sealwatch
