// What people did, as a chain that shows tampering: table `acts` of each service's journal, one entry for each act that
// the service received, in the order of receipt.
//
//   hash_n = SHA-256(hash_{n-1}, n, when, kind, asset, who, subject, text, outcome),   hash_0 = SHA-256(service)
//
// each field with its length before it. Whoever changes, removes or reorders an entry must make anew all that follow;
// who cuts off the end leaves a chain that is whole, and shorter. Hence every service tells its last entry in its
// heartbeat, and the others keep what they heard in their own journals, table `anchors`: an entry that is in no record any
// more was cut off. The last hash stands in the log, too, and can be kept elsewhere (sealwatch audit).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"

namespace sealwatch {

struct OperatorAct {
  UtcTime at;        ///< when the service received it
  std::string kind;  ///< "acknowledgement", "seal_replaced", "test_retracted", "model_acceptance", ...
  std::string asset_id;
  std::string who;
  std::string subject;  ///< message id of the act, or of what was tried again
  std::string text;     ///< the remark
  std::string outcome;  ///< "taken", or why not
};

struct AuditEntry {
  std::int64_t sequence = 0;  ///< 1, 2, 3, ...
  OperatorAct act;
  std::string previous;  ///< hash of the entry before, in hexadecimal
  std::string hash;
};

/// Where and how a chain breaks.
struct AuditBreak {
  std::int64_t sequence = 0;  ///< the first entry that is not as it was written, or is missing
  std::string why;
};

/// An entry of another service's record, as that one told it.
struct AuditAnchor {
  std::string service;
  std::int64_t sequence = 0;
  std::string hash;
  friend bool operator==(const AuditAnchor&, const AuditAnchor&) = default;
};

/// In a heartbeat: StreamPosition of this topic, with the last entry's hash in the place of the writer.
inline constexpr const char* kActsTopic = "acts";

/// The hash before the first entry.
[[nodiscard]] std::string audit_begin(const std::string& service);
[[nodiscard]] std::string audit_hash(const AuditEntry& entry);
/// Nothing where the chain is whole.
[[nodiscard]] std::optional<AuditBreak> find_break(const std::string& service, const std::vector<AuditEntry>& entries);

/// The first entry that others have heard of and that is not, or no longer, in the record; nothing where all are.
[[nodiscard]] std::optional<AuditBreak> find_cut(const std::string& service, const std::vector<AuditEntry>& entries,
                                                 const std::vector<AuditAnchor>& heard);

struct AuditAnchors {
  std::vector<AuditAnchor> heard;
  bool are_whole = true;  ///< as they were kept
};
/// What a service's journal, which may run, says of others' records.
[[nodiscard]] Result<AuditAnchors> read_audit_anchors(const std::string& connection, const std::string& service);
/// The chain in a service's journal, which may run; it is not changed.
[[nodiscard]] Result<std::vector<AuditEntry>> read_audit_trail(const std::string& connection,
                                                               const std::string& service);

}  // namespace sealwatch
