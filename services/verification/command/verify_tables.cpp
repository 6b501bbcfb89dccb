#include "services/verification/command/verify_tables.hpp"

#include "services/cli/terminal.hpp"
#include "services/common/report/page.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::cli {
namespace {

using verification::Mean;
using verification::MethodSummary;
using verification::Share;
using verification::Summary;

constexpr double kNormal97_5 = 1.959963984540054;

std::string percent_cell(const Share& share) {
  return share.of == 0 ? "–"
                       : number(100.0 * share.value(), 3) + " (" + number(100.0 * share.interval.low, 3) + "–" +
                             number(100.0 * share.interval.high, 3) + ")";
}

std::string mean_cell(const Mean& mean) {
  return mean.known ? number(mean.value, 3) + " ± " + number(kNormal97_5 * mean.standard_error, 2) : "–";
}

}  // namespace

std::string verification_main_table(const Summary& summary) {
  report::Table table({"method", ">converged %", ">reliable %", ">timely %", ">timely of converged %", ">lead time",
                       ">error", ">final error", ">last year", ">95 % width, last year", ">all months"});
  for (const MethodSummary& m : summary.methods)
    table.row({m.label, percent_cell(m.converged), percent_cell(m.reliable), percent_cell(m.timely),
               percent_cell(m.timely_of_converged), mean_cell(m.antecedence), mean_cell(m.error),
               mean_cell(m.final_error), mean_cell(m.last_year_error), mean_cell(m.last_year_width),
               mean_cell(m.error_all_months)});
  return table.html();
}

std::string verification_alarm_table(const Summary& summary) {
  report::Table table({"method", ">false positive", ">false negative", ">failed before P10", ">error over oracle's",
                       ">prognostic horizon, first", ">stable", ">alpha-lambda %", ">by mass %", ">mass",
                       ">cumulative relative accuracy", ">asymmetric score"});
  for (const MethodSummary& m : summary.methods)
    table.row({m.label, mean_cell(m.false_positive), mean_cell(m.false_negative), mean_cell(m.before_p10),
               mean_cell(m.oracle_ratio), mean_cell(m.horizon_first_months), mean_cell(m.horizon_stable_months),
               percent_cell(m.alpha_lambda), percent_cell(m.alpha_lambda_by_mass), mean_cell(m.alpha_lambda_mass),
               mean_cell(m.cumulative_relative_accuracy), mean_cell(m.asymmetric_score)});
  return table.html();
}

std::string verification_coverage_table(const Summary& summary) {
  report::Table table({"method", ">months before", ">50 %", ">80 %", ">95 %", ">|error|", ">CRPS", ">95 % width",
                       ">interval score 80 %"});
  for (const MethodSummary& m : summary.methods)
    for (const auto& at : m.horizons)
      table.row({m.label, number(at.months, 2), percent_cell(at.coverage[0]), percent_cell(at.coverage[1]),
                 percent_cell(at.coverage[2]), mean_cell(at.absolute_error), mean_cell(at.crps), mean_cell(at.width_95),
                 mean_cell(at.interval_score_80)});
  return table.html();
}

std::string verification_overview(const Summary& s) {
  std::string text = std::to_string(s.lives) + " lives, " + std::to_string(s.tests) + " tests. " +
                     std::to_string(s.censored) + (s.censored == 1 ? " life outlasts" : " lives outlast") +
                     " the months of service and " + (s.censored == 1 ? "is" : "are") + " left out below. " +
                     number(100.0 * s.fails_in_8_to_20_years.value(), 3) + " % fail within 8 to 20 years, half by " +
                     number(s.lifetime_years.at[2], 3) + " years. ";
  text +=
      "The mean standard error of the condition is " + text::number_text(100.0 * s.estimate_std.value, 2) +
      " %. Squared error over variance is " + number(s.estimate_chi_square.value, 3) +
      " on average (1 if the standard errors are right). One test of each life: " + percent_cell(s.estimate_within_95) +
      " % within the 95 % interval. ";
  text += "The estimate over a life: monotonicity " + number(s.monotonicity, 3) + ", trendability " +
          number(s.trendability, 3) + ", prognosability " + number(s.prognosability, 3) + ".";
  return report::paragraph(text) +
         report::paragraph(
             "Definitions: docs/reference/metrics.md. Months; 95 % intervals. Shares are of the lives that failed.",
             "muted");
}

}  // namespace sealwatch::cli
