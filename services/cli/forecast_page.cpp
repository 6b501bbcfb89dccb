#include "services/cli/forecast_page.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/forecast/normal.hpp"
#include "sealwatch/forecast/student_t.hpp"
#include "sealwatch/forecast/words.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/report/readable.hpp"

namespace sealwatch::cli {
namespace {

using forecast::ConditionForecast;
using forecast::ConditionSample;
using forecast::ForecastPanel;
using forecast::PredictiveDistribution;
using report::Ink;
using report::Plot;

constexpr int kWide = 980;
constexpr int kHalf = 480;
constexpr double kMonthsAYear = 12.0;
constexpr double kShortestView_months = 12.0;
constexpr double kLongestView_months = 240.0;
constexpr double kBeyond = 1.15;  // a little past the last date of interest
constexpr double kNormal97_5 = 1.959963984540054;

/// 2021.25 for the beginning of April 2021.
double calendar_year(UtcTime time) {
  static const UtcTime kEpoch{};
  return 1970.0 + months_between(kEpoch, time) / kMonthsAYear;
}

report::Axis years() { return {.label = "year", .unit = "1"}; }

double quantile_factor(int degrees_of_freedom, double probability) {
  return degrees_of_freedom > 0 ? forecast::student_t_quantile(probability, degrees_of_freedom)
                                : forecast::normal_quantile(probability);
}

/// How far ahead is looked: past the latest date of the forecast in charge, and past the last campaign before that.
double view_months(const ForecastPanel::Answer& answer) {
  const Forecast& in_charge = answer.forecasts.front();
  const double latest = in_charge.state == ForecastState::ok ? in_charge.interval_95_high_months : 0.0;
  return std::clamp(kBeyond * latest, kShortestView_months, kLongestView_months);
}

std::vector<UtcTime> months_ahead(UtcTime now, double months) {
  std::vector<UtcTime> times;
  for (int month = 0; month <= static_cast<int>(std::ceil(months)); ++month) times.push_back(add_months(now, month));
  return times;
}

report::Scatter tests_of(const std::vector<ConditionSample>& samples, Ink ink, const std::string& label) {
  report::Scatter scatter{.x = {}, .y = {}, .ink = ink, .label = label, .radius = 2.2};
  for (const ConditionSample& sample : samples) {
    scatter.x.push_back(calendar_year(sample.time));
    scatter.y.push_back(sample.condition);
  }
  return scatter;
}

report::Intervals intervals_of(const std::vector<ConditionSample>& samples) {
  report::Intervals intervals{.x = {}, .y = {}, .low = {}, .high = {}, .ink = Ink::first, .label = "95 % of the test"};
  for (const ConditionSample& sample : samples) {
    intervals.x.push_back(calendar_year(sample.time));
    intervals.y.push_back(sample.condition);
    intervals.low.push_back(sample.condition - kNormal97_5 * sample.condition_std);
    intervals.high.push_back(sample.condition + kNormal97_5 * sample.condition_std);
  }
  return intervals;
}

/// From the first test to the last month that is forecast, at least a year and a little more.
std::pair<double, double> view_of(const ForecastQuestion& question, const std::vector<ConditionForecast>& conditions) {
  const double from = calendar_year(question.first);
  const double to = std::max(calendar_year(conditions.empty() ? question.last : conditions.back().time), from + 1.0);
  const double margin = 0.01 * (to - from);
  return {from - margin, to + margin};
}

void add_forecast_band(const std::vector<ConditionForecast>& conditions, double threshold, Plot& plot) {
  report::Line middle{.x = {}, .y = {}, .ink = Ink::second, .label = "forecast"};
  report::Band band{.x = {}, .low = {}, .high = {}, .ink = Ink::second, .label = "95 % of the condition"};
  for (const ConditionForecast& at : conditions) {
    const double half = quantile_factor(at.degrees_of_freedom, 0.975) * at.condition_std;
    if (at.condition + half < threshold - 0.1) break;  // long failed: nothing to see there
    band.x.push_back(calendar_year(at.time));
    band.low.push_back(at.condition - half);
    band.high.push_back(at.condition + half);
    middle.x.push_back(band.x.back());
    middle.y.push_back(at.condition);
  }
  plot.marks.emplace_back(std::move(band));
  plot.marks.emplace_back(std::move(middle));
}

Plot course(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
            const std::vector<ConditionForecast>& conditions) {
  const double threshold = question.request.threshold;
  Plot plot{.title = "Seal condition, share of the elastic modulus when new",
            .x = {.label = "year", .unit = "1", .range = view_of(question, conditions)},
            .y = {.label = "condition", .unit = "1"},
            .marks = {},
            .width = kWide,
            .height = 330};
  if (!conditions.empty()) add_forecast_band(conditions, threshold, plot);
  plot.marks.emplace_back(intervals_of(answer.used));
  plot.marks.emplace_back(tests_of(answer.used, Ink::first, "test"));
  if (!answer.left_out.empty()) plot.marks.emplace_back(tests_of(answer.left_out, Ink::bad, "left out"));
  plot.marks.emplace_back(report::Reference{.at = threshold, .ink = Ink::bad, .label = "failed"});
  const Forecast& in_charge = answer.forecasts.front();
  if (in_charge.state == ForecastState::ok) {
    const auto year = [&](double months) { return calendar_year(add_months(question.request.now, months)); };
    plot.marks.emplace_back(report::Line{.x = {year(in_charge.rul_p10_months), year(in_charge.rul_p90_months)},
                                         .y = {threshold, threshold},
                                         .ink = Ink::bad,
                                         .label = "end of life, 80 %",
                                         .width = 5.0});
  }
  return plot;
}

std::string method_label(const Forecast& forecast) {
  return report::words_of(forecast.method) + " " + std::to_string(forecast.window_months);
}

/// Remaining life by every method, with its 95 % interval.
Plot side_by_side(const ForecastPanel::Answer& answer) {
  Plot plot{.title = "Remaining life in months, 95 % intervals",
            .x = {},
            .y = {.label = "months", .unit = "1"},
            .marks = {},
            .width = kWide,
            .height = 200,
            .legend = false};
  report::Intervals intervals{.x = {}, .y = {}, .low = {}, .high = {}, .ink = Ink::first, .label = {}};
  for (const Forecast& forecast : answer.forecasts) {
    if (forecast.state == ForecastState::ok) {
      intervals.x.push_back(static_cast<double>(plot.x.categories.size()));
      intervals.y.push_back(forecast.rul_months);
      intervals.low.push_back(forecast.interval_95_low_months);
      intervals.high.push_back(forecast.interval_95_high_months);
    }
    plot.x.categories.push_back(method_label(forecast));
  }
  plot.marks.emplace_back(std::move(intervals));
  return plot;
}

std::string remaining_life_table(const ForecastPanel::Answer& answer) {
  report::Table table({"method", ">tests", ">months left", ">80 %", ">95 %", "end of life", "~why"});
  for (const Forecast& forecast : answer.forecasts) {
    std::vector<std::string> cells{method_label(forecast), std::to_string(forecast.tests_used)};
    if (forecast.state == ForecastState::ok) {
      const auto range = [](double low, double high) { return number(low, 3) + " to " + number(high, 3); };
      for (const std::string& cell :
           {number(forecast.rul_months, 3), range(forecast.rul_p10_months, forecast.rul_p90_months),
            range(forecast.interval_95_low_months, forecast.interval_95_high_months), date(forecast.end_of_life_ns)})
        cells.push_back(cell);
    } else {
      cells.insert(cells.end(), {"–", "–", "–", report::words_of(name_of(forecast.state))});
    }
    cells.push_back(forecast.explanation);
    for (std::string& cell : cells) cell = report::escaped(cell);
    table.row_of_html(cells, &forecast == &answer.forecasts.front() ? "strong" : "");
  }
  return table.html();
}

/// A value over the date on which the seal would be replaced: as a curve, and at each candidate.
Plot over_dates(const ForecastQuestion& question, const std::vector<DecisionOption>& decision, const std::string& title,
                const auto& at_months, double DecisionOption::*value) {
  report::Line curve{.x = {}, .y = {}, .ink = Ink::muted, .label = "any date"};
  report::Scatter candidates{.x = {}, .y = {}, .ink = Ink::first, .label = "candidate", .radius = 4.0};
  report::Scatter cheapest{.x = {}, .y = {}, .ink = Ink::third, .label = "cheapest", .radius = 6.0};
  double latest = 0.0;
  for (const DecisionOption& option : decision) latest = std::max(latest, option.months);
  constexpr int kPoints = 200;
  for (int k = 0; k <= kPoints; ++k) {
    const double months = std::min(kBeyond * latest, kLongestView_months) * k / kPoints;
    curve.x.push_back(calendar_year(add_months(question.request.now, months)));
    curve.y.push_back(at_months(months));
  }
  for (std::size_t k = 0; k + 1 < decision.size(); ++k) {  // waiting has no date
    if (decision[k].months > kLongestView_months) continue;
    report::Scatter& mark = decision[k].cheapest ? cheapest : candidates;
    mark.x.push_back(calendar_year(UtcTime{decision[k].at_ns}));
    mark.y.push_back(decision[k].*value);
  }
  Plot plot{.title = title, .x = years(), .y = {.label = {}, .unit = "1"}, .marks = {}, .width = kHalf, .height = 240};
  plot.marks.emplace_back(std::move(curve));
  if (!candidates.x.empty()) plot.marks.emplace_back(std::move(candidates));
  if (!cheapest.x.empty()) plot.marks.emplace_back(std::move(cheapest));
  return plot;
}

double expected_cost(const ForecastQuestion& question, const PredictiveDistribution& remaining, double months) {
  const std::array<forecast::Candidate, 1> candidate{{{.label = {}, .months = months}}};
  const auto weighed = forecast::weigh_candidates(remaining, candidate, intervention_costs(question));
  return weighed ? weighed->rows.front().expected_cost : std::nan("");
}

std::string decision_plots(const ForecastQuestion& question, const PredictiveDistribution& remaining,
                           const std::vector<DecisionOption>& decision) {
  const Plot failure = over_dates(
      question, decision, "Probability of failure before the replacement",
      [&](double months) { return remaining.cdf(months); }, &DecisionOption::failure_probability);
  std::string html = "<div class=\"plots\"><div>" + report::to_svg(failure) + "</div>";
  if (decision.front().cost_known) {
    const std::string& currency = decision.front().currency;
    Plot cost = over_dates(
        question, decision, "Expected cost of the replacement" + (currency.empty() ? "" : ", " + currency),
        [&](double months) { return expected_cost(question, remaining, months); }, &DecisionOption::expected_cost);
    cost.marks.emplace_back(report::Reference{.at = decision.back().expected_cost, .label = "wait for failure"});
    html.append("<div>").append(report::to_svg(cost)).append("</div>");
  }
  return html + "</div>";
}

std::string decision_table(const std::vector<DecisionOption>& decision) {
  const bool priced = decision.front().cost_known;
  std::vector<std::string> headers{"replacement", "date", ">months from the last test", ">fails before"};
  if (priced)
    headers.push_back(">expected cost" + (decision.front().currency.empty() ? "" : ", " + decision.front().currency));
  if (priced) headers.emplace_back("");
  report::Table table(headers);
  for (const DecisionOption& option : decision) {
    std::vector<std::string> cells{option.label, date(option.at_ns), number(option.months, 3),
                                   report::percent_text(option.failure_probability)};
    if (priced) cells.push_back(number(option.expected_cost, 4));
    if (priced) cells.emplace_back(option.cheapest ? "cheapest" : "");
    for (std::string& cell : cells) cell = report::escaped(cell);
    table.row_of_html(cells, option.cheapest ? "strong" : "");
  }
  return table.html();
}

std::string cost_words(const ForecastQuestion& question) {
  if (!question.costs)
    return "What replacements cost is not known: give --costs, or `costs` of the asset's site in the configuration, "
           "and "
           "expected costs stand beside the probabilities.";
  const SiteCosts& costs = *question.costs;
  std::string text =
      "Costs: planned " + number(costs.planned, 3) + ", after a failure " + number(costs.after_failure, 3);
  text += ", a month with a failed valve " + number(costs.failed_month, 3) + ", a month of seal life thrown away " +
          number(costs.unused_month, 3);
  text += "; waiting for the failure counts " + number(question.months_to_vessel, 3) +
          " months until a vessel comes. Formula: docs/forecast.md, Decision.";
  return text;
}

std::string decision_part(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
                          const std::vector<DecisionOption>& decision) {
  if (decision.empty())
    return report::section("Decision", report::paragraph("Without a forecast no date can be weighed."));
  return report::section("Decision", decision_table(decision) +
                                         decision_plots(question, *answer.distributions.front(), decision) +
                                         report::paragraph(cost_words(question), "muted"));
}

void list_samples(const std::vector<ConditionSample>& samples, const std::string& why, std::string& list) {
  for (const ConditionSample& sample : samples)
    list.append("<li>").append(report::escaped(format_date(sample.time) + ", condition " +
                                               forecast::as_condition(sample.condition) + ": " + why));
}

std::string reasons_part(const ForecastQuestion& question, const ForecastPanel::Answer& answer) {
  std::string list = "<ul><li>" + report::escaped(method_label(answer.forecasts.front()) +
                                                  " is in charge: " + answer.forecasts.front().explanation);
  if (answer.windows_disagree) list.append("<li>Windows disagree: ").append(report::escaped(answer.disagreement));
  if (question.without_error > 0)
    list.append("<li>Standard errors are not known of " + std::to_string(question.without_error) + " of " +
                std::to_string(question.request.history.size()) + " tests; how the tests scatter stands for them.");
  list_samples(question.vague, "left out as too vague", list);
  list_samples(answer.left_out, "left out as an isolated outlier", list);
  return report::section("Reasons", list + "</ul>");
}

std::string headline(const Forecast& forecast) {
  if (forecast.state != ForecastState::ok)
    return report::words_of(name_of(forecast.state)) + ": " + forecast.explanation;
  return forecast::in_months(forecast.rul_months) + " left (80 %: " + forecast::in_months(forecast.rul_p10_months) +
         " to " + forecast::in_months(forecast.rul_p90_months) + "), end of life about " +
         date(forecast.end_of_life_ns);
}

std::string head(const ForecastQuestion& question, const ForecastPanel::Answer& answer) {
  const std::string of = question.asset_id.empty() ? "" : " of " + question.asset_id;
  const Forecast& in_charge = answer.forecasts.front();
  const char* colour = in_charge.state == ForecastState::ok               ? "good"
                       : in_charge.state == ForecastState::past_threshold ? "bad"
                                                                          : "warn";
  std::string html = "<h1>Remaining life of the piston seal" + report::escaped(of) + "</h1>";
  html.append(report::paragraph(std::to_string(question.tests) + " tests, " + format_date(question.first) + " to " +
                                    format_date(question.last) + "; the seal fails at " +
                                    report::percent_text(question.request.threshold) + " of its elastic modulus.",
                                "muted"));
  html.append("<div class=\"banner ").append(colour).append("\"><p class=\"verdict\">");
  return html.append(report::escaped(headline(in_charge))).append("</p></div>");
}

}  // namespace

Result<std::string> forecast_page(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
                                  const std::vector<DecisionOption>& decision) {
  const auto in_charge = forecast::make_forecaster(question.forecasters.front());
  if (!in_charge) return fail(in_charge.error());
  forecast::ForecastRequest request = question.request;
  request.history = answer.used;
  std::vector<ConditionForecast> conditions;
  if (answer.forecasts.front().state == ForecastState::ok)
    conditions = (*in_charge)->predict_conditions(request, months_ahead(request.now, view_months(answer)));
  std::string body = head(question, answer);
  body += report::to_svg(course(question, answer, conditions));
  body += report::section("Remaining life", remaining_life_table(answer) + report::to_svg(side_by_side(answer)));
  body += decision_part(question, answer, decision);
  body += reasons_part(question, answer);
  return report::html_page("Remaining life of the piston seal", body);
}

}  // namespace sealwatch::cli
