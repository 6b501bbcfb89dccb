#include "services/cli/forecast_page.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "sealwatch/core/file.hpp"
#include "sealwatch/forecast/normal.hpp"
#include "sealwatch/forecast/student_t.hpp"
#include "services/cli/forecast_decision.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using forecast::ConditionForecast;
using forecast::ConditionSample;
using forecast::ForecastPanel;
using report::Ink;
using report::Plot;

constexpr int kWide = 980;
constexpr int kNarrow = 350;  // as a phone shows it
constexpr double kShortestView_months = 12.0;
constexpr double kLongestView_months = 240.0;
constexpr double kBeyond = 1.15;  // a little past the last date of interest
constexpr double kPercent = 100.0;
constexpr double kNormal97_5 = 1.959963984540054;

double quantile_factor(int degrees_of_freedom, double probability) {
  return degrees_of_freedom > 0 ? forecast::student_t_quantile(probability, degrees_of_freedom)
                                : forecast::normal_quantile(probability);
}

/// How far ahead is looked: past the latest date of the primary forecast, and past the last campaign before that.
double view_months(const ForecastPanel::Answer& answer) {
  const Forecast& primary = answer.forecasts.front();
  const double latest = primary.state == ForecastState::ok ? primary.interval_95_high_months : 0.0;
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
    scatter.y.push_back(kPercent * sample.condition);
  }
  return scatter;
}

report::Intervals intervals_of(const std::vector<ConditionSample>& samples) {
  report::Intervals intervals{
      .x = {}, .y = {}, .low = {}, .high = {}, .ink = Ink::first, .label = "test, 95 % interval"};
  for (const ConditionSample& sample : samples) {
    intervals.x.push_back(calendar_year(sample.time));
    intervals.y.push_back(kPercent * sample.condition);
    intervals.low.push_back(kPercent * (sample.condition - kNormal97_5 * sample.condition_std));
    intervals.high.push_back(kPercent * (sample.condition + kNormal97_5 * sample.condition_std));
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
  report::Line middle{.x = {}, .y = {}, .ink = Ink::second};
  report::Band band{.x = {}, .low = {}, .high = {}, .ink = Ink::second, .label = "forecast, 95 % interval"};
  for (const ConditionForecast& at : conditions) {
    const double half = quantile_factor(at.degrees_of_freedom, 0.975) * at.condition_std;
    if (at.condition + half < threshold - 0.1) break;  // long failed: nothing to see there
    band.x.push_back(calendar_year(at.time));
    band.low.push_back(kPercent * (at.condition - half));
    band.high.push_back(kPercent * (at.condition + half));
    middle.x.push_back(band.x.back());
    middle.y.push_back(kPercent * at.condition);
  }
  plot.marks.emplace_back(std::move(band));
  plot.marks.emplace_back(std::move(middle));
}

/// The day by which something has to be done, and the campaigns that are in view.
void add_dates(const ForecastQuestion& question, Plot& plot) {
  const auto add = [&plot](UtcTime day, const std::string& label, Ink ink) {
    const double at = calendar_year(day);
    if (at >= plot.x.range->first && at <= plot.x.range->second)
      plot.marks.emplace_back(report::Reference{.at = at, .vertical = true, .ink = ink, .label = label});
  };
  if (question.advice && question.advice->latest_by_known) {
    const UtcTime day{question.advice->latest_by_ns};
    add(day, "act by " + format_date(day), Ink::bad);
  }
  for (const forecast::FailureHorizon& campaign : question.request.horizons)
    if (campaign.before > question.request.now) add(campaign.before, campaign.label, Ink::third);
}

Plot course(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
            const std::vector<ConditionForecast>& conditions, int width) {
  const double threshold = question.request.threshold;
  Plot plot{.title = width < kWide ? "Condition (new: 100)"
                                   : "Condition of the " + question.part + ", index derived from " +
                                         question.worn_parameter + " (new: 100)",
            .x = {.label = "year", .unit = "1", .range = view_of(question, conditions), .whole = true},
            .y = {.label = "condition", .unit = "%"},
            .marks = {},
            .width = width,
            .height = 315};
  if (!conditions.empty()) add_forecast_band(conditions, threshold, plot);
  plot.marks.emplace_back(intervals_of(answer.used));
  plot.marks.emplace_back(tests_of(answer.used, Ink::first, ""));
  if (!answer.left_out.empty()) plot.marks.emplace_back(tests_of(answer.left_out, Ink::bad, "left out"));
  plot.marks.emplace_back(report::Reference{.at = kPercent * threshold,
                                            .ink = Ink::bad,
                                            .label = "failed below " + text::percent_text(threshold),
                                            .named_at_left = true});
  const Forecast& primary = answer.forecasts.front();
  if (primary.state == ForecastState::ok) {
    const auto year = [&](double months) { return calendar_year(add_months(question.request.now, months)); };
    plot.marks.emplace_back(report::Line{.x = {year(primary.rul_p10_months), year(primary.rul_p90_months)},
                                         .y = {kPercent * threshold, kPercent * threshold},
                                         .ink = Ink::bad,
                                         .label = "end of life, 80 % interval",
                                         .width = 5.0});
  }
  add_dates(question, plot);
  return plot;
}

std::string method_label(const Forecast& forecast) {
  return text::in_words(forecast.method) + " " + std::to_string(forecast.window_months);
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

/// Dates and percentages stay on one line.
std::string in_lines(const std::string& text) {
  std::string html = report::unbroken(report::escaped(text));
  for (std::size_t at = 0; (at = html.find(" %", at)) != std::string::npos;) html.replace(at, 1, "\u00a0");
  return html;
}

/// What stands behind the methods' names.
std::string methods_note(const ForecastPanel::Answer& answer) {
  std::string list;
  const auto any = [&](std::string_view method) {
    return std::ranges::any_of(answer.forecasts, [&](const Forecast& forecast) { return forecast.method == method; });
  };
  for (const auto& [method, meaning] : std::initializer_list<std::pair<std::string_view, std::string_view>>{
           {"state_space", "state space: the law of ageing, followed through all tests"},
           {"fleet", "fleet: the same, assuming that it belongs to a known population"},
           {"ols",
            "ols: a straight line through the tests of as many months as its name says; ageing is curved, so its "
            "interval is "
            "too narrow"},
           {"ols_drift", "ols drift: the same line, with a slope that may change"},
           {"ols_log_time", "ols log time: a straight line over the logarithm of time"},
           {"average", "average: the mean of several methods, weighted by their past accuracy for this part"}})
    if (any(method)) list.append("<li>").append(meaning);
  return report::paragraph(
             "Months count from the last test. The advice rests on the forecaster in bold; the others are for "
             "comparison.",
             "small muted") +
         "<ul class=\"small muted\">" + list + "</ul>";
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
      cells.insert(cells.end(), {"–", "–", "–", text::in_words(name_of(forecast.state))});
    }
    cells.push_back(forecast.explanation);
    for (std::string& cell : cells) cell = report::escaped(cell);
    table.row_of_html(cells, &forecast == &answer.forecasts.front() ? "strong" : "");
  }
  return table.html();
}

void list_samples(const std::vector<ConditionSample>& samples, const std::string& why, std::string& list) {
  for (const ConditionSample& sample : samples)
    list.append("<li>").append(
        in_lines(format_date(sample.time) + ", condition " + text::as_condition(sample.condition) + ": " + why));
}

/// Whether the services' advice gives this among its reasons.
bool says(const std::optional<Advisory>& advice, const std::string& explanation) {
  return advice && std::ranges::any_of(advice->reasons, [&](const std::string& reason) {
           return reason.find(explanation) != std::string::npos;
         });
}

std::string reasons_part(const ForecastQuestion& question, const ForecastPanel::Answer& answer) {
  std::string list = "<ul>";
  if (question.advice)
    for (const std::string& reason : question.advice->reasons) list.append("<li>").append(in_lines(reason));
  const Forecast& primary = answer.forecasts.front();
  if (!says(question.advice, primary.explanation))
    list += "<li>" + in_lines(method_label(primary) + " is the primary forecaster: " + primary.explanation);
  if (answer.windows_disagree) list.append("<li>Windows disagree: ").append(in_lines(answer.disagreement));
  if (question.without_error > 0)
    list.append("<li>Standard errors are unknown for " + std::to_string(question.without_error) + " of " +
                std::to_string(question.request.history.size()) + " tests; the scatter of the tests replaces them.");
  list_samples(question.vague, "left out as too vague", list);
  list_samples(answer.left_out, "left out as an isolated outlier", list);
  for (const TestNotCounted& test : question.not_counted)
    list.append("<li>").append(in_lines(format_date(test.time) + ", left out by the services: " + test.why));
  return report::folded_section("Reasons", "what the advice and the forecast rest on, what was left out",
                                list + "</ul>", report::Paper::printed);
}

/// "37 months left (80 %: 35 to 39), end of life about 2021-04-15", or why there is no such forecast.
std::string outlook(const Forecast& forecast) {
  if (forecast.state != ForecastState::ok) return text::in_words(name_of(forecast.state)) + ": " + forecast.explanation;
  return text::in_months(forecast.rul_months) +
         " left (80 %: " + text::range_in_months(forecast.rul_p10_months, forecast.rul_p90_months) +
         "), end of life about " + date(forecast.end_of_life_ns);
}

/// The colour of what is to be done; of the forecast alone where the services gave no advice.
const char* colour_of(const std::optional<Advisory>& advice, ForecastState state) {
  if (!advice) {
    if (state == ForecastState::past_threshold) return "bad";
    return state == ForecastState::ok ? "" : "warn";
  }
  if (advice->priority >= AdvisoryPriority::high) return "bad";
  return advice->priority >= AdvisoryPriority::low ? "warn" : "good";
}

/// What to do, and why.
struct Headline {
  std::string action, why;
};

/// The recommendation begins with what to do; the sentences after it say why.
Headline headline_of(const Advisory& advice) {
  const std::string& text = advice.recommendation;
  const std::size_t end = std::min(text.find(". "), text.size());
  Headline headline{.action = text.substr(0, std::min(end + 1, text.size())),
                    .why = text.substr(std::min(end + 2, text.size()))};
  headline.why +=
      std::string(headline.why.empty() ? "" : " ").append("Priority: ").append(name_of(advice.priority)).append(".");
  if (advice.state == AdvisoryState::acknowledged) headline.why += " Acknowledged by " + advice.acknowledged_by + ".";
  return headline;
}

void add_figure(const std::string& value, const std::string& meaning, std::string& html) {
  html.append("<div><b>").append(report::unbroken(report::escaped(value)));
  html.append("</b><span>").append(report::unbroken(report::escaped(meaning))).append("</span></div>\n");
}

/// By when something has to be done, the condition now, what is left and when it ends.
std::string figures(const ForecastQuestion& question, const ForecastPanel::Answer& answer) {
  const Forecast& primary = answer.forecasts.front();
  const auto day = [&](double months) { return format_date(add_months(question.request.now, months)); };
  std::string html = "<div class=\"figures\">\n";
  if (question.advice && question.advice->latest_by_known)
    add_figure(date(question.advice->latest_by_ns), "act by", html);
  if (!answer.used.empty())
    add_figure(text::condition_in_percent(answer.used.back().condition),
               "condition of the " + question.part + "; failed below " + text::percent_text(question.request.threshold),
               html);
  if (primary.state == ForecastState::ok) {
    add_figure(text::in_months(primary.rul_months),
               "left; 80 %: " + number(primary.rul_p10_months, 3) + " to " + number(primary.rul_p90_months, 3), html);
    add_figure(date(primary.end_of_life_ns),
               "end of life; 80 %: " + day(primary.rul_p10_months) + " to " + day(primary.rul_p90_months), html);
  }
  return html.append("</div>\n");
}

/// " Cheapest of the choices compared below: 2031-06-01."; "" where costs do not tell.
std::string cheapest_in_words(const std::vector<DecisionOption>& decision) {
  const auto cheapest = std::ranges::find(decision, true, &DecisionOption::cheapest);
  return cheapest == decision.end() ? "" : " Cheapest of the choices compared below: " + cheapest->label + ".";
}

/// What follows where no service has given advice: from the forecast alone.
Headline headline_without_advice(const ForecastQuestion& question, const Forecast& primary,
                                 const std::vector<DecisionOption>& decision) {
  const auto day = [&](double months) { return format_date(add_months(question.request.now, months)); };
  const std::string why = outlook(primary) + ".";
  switch (primary.state) {
    case ForecastState::ok:
      return {"Book a vessel by " + day(primary.rul_p10_months - question.months_to_vessel) + " to replace the " +
                  question.part + " before " + day(primary.rul_p10_months) + ".",
              "By " + day(primary.rul_p10_months) + " one in ten would have failed; a vessel takes " +
                  text::in_months(question.months_to_vessel) + "." + cheapest_in_words(decision) + " " + why +
                  " The advisory of the services may differ: it needs confirmation by several tests."};
    case ForecastState::past_threshold:
      return {"Replace the " + question.part + " now: it has reached its limit.",
              why + " Follow the procedure for a valve that may not close."};
    case ForecastState::no_significant_trend:
      return {"No action needed: the condition does not fall beyond the scatter of the tests.",
              why + " Continue with monthly tests."};
    case ForecastState::insufficient_history:
      break;
  }
  return {"Continue with monthly tests: the history is too short for a forecast.", why};
}

/// "Piston seal"
std::string heading_of(std::string part) {
  if (!part.empty()) part.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(part.front())));
  return part;
}

std::string head(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
                 const std::vector<DecisionOption>& decision) {
  const std::string of = question.asset_id.empty() ? "" : " of " + question.asset_id;
  const Forecast& primary = answer.forecasts.front();
  const Headline headline =
      question.advice ? headline_of(*question.advice) : headline_without_advice(question, primary, decision);
  std::string html = "<h1>" + report::escaped(heading_of(question.part)) + report::escaped(of) + "</h1>";
  html.append("<p class=\"muted small\">").append(in_lines(history_words(question))).append("</p>");
  html.append("<div class=\"banner ").append(colour_of(question.advice, primary.state));
  html.append("\"><p class=\"verdict\">").append(in_lines(headline.action));
  html.append("</p><p>").append(in_lines(headline.why)).append("</p></div>");
  if (question.tests > 0) html += figures(question, answer);
  return html;
}

}  // namespace

Result<std::string> forecast_body(const ForecastQuestion& question, const ForecastPanel::Answer& answer,
                                  const std::vector<DecisionOption>& decision) {
  if (question.tests == 0) return head(question, answer, decision) + forecast_decision_part(question, answer, decision);
  const auto primary = forecast::make_forecaster(question.forecasters.front());
  if (!primary) return fail(primary.error());
  forecast::ForecastRequest request = question.request;
  request.history = answer.used;
  std::vector<ConditionForecast> conditions;
  if (answer.forecasts.front().state == ForecastState::ok)
    conditions = (*primary)->predict_conditions(request, months_ahead(request.now, view_months(answer)));
  std::string body = head(question, answer, decision);
  // Drawn for either width: scaled down, its letters could not be read on a phone.
  for (const auto& [name, width] : {std::pair{"wide", kWide}, {"narrow", kNarrow}})
    body += std::string("<div class=\"") + name + "\">" + report::to_svg(course(question, answer, conditions, width)) +
            "</div>\n";
  body += report::folded_section("Remaining life", "all methods side by side",
                                 remaining_life_table(answer) + methods_note(answer) + "<div class=\"scroll\">" +
                                     report::to_svg(side_by_side(answer)) + "</div>");
  body += forecast_decision_part(question, answer, decision);
  body += reasons_part(question, answer);
  return body;
}

Status write_forecast_page(const std::string& file, const Result<std::string>& body) {
  if (!body) return fail(body.error());
  return write_file(file, report::html_page("What to do, by when, why", *body));
}

Status write_forecasts(const std::string& file, const std::vector<ForecastQuestion>& questions) {
  std::string bodies;
  for (const ForecastQuestion& question : questions) {
    const auto answer = answer_of(question);
    if (!answer) return fail(answer.error());
    const auto body = forecast_body(question, *answer, decision_of(question, *answer));
    if (!body) return fail(body.error());
    bodies += *body;
  }
  return write_forecast_page(file, bodies);
}

}  // namespace sealwatch::cli
