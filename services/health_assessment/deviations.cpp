#include "services/health_assessment/deviations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

/// Quantities of state detection that a fault of the actuator or of a sensor moves.
constexpr std::array<std::string_view, 12> kQuantities = {
    "leakage_resistance", "friction_pressure", "breakaway_pressure", "load_pressure",
    "load_free_current",  "hold_decay_rate",   "pump_slip",          "shaft_drag",
    "back_emf",           "flow_gain",         "delivery_ratio",     "velocity_gain"};

/// Beyond the alarm a deviation says nothing more about which fault it is.
constexpr double kLargest = 4.0;

bool speaks_of_faults(std::string_view quantity) {
  return std::find(kQuantities.begin(), kQuantities.end(), quantity) != kQuantities.end();
}

}  // namespace

std::vector<Deviation> deviations_of(const StateReport& report) {
  std::vector<Deviation> deviations;
  for (const RegionJudgement& judgement : report.judgements) {
    if (!speaks_of_faults(judgement.quantity) || find_deviation(deviations, judgement.quantity) != nullptr) continue;
    const double step = judgement.warning_limit - judgement.advisory_limit;
    if (!(std::abs(step) > 0.0)) continue;
    const double centre = judgement.advisory_limit - step;
    double value = (judgement.value - centre) / std::abs(step);
    const bool on_good_side = value * step < 0.0;
    if (on_good_side) value = 0.0;
    const bool informative = !on_good_side || judgement.reference == Reference::own_baseline;
    deviations.push_back({judgement, std::abs(step), std::clamp(value, -kLargest, kLargest), informative});
  }
  return deviations;
}

const Deviation* find_deviation(const std::vector<Deviation>& deviations, std::string_view quantity) {
  const auto found = std::find_if(deviations.begin(), deviations.end(),
                                  [&](const Deviation& d) { return d.judgement.quantity == quantity; });
  return found == deviations.end() ? nullptr : &*found;
}

std::string in_words(const RegionJudgement& judgement) {
  return text::format("{} {}, advisory {} {:.3g}", text::in_words(judgement.quantity),
                      text::with_unit(judgement.value, judgement.unit),
                      judgement.alarm_limit < judgement.advisory_limit ? "below" : "above", judgement.advisory_limit);
}

}  // namespace sealwatch
