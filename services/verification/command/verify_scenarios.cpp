#include "services/verification/command/verify_scenarios.hpp"

#include <functional>
#include <nlohmann/json.hpp>

#include "services/cli/terminal.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"
#include "services/verification/command/verify_results.hpp"

namespace sealwatch::cli {
namespace {

using verification::Mean;
using verification::MethodSummary;
using verification::Share;

constexpr double kNormal97_5 = 1.959963984540054;
constexpr std::size_t k24 = 1, k12 = 2;  // of kHorizons_months

/// A value with its 95 % interval; unknown where nothing answered.
struct Figure {
  bool known = false;
  double value = 0.0, low = 0.0, high = 0.0;
};

Figure figure(const Share& share) {
  return {share.of > 0, 100.0 * share.value(), 100.0 * share.interval.low, 100.0 * share.interval.high};
}

Figure figure(const Mean& mean, double factor = 1.0) {
  const double half = kNormal97_5 * mean.standard_error;
  return {mean.known, factor * mean.value, factor * (mean.value - half), factor * (mean.value + half)};
}

struct Column {
  const char* heading;
  const char* key;
  int decimals;
  std::function<Figure(const MethodSummary&)> figure;
};

const std::vector<Column>& columns() {
  static const std::vector<Column> all{
      {"reliable %", "reliable_percent", 0, [](const MethodSummary& m) { return figure(m.reliable); }},
      {"lead time", "antecedence_months", 0, [](const MethodSummary& m) { return figure(m.antecedence); }},
      {"last year", "last_year_error_months", 2, [](const MethodSummary& m) { return figure(m.last_year_error); }},
      {"24 before", "error_24_months_before_months", 2,
       [](const MethodSummary& m) { return figure(m.horizons[k24].absolute_error); }},
      {"80 % at 24", "coverage_80_24_months_before_percent", 0,
       [](const MethodSummary& m) { return figure(m.horizons[k24].coverage[1]); }},
      {"80 % at 12", "coverage_80_12_months_before_percent", 0,
       [](const MethodSummary& m) { return figure(m.horizons[k12].coverage[1]); }},
      {"before P10 %", "failed_before_p10_percent", 0,
       [](const MethodSummary& m) { return figure(m.before_p10, 100.0); }},
      {"a-l mass", "alpha_lambda_mass", 2, [](const MethodSummary& m) { return figure(m.alpha_lambda_mass); }}};
  return all;
}

std::string cell(const Column& column, const MethodSummary& method) {
  const Figure f = column.figure(method);
  if (!f.known) return "-";
  return text::format("{0:.{3}f} ({1:.{3}f} to {2:.{3}f})", f.value, f.low, f.high, column.decimals);
}

/// "240" says nothing of a forecaster that takes the whole life.
std::string label_of(const MethodSummary& method) {
  const std::size_t whole_life = method.label.find(" 240");
  return whole_life == std::string::npos ? method.label : method.label.substr(0, whole_life);
}

int failed_lives(const verification::Summary& summary) { return summary.lives - summary.censored; }

/// Error in the last year of each method, scenario by scenario.
report::Plot last_year_plot(const std::vector<ScenarioSummary>& scenarios, std::size_t method) {
  report::Intervals marks{.x = {}, .y = {}, .low = {}, .high = {}, .ink = report::Ink::first, .label = {}};
  report::Plot plot{.title = label_of(scenarios.front().summary.methods[method]),
                    .x = {},
                    .y = {.label = "months", .unit = "1"},
                    .marks = {},
                    .width = 980,
                    .height = 150,
                    .legend = false};
  for (const ScenarioSummary& one : scenarios) {
    const Figure f = figure(one.summary.methods[method].last_year_error);
    const auto place = static_cast<double>(plot.x.categories.size());
    plot.x.categories.push_back(text::in_words(one.scenario));
    if (!f.known) continue;
    marks.x.push_back(place);
    marks.y.push_back(f.value);
    marks.low.push_back(f.low);
    marks.high.push_back(f.high);
  }
  plot.marks.emplace_back(std::move(marks));
  return plot;
}

constexpr const char* kLegend =
    "Months; 95 % intervals in brackets. Last year: mean error over it; 24 before: mean error 24 months before "
    "failure; "
    "80 % at 24, 12: coverage of the 80 % interval then, in %; before P10: share of the forecasts whose P10 the "
    "failure "
    "came before, in %; a-l mass: probability given to 20 % about the truth at half of the way. Changes are scored "
    "from "
    "half a year after them. Definitions: docs/reference/metrics.md, scenarios: docs/records/verification.md.";

}  // namespace

std::string scenario_table(const std::vector<ScenarioSummary>& scenarios) {
  static constexpr const char* kRow = "{:14} {:>5} {:16}";
  static constexpr const char* kCell = " {:>20}";
  std::string text = text::format(kRow, "scenario", "lives", "method");
  for (const Column& column : columns()) text += text::format(kCell, column.heading);
  text += "\n";
  for (const ScenarioSummary& one : scenarios)
    for (const MethodSummary& method : one.summary.methods) {
      const bool first = &method == &one.summary.methods.front();
      text += text::format(kRow, first ? one.scenario : "", first ? std::to_string(failed_lives(one.summary)) : "",
                           label_of(method));
      for (const Column& column : columns()) text += text::format(kCell, cell(column, method));
      text += "\n";
    }
  return text + wrapped(kLegend, 110, 0) + "\n";
}

std::string scenario_page(const std::vector<ScenarioSummary>& scenarios) {
  std::vector<std::string> headers{"scenario", ">lives", "method"};
  for (const Column& column : columns()) headers.push_back(std::string(">").append(column.heading));
  report::Table table(headers);
  for (const ScenarioSummary& one : scenarios)
    for (const MethodSummary& method : one.summary.methods) {
      const bool first = &method == &one.summary.methods.front();
      std::vector<std::string> cells{first ? text::in_words(one.scenario) : "",
                                     first ? std::to_string(failed_lives(one.summary)) : "", label_of(method)};
      for (const Column& column : columns()) cells.push_back(cell(column, method));
      table.row(cells);
    }
  std::string plots = "<div class=\"plots\">";
  for (std::size_t method = 0; method < scenarios.front().summary.methods.size(); ++method)
    plots.append("<div>").append(report::to_svg(last_year_plot(scenarios, method))).append("</div>");
  return report::html_page("Forecasters under scenarios",
                           "<h1>Forecasters under scenarios</h1>" +
                               report::section("One table", table.html() + report::paragraph(kLegend, "muted")) +
                               report::section("Mean error in the last year, months", plots + "</div>"));
}

std::string scenario_json(const std::vector<ScenarioSummary>& scenarios) {
  using Json = nlohmann::ordered_json;
  Json json = {{"schema", "sealwatch.verification_scenarios/1"}, {"scenarios", Json::array()}};
  for (const ScenarioSummary& one : scenarios) {
    Json entry = {{"scenario", one.scenario},
                  {"lives", one.summary.lives},
                  {"censored_lives", one.summary.censored},
                  {"unusable_tests", one.summary.unusable_tests},
                  {"methods", Json::array()}};
    for (const MethodSummary& method : one.summary.methods) {
      Json row = {{"method", method.label}};
      for (const Column& column : columns()) {
        const Figure f = column.figure(method);
        row[column.key] = f.known ? Json{{"value", f.value}, {"interval_95", {f.low, f.high}}} : Json(nullptr);
      }
      entry["methods"].push_back(std::move(row));
    }
    json["scenarios"].push_back(std::move(entry));
  }
  return json.dump(1) + "\n";
}

}  // namespace sealwatch::cli
