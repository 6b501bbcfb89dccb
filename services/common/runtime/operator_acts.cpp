#include "services/common/runtime/operator_acts.hpp"

#include "services/common/runtime/admission.hpp"

namespace sealwatch {

bool is_an_act(const Message& message) {
  return std::holds_alternative<Acknowledgement>(message) || std::holds_alternative<MaintenanceEvent>(message) ||
         std::holds_alternative<ModelAcceptance>(message);
}

std::optional<OperatorAct> act_of(const Message& message, UtcTime received, std::string outcome) {
  OperatorAct act{.at = received,
                  .kind = std::string(name_of(topic_of(message))),
                  .asset_id = asset_of(message),
                  .who = {},
                  .subject = header_of(message).message_id,
                  .text = {},
                  .outcome = std::move(outcome)};
  if (const auto* seen = std::get_if<Acknowledgement>(&message)) {
    act.who = seen->acknowledged_by;
    act.text = seen->remark;
  } else if (const auto* event = std::get_if<MaintenanceEvent>(&message)) {
    act.kind = event->kind;
    act.who = event->reported_by;
    act.text = event->remark;
  } else if (const auto* acceptance = std::get_if<ModelAcceptance>(&message)) {
    if (acceptance->revoked) act.kind = "model_revoked";
    act.who = acceptance->accepted_by;
    act.text = acceptance->discrepancy_id + (acceptance->remark.empty() ? "" : ": " + acceptance->remark);
  } else {
    return std::nullopt;
  }
  // What is refused for its length stands here as well, and for ever.
  for (std::string* const text : {&act.kind, &act.asset_id, &act.who, &act.subject, &act.text})
    if (text->size() > kLongestRemark) text->resize(kLongestRemark);
  return act;
}

bool is_taken(std::string_view outcome) { return outcome == kTaken || outcome.starts_with(std::string(kTaken) + ", "); }

bool is_said_here(std::string_view outcome) {
  return outcome.find(kFetchedBack) == std::string_view::npos && outcome.find(kAsElsewhere) == std::string_view::npos;
}

}  // namespace sealwatch
