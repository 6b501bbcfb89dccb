// A text plant's monthly tests through all six layers offline: what its asset's file says of wear becomes a condition and
// a remaining life.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <random>
#include <regex>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/cli/concluded_history.hpp"
#include "services/cli/forecast_page.hpp"
#include "services/cli/layers.hpp"
#include "services/cli/summary.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;

// Its packing wears: the friction grows from 2 kN s/m by 1.5 % a month. Channels have names of their own.
constexpr const char* kPlant = R"yaml(name: packed_valve
meaning: valve positioner with a return spring and a packing
inputs:
  command: {unit: V, role: drive, meaning: command to the drive}
outputs:
  stem: {value: x, unit: m, noise_std: 1.0e-5, role: stroke, meaning: stem position}
parameters:
  M:   {value: 20.0,  unit: kg,    meaning: moved mass}
  F_v: {value: 2.0e3, unit: N s/m, min: 500, max: 5.0e4, meaning: friction of the packing, estimate: true}
  k_s: {value: 1.0e4, unit: N/m,   meaning: stiffness of the return spring}
  k_F: {value: 100.0, unit: N/V,   meaning: force of the drive per voltage}
states:
  x: {der: v, unit: m, start: stem, meaning: stem position}
  v: {der: (k_F*command - F_v*v - k_s*x - F_missing) / M, unit: m/s, start: "0[m/s]", own: false, size: 0.1}
elements:
  piston:
    meaning: force on the stem
    sites:
      - {kind: piston_force, symbol: F_missing, signals: {speed: v, position: x}}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3}
wears: F_v
)yaml";
constexpr const char* kAsset = R"yaml(asset_id: V-9
model: packed_valve.yaml
condition: {at_100: 2.0e3, at_60: 4.0e3, scale: logarithmic, part: stem packing}
pst: {start: 0.01, stroke: 0.02, speed: 0.01, hold: 3.0, interval_months: 1}
)yaml";
constexpr double kNew = 2e3, kGrowth = 0.015;
constexpr int kMonths = 30;

/// Out, hold, back, hold, by the spring: the command that the stem follows.
double command_at(double t) {
  const auto ramp = [](double share) { return std::clamp(share, 0.0, 1.0); };
  const double way_m = 0.01 + 0.02 * (ramp((t - 1.0) / 2.0) - ramp((t - 6.0) / 2.0));
  return 100.0 * way_m;
}

Recording monthly(const AssetConfig& asset, int month) {
  AssetConfig worn = asset;
  worn.parameters.at("F_v").value = kNew * std::exp(kGrowth * month);
  Recording recording;
  recording.asset_id = asset.asset_id;
  recording.start_time = add_months(parse_utc("2031-01-05").value(), month);
  recording.recording_id = format_utc(*recording.start_time);
  recording.content_hash = recording.recording_id;
  Series command{"command", "V", 0.0, {}}, stem{"stem", "m", 1e-5, {}};
  for (int k = 0; k <= 1100; ++k) {
    recording.samples.time_s.push_back(0.01 * k);
    command.values.push_back(command_at(0.01 * k));
    stem.values.push_back(0.01);
  }
  recording.samples.channels = {command, stem};
  const auto simulation = PlantSimulation::create(worn, recording.samples).value();
  const auto outputs = simulation->run(simulation->start(), {}).value();
  std::mt19937 random(static_cast<unsigned>(month));
  std::normal_distribution<double> noise(0.0, 1e-5);
  for (std::size_t k = 0; k < recording.samples.time_s.size(); ++k)
    recording.samples.channels[1].values[k] = outputs.values(static_cast<Eigen::Index>(k), 0) + noise(random);
  return recording;
}

struct Concluded {
  std::vector<StateReport> states;
  std::vector<HealthReport> health;
  std::vector<LeakageEstimate> estimates;
  std::vector<RemainingLife> lives;
  std::vector<Advisory> advisories;
  AssetView view;
  ConcludedHistory history;
  void take(const Message& message) {
    view.take(message);
    history.take(message);
    if (const auto* one = std::get_if<StateReport>(&message)) states.push_back(*one);
    if (const auto* one = std::get_if<HealthReport>(&message)) health.push_back(*one);
    if (const auto* one = std::get_if<LeakageEstimate>(&message)) estimates.push_back(*one);
    if (const auto* one = std::get_if<RemainingLife>(&message)) lives.push_back(*one);
    if (const auto* one = std::get_if<Advisory>(&message)) advisories.push_back(*one);
  }
};

Configuration configuration_of(const AssetConfig& asset) {
  Configuration configuration;
  configuration.assets = {asset};
  return configuration;
}

/// Where a text speaks of a seal, which this plant has none of; "" where it does not.
std::string seals_named(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t at = text.find("seal");
  return at == std::string::npos ? "" : text.substr(at > 60 ? at - 60 : 0, 120);
}

long count(const std::string& text, const std::string& words) {
  long times = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++times;
  return times;
}

void leave_out(std::string& html, const std::string& from, const std::string& to) {
  for (std::size_t begin = 0; (begin = html.find(from)) != std::string::npos;)
    html.erase(begin, html.find(to, begin) + to.size() - begin);
}

/// A date in a page's text that a narrow line may break at its hyphens, with what stands before it; "": none.
std::string date_that_may_break(std::string html) {
  leave_out(html, "<svg", "</svg>");
  leave_out(html, "<span class=\"whole\">", "</span>");
  static const std::regex date(R"(\d\d\d\d-\d\d-\d\d)");
  std::smatch found;
  if (!std::regex_search(html, found, date)) return "";
  const auto at = static_cast<std::size_t>(found.position());
  return html.substr(at > 40 ? at - 40 : 0, 60);
}

Concluded concluded(const AssetConfig& asset) {
  const Configuration configuration = configuration_of(asset);
  const LayerSet layers = LayerSet::make(configuration).value();
  Concluded all;
  InProcessPipeline pipeline(layers.makers(), [&all](const Message& message) { all.take(message); });
  for (int month = 0; month < kMonths; ++month)
    for (RawSamples& block : blocks_of(monthly(asset, month))) pipeline.push(Message(std::move(block)));
  return all;
}

TEST(OwnPlantLife, MonthlyTestsBecomeAConditionAndARemainingLife) {
  const testing::YamlPlace place;
  place.write("packed_valve.yaml", kPlant);
  const auto asset = load_asset(place.write("a.yaml", kAsset));
  ASSERT_TRUE(asset) << asset.error().describe();
  ASSERT_TRUE(asset->condition);
  EXPECT_EQ(asset->condition->parameter, "F_v") << "the plant says what wears";
  const Concluded all = concluded(*asset);

  ASSERT_EQ(all.states.size(), static_cast<std::size_t>(kMonths));
  EXPECT_EQ(all.states.back().verdict, PstVerdict::passed) << all.states.back().verdict_reasons.front();
  ASSERT_EQ(all.estimates.size(), static_cast<std::size_t>(kMonths));
  for (int month = 0; month < kMonths; ++month) {
    const LeakageEstimate& estimate = all.estimates[static_cast<std::size_t>(month)];
    ASSERT_TRUE(estimate.used_for_forecast) << month << ": " << estimate.reasons.front();
    EXPECT_EQ(estimate.parameter, "F_v");
    EXPECT_EQ(estimate.unit, "N s/m");
    const double truth = 1.0 - 0.4 * kGrowth * month / std::log(2.0);
    EXPECT_NEAR(estimate.condition, truth, 5.0 * estimate.condition_std + 1e-3) << month;
  }
  ASSERT_EQ(all.health.size(), static_cast<std::size_t>(kMonths));
  for (int month = 0; month < kMonths; ++month) {
    const HealthReport& health = all.health[static_cast<std::size_t>(month)];
    const double truth = 1.0 - 0.4 * kGrowth * month / std::log(2.0);
    ASSERT_TRUE(health.health_grade_known) << month;
    EXPECT_NEAR(health.health_grade, (truth - 0.6) / 0.4, 0.01) << "between new and the threshold, month " << month;
  }
  const auto& last = all.states.back().judgements;
  EXPECT_NE(std::ranges::find(last, "condition", &RegionJudgement::quantity), last.end());

  const RemainingLife& life = all.lives.back();
  ASSERT_TRUE(life.condition_known);
  ASSERT_FALSE(life.forecasts.empty());
  EXPECT_EQ(life.forecasts.front().state, ForecastState::ok) << life.forecasts.front().explanation;
  // It reaches 60 % after ln 2 / 1.5 % = 46.2 months.
  const double left = std::log(2.0) / kGrowth - (kMonths - 1);
  constexpr double kCalendar = 0.1;  // months that are 28 to 31 days long, in which it wears alike
  EXPECT_GT(left, life.forecasts.front().interval_95_low_months - kCalendar);
  EXPECT_LT(left, life.forecasts.front().interval_95_high_months + kCalendar);
  ASSERT_FALSE(all.advisories.empty());

  for (const Advisory& advisory : all.advisories) {
    EXPECT_EQ(seals_named(advisory.recommendation), "");
    for (const std::string& reason : advisory.reasons) EXPECT_EQ(seals_named(reason), "");
    for (const RequestForWork& work : advisory.request_for_work)
      EXPECT_EQ(seals_named(work.work_id + work.solution_package), "");
  }
  EXPECT_THAT(all.advisories.back().recommendation, HasSubstr("Condition of the stem packing is"));
  EXPECT_EQ(seals_named(all.view.screen(false)), "");
  const auto question = all.history.question(*asset, configuration_of(*asset));
  ASSERT_TRUE(question);
  const auto answer = answer_of(*question);
  ASSERT_TRUE(answer) << answer.error().describe();
  const std::string page = forecast_body(*question, *answer, {}).value();
  EXPECT_EQ(seals_named(page), "");
  EXPECT_THAT(page, HasSubstr("Condition of the stem packing, index derived from F_v (new: 100)"));
  const std::string reasons = page.substr(page.find("what the advice and the forecast rest on"));
  EXPECT_EQ(count(reasons, "condition now"), 1) << "no reason is given twice: " << reasons;
  EXPECT_EQ(date_that_may_break(page), "");
}

}  // namespace
}  // namespace sealwatch::cli
