#include "services/cli/forecast_text.hpp"

#include <algorithm>

#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"
#include "services/common/report/readable.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kIndent = 19;  ///< where the figures of a screen begin
constexpr double kCertain = 0.9995;  ///< shown as 100.0 %

std::string forecast_row(const Forecast& forecast, bool in_charge) {
  char line[200];
  const std::string method = forecast.method + (in_charge ? " *" : "");
  std::snprintf(line, sizeof line, "                   %-14s %2d months  ", method.c_str(), forecast.window_months);
  if (forecast.state != ForecastState::ok)
    return line + report::words_of(name_of(forecast.state)) + ": " + forecast.explanation + "\n";
  char figures[200];
  std::snprintf(figures, sizeof figures, "%6.1f     %6.1f .. %-6.1f   %5.1f / %5.1f / %5.1f   %s\n",
                forecast.rul_months, forecast.interval_95_low_months, forecast.interval_95_high_months,
                forecast.rul_p10_months, forecast.rul_p50_months, forecast.rul_p90_months,
                date(forecast.end_of_life_ns).c_str());
  return std::string(line) + figures;
}

/// A heading on the first line, blanks on the others.
std::string lead(const std::string& heading, bool first) {
  return first ? padded("  " + heading, kIndent) : std::string(kIndent, ' ');
}

/// Columns of text, each as wide as its longest cell; the first row carries the heading.
std::string aligned(const std::string& heading, const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t column = 0; column < row.size(); ++column)
      widths[column] = std::max(widths[column], letters(row[column]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = lead(heading, text.empty());
    for (std::size_t column = 0; column < row.size(); ++column)
      line.append(padded(row[column], widths[column])).append("  ");
    text.append(line.substr(0, line.find_last_not_of(' ') + 1)).append("\n");
  }
  return text;
}

std::string failure_chart(const std::vector<FailureProbability>& probabilities) {
  std::vector<std::vector<std::string>> rows;
  for (const FailureProbability& item : probabilities) {
    const std::string day = date(item.before_ns);
    const std::string before = item.label == day ? day : item.label + ", " + day;
    rows.push_back({"before " + before + ": " + percent(item.probability), bar(item.probability)});
    if (item.probability > kCertain) break;  // later ones are certain too
  }
  return aligned("P(failure)", rows);
}

}  // namespace

std::string forecast_table(const std::vector<Forecast>& forecasts) {
  if (forecasts.empty()) return {};
  std::string text =
      "  remaining life   method         window     forecast   95 % interval      P10 /   P50 /   P90   end of life\n";
  for (const Forecast& forecast : forecasts) text += forecast_row(forecast, &forecast == &forecasts.front());
  text += "                   (months from the last test; * in charge)\n";
  return text + failure_chart(forecasts.front().failure_probability);
}

std::string decision_chart(const std::vector<DecisionOption>& decision) {
  double dearest = 0.0;
  for (const DecisionOption& option : decision) {
    if (!option.cost_known) return {};
    dearest = std::max(dearest, option.expected_cost);
  }
  if (decision.empty()) return {};
  std::vector<std::vector<std::string>> rows{
      {"replacement", "", "", "fails before", "", "expected cost, " + decision.front().currency}};
  for (const DecisionOption& option : decision)
    rows.push_back({option.label, date(option.at_ns), percent(option.failure_probability),
                    bar(option.failure_probability), number(option.expected_cost, 3),
                    bar(dearest > 0.0 ? option.expected_cost / dearest : 0.0), option.cheapest ? "cheapest" : ""});
  return aligned("decision", rows);
}

}  // namespace sealwatch::cli
