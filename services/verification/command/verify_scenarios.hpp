// One table of all scenarios of `sealwatch verify rul --scenario`, each forecaster under each, with 95 % intervals.
#pragma once

#include <string>
#include <vector>

#include "services/verification/lives/summary.hpp"

namespace sealwatch::cli {

struct ScenarioSummary {
  std::string scenario;
  verification::Summary summary;
};

/// For people, in characters.
[[nodiscard]] std::string scenario_table(const std::vector<ScenarioSummary>& scenarios);
/// scenarios.html: the same as a page, with a plot of each measure.
[[nodiscard]] std::string scenario_page(const std::vector<ScenarioSummary>& scenarios);
/// scenarios.json, schema sealwatch.verification_scenarios/1.
[[nodiscard]] std::string scenario_json(const std::vector<ScenarioSummary>& scenarios);

}  // namespace sealwatch::cli
