#include "services/cli/forecast_text.hpp"

#include <algorithm>
#include <cmath>

#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kIndent = 19;  ///< where the figures of a screen begin
constexpr double kCertain = 0.9995;  ///< shown as 100.0 %

std::string forecast_row(const Forecast& forecast, bool in_charge) {
  const std::string line =
      text::format("{:19}{:14} {:2} months  ", "", forecast.method + (in_charge ? " *" : ""), forecast.window_months);
  if (forecast.state != ForecastState::ok)
    return line + text::in_words(name_of(forecast.state)) + ": " + forecast.explanation + "\n";
  return line + text::format("{:6.1f}     {:6.1f} .. {:<6.1f}   {:5.1f} / {:5.1f} / {:5.1f}   {}\n",
                             forecast.rul_months, forecast.interval_95_low_months, forecast.interval_95_high_months,
                             forecast.rul_p10_months, forecast.rul_p50_months, forecast.rul_p90_months,
                             date(forecast.end_of_life_ns));
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
    rows.push_back({"before " + before + ": " + text::in_percent(item.probability), bar(item.probability)});
    if (item.probability > kCertain) break;  // later ones are certain too
  }
  return aligned("P(failure)", rows);
}

/// P(at most k of n) when each comes true with `probability`: forecasts are scored three months apart, so one after the
/// other.
double at_most(int k, int n, double probability) {
  double term = std::pow(1.0 - probability, n);
  double sum = term;
  for (int i = 1; i <= k; ++i) {
    term *= (n - i + 1.0) / i * probability / (1.0 - probability);
    sum += term;
  }
  return sum;
}

constexpr int kFewestToJudge = 5;
constexpr double kHardlyChance = 0.05;
constexpr double kUnremarkable = 0.20;  // of sound forecasters as few or fewer come true this often

std::string verdict_on(int of_80, int of_95, int n) {
  if (n < kFewestToJudge) return {};
  const double chance = std::min(at_most(of_80, n, 0.80), at_most(of_95, n, 0.95));
  if (chance < kHardlyChance) return ": too few, the intervals are too narrow";
  return chance < kUnremarkable ? ": few, but that may be chance" : ": as expected";
}

}  // namespace

std::string forecast_table(const std::vector<Forecast>& forecasts) {
  if (forecasts.empty()) return {};
  std::string text =
      "  remaining life   method         window     forecast   95 % interval      P10 /   P50 /   P90   end of life\n";
  for (const Forecast& forecast : forecasts) text += forecast_row(forecast, &forecast == &forecasts.front());
  const auto is_line = [](const Forecast& forecast) {
    return forecast.method == "ols" && forecast.state == ForecastState::ok;
  };
  const bool lines = std::ranges::any_of(forecasts, is_line);
  text += std::string("                   (months from the last test; * primary") +
          (lines ? "; ols: a straight line; ageing is curved, so its interval is too narrow)\n" : ")\n");
  return text + failure_chart(forecasts.front().failure_probability);
}

std::string scored_line(const RemainingLife& life) {
  constexpr double kDoubtful = 0.5;  // probability that the forecaster has not drifted
  const int n = life.scored_forecasts;
  if (n <= 0) return {};
  const int of_80 = static_cast<int>(std::lround(life.coverage_80 * n));
  const int of_95 = static_cast<int>(std::lround(life.coverage_95 * n));
  const bool drifted = life.confidence < kDoubtful;
  return "  scored           of the last " + count_of(static_cast<std::size_t>(n), "forecast") + " (3 months ahead), " +
         std::to_string(of_80) + " held within their 80 % interval, " + std::to_string(of_95) + " within 95 %" +
         (drifted ? "; the forecaster has probably drifted" : verdict_on(of_80, of_95, n)) + "\n";
}

std::string decision_chart(const std::vector<DecisionOption>& decision) {
  double dearest = 0.0;
  for (const DecisionOption& option : decision) {
    if (!option.cost_known) return {};
    dearest = std::max(dearest, option.expected_cost);
  }
  if (decision.empty()) return {};
  const std::string& currency = decision.front().currency;
  std::vector<std::vector<std::string>> rows{
      {"replacement", "", "", "fails before", "", "expected cost" + (currency.empty() ? "" : ", " + currency)}};
  for (const DecisionOption& option : decision)
    rows.push_back({option.label, date(option.at_ns), text::in_percent(option.failure_probability),
                    bar(option.failure_probability), number(option.expected_cost, 3),
                    bar(dearest > 0.0 ? option.expected_cost / dearest : 0.0), option.cheapest ? "cheapest" : ""});
  return aligned("decision", rows);
}

}  // namespace sealwatch::cli
