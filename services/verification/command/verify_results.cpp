#include "services/verification/command/verify_results.hpp"

#include <nlohmann/json.hpp>

#include "services/common/text/format.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;
using verification::HorizonSummary;
using verification::Mean;
using verification::MethodSummary;
using verification::Quantiles;
using verification::Share;
using verification::Summary;

constexpr double kNormal97_5 = 1.959963984540054;

Json json_of(const Share& share) {
  if (share.of == 0) return nullptr;
  return {{"value", share.value()},
          {"interval_95", {share.interval.low, share.interval.high}},
          {"count", share.count},
          {"of", share.of}};
}

Json json_of(const Mean& mean) {
  if (!mean.known) return nullptr;
  return {
      {"value", mean.value},
      {"interval_95", {mean.value - kNormal97_5 * mean.standard_error, mean.value + kNormal97_5 * mean.standard_error}},
      {"standard_error", mean.standard_error},
      {"lives", mean.lives}};
}

Json json_of(const Quantiles& q) {
  if (q.values == 0) return nullptr;
  return {{"p5", q.at[0]},  {"p25", q.at[1]}, {"p50", q.at[2]},
          {"p75", q.at[3]}, {"p95", q.at[4]}, {"values", q.values}};
}

Json json_of(const HorizonSummary& at) {
  return {{"months_before_failure", at.months},
          {"answered", json_of(at.answered)},
          {"coverage_50", json_of(at.coverage[0])},
          {"coverage_80", json_of(at.coverage[1])},
          {"coverage_95", json_of(at.coverage[2])},
          {"absolute_error_months", json_of(at.absolute_error)},
          {"error_months", json_of(at.error)},
          {"crps_months", json_of(at.crps)},
          {"interval_95_width_months", json_of(at.width_95)},
          {"interval_score_80_months", json_of(at.interval_score_80)},
          {"interval_score_95_months", json_of(at.interval_score_95)}};
}

Json json_of(const MethodSummary& method) {
  Json json = {{"method", method.label},
               {"convergence_rate", json_of(method.converged)},
               {"reliable_share", json_of(method.reliable)},
               {"timely_share", json_of(method.timely)},
               {"timely_share_of_converged", json_of(method.timely_of_converged)},
               {"antecedence_months", json_of(method.antecedence)},
               {"antecedence_quantiles_months", json_of(method.antecedence_box)},
               {"error_months", json_of(method.error)},
               {"error_since_converged_months", json_of(method.error_since_converged)},
               {"final_error_months", json_of(method.final_error)},
               {"final_error_quantiles_months", json_of(method.final_error_box)},
               {"last_year_error_months", json_of(method.last_year_error)},
               {"last_year_width_months", json_of(method.last_year_width)},
               {"error_all_months_months", json_of(method.error_all_months)},
               {"false_positive_ratio", json_of(method.false_positive)},
               {"false_negative_ratio", json_of(method.false_negative)},
               {"failure_before_p10", json_of(method.before_p10)},
               {"error_over_oracle", json_of(method.oracle_ratio)},
               {"prognostic_horizon_first_months", json_of(method.horizon_first_months)},
               {"prognostic_horizon_stable_months", json_of(method.horizon_stable_months)},
               {"prognostic_horizon_stable_share", json_of(method.horizon_stable)},
               {"alpha_lambda_share", json_of(method.alpha_lambda)},
               {"alpha_lambda_by_mass_share", json_of(method.alpha_lambda_by_mass)},
               {"alpha_lambda_mass", json_of(method.alpha_lambda_mass)},
               {"cumulative_relative_accuracy", json_of(method.cumulative_relative_accuracy)},
               {"convergence_distance", json_of(method.convergence_distance)},
               {"asymmetric_score", json_of(method.asymmetric_score)}};
  json["horizons"] = Json::array();
  for (const HorizonSummary& at : method.horizons) json["horizons"].push_back(json_of(at));
  json["pit_histogram"] = method.pit;
  json["reliable_share_by_months_before_failure"] = method.reliable_by_month;
  json["worst_lives"] = Json::array();
  for (const verification::WorstLife& worst : method.worst)
    json["worst_lives"].push_back({{"life", worst.life}, {"mean_error_months", worst.error_months}});
  return json;
}

Json setting_json(const std::string& text) {
  Json json = Json::object();
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos && !line.starts_with("method"))
      json[line.substr(0, equals)] = line.substr(equals + 3);
    begin = end + 1;
  }
  return json;
}

std::string cell(const Share& share) {
  if (share.of <= 0) return "-";
  return text::format("{:5.1f} ({:.0f}-{:.0f})", 100.0 * share.value(), 100.0 * share.interval.low,
                      100.0 * share.interval.high);
}

std::string cell(const Mean& mean, int decimals) {
  if (!mean.known) return "-";
  return text::format("{0:.{2}f} +-{1:.{2}f}", mean.value, kNormal97_5 * mean.standard_error, decimals);
}

}  // namespace

std::string verification_json(const verification::LifeCollection& lives, const Summary& summary) {
  Json json = {{"schema", "sealwatch.verification/1"},
               {"setting", setting_json(lives.setting_text())},
               {"lives", summary.lives},
               {"censored_lives", summary.censored},
               {"tests", summary.tests},
               {"unusable_tests", summary.unusable_tests},
               {"lifetime_years", json_of(summary.lifetime_years)},
               {"fails_in_8_to_20_years", json_of(summary.fails_in_8_to_20_years)},
               {"estimate",
                {{"condition_std", json_of(summary.estimate_std)},
                 {"mean_squared_error_over_variance", json_of(summary.estimate_chi_square)},
                 {"within_95_interval", json_of(summary.estimate_within_95)},
                 {"monotonicity", summary.monotonicity},
                 {"trendability", summary.trendability},
                 {"prognosability", summary.prognosability}}},
               {"methods", Json::array()}};
  for (const MethodSummary& method : summary.methods) json["methods"].push_back(json_of(method));
  return json.dump(1) + "\n";
}

std::string verification_table(const Summary& summary) {
  std::string text = text::format(
      "{} lives ({} outlast the months of service), {} tests; failure after {:.1f}, {:.1f}, {:.1f} years (5, 50, 95 "
      "%)\n"
      "shares in % of the lives that failed, months otherwise; 95 % intervals in brackets or behind +-\n",
      summary.lives, summary.censored, summary.tests, summary.lifetime_years.at[0], summary.lifetime_years.at[2],
      summary.lifetime_years.at[4]);
  static constexpr const char* kRow = "{:17} {:>14} {:>14} {:>14} {:>13} {:>12} {:>12} {:>13} {:>13} {:>13} {:>13}\n";
  text += text::format(kRow, "method", "converged", "reliable", "timely", "lead time", "error", "last year",
                       "95% width", "false pos.", "false neg.", "a-l mass");
  for (const MethodSummary& method : summary.methods) {
    text += text::format(kRow, method.label, cell(method.converged), cell(method.reliable), cell(method.timely),
                         cell(method.antecedence, 1), cell(method.error, 2), cell(method.last_year_error, 2),
                         cell(method.last_year_width, 1), cell(method.false_positive, 3),
                         cell(method.false_negative, 3), cell(method.alpha_lambda_mass, 2));
  }
  return text;
}

}  // namespace sealwatch::cli
