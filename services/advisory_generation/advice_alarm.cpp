#include "services/advisory_generation/advice_alarm.hpp"

#include "sealwatch/message/alarm_state.hpp"
#include "services/advisory_generation/advisory_revision.hpp"

namespace sealwatch::advisory_generation {

std::optional<StandingAdvice> advice_alarm(const Message& output) {
  const auto* advisory = std::get_if<Advisory>(&output);
  if (advisory == nullptr || advisory->state == AdvisoryState::superseded) return std::nullopt;
  StandingAdvice said{.asset_id = advisory->asset_id, .advice = {}, .is_answered = false};
  if (advisory->action == AdvisoryAction::none) {
    said.is_answered = is_answer_to_replacement(*advisory);
    return said;
  }
  const Header& header = advisory->header;
  said.advice.emplace();
  said.advice->alarm = {.kind = std::string(is_of_overdue_test(*advisory) ? kOverdueAlarm : kAdviceAlarm),
                        .asset_id = advisory->asset_id,
                        .subject = advisory->advisory_id,
                        .pst_id = header.pst_id,
                        .text = advisory->recommendation,
                        .since_ns = header.event_time_known ? header.event_time_ns : 0};
  said.advice->due_ns = advisory->latest_by_known ? advisory->latest_by_ns : 0;
  if (advisory->state == AdvisoryState::acknowledged) {
    said.advice->acknowledged_by = advisory->acknowledged_by;
    said.advice->acknowledged_at_ns = advisory->acknowledged_at_ns;
  }
  return said;
}

}  // namespace sealwatch::advisory_generation
