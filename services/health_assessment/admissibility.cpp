#include "services/health_assessment/admissibility.hpp"

#include <algorithm>
#include <initializer_list>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

/// The channels of a test that are in order, by their roles.
class InOrder {
 public:
  InOrder(const TestFeatures& features, const PlantDescription& plant) : features_(features), plant_(plant) {}
  [[nodiscard]] bool has(ChannelRole role) const {
    const std::string channel = channel_name(plant_, role);
    return std::ranges::any_of(features_.channel_status, [&](const ChannelStatus& status) {
      return status.channel == channel && status.state == ChannelState::OK;
    });
  }
  [[nodiscard]] bool any(std::initializer_list<ChannelRole> roles) const {
    return std::ranges::any_of(roles, [&](ChannelRole role) { return has(role); });
  }

 private:
  const TestFeatures& features_;
  const PlantDescription& plant_;
};

bool cylinder_circuit_possible(const InOrder& channels) {
  const bool pressures = channels.has(ChannelRole::pressure_up) && channels.has(ChannelRole::pressure_down);
  return channels.has(ChannelRole::flow) && (pressures || channels.has(ChannelRole::pressure_difference)) &&
         channels.any({ChannelRole::stroke, ChannelRole::speed});
}

bool whole_actuator_possible(const InOrder& channels) {
  return channels.has(ChannelRole::drive) && channels.has(ChannelRole::shaft_speed) &&
         channels.any({ChannelRole::pressure_up, ChannelRole::pressure_down, ChannelRole::pressure_difference}) &&
         channels.has(ChannelRole::stroke);
}

/// A plant without a hydraulic cylinder is estimated by what it is simulated with: all that drives it, and any output.
bool model_possible(const TestFeatures& features, const PlantDescription& plant) {
  return std::ranges::any_of(features.channel_status, [&](const ChannelStatus& status) {
    const ChannelDescription* channel = plant.find_channel(status.channel);
    return channel != nullptr && !channel->input && status.state == ChannelState::OK;
  });
}

/// Whether the plant is one whose seal the holds of a test control.
bool has_cylinder(const PlantDescription& plant) { return plant.find_parameter(ParameterRole::area_up) != nullptr; }

std::string missing_channels(const TestFeatures& features, bool of_seal) {
  std::string text =
      std::string("no ") + (of_seal ? "leakage " : "") + "estimate is possible with the channels that are in order";
  for (const ChannelStatus& status : features.channel_status) {
    if (status.state == ChannelState::OK || status.state == ChannelState::NOT_USED) continue;
    text += "; " + status.channel + " is " + std::string(name_of(status.state));
    if (!status.reason.empty()) text += " (" + status.reason + ")";
  }
  return text;
}

std::string quality_text(const RegionJudgement& judgement) {
  if (judgement.quantity == "fluid_temperature_deviation")
    return text::format("off temperature: the oil was {:+.1f} K from the 4 degC of the seabed, {:.1f} K are allowed",
                        judgement.value, judgement.warning_limit);
  return text::format("{}: {:.0f} % of the test, {:.0f} % are allowed",
                      judgement.quantity == "drive_saturation" ? "the drive was saturated" : "samples are missing",
                      100.0 * judgement.value, 100.0 * judgement.warning_limit);
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

std::vector<std::string> inadmissible_reasons(const AssetConfig& asset, const StateReport& report,
                                              const TestFeatures& features) {
  if (report.verdict == PstVerdict::aborted || report.verdict == PstVerdict::not_judged) {
    const std::string why = report.verdict_reasons.empty() ? "no reason given" : report.verdict_reasons.front();
    return {std::string(report.verdict == PstVerdict::aborted ? "aborted: " : "not judged: ") + why};
  }
  std::vector<std::string> reasons;
  const bool has_hold = std::any_of(features.phases.begin(), features.phases.end(),
                                    [](const Phase& phase) { return phase.kind == PhaseKind::hold; });
  const PlantDescription& plant = plant_or_default(asset.model);
  const bool cylinder = has_cylinder(plant);
  if (!has_hold && cylinder) reasons.push_back("no hold was found, and the holds control the leakage resistance");
  for (const RegionJudgement& judgement : report.judgements)
    if (is_poor(judgement)) reasons.push_back(quality_text(judgement));
  const InOrder channels(features, plant);
  const bool possible = cylinder ? cylinder_circuit_possible(channels) || whole_actuator_possible(channels)
                                 : model_possible(features, plant);
  if (!possible) reasons.push_back(missing_channels(features, cylinder));
  return reasons;
}

}  // namespace sealwatch
