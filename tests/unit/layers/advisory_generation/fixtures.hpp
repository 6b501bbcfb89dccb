// Messages of one test as the advice sees them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/forecast/degradation_line.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/advisory_generation/assessment.hpp"

namespace sealwatch::test {

inline const std::string kAsset = "XT03-MV2";
inline const UtcTime kInstalled = parse_utc("2010-01-01").value();

/// Campaigns every summer, twelve months to book a vessel.
inline Configuration configuration() {
  Configuration configuration;
  SiteConfig site{.site = "north", .campaigns = {}, .booking_lead_time_months = 12.0};
  for (int year = 2011; year <= 2025; ++year)
    site.campaigns.push_back({"summer " + std::to_string(year), parse_utc(std::to_string(year) + "-06-01").value()});
  configuration.sites = {site};
  configuration.assets.resize(1);
  configuration.assets[0].asset_id = kAsset;
  configuration.assets[0].site = "north";
  configuration.assets[0].segment = "XT03";
  configuration.assets[0].condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  return configuration;
}

struct TestCase {
  double month = 24.0;  ///< since kInstalled
  ForecastState forecast = ForecastState::ok;
  double rul_months = 90.0;
  double rul_std_months = 4.0;  ///< normal
  bool used = true;
  PstVerdict verdict = PstVerdict::passed;
  AlertRegion region = AlertRegion::normal;
  std::vector<ProposedFault> faults = {};
  std::vector<RegionJudgement> judgements = {};
  bool time_known = true;

  [[nodiscard]] UtcTime time() const { return add_months(kInstalled, month); }
  [[nodiscard]] std::string pst_id() const { return kAsset + "/" + std::to_string(std::lround(100 * month)); }
  [[nodiscard]] Header header(const std::string& topic) const {
    Header header;
    header.message_id = topic + "/" + pst_id();
    header.pst_id = pst_id();
    header.event_time_known = time_known;
    header.event_time_ns = time_known ? time().nanoseconds : 0;
    header.replay = true;
    return header;
  }
  [[nodiscard]] RemainingLife life() const {
    RemainingLife life;
    life.asset_id = kAsset;
    life.header = header("remaining_life");
    life.threshold = 0.6;
    life.condition_known = true;
    life.condition = 0.6 + 0.004 * rul_months;
    Forecast forecast_in_charge;
    forecast_in_charge.method = "ols";
    forecast_in_charge.window_months = 36;
    forecast_in_charge.state = forecast;
    forecast_in_charge.explanation = "36 tests";
    if (forecast == ForecastState::ok) {
      forecast_in_charge.rul_months = forecast_in_charge.rul_p50_months = rul_months;
      forecast_in_charge.rul_p10_months = std::max(0.0, rul_months - 1.2816 * rul_std_months);
      forecast_in_charge.rul_p90_months = rul_months + 1.2816 * rul_std_months;
      forecast_in_charge.end_of_life_ns = add_months(time(), rul_months).nanoseconds;
      const Configuration known = configuration();  // outlives the loop, as a temporary would not
      for (const Campaign& campaign : known.sites[0].campaigns)
        if (campaign.start > time()) {
          const double z = (months_between(time(), campaign.start) - rul_months) / rul_std_months;
          forecast_in_charge.failure_probability.push_back(
              {campaign.start.nanoseconds, campaign.label, 0.5 * std::erfc(-z / std::sqrt(2.0))});
        }
    }
    life.forecasts = {forecast_in_charge};
    return life;
  }
  [[nodiscard]] HealthReport health() const {
    HealthReport report;
    report.asset_id = kAsset;
    report.header = header("health_report");
    report.health_grade = 0.7;
    report.health_grade_known = true;
    report.ambiguity_group = faults;
    return report;
  }
  [[nodiscard]] StateReport state() const {
    StateReport report;
    report.asset_id = kAsset;
    report.header = header("state_report");
    report.verdict = verdict;
    report.region = region;
    report.judgements = judgements;
    if (verdict != PstVerdict::passed) report.verdict_reasons = {"stroke ended at 4.1 mm of 16 mm"};
    return report;
  }
  [[nodiscard]] LeakageEstimate leakage() const {
    LeakageEstimate estimate;
    estimate.asset_id = kAsset;
    estimate.header = header("leakage_estimate");
    estimate.header.source_ids = {"health_report/" + pst_id(), "test_window/" + pst_id()};
    estimate.estimated = estimate.condition_known = true;
    estimate.used_for_forecast = used;
    if (!used) estimate.reasons = {"cut after 7.4 s of about 31 s"};
    return estimate;
  }
  [[nodiscard]] advisory_generation::Evidence evidence() const { return {life(), health(), state(), leakage()}; }
  [[nodiscard]] std::vector<Message> messages() const { return {life(), health(), state(), leakage()}; }
};

inline ProposedFault fault(FaultKind kind, const std::string& element, double likelihood) {
  ProposedFault fault;
  fault.kind = kind;
  fault.element = element;
  fault.likelihood = likelihood;
  return fault;
}

inline std::vector<Message> inputs_of(const std::vector<TestCase>& tests) {
  std::vector<Message> inputs;
  for (const TestCase& one : tests)
    for (const Message& message : one.messages()) inputs.push_back(message);
  return inputs;
}

/// A seal that ends at `end_month`, tested every month.
inline std::vector<TestCase> life_until(int first, int last, double end_month) {
  std::vector<TestCase> tests;
  for (int n = first; n <= last; ++n) {
    TestCase one{.month = static_cast<double>(n), .rul_months = end_month - n};
    if (one.rul_months <= 0.0) one.forecast = ForecastState::past_threshold;
    tests.push_back(one);
  }
  return tests;
}

}  // namespace sealwatch::test
