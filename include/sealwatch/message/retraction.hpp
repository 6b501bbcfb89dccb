// Retraction: an operator says that a test, or everything since a date, must not count (a wrong asset, a wrong clock, a
// sensor that was found broken). It travels as a maintenance_event of these kinds, whose time is that of the act, with
// who and why; its message_id says what is meant, so that layers find it again in what they concluded from it:
//
//   test_retracted         retraction/<asset>/test/<pst_id>/<when>
//   tests_retracted        retraction/<asset>/since/<time>/<when>     all that is known when it comes, from that time on:
//                                                                     who takes it names them in it, and in the record
//   retraction_withdrawn   retraction/<asset>/withdrawn/<when>/<id of the retraction, or of a replacement that was none>
//
// Nothing is deleted: what is retracted stays in the record, and counts again when the retraction is withdrawn. Where a
// replacement is taken back, the tests before it count again.
#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/advisory_generation.hpp"

namespace sealwatch {

inline constexpr std::string_view kTestRetracted = "test_retracted";
inline constexpr std::string_view kTestsRetracted = "tests_retracted";
inline constexpr std::string_view kRetractionWithdrawn = "retraction_withdrawn";

struct Retraction {
  std::string id;                     ///< message id of the event that says it
  std::string pst_id = {};            ///< the test; "" none
  std::optional<UtcTime> since = {};  ///< all tests from then on
  std::string withdrawn_id = {};      ///< the retraction or replacement that no longer holds; "" none
  /// Those that "since" means, where it is recorded; else those that are known.
  std::optional<std::vector<std::string>> tests = {};
};

[[nodiscard]] inline bool is_retraction_kind(std::string_view kind) {
  return kind == kTestRetracted || kind == kTestsRetracted || kind == kRetractionWithdrawn;
}

[[nodiscard]] inline bool is_replacement(const MaintenanceEvent& event) { return event.kind.ends_with("_replaced"); }

/// Whether a message of this id reports a replacement; its id ends in the time.
[[nodiscard]] inline bool is_replacement_id(std::string_view message_id) {
  return message_id.starts_with("maintenance_event/");
}

/// Those that the message names as its causes: it is of the first test after them.
[[nodiscard]] inline std::vector<std::string> replacements_before(const Header& header) {
  std::vector<std::string> ids;
  std::ranges::copy_if(header.source_ids, std::back_inserter(ids), is_replacement_id);
  return ids;
}

/// When the replacement of this id was, where it is one.
[[nodiscard]] inline std::optional<UtcTime> time_of_replacement(const std::string& message_id) {
  if (!is_replacement_id(message_id)) return std::nullopt;
  const auto time = parse_utc(message_id.substr(message_id.rfind('/') + 1));
  return time ? std::optional(*time) : std::nullopt;
}

[[nodiscard]] inline bool is_retraction_id(std::string_view message_id) {
  return message_id.starts_with("retraction/");
}

/// Whether a message of no test was concluded anew from those that count after a retraction: it then stands for the
/// latest, though it speaks of an earlier test than the one retracted.
[[nodiscard]] inline bool answers_retraction(const Header& header) {
  return header.pst_id.empty() && std::ranges::any_of(header.source_ids, is_retraction_id);
}

/// The retraction that the message answers: its id stands among the sources; nothing where it answers none.
[[nodiscard]] inline std::optional<std::string> retraction_answered(const Header& header) {
  const auto named = std::ranges::find_if(header.source_ids, is_retraction_id);
  return !header.pst_id.empty() || named == header.source_ids.end() ? std::nullopt : std::optional(*named);
}

/// What was done, by whom and why, in words.
[[nodiscard]] inline std::string in_words(const Retraction& retraction, const MaintenanceEvent& event) {
  std::string text = is_replacement_id(retraction.withdrawn_id)
                         ? "replacement '" + retraction.withdrawn_id + "' withdrawn"
                     : !retraction.withdrawn_id.empty() ? "retraction '" + retraction.withdrawn_id + "' withdrawn"
                     : retraction.since ? "all tests since " + format_date(*retraction.since) + " retracted"
                                        : "test " + retraction.pst_id + " retracted";
  text += " by " + event.reported_by;
  return event.remark.empty() ? text : text + " (" + event.remark + ")";
}

/// What the event of this id retracts or withdraws; nothing when it is no such event.
[[nodiscard]] inline std::optional<Retraction> retraction_of(const std::string& asset_id,
                                                             const std::string& message_id) {
  const std::string begin = "retraction/" + asset_id + "/";
  if (!message_id.starts_with(begin)) return std::nullopt;
  const std::string rest = message_id.substr(begin.size());
  const std::size_t first = rest.find('/'), last = rest.rfind('/');
  if (first == std::string::npos) return std::nullopt;
  Retraction retraction{.id = message_id};
  const std::string kind = rest.substr(0, first);
  if (kind == "withdrawn") {
    const std::size_t second = rest.find('/', first + 1);
    if (second == std::string::npos || second + 1 == rest.size()) return std::nullopt;
    retraction.withdrawn_id = rest.substr(second + 1);
    return retraction;
  }
  if (last <= first + 1) return std::nullopt;
  const std::string what = rest.substr(first + 1, last - first - 1);
  if (kind == "test") retraction.pst_id = what;
  if (kind == "since")
    if (const auto time = parse_utc(what)) retraction.since = *time;
  if (retraction.pst_id.empty() && !retraction.since) return std::nullopt;
  return retraction;
}

/// What the event retracts or withdraws, with the tests that it names.
[[nodiscard]] inline std::optional<Retraction> retraction_of(const MaintenanceEvent& event) {
  auto retraction = retraction_of(event.asset_id, event.header.message_id);
  if (retraction && event.tests_known) retraction->tests = event.test_ids;
  return retraction;
}

/// What a report of state detection or health assessment answers.
template <class Report>
[[nodiscard]] std::optional<Retraction> retraction_answered_by(const Report& report) {
  const auto id = retraction_answered(report.header);
  auto retraction = id ? retraction_of(report.asset_id, *id) : std::nullopt;
  if (retraction && report.retracted_tests_known) retraction->tests = report.retracted_test_ids;
  return retraction;
}

/// Says in the answer which tests the retraction means.
template <class Report>
void name_tests(const std::optional<std::vector<std::string>>& tests, Report& answer) {
  answer.retracted_tests_known = tests.has_value();
  answer.retracted_test_ids = tests.value_or(std::vector<std::string>());
}

/// What an event of each kind has in its id behind the asset's.
[[nodiscard]] inline std::string retraction_id(const std::string& asset_id, std::string_view kind,
                                               const std::string& what, UtcTime when) {
  const std::string begin = "retraction/" + asset_id + "/", now = format_utc(when);
  if (kind == kRetractionWithdrawn) return begin + "withdrawn/" + now + "/" + what;
  return begin + (kind == kTestRetracted ? "test/" : "since/") + what + "/" + now;
}

}  // namespace sealwatch
