#include "services/advisory_generation/advisory_revision.hpp"

#include <algorithm>

#include "sealwatch/core/text.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::advisory_generation {
namespace {

constexpr const char* kProducer = "advisory_generation 0.1.0";
constexpr const char* kAcknowledged = "/acknowledged/";
constexpr const char* kNoted = "/noted/";
/// Twice what one person may say. Who said more stands in the audit trail.
constexpr std::size_t kLongestRemark = 8000;

/// The header of an answer to `cause`, whose test (if it has one) or message names it.
Header answer_to(const Header& cause) {
  Header header;
  header.message_id = "advisory/" + (cause.pst_id.empty() ? cause.message_id : cause.pst_id);
  header.pst_id = cause.pst_id;
  header.producer = kProducer;
  header.event_time_known = cause.event_time_known;
  header.event_time_ns = cause.event_time_ns;
  header.replay = cause.replay;
  header.source_ids = {cause.message_id};
  return header;
}

// Whether who has acknowledged `current` must look again: an earlier date, one where there was none, or none any more,
// which is as soon as may be.
bool is_more_pressing(const Advisory& current, const Advisory& next) {
  if (current.latest_by_known != next.latest_by_known) return true;
  return next.latest_by_known && next.latest_by_ns < current.latest_by_ns;
}

// What stands is said again because of `cause`: it still rests on what it rested on.
Advisory said_again(const Advisory& current, Header header) {
  Advisory advisory = current;
  advisory.header = std::move(header);
  advisory.header.source_ids.push_back(current.header.message_id);
  advisory.revision = current.revision + 1;
  return advisory;
}

}  // namespace

Advisory revision_of(const std::optional<Advisory>& current, const std::string& asset_id,
                     const Recommendation& recommendation, const Header& cause) {
  Advisory next;
  next.asset_id = asset_id;
  next.header = answer_to(cause);
  next.priority = recommendation.priority;
  next.action = recommendation.action;
  next.recommendation = recommendation.text;
  next.latest_by_known = recommendation.latest_by.has_value();
  next.latest_by_ns = recommendation.latest_by.value_or(UtcTime{}).nanoseconds;
  if (current && current->action == next.action && current->priority == next.priority) {
    next.advisory_id = current->advisory_id;
    next.revision = current->revision + 1;
    next.supersedes_id = current->supersedes_id;
    if (current->state == AdvisoryState::acknowledged && !is_more_pressing(*current, next)) {
      next.state = AdvisoryState::acknowledged;
      next.acknowledged_by = current->acknowledged_by;
      next.acknowledged_at_ns = current->acknowledged_at_ns;
      next.acknowledgement_remark = current->acknowledgement_remark;
    }
  } else {
    next.advisory_id = "recommendation/" + (cause.pst_id.empty() ? cause.message_id : cause.pst_id);
    next.supersedes_id = current ? current->advisory_id : "";
  }
  return next;
}

Advisory superseded(Advisory old, const Advisory& successor) {
  const std::vector<std::string> sources = {old.header.message_id};
  old.header.message_id = successor.header.message_id + "/superseded";
  old.header.pst_id = successor.header.pst_id;
  old.header.event_time_known = successor.header.event_time_known;
  old.header.event_time_ns = successor.header.event_time_ns;
  old.header.replay = successor.header.replay;
  old.header.source_ids = sources;
  old.state = AdvisoryState::superseded;
  return old;
}

std::string id_without_acknowledgements(const Advisory& advisory, const std::string& before) {
  const std::string& id = advisory.header.message_id;
  return id.starts_with(before + kAcknowledged) || id.starts_with(before + kNoted) ? before : id;
}

std::optional<Advisory> with_acknowledgement(const Advisory& current, const std::string& current_id,
                                             const Acknowledgement& acknowledgement) {
  Advisory answer = current;
  const std::string its_id = content_hash(acknowledgement.header.message_id);
  answer.header.source_ids = {current.header.message_id, acknowledgement.header.message_id};
  if (acknowledgement.advisory_id != current.advisory_id) {
    answer.header.message_id = current_id + kNoted + its_id;
    std::string remark = answer.acknowledgement_remark.empty() ? "" : "; ";  // what somebody said stays
    remark += "acknowledgement of '" + acknowledgement.advisory_id + "' by " + acknowledgement.acknowledged_by +
              " not applied: this advisory is '" + current.advisory_id + "'";
    if (answer.acknowledgement_remark.size() + remark.size() <= kLongestRemark) answer.acknowledgement_remark += remark;
    return answer;
  }
  if (current.state == AdvisoryState::acknowledged) return std::nullopt;
  answer.header.message_id = current_id + kAcknowledged + its_id;
  answer.state = AdvisoryState::acknowledged;
  answer.acknowledged_by = acknowledgement.acknowledged_by;
  answer.acknowledged_at_ns = acknowledgement.header.event_time_ns;
  answer.acknowledgement_remark = acknowledgement.remark;
  return answer;
}

Advisory with_overdue_test(const std::optional<Advisory>& current, const StateReport& report) {
  Recommendation call;
  call.priority = AdvisoryPriority::medium;
  call.action = AdvisoryAction::repeat_test;
  // Since when: this stands until the test comes, while the days grow.
  constexpr double kDay_s = 86400.0;
  const UtcTime due = add_seconds({report.header.event_time_ns}, -kDay_s * report.overdue_days);
  call.text = "Run the partial stroke test: it is overdue since " + format_date(due) + ".";
  const bool same = current && current->priority == call.priority && current->action == call.action;
  const bool more_urgent_stands = current && current->priority >= call.priority && !same;
  if (!more_urgent_stands) {
    Advisory advisory = revision_of(current, report.asset_id, call, report.header);
    advisory.reasons = {call.text};
    return advisory;
  }
  Advisory advisory = said_again(*current, answer_to(report.header));
  advisory.reasons.insert(advisory.reasons.begin(), "also: " + call.text);
  return advisory;
}

Advisory after_replacement(const std::optional<Advisory>& current, const MaintenanceEvent& event) {
  Recommendation fresh;
  fresh.text = "No action needed: " + text::in_words(event.kind) + " on " + format_date({event.header.event_time_ns}) +
               ", the history starts anew.";
  Header cause = event.header;
  cause.pst_id.clear();
  std::optional<Advisory> none_of_its_kind = current;
  if (none_of_its_kind) none_of_its_kind->action = AdvisoryAction::replace_now;  // never a mere revision
  Advisory advisory = revision_of(none_of_its_kind, event.asset_id, fresh, cause);
  advisory.reasons = {text::in_words(event.kind) + " reported by " + event.reported_by +
                      (event.remark.empty() ? "" : ": " + event.remark)};
  return advisory;
}

Advisory after_late_replacement(const Advisory& current, const MaintenanceEvent& event) {
  Header cause = event.header;
  cause.pst_id.clear();
  Advisory advisory = said_again(current, answer_to(cause));
  advisory.reasons.insert(advisory.reasons.begin(), text::in_words(event.kind) + " on " +
                                                        format_date({event.header.event_time_ns}) + " reported by " +
                                                        event.reported_by +
                                                        " after later tests: this advice stands until the next test");
  return advisory;
}

Advisory after_retraction(const Advisory& current, const MaintenanceEvent& event, const Retraction& retraction) {
  Header cause = event.header;
  cause.pst_id.clear();
  Advisory advisory = said_again(current, answer_to(cause));
  advisory.reasons.insert(advisory.reasons.begin(), in_words(retraction, event) +
                                                        ": this advice is about to be renewed from the tests that "
                                                        "count; its id is " +
                                                        retraction.id);
  return advisory;
}

std::string renewed_id(const std::string& retraction_id) { return "renewed/" + retraction_id; }

std::optional<Retraction> retraction_of_renewed(const Advisory& advisory) {
  const std::string prefix = "advisory/" + renewed_id({});
  const std::string& id = advisory.header.message_id;
  return id.starts_with(prefix) ? retraction_of(advisory.asset_id, id.substr(prefix.size())) : std::nullopt;
}

std::optional<Retraction> answered_retraction(const Advisory& advisory) {
  constexpr std::string_view kPrefix = "advisory/";
  const std::string& id = advisory.header.message_id;
  return id.starts_with(kPrefix) ? retraction_of(advisory.asset_id, id.substr(kPrefix.size())) : std::nullopt;
}

bool is_answer_to_replacement(const Advisory& advisory) {
  return !advisory.header.source_ids.empty() &&
         advisory.header.message_id.rfind("advisory/maintenance_event/", 0) == 0 &&
         advisory.header.message_id == "advisory/" + advisory.header.source_ids.front();
}

bool is_of_overdue_test(const Advisory& advisory) {
  return advisory.action == AdvisoryAction::repeat_test &&
         advisory.advisory_id.starts_with("recommendation/state_report/" + advisory.asset_id + "/overdue/");
}

std::vector<std::string> source_ids(const Evidence& evidence) {
  std::vector<std::string> ids;
  const auto add = [&](const std::string& id) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  for (const Header* header :
       {&evidence.life.header, &evidence.leakage.header, &evidence.health.header, &evidence.state.header})
    add(header->message_id);
  for (const Header* header : {&evidence.leakage.header, &evidence.health.header, &evidence.state.header})
    for (const std::string& id : header->source_ids) add(id);
  return ids;
}

}  // namespace sealwatch::advisory_generation
