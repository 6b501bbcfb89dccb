#include "services/advisory_generation/reasons.hpp"

#include "sealwatch/config/judged_quantities.hpp"
#include "sealwatch/message/worn_words.hpp"
#include "services/advisory_generation/assessment.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::advisory_generation {
namespace {

using text::as_condition;
using text::condition_in_percent;
using text::in_months;
using text::in_percent;
using text::in_words;
using text::with_unit;

/// Below this a fault is proposed only because some fault must come first.
constexpr double kWorthNaming = 0.10;
/// Behind the name of a test.
constexpr const char* kMeasured = ": ";
constexpr const char* kLeftOut = " left out of the forecast: ";

/// "test of 2018-03-24".
std::string name_of_test(const Header& header) {
  return header.event_time_known ? "test of " + format_date({header.event_time_ns}) : "this test";
}

std::string quantity_words(std::string_view quantity) {
  if (quantity.starts_with(kResidualQuantity))
    return "difference from the simulation in " + in_words(quantity.substr(kResidualQuantity.size()));
  if (quantity.starts_with(kChannelQuantity))
    return "loss of the channel " + in_words(quantity.substr(kChannelQuantity.size()));
  return in_words(quantity);
}

std::string_view reference_words(Reference reference) {
  switch (reference) {
    case Reference::limit:
      return "fixed limits";
    case Reference::nominal_model:
      return "the model of the asset file";
    case Reference::own_baseline:
      return "this actuator's first tests";
    case Reference::accepted_model:
      return "the accepted model";
  }
  return {};
}

/// "leakage resistance in region warning: 5.91e+12 Pa s/m3 (warning below 7.31e+12, alarm below 4.64e+12; by fixed
/// limits)"
std::string region_words(const RegionJudgement& one) {
  const std::string side = one.alarm_limit < one.advisory_limit ? " below " : " above ";
  return quantity_words(one.quantity) + " in region " + std::string(name_of(one.region)) + ": " +
         with_unit(one.value, one.unit) + " (warning" + side + with_unit(one.warning_limit, "1") + ", alarm" + side +
         with_unit(one.alarm_limit, "1") + "; by " + std::string(reference_words(one.reference)) + ")";
}

void add_forecast(std::vector<std::string>& reasons, const RemainingLife& life) {
  if (life.forecasts.empty()) return;
  const Forecast& forecast = life.forecasts.front();
  const std::string name =
      "forecast (" + in_words(forecast.method) + ", " + std::to_string(forecast.window_months) + " months): ";
  if (forecast.state != ForecastState::ok) {
    reasons.push_back(name + in_words(name_of(forecast.state)) + ", " + forecast.explanation);
  } else {
    reasons.push_back(name + in_months(forecast.rul_p50_months) +
                      " left (80 %: " + text::range_in_months(forecast.rul_p10_months, forecast.rul_p90_months) +
                      "), end of life " + format_date({forecast.end_of_life_ns}) + "; " + forecast.explanation);
    for (const FailureProbability& one : forecast.failure_probability) {
      reasons.push_back("failure before " + one.label + " (" + format_date({one.before_ns}) +
                        "): " + in_percent(one.probability));
      if (one.probability > 0.5) break;  // later ones only come nearer to certainty
    }
  }
  if (life.windows_disagree) reasons.push_back("windows disagree: " + life.disagreement);
}

void add_condition(std::vector<std::string>& reasons, const LeakageEstimate& leakage, const RemainingLife& life) {
  if (leakage.estimated) {
    std::string text =
        (is_of_seal(leakage) ? "leakage resistance " : "") + worn_parameter(leakage) + " = " +
        text::readable_with_error(leakage.resistance_Pa_s_m3, leakage.resistance_std_Pa_s_m3, worn_unit(leakage)) +
        " (by sensor noise alone)";
    if (leakage.condition_known)
      text = worn_condition(leakage) + " " + condition_in_percent(leakage.condition) + limit_of(life) + ", " + text;
    reasons.push_back(name_of_test(leakage.header) + kMeasured + text);
  }
  if (!leakage.used_for_forecast)
    reasons.push_back(name_of_test(leakage.header) + kLeftOut + text::joined(leakage.reasons));
}

/// Whether grade and proposals are those of an earlier test, as this one does not tell.
bool is_carried_over(const HealthReport& health, const StateReport& state) {
  if (state.judgements.empty()) return true;
  const auto& group = health.ambiguity_group;
  return !group.empty() && !group.front().evidence.empty() &&
         group.front().evidence.front().starts_with("carried over");
}

void add_health(std::vector<std::string>& reasons, const HealthReport& health, const StateReport& state) {
  std::string text = health.health_grade_known ? "health grade " + as_condition(health.health_grade)
                                               : "health grade not known: no test has measured the wear";
  if (health.trend_known)
    text += ", " + as_condition(health.health_trend_per_year) + " ± " + as_condition(health.health_trend_std_per_year) +
            " a year";
  if (!health.ambiguity_group.empty()) {
    const ProposedFault& first = health.ambiguity_group.front();
    if (first.likelihood < kWorthNaming)
      text += "; no fault stands out";
    else
      text += (first.likelihood > 0.5 ? "; most likely fault: " : "; possible fault: ") + describe(first);
  }
  if (is_carried_over(health, state)) text += "; this test itself does not tell";
  reasons.push_back(text);
}

void add_state(std::vector<std::string>& reasons, const StateReport& state) {
  for (const RegionJudgement& judgement : state.judgements)
    if (judgement.region == AlertRegion::alarm || judgement.region == AlertRegion::warning)
      reasons.push_back(region_words(judgement));
  if (state.verdict != PstVerdict::passed)
    reasons.push_back("partial stroke test " + in_words(name_of(state.verdict)) +
                      (state.verdict_reasons.empty() ? "" : ": " + text::joined(state.verdict_reasons)));
  if (state.pst_overdue) reasons.push_back("the test came " + text::in_days(state.overdue_days) + " late");
}

}  // namespace

std::vector<std::string> reasons_of(const Evidence& evidence) {
  std::vector<std::string> reasons;
  add_forecast(reasons, evidence.life);
  if (evidence.said)
    reasons.insert(reasons.end(), evidence.said->reasons.begin(), evidence.said->reasons.end());
  else
    add_condition(reasons, evidence.leakage, evidence.life);
  add_health(reasons, evidence.health, evidence.state);
  add_state(reasons, evidence.state);
  return reasons;
}

std::vector<std::string> reasons_of_condition(const Header& test, const std::vector<std::string>& reasons) {
  std::vector<std::string> found;
  for (const std::string& reason : reasons)
    if (reason.starts_with(name_of_test(test) + kMeasured) || reason.starts_with(name_of_test(test) + kLeftOut))
      found.push_back(reason);
  return found;
}

std::string limit_of(const RemainingLife& life) {
  return life.threshold > 0.0 ? " (limit " + condition_in_percent(life.threshold) + ")" : "";
}

std::string describe(const ProposedFault& fault) {
  constexpr std::string_view kSensor = "sensor:";  // the kind says so already
  const std::string_view element = fault.element;
  const bool named_twice = fault.kind == FaultKind::sensor && element.starts_with(kSensor);
  return in_words(name_of(fault.kind)) + " of " + in_words(named_twice ? element.substr(kSensor.size()) : element) +
         ", likelihood " + in_percent(fault.likelihood) +
         (fault.iso14224_code.empty() ? "" : " (ISO 14224 " + fault.iso14224_code + ")");
}

}  // namespace sealwatch::advisory_generation
