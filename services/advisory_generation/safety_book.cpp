#include "services/advisory_generation/safety_book.hpp"

#include "sealwatch/forecast/safety_margin.hpp"
#include "sealwatch/message/worn_words.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::advisory_generation {
namespace {

constexpr double kHoursAMonth = 365.25 * 24.0 / 12.0;

void add_intervals(SafetyBook& book, const PstSetting& pst, const SiteSafety& safety, std::optional<UtcTime> now) {
  const auto probability = forecast::average_failure_probability_on_demand(
      {.dangerous_undetected_per_hour = safety.dangerous_undetected_per_hour,
       .partial_stroke_coverage = safety.partial_stroke_coverage,
       .partial_stroke_interval_h = pst.interval_months * kHoursAMonth,
       .full_stroke_interval_h = safety.full_stroke_interval_months * kHoursAMonth});
  book.failure_probability_known = probability.has_value();
  if (probability) book.failure_probability_on_demand = *probability;
  if (!safety.last_full_stroke || !now) return;
  const forecast::TestDue due = forecast::next_test_due(safety.last_full_stroke, *safety.last_full_stroke,
                                                        safety.full_stroke_interval_months, *now);
  book.full_stroke_known = true;
  book.full_stroke_due_ns = due.due.nanoseconds;
  book.full_stroke_overdue_months = due.overdue_months;
}

// As the test measured it: the drive makes up for the leak as long as it can. A test without a measured speed leaves
// what the leak takes from the flow of its own ramp.
double time_margin(const StateReport& state, double from_leak) {
  for (const RegionJudgement& judgement : state.judgements)
    if (judgement.quantity == "closing_time" && judgement.value > 0.0)
      return judgement.warning_limit / judgement.value - 1.0;
  return from_leak;
}

void add_margins(SafetyBook& book, const AssetConfig& asset, const Evidence& evidence) {
  const LeakageEstimate& leakage = evidence.leakage;
  const PlantDescription& plant = plant_or_default(asset.model);
  const ParameterDescription *area = plant.find_parameter(ParameterRole::area_up),
                             *stroke = plant.find_parameter(ParameterRole::stroke);
  const auto has = [&](const std::string& name) { return asset.parameters.contains(name); };
  if (!leakage.estimated || !is_of_seal(leakage) || area == nullptr || stroke == nullptr || !has(area->name) ||
      !has(stroke->name) || !has(plant.load_parameter))
    return;
  forecast::ClosingConditions conditions;
  conditions.piston_area_m2 = asset.parameter(area->name);
  conditions.stroke_m = asset.parameter(stroke->name);
  conditions.inlet_flow_m3_s = asset.parameter(area->name) * asset.pst.speed_m_s;
  conditions.load_N = asset.parameter(plant.load_parameter);
  const auto margin = forecast::closing_margin(leakage.resistance_Pa_s_m3, conditions);
  if (!margin) return;
  book.margin_known = true;
  book.closing_time_margin = time_margin(evidence.state, margin->time_margin);
  book.closing_force_margin = margin->force_margin;
}

std::string amount(double money) { return text::significant(money, 4); }

}  // namespace

SafetyBook safety_book(const Evidence& evidence, const AssetConfig* asset, const std::optional<SiteSafety>& safety) {
  SafetyBook book;
  if (!asset) return book;
  std::optional<UtcTime> now;
  if (evidence.life.header.event_time_known) now = UtcTime{evidence.life.header.event_time_ns};
  if (now) {
    const forecast::TestDue due = forecast::next_test_due(now, *now, asset->pst.interval_months, *now);
    book.partial_stroke_known = true;
    book.partial_stroke_due_ns = due.due.nanoseconds;
    book.partial_stroke_overdue_days = evidence.state.overdue_days;
  }
  if (safety) add_intervals(book, asset->pst, *safety, now);
  if (evidence.said) {
    book.margin_known = evidence.said->margins.margin_known;
    book.closing_time_margin = evidence.said->margins.closing_time_margin;
    book.closing_force_margin = evidence.said->margins.closing_force_margin;
  } else {
    add_margins(book, *asset, evidence);
  }
  return book;
}

std::vector<std::string> in_words(const std::vector<DecisionOption>& decision, const SafetyBook& book) {
  std::vector<std::string> words;
  for (const DecisionOption& option : decision) {
    if (!option.cheapest) continue;
    std::string text = "cheapest on average: ";
    text.append(option.label).append(", ").append(amount(option.expected_cost));
    if (!option.currency.empty()) text.append(" ").append(option.currency);
    text.append(" expected; now ").append(amount(decision.front().expected_cost));
    text.append(", waiting for the failure ").append(amount(decision.back().expected_cost));
    words.push_back(std::move(text));
  }
  if (book.failure_probability_known)
    words.push_back(std::string("average probability of failure on demand ")
                        .append(text::in_sentence(book.failure_probability_on_demand)));
  if (book.full_stroke_known && book.full_stroke_overdue_months > 0.0)
    words.push_back(std::string("the full stroke test was due on ").append(format_date({book.full_stroke_due_ns})));
  return words;
}

}  // namespace sealwatch::advisory_generation
