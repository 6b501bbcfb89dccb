#include "services/cli/forecast_decision.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/cli/terminal.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::cli {
namespace {

using forecast::ForecastPanel;
using forecast::PredictiveDistribution;
using report::Ink;
using report::Plot;

constexpr int kHalf = 480;
constexpr double kMonthsAYear = 12.0;
constexpr double kLongestView_months = 240.0;
constexpr double kBeyond = 1.15;  // a little past the last date of interest

report::Axis years() { return {.label = "year", .unit = "1"}; }

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
                                   text::in_percent(option.failure_probability)};
    if (priced) cells.push_back(number(option.expected_cost, 4));
    if (priced) cells.emplace_back(option.cheapest ? "cheapest" : "");
    for (std::string& cell : cells) cell = report::escaped(cell);
    table.row_of_html(cells, option.cheapest ? "strong" : "");
  }
  return table.html();
}

std::string cost_words(const ForecastQuestion& question) {
  if (!question.costs)
    return "Expected costs are not shown because replacement costs are unknown. Give --costs, or set the costs of the "
           "asset's site in the configuration.";
  const SiteCosts& costs = *question.costs;
  std::string text =
      "Costs: planned " + number(costs.planned, 3) + ", after a failure " + number(costs.after_failure, 3);
  text += ", a month with a failed valve " + number(costs.failed_month, 3) + ", a month of unused life " +
          number(costs.unused_month, 3);
  text += "; waiting for the failure counts " + number(question.months_to_vessel, 3) +
          " months until a vessel comes. Formula: docs/forecast.md, Decision.";
  return text;
}

/// "cheapest: summer 2027", or what else there is to see.
std::string inside(const std::vector<DecisionOption>& decision) {
  const auto cheapest = std::ranges::find(decision, true, &DecisionOption::cheapest);
  return cheapest == decision.end() ? "probability of failure before each date" : "cheapest: " + cheapest->label;
}

}  // namespace

std::string forecast_decision_part(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
                                   const std::vector<DecisionOption>& decision) {
  if (decision.empty())
    return report::section("Decision", report::paragraph("Without a forecast, dates cannot be compared."));
  return report::folded_section("Decision", inside(decision),
                                decision_table(decision) +
                                    decision_plots(question, *answer.distributions.front(), decision) +
                                    report::paragraph(cost_words(question), "muted"),
                                report::Paper::printed);
}

double calendar_year(UtcTime time) {
  static const UtcTime kEpoch{};
  return 1970.0 + months_between(kEpoch, time) / kMonthsAYear;
}

}  // namespace sealwatch::cli
