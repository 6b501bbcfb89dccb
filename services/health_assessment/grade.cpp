#include "services/health_assessment/grade.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

constexpr std::array<std::string_view, 7> kFunctional = {"friction_pressure", "breakaway_pressure", "load_free_current",
                                                         "pump_slip",         "shaft_drag",         "back_emf",
                                                         "closing_time"};
/// Deviation of the alarm limit, in advisory widths.
constexpr double kAlarmWidths = 3.0;
constexpr double kGradePerRegion = 0.25;

double grade_at(double theta, double threshold) {
  return std::clamp((theta - threshold) / (1.0 - threshold), 0.0, 1.0);
}

/// Of what wears: by the condition that the simulation shows, by the seal's leakage, or by its deviation.
std::optional<double> wear_grade(const AssetConfig& asset, const StateReport& report,
                                 const std::vector<Deviation>& deviations, std::optional<double> last_grade) {
  const auto condition = std::ranges::find(report.judgements, "condition", &RegionJudgement::quantity);
  if (condition != report.judgements.end() && asset.condition)
    return grade_at(condition->value, asset.condition->threshold);
  const Deviation* leakage = find_deviation(deviations, "leakage_resistance");
  const std::optional<ConditionSetting>& seal = plant_or_default(asset.model).condition;
  if (leakage != nullptr && asset.condition && seal && asset.condition->parameter == seal->parameter)
    return grade_at(asset.condition->condition(leakage->judgement.value), asset.condition->threshold);
  if (leakage == nullptr && !asset.condition) leakage = find_deviation(deviations, "hold_decay_rate");
  if (leakage == nullptr) return last_grade;
  const bool is_resistance = leakage->judgement.quantity == "leakage_resistance";
  const double worse = is_resistance ? -leakage->value : leakage->value;
  return std::clamp(1.0 - worse / kAlarmWidths, 0.0, 1.0);
}

double functional_grade(const StateReport& report) {
  AlertRegion worst = AlertRegion::normal;
  for (const RegionJudgement& judgement : report.judgements)
    if (std::find(kFunctional.begin(), kFunctional.end(), judgement.quantity) != kFunctional.end())
      worst = std::max(worst, judgement.region);
  return 1.0 - kGradePerRegion * static_cast<double>(static_cast<int>(worst));
}

}  // namespace

std::optional<double> health_grade(const AssetConfig& asset, const StateReport& report,
                                   const std::vector<Deviation>& deviations, std::optional<double> last_grade) {
  if (report.verdict == PstVerdict::failed) return 0.0;
  const std::optional<double> wear = wear_grade(asset, report, deviations, last_grade);
  return wear ? std::optional(std::min(*wear, functional_grade(report))) : std::nullopt;
}

}  // namespace sealwatch
