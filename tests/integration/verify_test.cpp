// `sealwatch verify` and `sealwatch validate` as a scheduler and an engineer use them.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/six_services.hpp"

namespace sealwatch::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Verify : public SixServices {
 protected:
  static std::string asset() { return config() + "/assets/xt03-mv2.yaml"; }
  [[nodiscard]] std::string place(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] static std::string contents(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  /// Ten short lives with few forecasters, unless `more` says otherwise: what matters is how they are put together.
  [[nodiscard]] Finished verify(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"sealwatch", "verify", "rul", "--asset", asset(), "--out", place(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::vector<std::pair<std::string, std::string>> usual{
        {"--lives", "10"},
        {"--seed", "3"},
        {"--months", "120"},  // more than enough for lives of four to six years
        {"--degradation", "steepening_limit_min=0.012"},
        {"--degradation", "steepening_limit_max=0.016"},
        {"--forecaster", "ols:24"},
        {"--forecaster", "state_space"}};
    for (const auto& [option, value] : usual)
      if (std::find(more.begin(), more.end(), option) == more.end()) {
        arguments.push_back(option);
        arguments.push_back(value);
      }
    return run(arguments);
  }
  [[nodiscard]] Finished merge(const std::vector<std::string>& folders, const std::string& out) const {
    std::vector<std::string> arguments{"sealwatch", "verify", "merge", "--out", place(out)};
    for (const std::string& folder : folders) arguments.push_back(place(folder));
    return run(arguments);
  }
};

TEST_F(Verify, ShardsAndThreadsGiveTheResultOfOneRun) {
  const Finished whole = verify("whole", {"--threads", "2"});
  ASSERT_EQ(whole.status, 0) << whole.output;
  EXPECT_THAT(whole.output, HasSubstr("state_space 240"));
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const Finished part = verify("shard" + std::string(1, shard[0]), {"--shard", shard, "--threads", "1"});
    ASSERT_EQ(part.status, 0) << part.output;
    EXPECT_THAT(part.output, HasSubstr("verify merge"));
  }
  const Finished merged = merge({"shard3", "shard1", "shard2"}, "merged");
  ASSERT_EQ(merged.status, 0) << merged.output;
  const std::string results = contents(place("whole/results.json"));
  EXPECT_EQ(contents(place("merged/results.json")), results);
  EXPECT_EQ(contents(place("merged/report.html")), contents(place("whole/report.html")));

  const json summary = json::parse(results);
  EXPECT_EQ(summary["schema"], "sealwatch.verification/1");
  EXPECT_EQ(summary["lives"], 10);
  EXPECT_EQ(summary["censored_lives"], 0);
  ASSERT_EQ(summary["methods"].size(), 3U);
  EXPECT_EQ(summary["methods"][2]["method"], "oracle");
  const json& oracle = summary["methods"][2];
  EXPECT_EQ(oracle["convergence_rate"]["of"], 10);
  EXPECT_LT(oracle["last_year_error_months"]["value"], 2.0);
  EXPECT_GT(oracle["alpha_lambda_mass"]["value"], 0.3);
  EXPECT_EQ(oracle["alpha_lambda_by_mass_share"]["of"], 10);
  EXPECT_NEAR(summary["estimate"]["mean_squared_error_over_variance"]["value"].get<double>(), 1.0, 0.3);
  for (const char* plot : {"<svg", "Degradation of the first lives", "Estimate against truth", "Convergence rate",
                           "Timely share", "Final error", "Width of the 95 % interval", "PIT", "Worst lives"})
    EXPECT_THAT(contents(place("whole/report.html")), HasSubstr(plot));
}

TEST_F(Verify, GoesOnWithAnInterruptedRunAndNothingElse) {
  ASSERT_EQ(verify("begun", {"--shard", "1/2"}).status, 0);
  EXPECT_EQ(verify("begun").status, 2);  // holds lives
  const Finished other = verify("begun", {"--resume", "--months", "100"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.output, HasSubstr("'months = 120' against 'months = 100'"));
  const Finished rest = verify("begun", {"--resume"});
  ASSERT_EQ(rest.status, 0) << rest.output;
  EXPECT_EQ(json::parse(contents(place("begun/cost.json")))["found_lives"], 5);
  ASSERT_EQ(verify("whole").status, 0);
  EXPECT_EQ(contents(place("begun/results.json")), contents(place("whole/results.json")));
}

TEST_F(Verify, ScenariosStandInOneTableWhateverTheShards) {
  const std::vector<std::string> several{
      "--scenario", "reference,outliers,missing,aborted,replaced,load_change,contamination", "--lives", "4"};
  const Finished whole = verify("all", several);
  ASSERT_EQ(whole.status, 0) << whole.output;
  const json table = json::parse(contents(place("all/scenarios.json")));
  EXPECT_EQ(table["schema"], "sealwatch.verification_scenarios/1");
  ASSERT_EQ(table["scenarios"].size(), 7U);
  for (const json& scenario : table["scenarios"]) {
    EXPECT_THAT(whole.output, HasSubstr(scenario["scenario"].get<std::string>()));
    ASSERT_EQ(scenario["methods"].size(), 3U) << scenario["scenario"];
    EXPECT_EQ(scenario["lives"], 4);
    for (const json& method : scenario["methods"])
      EXPECT_EQ(method["last_year_error_months"]["interval_95"].size(), 2U) << method;
  }
  EXPECT_THAT(contents(place("all/scenarios.html")), HasSubstr("<svg"));
  // The reference is the run without any scenario.
  ASSERT_EQ(verify("plain", {"--lives", "4"}).status, 0);
  EXPECT_EQ(contents(place("all/reference/results.json")), contents(place("plain/results.json")));
  EXPECT_NE(contents(place("all/outliers/lives/000000.life")), contents(place("plain/lives/000000.life")));

  for (const char* shard : {"1/2", "2/2"}) {
    std::vector<std::string> part = several;
    part.insert(part.end(), {"--shard", shard});
    ASSERT_EQ(verify("part" + std::string(1, shard[0]), part).status, 0);
  }
  const Finished merged = merge({"part2", "part1"}, "together");
  ASSERT_EQ(merged.status, 0) << merged.output;
  EXPECT_EQ(contents(place("together/scenarios.json")), contents(place("all/scenarios.json")));
  EXPECT_EQ(contents(place("together/scenarios.html")), contents(place("all/scenarios.html")));
}

TEST_F(Verify, AOneScenarioRunIsAnOrdinaryOne) {
  const Finished one = verify("one", {"--scenario", "outliers", "--lives", "2"});
  ASSERT_EQ(one.status, 0) << one.output;
  EXPECT_EQ(json::parse(contents(place("one/results.json")))["setting"]["scenario"], "outliers");
  const Finished other = verify("one", {"--lives", "2", "--resume"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.output, HasSubstr("'scenario = outliers' against 'scenario = reference'"));
}

TEST_F(Verify, BadInputIsRefusedWithItsRule) {
  const auto refused = [&](const std::vector<std::string>& more, const char* rule) {
    const Finished finished = verify("bad", more);
    EXPECT_EQ(finished.status, 2) << finished.output;
    EXPECT_THAT(finished.output, HasSubstr(rule));
  };
  refused({"--lives", "0"}, "an empty fleet");
  refused({"--shard", "3/2"}, "1 <= k <= n");
  refused({"--truth", "circus"}, "circuit");
  refused({"--scenario", "outlier"}, "did you mean 'outliers'?");
  refused({"--forecaster", "olss"}, "did you mean");
  refused({"--degradation", "n0=3"}, "did you mean");
  refused({"--months", "0"}, "months");
  EXPECT_EQ(merge({"nowhere"}, "merged").status, 2);
  ASSERT_EQ(verify("half", {"--shard", "2/2"}).status, 0);
  const Finished half = merge({"half"}, "merged");
  EXPECT_EQ(half.status, 2);
  EXPECT_THAT(half.output, HasSubstr("5 of 10 lives are missing, the first is number 0"));
}

TEST_F(Verify, ValidateTellsAWornSealFromTheAssetFile) {
  ASSERT_EQ(
      run({"sealwatch", "simulate", "--asset", asset(), "--condition", "0.8", "--seed", "5", "--out", place("worn")})
          .status,
      0);
  std::string recording;
  for (const auto& entry : std::filesystem::directory_iterator(place("worn")))
    if (entry.path().extension() == ".csv") recording = entry.path().string();
  const std::vector<std::string> command{"sealwatch", "validate", "--asset",          asset(),
                                         recording,   "--out",    place("validation")};
  const Finished as_it_stands = run(command);
  EXPECT_EQ(as_it_stands.status, 1) << as_it_stands.output;
  json result = json::parse(contents(place("validation/validation.json")));
  EXPECT_EQ(result["schema"], "sealwatch.validation/1");
  EXPECT_FALSE(result["valid"].get<bool>());
  std::vector<std::string> with_fit = command;
  with_fit.emplace_back("--fit");
  const Finished fitted = run(with_fit);
  EXPECT_EQ(fitted.status, 0) << fitted.output;
  result = json::parse(contents(place("validation/validation.json")));
  EXPECT_TRUE(result["valid"].get<bool>());
  EXPECT_NEAR(result["recordings"][0]["channels"]["position"]["noise_normalised_rms"].get<double>(), 1.0, 0.1);
  EXPECT_THAT(contents(place("validation/report.html")), HasSubstr("autocorrelation of the residual"));
  EXPECT_EQ(run({"sealwatch", "validate", "--asset", asset(), place("none.csv"), "--out", place("validation")}).status,
            2);
}

}  // namespace
}  // namespace sealwatch::testing
