// Commands around a user's own model, as scripts use them: a trace beside a recording, an exported FMU, a life of a plant
// as text, a fleet's constants from its histories.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/six_services.hpp"

namespace sealwatch::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPlant = R"yaml(name: worn_packing
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
model: worn_packing.yaml
condition: {at_100: 2.0e3, at_60: 4.0e3, scale: logarithmic, part: stem packing}
pst: {start: 0.01, stroke: 0.02, speed: 0.01, hold: 3.0, interval_months: 1}
)yaml";

class OwnPlantCommands : public SixServices {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    const std::string file = (folder_ / name).string();
    std::ofstream(file) << text;
    return file;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string asset(const std::string& text = kAsset) const {
    write("worn_packing.yaml", kPlant);
    return write("asset.yaml", text);
  }
  /// A test's inputs, with the stem's first place.
  [[nodiscard]] std::string inputs() const {
    std::ostringstream text;
    text << "time,command[V],stem[mm]\n";
    for (int k = 0; k <= 1100; ++k) {
      const double t = 0.01 * k, way = std::clamp((t - 1.0) / 2.0, 0.0, 1.0) - std::clamp((t - 6.0) / 2.0, 0.0, 1.0);
      text << t << "," << 1.0 + 2.0 * way << ",10\n";
    }
    return write("inputs.csv", text.str());
  }
};

// Each with a load of its own, so that a test's name stands beside it.
TEST_F(OwnPlantCommands, TestsOfOneLogAreCountedAndNamed) {
  write("worn_packing.yaml", std::string(kPlant) + "load: k_F\n");
  const std::string asset_file = write("asset.yaml", std::string(kAsset) + "log: {time_resets: split}\n");
  const Finished simulated =
      run({"sealwatch", "simulate", "--asset", asset_file, "--input", inputs(), "--out", path("tests")});
  ASSERT_EQ(simulated.status, 0) << simulated.output;
  std::ifstream one(path("tests/inputs.csv"));
  std::string header, rows;
  std::getline(one, header);
  std::getline(one, rows, '\0');
  const std::string log = write("log.csv", header + "\n" + rows + rows);
  const Finished fit = run({"sealwatch", "fit", "--asset", asset_file, log});
  EXPECT_THAT(fit.output, HasSubstr("2 recordings: "));
  EXPECT_THAT(fit.output, HasSubstr("log.csv#2"));
  const Finished as_json = run({"sealwatch", "fit", "--asset", asset_file, log, "--json"});
  EXPECT_EQ(run({"sealwatch", "fit", "--asset", asset_file, log, "--json", "--threads", "1"}).output, as_json.output);
  EXPECT_EQ(json::parse(as_json.output)["recordings"], json({log + "#1", log + "#2"})) << as_json.output;
  const Finished validated = run({"sealwatch", "validate", "--asset", asset_file, log, "--out", path("validated")});
  EXPECT_THAT(validated.output, HasSubstr("log.csv#2"));
}

// A pendulum that a controller holds upright, with the controller's torque alone: fitted states at its start follow it for
// a while, and say nothing.
TEST_F(OwnPlantCommands, AFitOfAPlantThatRunsAwayIsNotAdmissible) {
  write("pendulum.yaml", R"yaml(name: held_pendulum
meaning: a pendulum that stands on a fixed pivot
inputs: {u: {unit: N m, meaning: torque}}
outputs: {angle: {value: phi, unit: rad, noise_std: 1.0e-4, meaning: from upright}}
parameters:
  g: {value: 20, unit: 1/s2, meaning: gravity over length}
  d: {value: 0.1, unit: 1/s, meaning: friction of the bearing, estimate: true}
  J: {value: 0.1, unit: kg m2, meaning: inertia}
states:
  phi: {der: w, unit: rad, start: angle}
  w: {der: g*sin(phi) - d*w + u/J, unit: rad/s, start: 0, size: 1.0}
elements: {}
law_sizes: {}
)yaml");
  std::ostringstream log;
  log << "time,u,angle\n" << std::setprecision(12);
  constexpr double kStep = 1.0e-4, kInertia = 0.1;
  double phi = 0.0, w = 0.0;
  for (int k = 0; k <= 80000; ++k) {
    const double u = kInertia * (60.0 * (0.1 * std::sin(1.5 * kStep * k) - phi) - 10.0 * w);
    if (k % 100 == 0) log << kStep * k << "," << u << "," << phi + 1.0e-4 * std::sin(0.37 * k * k) << "\n";
    w += kStep * (20.0 * std::sin(phi) - 0.2 * w + u / kInertia);
    phi += kStep * w;
  }
  const std::string asset_file = write("pendulum-1.yaml", "asset_id: P-1\nmodel: pendulum.yaml\n");
  const Finished fit = run({"sealwatch", "fit", "--asset", asset_file, write("log.csv", log.str())});
  EXPECT_EQ(fit.status, 1) << fit.output;
  EXPECT_THAT(fit.output, AllOf(HasSubstr("NOT admissible"), HasSubstr("- The simulated plant runs away by itself")));
}

// A slow wave and a little noise that is the same in every run.
std::string trace(double gain, unsigned seed) {
  std::ostringstream text;
  text << "time,position[mm]\n";
  std::uint64_t state = seed;
  for (int k = 0; k < 800; ++k) {
    double noise = -6.0;
    for (int n = 0; n < 12; ++n) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      noise += static_cast<double>(state >> 11U) * 0x1p-53;
    }
    text << 0.01 * k << "," << 20.0 + gain * 10.0 * std::sin(0.02 * k) + (seed > 0 ? 0.05 * noise : 0.0) << "\n";
  }
  return text.str();
}

TEST_F(OwnPlantCommands, ATraceThatAgreesIsConsistentAndOneWithAGainSaysWhatExplainsIt) {
  const std::string recorded = write("recorded.csv", trace(1.0, 7));
  const Finished same =
      run({"sealwatch", "validate", "--simulated", write("same.csv", trace(1.0, 0)), recorded, "--json"});
  EXPECT_EQ(same.status, 0) << same.output;
  EXPECT_EQ(json::parse(same.output)["schema"], "sealwatch.trace/1");
  const std::string page = path("trace.html");
  const Finished other =
      run({"sealwatch", "validate", "--simulated", write("other.csv", trace(1.1, 0)), recorded, "--page", page});
  EXPECT_EQ(other.status, 1) << "the answer is no";
  EXPECT_THAT(other.output, HasSubstr("explains it"));
  EXPECT_THAT(other.output, HasSubstr("gain"));
  std::ostringstream text;
  text << std::ifstream(page).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("<svg"));
}

TEST_F(OwnPlantCommands, ATraceNeedsOneRecordingWithAChannelInCommon) {
  const std::string recorded = write("recorded.csv", trace(1.0, 7));
  const std::string simulated = write("simulated.csv", trace(1.0, 0));
  EXPECT_EQ(run({"sealwatch", "validate", "--simulated", simulated, recorded, recorded}).status, 2);
  const Finished foreign =
      run({"sealwatch", "validate", "--simulated", write("foreign.csv", "time,level[m]\n0,1\n1,2\n2,3\n"), recorded});
  EXPECT_EQ(foreign.status, 2);
  EXPECT_THAT(foreign.output, HasSubstr("foreign.csv"));
}

TEST_F(OwnPlantCommands, ALifeOfAPlantAsTextAgesWhatTheAssetSaysWears) {
  const Finished made = run({"sealwatch", "simulate", "--asset", asset(), "--input", inputs(), "--noise", "--ageing",
                             "--months", "6", "--seed", "3", "--out", path("life")});
  ASSERT_EQ(made.status, 0) << made.output;
  EXPECT_THAT(made.output, HasSubstr("6 months"));
  std::ifstream truth(path("life/truth.jsonl"));
  std::vector<json> lines;
  for (std::string line; std::getline(truth, line);) lines.push_back(json::parse(line));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_GT(lines.back()["F_v_N_s_m"].get<double>(), lines.front()["F_v_N_s_m"].get<double>()) << "friction grows";
  const double theta = lines.back()["theta"], value = lines.back()["F_v_N_s_m"];
  EXPECT_NEAR(value, 2e3 * std::pow(2.0, (1.0 - theta) / 0.4), 1e-6 * value) << "by the asset's line";
  // The recordings tell it back.
  const Finished fit = run({"sealwatch", "fit", "--asset", path("asset.yaml"),
                            path("life/" + lines.back()["recording"].get<std::string>() + ".csv"), "--json"});
  ASSERT_EQ(fit.status, 0) << fit.output;
  const json friction = json::parse(fit.output)["parameters"].front();
  EXPECT_EQ(friction["name"], "F_v");
  EXPECT_NEAR(friction["value"].get<double>(), value, 4.0 * friction["std_error"].get<double>());
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

json last_line(const std::filesystem::path& file) {
  std::string text = text_of(file);
  if (text.empty()) return {};
  text.pop_back();
  return json::parse(text.substr(text.rfind('\n') + 1));
}

// What the asset's file says of wear is a condition and a remaining life in the services' own processes, too.
TEST_F(OwnPlantCommands, TheSixServicesTellTheLifeOfAWornPacking) {
  constexpr int kMonths = 30;
  std::filesystem::create_directories(folder_ / "config/assets");
  std::filesystem::copy(config() + "/sealwatch.yaml", folder_ / "config/sealwatch.yaml");
  std::filesystem::create_directories(folder_ / "config/plants");
  write("config/plants/worn_packing.yaml", kPlant);
  std::string text = kAsset;
  const std::string valve = write("config/assets/valve.yaml", text.replace(text.find("worn"), 4, "../plants/worn"));
  const Finished made = run({"sealwatch", "simulate", "--asset", valve, "--input", inputs(), "--ageing", "--months",
                             std::to_string(kMonths), "--out", path("life")});
  ASSERT_EQ(made.status, 0) << made.output;
  std::vector<std::string> tests;
  for (const auto& entry : std::filesystem::directory_iterator(path("life")))
    if (entry.path().extension() == ".csv") tests.push_back(entry.path().string());
  ASSERT_EQ(tests.size(), static_cast<std::size_t>(kMonths));
  const auto replayed = [&](std::vector<std::string> command, const char* results) {
    command.insert(command.end(), {"--config", path("config"), "--quiet", "--results", path(results)});
    command.insert(command.end(), tests.begin(), tests.end());
    return run(command);
  };
  const Finished live = replayed({"sealwatch", "replay", "--with-services", "--state", path("state")}, "live");
  ASSERT_EQ(live.status, 0) << live.output;
  const Finished offline = replayed({"sealwatch", "replay", "--offline"}, "offline");
  ASSERT_EQ(offline.status, 0) << offline.output;
  for (const char* topic : {"test_features", "state_report", "health_report", "leakage_estimate", "remaining_life",
                            "pst_request", "advisory"}) {
    const std::string file = std::string(topic) + ".jsonl", lines = text_of(folder_ / "live" / file);
    EXPECT_GE(std::count(lines.begin(), lines.end(), '\n'), kMonths) << topic;
    EXPECT_TRUE(lines == text_of(folder_ / "offline" / file)) << topic;
  }
  const json truth = last_line(folder_ / "life/truth.jsonl");
  const json estimate = last_line(folder_ / "live/leakage_estimate.jsonl");
  EXPECT_EQ(estimate["parameter"], "F_v");
  EXPECT_EQ(estimate["unit"], "N s/m");
  EXPECT_NEAR(estimate["condition"].get<double>(), truth["theta"].get<double>(), 1e-3);
  const json forecast = last_line(folder_ / "live/remaining_life.jsonl")["forecasts"].front();
  EXPECT_EQ(forecast["state"], "ok") << forecast;
  EXPECT_GT(forecast["rul_months"].get<double>(), 12.0) << "27 % went in 30 months, 13 % are left";
  EXPECT_LT(forecast["rul_months"].get<double>(), 120.0);
  const json advisory = last_line(folder_ / "live/advisory.jsonl");
  EXPECT_THAT(advisory["recommendation"].get<std::string>(), HasSubstr("Condition of the stem packing"));
}

TEST_F(OwnPlantCommands, ALifeNeedsToKnowWhatWearsAndOneTest) {
  const std::string bare = asset("asset_id: V-9\nmodel: worn_packing.yaml\n");
  const Finished unknown =
      run({"sealwatch", "simulate", "--asset", bare, "--input", inputs(), "--ageing", "--out", path("a")});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.output, HasSubstr("condition"));
  const std::string file = inputs();
  const Finished two =
      run({"sealwatch", "simulate", "--asset", asset(), "--input", file, file, "--months", "3", "--out", path("b")});
  EXPECT_EQ(two.status, 2);
  EXPECT_THAT(two.output, HasSubstr("2 files"));
}

TEST_F(OwnPlantCommands, AnExportedUnitIsImportedAgainAndABadPlaceIsNamed) {
  const std::string fmu = path("valve.fmu");
  const Finished exported = run({"sealwatch", "plant", "export", "--asset", asset(), "--fmu", fmu});
  ASSERT_EQ(exported.status, 0) << exported.output;
  EXPECT_THAT(exported.output, HasSubstr("FMI 2.0"));
  const Finished imported = run({"sealwatch", "plant", "import", fmu, "--out", path("again.yaml")});
  EXPECT_EQ(imported.status, 0) << imported.output;
  std::ostringstream text;
  text << std::ifstream(path("again.yaml")).rdbuf();
  for (const char* name : {"F_v", "command", "stem"}) EXPECT_THAT(text.str(), HasSubstr(name));
  const Finished nowhere =
      run({"sealwatch", "plant", "export", "--asset", path("asset.yaml"), "--fmu", path("no such folder/valve.fmu")});
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_THAT(nowhere.output, HasSubstr("no such folder"));
  const std::string built_in = std::string(SEALWATCH_SOURCE_DIR) + "/config/assets/xt03-mv2.yaml";
  const Finished again = run({"sealwatch", "plant", "export", "--asset", built_in, "--fmu", fmu});
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.output, HasSubstr("is there already"));
  const Finished other = run({"sealwatch", "plant", "export", "--asset", built_in, "--fmu", path("actuator.fmu")});
  EXPECT_EQ(other.status, 0) << other.output;
}

// Lives that fall from 1 by `rate` a month, steepening, up and down by `scatter`.
std::string life(double rate, int tests, double scatter = 0.0007) {
  std::ostringstream text;
  text << "time[iso8601],theta[1],theta_std[1]\n";
  for (int k = 0; k < tests; ++k) {
    char line[80];
    std::snprintf(line, sizeof line, "%d-%02d-10T00:00:00Z,%.6f,0.001\n", 2020 + k / 12, k % 12 + 1,
                  1.0 - rate * (k + 1) * (1.0 + 0.004 * k) + scatter * ((k * 7) % 5 - 2));
    text << line;
  }
  return text.str();
}

TEST_F(OwnPlantCommands, AFleetsHistoriesGiveConstantsThatTheConfigurationTakes) {
  const std::vector<std::string> histories = {write("1.csv", life(0.0030, 80)), write("2.csv", life(0.0040, 70)),
                                              write("3.csv", life(0.0035, 60)), write("short.csv", life(0.003, 5))};
  std::vector<std::string> command = {"sealwatch", "fleet", "fit"};
  command.insert(command.end(), histories.begin(), histories.end());
  const Finished text = run(command);
  ASSERT_EQ(text.status, 0) << text.output;
  EXPECT_THAT(text.output, HasSubstr("3 lives"));
  EXPECT_THAT(text.output, HasSubstr("fewer than 12 tests: 1"));
  const std::size_t begin = text.output.find("services:");
  ASSERT_NE(begin, std::string::npos);
  // What it prints is a configuration, and another fleet would give another one.
  std::filesystem::create_directories(folder_ / "configuration/assets");
  const std::string configuration = write("configuration/sealwatch.yaml", text.output.substr(begin));
  const Finished checked = run({"sealwatch", "config", "check", "--config", configuration});
  EXPECT_THAT(checked.output, Not(HasSubstr("initial_rate")));
  command.emplace_back("--json");
  const Finished machine = run(command);
  ASSERT_EQ(machine.status, 0) << machine.output;
  const json result = json::parse(machine.output);
  EXPECT_EQ(result["schema"], "sealwatch.fleet/1");
  EXPECT_EQ(result["lives"], 3);
  EXPECT_EQ(result["passed_over"], 1);
  EXPECT_GT(result["std_errors"]["initial_rate"].get<double>(), 0.0);
  EXPECT_GT(result["std_errors"]["irregularity_std"].get<double>(), 0.0);
  EXPECT_TRUE(result["limits"].empty());
  EXPECT_GT(result["constants"]["initial_rate"].get<double>(), 0.0);
}

// Lives that are too regular tell no irregularity, but what it is at most.
TEST_F(OwnPlantCommands, ARegularFleetHasALimitInPlaceOfAnIrregularity) {
  std::vector<std::string> command = {"sealwatch",
                                      "fleet",
                                      "fit",
                                      write("1.csv", life(0.0030, 80, 0.0)),
                                      write("2.csv", life(0.0040, 70, 0.0)),
                                      write("3.csv", life(0.0035, 60, 0.0))};
  const Finished text = run(command);
  ASSERT_EQ(text.status, 0) << text.output;
  EXPECT_THAT(text.output, HasSubstr("limit, 95 %"));
  command.emplace_back("--json");
  const json result = json::parse(run(command).output);
  EXPECT_TRUE(result["std_errors"]["irregularity_std"].is_null());
  ASSERT_EQ(result["limits"].size(), 1U);
  EXPECT_EQ(result["limits"][0]["name"], "irregularity_std");
}

TEST_F(OwnPlantCommands, AFleetWithoutALongLifeOrWithTooFewDatesIsRefused) {
  const std::string brief = write("short.csv", life(0.003, 5)), whole = write("long.csv", life(0.003, 40));
  const Finished none = run({"sealwatch", "fleet", "fit", brief});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.output, HasSubstr("at least 12"));
  const Finished dates = run({"sealwatch", "fleet", "fit", whole, whole, "--installed", "2019-12-01"});
  EXPECT_EQ(dates.status, 2);
  EXPECT_THAT(dates.output, HasSubstr("--installed"));
  const Finished twice = run({"sealwatch", "fleet", "fit", whole, write("copy.csv", life(0.003, 40))});
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.output, HasSubstr("copy.csv: holds the same tests as "));
  const Finished bad = run({"sealwatch", "fleet", "fit", write("bad.csv", "time[iso8601],theta[1]\n2020-01-01,x\n")});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.output, HasSubstr("bad.csv"));
}

}  // namespace
}  // namespace sealwatch::testing
