// The report of a verification: the tables, and the plots of the source's chapter 4 with what was added to it.
#include <algorithm>
#include <cmath>

#include "services/cli/terminal.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/words.hpp"
#include "services/verification/command/verify_results.hpp"
#include "services/verification/command/verify_tables.hpp"

namespace sealwatch::cli {
namespace {

using report::Ink;
using report::Plot;
using verification::LifeCollection;
using verification::LifeRecord;
using verification::Mean;
using verification::MethodSummary;
using verification::Share;
using verification::Summary;

constexpr std::uint32_t kFamily = 15;  // lives drawn, as in the source's figure 2.8
constexpr double kMonthsAYear = 12.0;
constexpr double kNormal97_5 = 1.959963984540054;
constexpr std::array kInks{Ink::first, Ink::second, Ink::third, Ink::fourth};

std::string in_row(const std::vector<Plot>& plots) {
  std::string html = "<div class=\"plots\">";
  for (const Plot& plot : plots) html.append("<div>").append(report::to_svg(plot)).append("</div>");
  return html + "</div>";
}

Result<Plot> family(const LifeCollection& lives) {
  Plot plot{.title = "Degradation of the first lives",
            .x = {.label = "age", .unit = "years"},
            .y = {.label = "seal condition", .unit = "1"},
            .marks = {},
            .legend = false};
  for (std::uint32_t k = 0; k < std::min(kFamily, lives.size()); ++k) {
    const Result<LifeRecord> life = lives.read(k);
    if (!life) return fail(life.error());
    report::Line line{.x = {0.0}, .y = {1.0}, .ink = kInks[k % kInks.size()], .label = {}, .width = 1.0};
    for (const auto& test : life->tests) {
      line.x.push_back(test.time_months / kMonthsAYear);
      line.y.push_back(test.condition);
    }
    plot.marks.emplace_back(std::move(line));
  }
  plot.marks.emplace_back(report::Reference{.at = 0.6, .label = "failed"});
  return plot;
}

/// Estimate and truth of one life, and their difference in standard errors.
std::vector<Plot> estimates(const LifeRecord& life) {
  report::Line truth{.x = {}, .y = {}, .ink = Ink::muted, .label = "truth", .width = 2.5};
  report::Scatter estimate{.x = {}, .y = {}, .ink = Ink::first, .label = "estimate"};
  report::Scatter off{.x = {}, .y = {}, .ink = Ink::first, .label = {}};
  for (const auto& test : life.tests) {
    const double years = test.time_months / kMonthsAYear;
    truth.x.push_back(years);
    truth.y.push_back(test.condition);
    if (!test.usable) continue;
    estimate.x.push_back(years);
    estimate.y.push_back(test.estimate);
    off.x.push_back(years);
    off.y.push_back((test.estimate - test.condition) / test.estimate_std);
  }
  const report::Axis age{.label = "age", .unit = "years"};
  return {{.title = "Estimate against truth, life " + std::to_string(life.life),
           .x = age,
           .y = {.label = "seal condition", .unit = "1"},
           .marks = {truth, estimate}},
          {.title = "Estimate minus truth, in standard errors",
           .x = age,
           .y = {.label = "standard errors", .unit = "1"},
           .marks = {report::Reference{.at = -kNormal97_5, .label = "95 %"}, report::Reference{.at = kNormal97_5}, off},
           .legend = false}};
}

bool of_family(const MethodSummary& method, const std::string& name) { return method.label.starts_with(name + " "); }

/// Share of lives that are reliable from so many months before failure on; one plot for each group of methods.
Plot convergence(const Summary& summary, const std::string& title, const std::vector<std::string>& families) {
  Plot plot{.title = title,
            .x = {.label = "months before failure", .unit = "1", .range = std::pair{0.0, 60.0}},
            .y = {.label = "reliable from then on", .unit = "1", .range = std::pair{0.0, 1.0}},
            .marks = {}};
  std::size_t ink = 0;
  for (const MethodSummary& method : summary.methods) {
    const bool oracle = method.label == "oracle";
    const bool wanted = oracle || std::any_of(families.begin(), families.end(),
                                              [&](const std::string& name) { return of_family(method, name); });
    if (!wanted) continue;
    report::Line line{.x = {},
                      .y = method.reliable_by_month,
                      .ink = oracle ? Ink::muted : kInks[ink++ % kInks.size()],
                      .label = method.label,
                      .width = 1.4,
                      .dashed = oracle};
    for (std::size_t k = 0; k < line.y.size(); ++k) line.x.push_back(static_cast<double>(k));
    plot.marks.emplace_back(std::move(line));
  }
  return plot;
}

/// "ols_log_time 36" as "log 36", "state_space 240" as "state space": so that all stand beside each other.
std::string short_label(std::string label) {
  if (label.starts_with("ols_log_time")) return "log" + label.substr(12);
  if (label.starts_with("ols_")) return label.substr(4);
  if (const std::size_t whole_life = label.find(" 240"); whole_life != std::string::npos) label.resize(whole_life);
  return text::in_words(label);
}

std::vector<std::string> labels_of(const Summary& summary) {
  std::vector<std::string> labels;
  for (const MethodSummary& method : summary.methods) labels.push_back(short_label(method.label));
  return labels;
}

/// One value with its interval for each method.
template <class Value>
Plot by_method(const Summary& summary, const std::string& title, const std::string& label, const Value& value) {
  report::Intervals marks{.x = {}, .y = {}, .low = {}, .high = {}, .ink = Ink::first, .label = {}};
  for (std::size_t k = 0; k < summary.methods.size(); ++k) {
    const auto [middle, low, high] = value(summary.methods[k]);
    marks.x.push_back(static_cast<double>(k));
    marks.y.push_back(middle);
    marks.low.push_back(low);
    marks.high.push_back(high);
  }
  return {.title = title,
          .x = {.label = {}, .categories = labels_of(summary)},
          .y = {.label = label, .unit = "1"},
          .marks = {marks},
          .width = 940,
          .legend = false};
}

auto share_at(Share MethodSummary::*part) {
  return [part](const MethodSummary& method) {
    const Share& share = method.*part;
    return std::array{share.value(), share.interval.low, share.interval.high};
  };
}

std::array<double, 3> with_interval(const Mean& mean) {
  const double half = kNormal97_5 * mean.standard_error;
  const double value = mean.known ? mean.value : std::nan("");
  return {value, value - half, value + half};
}

Plot boxes(const Summary& summary, const std::string& title, const auto& quantiles) {
  report::Boxes boxes{.boxes = {}, .ink = Ink::first, .label = {}};
  for (std::size_t k = 0; k < summary.methods.size(); ++k) {
    const verification::Quantiles& q = quantiles(summary.methods[k]);
    if (q.values > 0) boxes.boxes.push_back({static_cast<double>(k), q.at[0], q.at[1], q.at[2], q.at[3], q.at[4]});
  }
  return {.title = title,
          .x = {.label = {}, .categories = labels_of(summary)},
          .y = {.label = "forecast minus truth, months", .unit = "1"},
          .marks = {boxes, report::Reference{.at = 0.0}},
          .width = 940,
          .legend = false};
}

std::vector<Plot> pit_histograms(const Summary& summary) {
  std::vector<Plot> plots;
  for (const MethodSummary& method : summary.methods) {
    report::Bars bars{.edges = {}, .heights = {}, .ink = Ink::first, .label = {}};
    double total = 0.0;
    for (const int count : method.pit) total += count;
    for (int k = 0; k <= verification::kPitBins; ++k) bars.edges.push_back(k / double{verification::kPitBins});
    for (const int count : method.pit)
      bars.heights.push_back(total > 0.0 ? verification::kPitBins * count / total : 0.0);
    plots.push_back({.title = method.label,
                     .x = {.label = "PIT", .unit = "1", .range = std::pair{0.0, 1.0}},
                     .y = {.label = "density", .unit = "1"},
                     .marks = {bars, report::Reference{.at = 1.0}},
                     .width = 300,
                     .height = 150,
                     .legend = false});
  }
  return plots;
}

Plot life_plot(const LifeRecord& life, std::size_t method, const std::string& title) {
  report::Line truth{.x = {}, .y = {}, .ink = Ink::muted, .label = "truth", .width = 2.0, .dashed = true};
  report::Line forecast{.x = {}, .y = {}, .ink = Ink::first, .label = "forecast"};
  report::Band band{.x = {}, .low = {}, .high = {}, .ink = Ink::first, .label = "95 %"};
  double longest = 1.0;
  for (std::size_t k = 0; k < life.tests.size(); ++k) {
    const double years = life.tests[k].time_months / kMonthsAYear;
    const auto& answer = life.answers[method][k];
    const bool number = answer.state == ForecastState::ok || answer.state == ForecastState::past_threshold;
    truth.x.push_back(years);
    truth.y.push_back(life.true_rul_months(k));
    forecast.x.push_back(years);
    forecast.y.push_back(number ? answer.rul : std::nan(""));
    band.x.push_back(years);
    band.low.push_back(number ? answer.interval_95_low : std::nan(""));
    band.high.push_back(number ? answer.interval_95_high : std::nan(""));
    longest = std::max(longest, life.true_rul_months(k));
  }
  return {.title = title,
          .x = {.label = "age", .unit = "years"},
          .y = {.label = "remaining life, months", .unit = "1", .range = std::pair{0.0, 1.3 * longest}},
          .marks = {band, truth, forecast}};
}

Result<std::vector<Plot>> worst_lives(const LifeCollection& lives, const Summary& summary) {
  std::vector<Plot> plots;
  for (std::size_t k = 0; k < summary.methods.size(); ++k) {
    const MethodSummary& method = summary.methods[k];
    if (method.worst.empty()) continue;
    const Result<LifeRecord> life = lives.read(method.worst.front().life);
    if (!life) return fail(life.error());
    plots.push_back(life_plot(*life, k,
                              method.label + ", life " + std::to_string(life->life) + ": mean error " +
                                  number(method.worst.front().error_months, 3) + " months"));
  }
  return plots;
}

std::string setting_part(const LifeCollection& lives) {
  return report::folded("Setting of this run", "<pre>" + report::escaped(lives.setting_text()) + "</pre>");
}

}  // namespace

Result<std::string> verification_page(const LifeCollection& lives, const Summary& summary) {
  const Result<Plot> first_lives = family(lives);
  const Result<LifeRecord> first = lives.read(0);
  const Result<std::vector<Plot>> worst = worst_lives(lives, summary);
  if (!first_lives) return fail(first_lives.error());
  if (!first) return fail(first.error());
  if (!worst) return fail(worst.error());
  std::vector<Plot> truth = estimates(*first);
  truth.insert(truth.begin(), *first_lives);
  std::string body = report::section("The fleet", verification_overview(summary) + setting_part(lives) + in_row(truth));
  body += report::section(
      "Methods",
      verification_main_table(summary) + verification_alarm_table(summary) +
          report::paragraph("In plots: log is ols_log_time, drift ols_drift, fieller ols_fieller; forecasters "
                            "without a number take the whole life.",
                            "muted"));
  body += report::section("Convergence",
                          in_row({convergence(summary, "Lines over time", {"ols"}),
                                  convergence(summary, "Lines over ln time", {"ols_log_time"}),
                                  convergence(summary, "Lines that carry drift", {"ols_drift", "ols_fieller"}),
                                  convergence(summary, "With the law of ageing", {"state_space", "fleet", "average"}),
                                  by_method(summary, "Convergence rate", "share", share_at(&MethodSummary::converged)),
                                  by_method(summary, "Reliable share", "share", share_at(&MethodSummary::reliable)),
                                  by_method(summary, "Timely share", "share", share_at(&MethodSummary::timely))}));
  body += report::section("Errors and intervals",
                          in_row({boxes(
                                      summary, "Final error (5, 25, 50, 75, 95 %)",
                                      [](const MethodSummary& m) -> const auto& { return m.final_error_box; }),
                                  boxes(
                                      summary, "Error 12 months before failure",
                                      [](const MethodSummary& m) -> const auto& { return m.horizons[2].error; }),
                                  by_method(summary, "Width of the 95 % interval in the last year", "months",
                                            [](const MethodSummary& m) { return with_interval(m.last_year_width); })}));
  body +=
      report::section("Calibration", report::paragraph("Probability that each forecast gave to what came: flat when "
                                                       "calibrated, at 36, 24, 12 and 6 months before failure.") +
                                         in_row(pit_histograms(summary)) + verification_coverage_table(summary));
  body += report::section(
      "Worst lives", report::paragraph("Of each method, by the mean error of the last three years.") + in_row(*worst));
  return report::html_page("Verification of the remaining useful life",
                           "<h1>Verification of the remaining useful life</h1>" + body);
}

}  // namespace sealwatch::cli
