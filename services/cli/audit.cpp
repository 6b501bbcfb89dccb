// `sealwatch audit`: the record of what people did, and whether it is whole.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "sealwatch/core/visible_text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/runtime/operator_acts.hpp"
#include "services/common/store/audit_trail.hpp"

namespace sealwatch::cli {
namespace {

struct Trail {
  std::string service;
  std::vector<AuditEntry> entries;
  std::optional<AuditBreak> broken;
  bool has_anchors = true;  ///< of the others' records, all that it kept
};

/// None where a journal cannot be looked into, or there is none.
std::optional<std::vector<Trail>> read_trails(const AuditOptions& options) {
  const auto connections = journals_at_hand(options.state_directory, options.config);
  if (!connections) return std::nullopt;
  std::vector<AuditAnchor> heard;
  std::set<std::string> without_anchors;
  for (const auto& [service, connection] : *connections) {
    const auto anchors = read_audit_anchors(connection, service);
    if (!anchors || !anchors->are_whole) without_anchors.insert(service);
    if (anchors) heard.insert(heard.end(), anchors->heard.begin(), anchors->heard.end());
  }
  std::vector<Trail> trails;
  for (const auto& [service, connection] : *connections) {
    auto entries = read_audit_trail(connection, service);
    if (!entries) {
      complain(entries.error());
      return std::nullopt;
    }
    auto broken = find_break(service, *entries);
    if (!broken) broken = find_cut(service, *entries, heard);
    trails.push_back({service, std::move(*entries), std::move(broken), !without_anchors.contains(service)});
  }
  return trails;
}

bool is_asked_for(const AuditEntry& entry, const AuditOptions& options) {
  return options.asset_id.empty() || entry.act.asset_id == options.asset_id;
}

/// Nothing for nearly all, which were taken as they were said.
std::string became_of(const std::string& outcome) {
  if (outcome == kTaken) return {};
  return is_taken(outcome) || outcome.starts_with("waits ") ? outcome : "refused: " + outcome;
}

void print(const Trail& trail, const AuditOptions& options) {
  for (const AuditEntry& entry : trail.entries) {
    if (!is_asked_for(entry, options)) continue;
    const OperatorAct& act = entry.act;
    std::string line = to_the_second(act.at) + "  " + trail.service + " " + std::to_string(entry.sequence) + "  " +
                       act.kind + "  " + act.asset_id + "  by " + act.who + "  " + act.subject;
    if (!act.text.empty()) line += "  (" + act.text + ")";
    if (const std::string became = became_of(act.outcome); !became.empty()) line += "  " + became;
    std::printf("%s\n", visible(line).c_str());
  }
  const std::string count = std::to_string(trail.entries.size()) + (trail.entries.size() == 1 ? " act" : " acts");
  if (trail.broken)
    std::printf("%s: BROKEN at entry %lld of %s: %s\n", trail.service.c_str(),
                static_cast<long long>(trail.broken->sequence), count.c_str(), trail.broken->why.c_str());
  else
    std::printf("%s: %s, as they were written%s\n", trail.service.c_str(), count.c_str(),
                trail.entries.empty() ? "" : ("; last hash " + trail.entries.back().hash).c_str());
  if (!trail.has_anchors)
    std::printf("%s: BROKEN: what it kept of the other services' last hashes was changed or removed\n",
                trail.service.c_str());
}

nlohmann::ordered_json as_json(const Trail& trail, const AuditOptions& options) {
  nlohmann::ordered_json acts = nlohmann::ordered_json::array();
  for (const AuditEntry& entry : trail.entries)
    if (is_asked_for(entry, options))
      acts.push_back({{"entry", entry.sequence},
                      {"at", format_utc(entry.act.at)},
                      {"kind", entry.act.kind},
                      {"asset_id", entry.act.asset_id},
                      {"who", entry.act.who},
                      {"subject", entry.act.subject},
                      {"text", entry.act.text},
                      {"outcome", entry.act.outcome},
                      {"hash", entry.hash}});
  nlohmann::ordered_json result = {{"service", trail.service},
                                   {"whole", !trail.broken && trail.has_anchors},
                                   {"last_hash", trail.entries.empty() ? "" : trail.entries.back().hash}};
  if (trail.broken) result["broken"] = {{"entry", trail.broken->sequence}, {"why", trail.broken->why}};
  result["acts"] = std::move(acts);
  return result;
}

bool has_hash(const std::vector<Trail>& trails, const std::string& hash) {
  return std::ranges::any_of(trails, [&](const Trail& trail) {
    return std::ranges::find(trail.entries, hash, &AuditEntry::hash) != trail.entries.end();
  });
}

}  // namespace

int run_audit(const AuditOptions& options) {
  const auto trails = read_trails(options);
  if (!trails) return kBadInput;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Trail& trail : *trails) options.json ? list.push_back(as_json(trail, options)) : print(trail, options);
  const bool cut = !options.contains.empty() && !has_hash(*trails, options.contains);
  if (options.json)
    std::printf("%s\n", nlohmann::ordered_json{{"schema", "sealwatch.audit/1"}, {"services", list}}.dump(1).c_str());
  if (cut)
    complain(Error{.file = {},
                   .place = "--contains",
                   .value = options.contains,
                   .rule = "is no longer in the trail: its end was cut off",
                   .advice = "compare with a backup, and with 'act recorded' in the services' logs"});
  const bool whole =
      std::ranges::none_of(*trails, [](const Trail& trail) { return trail.broken.has_value() || !trail.has_anchors; });
  return whole && !cut ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli
