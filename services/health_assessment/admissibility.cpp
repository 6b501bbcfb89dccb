#include "services/health_assessment/admissibility.hpp"

#include <algorithm>
#include <cstdio>
#include <initializer_list>

namespace sealwatch {
namespace {

bool is_ok(const TestFeatures& features, std::string_view channel) {
  return std::any_of(features.channel_status.begin(), features.channel_status.end(), [&](const ChannelStatus& status) {
    return status.channel == channel && status.state == ChannelState::OK;
  });
}

bool any_ok(const TestFeatures& features, std::initializer_list<std::string_view> channels) {
  return std::any_of(channels.begin(), channels.end(), [&](std::string_view c) { return is_ok(features, c); });
}

bool cylinder_circuit_possible(const TestFeatures& features) {
  const bool pressures = is_ok(features, "pressure_a") && is_ok(features, "pressure_b");
  return is_ok(features, "flow") && (pressures || is_ok(features, "pressure_differential")) &&
         any_ok(features, {"position", "velocity"});
}

bool whole_actuator_possible(const TestFeatures& features) {
  return any_ok(features, {"motor_voltage", "motor_duty"}) && is_ok(features, "shaft_speed") &&
         any_ok(features, {"pressure_a", "pressure_b", "pressure_differential"}) && is_ok(features, "position");
}

std::string missing_channels(const TestFeatures& features) {
  std::string text = "no leakage estimate is possible with the channels that are in order";
  for (const ChannelStatus& status : features.channel_status) {
    if (status.state == ChannelState::OK || status.state == ChannelState::NOT_USED) continue;
    text += "; " + status.channel + " is " + std::string(name_of(status.state));
    if (!status.reason.empty()) text += " (" + status.reason + ")";
  }
  return text;
}

std::string quality_text(const RegionJudgement& judgement) {
  char text[160];
  if (judgement.quantity == "fluid_temperature_deviation")
    std::snprintf(text, sizeof text,
                  "off temperature: the oil was %+.1f K from the 4 degC of the seabed, %.1f K are allowed",
                  judgement.value, judgement.warning_limit);
  else
    std::snprintf(text, sizeof text, "%s: %.0f %% of the test, %.0f %% are allowed",
                  judgement.quantity == "drive_saturation" ? "the drive was saturated" : "samples are missing",
                  100.0 * judgement.value, 100.0 * judgement.warning_limit);
  return text;
}

bool is_poor(const RegionJudgement& judgement) {
  const std::string& quantity = judgement.quantity;
  const bool of_recording =
      quantity == "fluid_temperature_deviation" || quantity == "drive_saturation" || quantity == "missing_share";
  return of_recording && judgement.raw_region >= AlertRegion::warning;
}

}  // namespace

bool is_poor_recording(const StateReport& report) {
  return std::any_of(report.judgements.begin(), report.judgements.end(), is_poor);
}

std::vector<std::string> inadmissible_reasons(const StateReport& report, const TestFeatures& features) {
  if (report.verdict == PstVerdict::aborted || report.verdict == PstVerdict::not_judged) {
    const std::string why = report.verdict_reasons.empty() ? "no reason given" : report.verdict_reasons.front();
    return {std::string(report.verdict == PstVerdict::aborted ? "aborted: " : "not judged: ") + why};
  }
  std::vector<std::string> reasons;
  const bool has_hold = std::any_of(features.phases.begin(), features.phases.end(),
                                    [](const Phase& phase) { return phase.kind == PhaseKind::hold; });
  if (!has_hold) reasons.push_back("no hold was found, and the holds control the leakage resistance");
  for (const RegionJudgement& judgement : report.judgements)
    if (is_poor(judgement)) reasons.push_back(quality_text(judgement));
  if (!cylinder_circuit_possible(features) && !whole_actuator_possible(features))
    reasons.push_back(missing_channels(features));
  return reasons;
}

}  // namespace sealwatch
