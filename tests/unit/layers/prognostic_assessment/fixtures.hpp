// Tests (as in: partial stroke tests) for the prognosis tests, and an estimator that says what it is told.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/estimator.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch::test {

inline const std::string kAsset = "XT03-MV2";
inline const UtcTime kInstalled = parse_utc("2010-01-01").value();

inline Configuration configuration() {
  Configuration configuration;
  configuration.sites = {
      {"north",
       {{"summer 2016", parse_utc("2016-06-01").value()}, {"summer 2018", parse_utc("2018-06-01").value()}},
       12.0}};
  configuration.assets.resize(2);
  configuration.assets[0].asset_id = kAsset;
  configuration.assets[0].site = "north";
  configuration.assets[0].condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  configuration.assets[1].asset_id = "BENCH-1";
  configuration.assets[1].model = "eha_switched";
  return configuration;
}

inline FitReport fit(const std::string& model, double resistance, double std_error, bool admissible = true) {
  FitReport report;
  report.model = model;
  report.admissible = admissible;
  report.parameters = {{.name = "R_CL", .unit = "Pa s/m3", .value = resistance, .std_error = std_error}};
  if (!admissible) report.reasons = {"whiteness of pressure_a: p = 1e-9"};
  return report;
}

/// Finds R_CL, its standard error and the verdict in the window's samples, where `TestCase` put them.
class ScriptedEstimator final : public Estimator {
 public:
  std::vector<FitReport> estimate(const AssetConfig&, const TimeSeries& samples, std::span<const Phase>,
                                  const std::stop_token&) const override {
    if (samples.channels.empty()) return {};
    const std::vector<double>& told = samples.channels.front().values;
    return {fit("eha", told[0], told[1], told[2] > 0.0)};
  }
};

struct TestCase {
  double month = 1.0;  ///< since kInstalled
  double condition = 0.9;
  double condition_std = 0.002;
  bool admissible = true;  ///< health assessment
  bool fit_admissible = true;
  bool time_known = true;
  std::string asset_id = kAsset;

  [[nodiscard]] std::string pst_id() const { return asset_id + "/" + std::to_string(std::lround(100 * month)); }
  [[nodiscard]] Header header(const std::string& topic) const {
    Header header;
    header.message_id = topic + "/" + pst_id();
    header.pst_id = pst_id();
    header.event_time_known = time_known;
    header.event_time_ns = time_known ? add_months(kInstalled, month).nanoseconds : 0;
    header.replay = true;
    return header;
  }
  [[nodiscard]] HealthReport health() const {
    HealthReport report;
    report.asset_id = asset_id;
    report.header = header("health_report");
    report.admissible_for_prognosis = admissible;
    if (!admissible) report.inadmissible_reasons = {"cut after 7.4 s of about 31 s"};
    return report;
  }
  [[nodiscard]] TestWindow window() const {
    TestWindow window;
    window.asset_id = asset_id;
    window.header = header("test_window");
    const ConditionSetting seal{
        .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
    const double slope = seal.value(1.0) - seal.value(0.0);
    window.samples.channels = {
        {"told", "1", 0.0, {seal.value(condition), condition_std * slope, fit_admissible ? 1.0 : 0.0}}};
    return window;
  }
};

inline MaintenanceEvent replacement(double month) {
  MaintenanceEvent event;
  event.asset_id = kAsset;
  event.kind = "seal_replaced";
  event.reported_by = "night shift";
  event.header.event_time_known = true;
  event.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  event.header.message_id = "maintenance_event/" + kAsset + "/" + format_utc({event.header.event_time_ns});
  return event;
}

/// theta = 1 - 0.004 t: 0.60 at 100 months, i.e. 2018-05.
inline std::vector<TestCase> straight_life(int first, int last) {
  std::vector<TestCase> life;
  for (int n = first; n <= last; ++n) life.push_back({.month = static_cast<double>(n), .condition = 1.0 - 0.004 * n});
  return life;
}

inline std::vector<Message> inputs_of(const std::vector<TestCase>& life) {
  std::vector<Message> inputs;
  for (const TestCase& test : life) {
    inputs.emplace_back(test.window());
    inputs.emplace_back(test.health());
  }
  return inputs;
}

}  // namespace sealwatch::test
