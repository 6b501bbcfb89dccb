// `sealwatch` as scripts use it: machine-readable results, exit status, errors that name file and place.
#include <gmock/gmock.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "sealwatch/core/time.hpp"
#include "services/common/message/json.hpp"
#include "tests/integration/six_services.hpp"
#include "tests/integration/two_seconds.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class Commands : public SixServices {
 protected:
  static std::string asset() { return config() + "/assets/xt03-mv2.yaml"; }
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    const std::string file = (folder_ / name).string();
    std::ofstream(file) << text;
    return file;
  }
  /// One test of a worn seal, with the truth.
  [[nodiscard]] std::pair<std::string, json> worn_test() const {
    const std::string folder = (folder_ / "worn").string();
    const Finished made = run({"sealwatch", "simulate", "--asset", asset(), "--condition", "0.8", "--rate", "100",
                               "--seed", "5", "--out", folder});
    EXPECT_EQ(made.status, 0) << made.output;
    json truth;
    std::ifstream(folder + "/truth.jsonl") >> truth;
    return {folder + "/" + truth["recording"].get<std::string>() + ".csv", truth};
  }
  /// A history that falls by `per_month` from 0.95 over `tests` months.
  [[nodiscard]] std::string history(int tests, double per_month) const {
    std::string text = "time[iso8601],theta[1],theta_std[1]\n";
    for (int k = 0; k < tests; ++k) {
      char line[80];
      std::snprintf(line, sizeof line, "%d-%02d-10T00:00:00Z,%.6f,0.001\n", 2020 + k / 12, k % 12 + 1,
                    0.95 - per_month * k + 0.0005 * (k % 3 - 1));
      text += line;
    }
    return write("history.csv", text);
  }
};

TEST_F(Commands, FitRecoversTheBenchAndPrintsItsSchema) {
  const auto [recording, truth] = worn_test();
  const Finished fit = run({"sealwatch", "fit", "--asset", asset(), recording, "--json"});
  ASSERT_EQ(fit.status, 0) << fit.output;
  const json result = json::parse(fit.output);
  EXPECT_EQ(result["schema"], "sealwatch.fit/1");
  EXPECT_EQ(result["asset_id"], "XT03-MV2");
  EXPECT_TRUE(result["admissible"].get<bool>());
  EXPECT_EQ(result["loads"].size(), 1U);
  for (const char* key : {"noise_normalised_rms", "nrmse_percent", "whiteness_p", "independence_p"})
    EXPECT_TRUE(result["channels"]["pressure_a"].contains(key)) << key;
  const auto leakage = std::find_if(result["parameters"].begin(), result["parameters"].end(),
                                    [](const json& p) { return p["name"] == "R_CL"; });
  ASSERT_NE(leakage, result["parameters"].end());
  EXPECT_EQ((*leakage)["unit"], "Pa s/m3");
  EXPECT_TRUE((*leakage)["free"].get<bool>());
  // Four standard errors: one chance in 16 000 for an honest estimate.
  EXPECT_NEAR((*leakage)["value"].get<double>(), truth["R_CL_Pa_s_m3"].get<double>(),
              4.0 * (*leakage)["std_error"].get<double>());
}

TEST_F(Commands, FitOfTheCylinderCircuitAgrees) {
  const auto [recording, truth] = worn_test();
  const Finished fit =
      run({"sealwatch", "fit", "--asset", asset(), "--model", "cylinder_circuit", recording, "--json"});
  ASSERT_EQ(fit.status, 0) << fit.output;
  const json leakage = json::parse(fit.output)["parameters"][0];
  EXPECT_EQ(leakage["name"], "R_CL");
  EXPECT_NEAR(leakage["value"].get<double>(), truth["R_CL_Pa_s_m3"].get<double>(),
              4.0 * leakage["std_error"].get<double>());
  // The asset named on the command line is the recording's, whether or not a sidecar says so.
  std::filesystem::remove(std::filesystem::path(recording).replace_extension(".yaml"));
  const Finished bare =
      run({"sealwatch", "fit", "--asset", asset(), "--model", "cylinder_circuit", recording, "--json"});
  ASSERT_EQ(bare.status, 0) << bare.output;
  EXPECT_NEAR(json::parse(bare.output)["parameters"][0]["value"].get<double>(), leakage["value"].get<double>(),
              leakage["std_error"].get<double>());
}

TEST_F(Commands, ForecastOfASteadyDeclineMeetsItsEnd) {
  // 0.95 - 0.005 k reaches 0.60 at k = 70; the last of 48 tests is k = 47: 23 months are left.
  const Finished forecast =
      run({"sealwatch", "forecast", "--history", history(48, 0.005), "--before", "2025-06-01", "--json"});
  ASSERT_EQ(forecast.status, 0) << forecast.output;
  const json result = json::parse(forecast.output);
  EXPECT_EQ(result["schema"], "sealwatch.forecast/1");
  EXPECT_EQ(result["at"], "2023-12-10T00:00:00Z");
  int windows = 0;
  for (const json& one : result["forecasts"]) {
    if (one["method"] != "ols") continue;
    ++windows;
    EXPECT_EQ(one["state"], "ok") << one;
    EXPECT_NEAR(one["rul_months"]["p50"].get<double>(), 23.0, 1.0) << one;
    EXPECT_LT(one["rul_months"]["p10"], one["rul_months"]["p90"]);
    EXPECT_EQ(one["interval_95"].size(), 2U);
    EXPECT_EQ(one["end_of_life"].get<std::string>().substr(0, 4), "2025");
    EXPECT_TRUE(one["failure_probability_before"].contains("2025-06-01"));
  }
  EXPECT_EQ(windows, 3);
}

TEST_F(Commands, ForecastSaysWhichDateItPassesOver) {
  const Finished forecast = run({"sealwatch", "forecast", "--history", history(48, 0.005), "--before", "2020-06-01"});
  EXPECT_EQ(forecast.status, 0);
  EXPECT_THAT(forecast.output, HasSubstr("--before 2020-06-01: passed over, as it is not after the last test"));
}

TEST_F(Commands, ForecastSaysWhenItCannotTell) {
  const Finished few = run({"sealwatch", "forecast", "--history", history(5, 0.005), "--json"});
  EXPECT_EQ(json::parse(few.output)["forecasts"][0]["state"], "insufficient_history");
  EXPECT_FALSE(json::parse(few.output)["forecasts"][0].contains("rul_months"));
  EXPECT_EQ(
      json::parse(
          run({"sealwatch", "forecast", "--history", history(48, 0.0), "--json"}).output)["forecasts"][0]["state"],
      "no_significant_trend");
  EXPECT_EQ(
      json::parse(
          run({"sealwatch", "forecast", "--history", history(48, 0.01), "--json"}).output)["forecasts"][0]["state"],
      "past_threshold");
}

TEST_F(Commands, ForecastSaysWhichTestsItDoesNotBelieveOrKnowTheErrorOf) {
  std::string known = "time[iso8601],theta[1],theta_std[1]\n";
  std::string unknown = "time[iso8601],theta[1]\n";
  for (int k = 0; k < 30; ++k) {
    char line[80];
    std::snprintf(line, sizeof line, "%d-%02d-10,%.4f", 2020 + k / 12, k % 12 + 1, 0.95 - 0.005 * k);
    known.append(line).append(k == 20 ? ",0.5\n" : ",0.001\n");  // a test that says nothing
    unknown.append(line).append("\n");
  }
  const Finished vague = run({"sealwatch", "forecast", "--history", write("vague.csv", known), "--json"});
  ASSERT_EQ(vague.status, 0) << vague.output;
  EXPECT_EQ(json::parse(vague.output)["left_out"], json::array({"2021-09-10T00:00:00Z"}));
  EXPECT_EQ(json::parse(vague.output)["tests"], 30);
  EXPECT_EQ(json::parse(vague.output)["tests_without_standard_error"], 0);
  const Finished without = run({"sealwatch", "forecast", "--history", write("without.csv", unknown)});
  ASSERT_EQ(without.status, 0) << without.output;
  EXPECT_THAT(without.output, HasSubstr("standard errors: unknown for 30 of 30 tests"));
}

TEST_F(Commands, ForecastRefusesAHistoryThatIsNoneWithRowAndColumn) {
  const auto refused = [this](const std::string& text, const std::vector<std::string>& says, bool with_asset = false) {
    std::vector<std::string> command{"sealwatch", "forecast", "--history", write("bad.csv", text)};
    if (with_asset) command.insert(command.end(), {"--asset", asset()});
    const Finished finished = run(command);
    EXPECT_EQ(finished.status, 2) << finished.output;
    for (const std::string& part : says) EXPECT_THAT(finished.output, HasSubstr(part));
  };
  const std::string head = "time[iso8601],theta[1],theta_std[1]\n2020-01-10,0.95,0.001\n";
  refused(head + "2020-02-10,0.94,0.001\n2020-02-10,0.94,0.001\n", {"row 4", "2020-02-10", "comes not after"});
  refused(head + "2020-03-10,0.94,0.001\n2020-02-10,0.93,0.001\n", {"row 4", "2020-02-10", "sort the rows"});
  refused(head + "2020-02-10,0.94,\n", {"row 3", "theta_std[1]", "is missing"});
  refused(head + "2020-02-10,0.94,-0.001\n", {"row 3", "theta_std[1]", "-0.001"});
  refused(head + "2020-02-10,nan,0.001\n", {"row 3", "theta[1]", "nan", "must be a finite number"});
  refused("", {"bad.csv", "is empty"});
  refused("time[iso8601],theta[1],theta_std[1]\n", {"bad.csv", "has no row of data"});
  refused("time[iso8601],R_CL[Pa s/m3]\n2020-01-10,2e13\n2020-02-10,-2e13\n", {"row 3", "R_CL[Pa s/m3]", "-2e13"},
          true);
  refused("time[iso8601],R_CL[Pa s/m3]\n2020-01-10,2e13\n2020-02-10,0\n", {"row 3", "R_CL[Pa s/m3]"}, true);
}

TEST_F(Commands, ForecastWritesAPageWithTheDecision) {
  const std::string page = (folder_ / "page.html").string();
  const std::vector<std::string> command{"sealwatch",   "forecast",   "--history",  history(48, 0.005),
                                         "--before",    "2024-12-01", "2027-06-01", "--costs",
                                         "10,50,2,0.2", "--page",     page};
  const Finished text = run(command);
  ASSERT_EQ(text.status, 0) << text.output;
  EXPECT_THAT(text.output, ::testing::AllOf(HasSubstr("expected cost"), HasSubstr("cheapest"), HasSubstr(page)));
  std::ostringstream html;
  html << std::ifstream(page).rdbuf();
  for (const char* part : {"</html>", "Condition of the piston seal", "end of life, 80 % interval",
                           "Probability of failure before the replacement", "Expected cost of the replacement",
                           "wait for failure", "cheapest", "state space 240"})
    EXPECT_THAT(html.str(), HasSubstr(part));
  for (const char* outside : {"src=", "href=", "<link", "@import", "url("})
    EXPECT_EQ(html.str().find(outside), std::string::npos) << "not self-contained: " << outside;
  // In figures: 23 months are left; the second date is after them, the first before.
  std::vector<std::string> as_json = command;
  as_json.emplace_back("--json");
  const json decision = json::parse(run(as_json).output)["decision"];
  ASSERT_EQ(decision.size(), 4U);
  EXPECT_EQ(decision[0]["replacement"], "now");
  EXPECT_NEAR(decision[0]["expected_cost"].get<double>(), 10.0 + 0.2 * 23.0, 0.3);
  EXPECT_EQ(decision[1]["cheapest"], true);
  EXPECT_NEAR(decision[2]["failure_probability_before"].get<double>(), 1.0, 0.01);
  EXPECT_EQ(decision[3]["expected_cost"], 50.0 + 2.0 * 12.0);

  // Without a forecast there is a page too, which says so.
  const Finished steady = run({"sealwatch", "forecast", "--history", history(48, 0.0), "--page", page});
  EXPECT_EQ(steady.status, 1) << steady.output;
  std::ostringstream silent;
  silent << std::ifstream(page).rdbuf();
  EXPECT_THAT(silent.str(), HasSubstr("Without a forecast, dates cannot be compared"));
}

TEST_F(Commands, ForecastTakesCampaignsFromTheConfiguration) {
  const Finished forecast = run(
      {"sealwatch", "forecast", "--history", history(48, 0.005), "--asset", asset(), "--config", config(), "--json"});
  ASSERT_EQ(forecast.status, 0) << forecast.output;
  const json decision = json::parse(forecast.output)["decision"];
  EXPECT_EQ(decision[1]["replacement"], "summer 2025");
  EXPECT_FALSE(decision[1].contains("expected_cost")) << "the site gives no costs";
  const auto refused = [this](const std::vector<std::string>& more, const char* says) {
    std::vector<std::string> command{"sealwatch", "forecast", "--history", history(48, 0.005)};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = run(command);
    EXPECT_EQ(finished.status, 2) << finished.output;
    EXPECT_THAT(finished.output, HasSubstr(says));
  };
  refused({"--config", config()}, "needs --asset");
  refused({"--costs", "10,50,2"}, "must be four numbers");
  refused({"--costs", "10,50,-2,0"}, "must not be negative");
  refused({"--page", (folder_ / "none" / "page.html").string()}, "cannot be written");
}

TEST_F(Commands, ForecastTellsNoProbabilityWithoutAForecast) {
  const Finished steady = run({"sealwatch", "forecast", "--history", history(48, 0.0), "--before", "2025-06-01"});
  EXPECT_EQ(steady.status, 1);
  EXPECT_THAT(steady.output, HasSubstr("P(failure)       unknown"));
  const Finished failed =
      run({"sealwatch", "forecast", "--history", history(48, 0.01), "--before", "2025-06-01", "--json"});
  EXPECT_EQ(failed.status, 1);
  const json in_charge = json::parse(failed.output)["forecasts"][0];
  EXPECT_EQ(in_charge["state"], "past_threshold");
  EXPECT_EQ(in_charge["failure_probability_before"]["2025-06-01"], 1.0);
}

TEST_F(Commands, BadInputNamesFileAndPlaceAndExitsWithTwo) {
  const auto refused = [this](const std::vector<std::string>& arguments) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 2) << finished.output;
    return finished.output;
  };
  const std::string text_in_number = write("bad.csv", "time[s],position[mm]\n0.0,1.0\n0.1,abc\n");
  EXPECT_THAT(refused({"sealwatch", "fit", "--asset", asset(), text_in_number}),
              ::testing::AllOf(HasSubstr("bad.csv"), HasSubstr("row 3"), HasSubstr("position"), HasSubstr("abc")));
  EXPECT_THAT(
      refused({"sealwatch", "fit", "--asset", write("asset.yaml", "asset_id: A\nparametres: {}\n"), text_in_number}),
      ::testing::AllOf(HasSubstr("line 2"), HasSubstr("parametres"), HasSubstr("did you mean 'parameters'?")));
  EXPECT_THAT(
      refused({"sealwatch", "forecast", "--history",
               write("twice.csv", "time[iso8601],theta[1],theta_std[1]\n2020-02-01,0.9,0.01\n2020-01-01,0.9,0.01\n")}),
      ::testing::AllOf(HasSubstr("twice.csv"), HasSubstr("row 3")));
  EXPECT_THAT(refused({"sealwatch", "forecast", "--asset", asset(), "--history",
                       write("unit.csv", "time[iso8601],R_CL[Pa s/m3]\n2020-01-01,2e13\n2020-02-01,2e300\n")}),
              ::testing::AllOf(HasSubstr("unit.csv"), HasSubstr("row 3"), HasSubstr("2e300")));
  EXPECT_THAT(refused({"sealwatch", "forecast", "--history", history(48, 0.005), "--threshold", "nan"}),
              HasSubstr("--threshold"));
  for (const char* option : {"--condition", "--rate", "--missing", "--cut"})
    EXPECT_THAT(
        refused({"sealwatch", "simulate", "--asset", asset(), option, "nan", "--ageing", "--out", folder_.string()}),
        ::testing::AllOf(HasSubstr(option), HasSubstr("must be a number")));
  EXPECT_THAT(refused({"sealwatch", "watch", "advisries"}), HasSubstr("did you mean 'advisory'?"));
  EXPECT_THAT(refused({"sealwatch", "replay", "--config", config(), "--speed", "fast", text_in_number}),
              HasSubstr("--speed"));
  EXPECT_THAT(refused({"sealwatch", "replay", "--config", config(), "--offline", "--with-services", text_in_number}),
              ::testing::AllOf(HasSubstr("--with-services"), HasSubstr("--offline")));
  EXPECT_THAT(
      refused({"sealwatch", "replay", "--config", config(), "--offline", "--state", folder_.string(), text_in_number}),
      ::testing::AllOf(HasSubstr("--state"), HasSubstr("--with-services")));
  EXPECT_THAT(refused({"sealwatch", "watch", "--config", config(), "--asset", "XT03-MV3"}),
              ::testing::AllOf(HasSubstr("is not a configured asset"), HasSubstr("did you mean 'XT03-MV2'?")));
  EXPECT_THAT(refused({"sealwatch", "fit", "--asset", "XT03-MV2", text_in_number}),
              HasSubstr("takes an asset file, and there is no file 'XT03-MV2'; for example --asset config/assets/"));
  for (const char* no_file : {"/dev/zero", "/dev/tty", "/tmp"})
    EXPECT_THAT(refused({"sealwatch", "fit", "--asset", no_file, text_in_number}),
                ::testing::AllOf(HasSubstr(std::string(no_file) + ": is a d"), HasSubstr("give a file")));
  for (const char* start : {"2300-01-01", "2250-10-01"})
    EXPECT_THAT(refused({"sealwatch", "simulate", "--asset", asset(), "--start", start, "--months", "2", "--out",
                         folder_.string()}),
                ::testing::AllOf(HasSubstr("--start"), HasSubstr("2250"), HasSubstr("nanoseconds")));
  EXPECT_THAT(refused({"sealwatch", "simulat"}), HasSubstr("did you mean 'simulate'?"));
  EXPECT_THAT(refused({"sealwatch", "simulate", "--asset", asset(), "--condition", "0.5", "--out", folder_.string()}),
              HasSubstr("--condition"));
  EXPECT_THAT(refused({"sealwatch", "replaced", "--config", config(), "XT03-MV2", "--at", "2999-01-01", "--by", "me"}),
              HasSubstr("--at"));
  EXPECT_THAT(refused({"sealwatch", "acknowledge", "--config", config(), "XT03-MV2", "any", "--by", " "}),
              HasSubstr("--by"));
  EXPECT_THAT(refused({"sealwatch", "accept", "--config", config(), "--asset-id", "XT03-MV3", "--discrepancy", "any",
                       "--by", "me"}),
              HasSubstr("did you mean 'XT03-MV2'?"));
}

TEST_F(Commands, AnAssetIdMayHoldWhatAFileNameMayNot) {
  const std::string file = write("slash.yaml", "asset_id: Å/MV2\n");
  const std::string folder = (folder_ / "slash").string();
  const Finished made = run({"sealwatch", "simulate", "--asset", file, "--rate", "50", "--out", folder});
  EXPECT_EQ(made.status, 0) << made.output;
  json truth;
  std::ifstream(folder + "/truth.jsonl") >> truth;
  const std::string recording = folder + "/" + truth["recording"].get<std::string>() + ".csv";
  const Finished fit = run({"sealwatch", "fit", "--asset", file, recording, "--json"});
  EXPECT_EQ(fit.status, 0) << fit.output;
}

TEST_F(Commands, ReplayPassesOverABadRecordingAndSaysSo) {
  const auto [recording, truth] = worn_test();
  const std::string bad = write("empty.csv", "");
  const Finished replay = run({"sealwatch", "replay", "--config", config(), "--offline", "--quiet", bad, recording});
  EXPECT_EQ(replay.status, 2) << replay.output;
  EXPECT_THAT(replay.output, HasSubstr("empty.csv"));
  EXPECT_THAT(replay.output, HasSubstr("R_CL")) << "the good recording is concluded all the same";
}

TEST_F(Commands, ReplayPassesOverAMissingRecordingAndAFolder) {
  const auto [recording, truth] = worn_test();
  const std::string missing = (folder_ / "nofile.csv").string();
  const Finished replay =
      run({"sealwatch", "replay", "--config", config(), "--offline", "--quiet", missing, folder_.string(), recording});
  EXPECT_EQ(replay.status, 2) << replay.output;
  EXPECT_THAT(replay.output,
              ::testing::AllOf(HasSubstr("nofile.csv: does not exist"), HasSubstr("is a folder"), HasSubstr("R_CL")));
}

/// Names that the system cannot follow are bad input, no failure of this program.
TEST_F(Commands, ALinkToItselfAndANameTooLongAreBadInput) {
  const std::string loop = (folder_ / "loop.csv").string();
  std::filesystem::create_symlink("loop.csv", loop);
  for (const std::string& name : {loop, std::string(5000, 'x')}) {
    const std::vector<std::vector<std::string>> commands = {
        {"replay", "--offline", "--config", config(), name},
        {"replay", "--offline", "--config", name, name},
        {"replay", "--offline", "--config", config(), "--asset", name, name},
        {"fit", "--asset", asset(), name},
        {"explain", "--asset", asset(), "--fit", name, "--out", (folder_ / "found").string()},
        {"explain", "--asset", asset(), "--fit", asset(), "--out", name},
        {"forecast", "--asset", name, "--state", folder_.string(), "--config", config()},
        {"forecast", "--history", name},
        {"validate", "--simulated", name, name},
        {"asset", "new", "--from", name, "--out", name},
        {"simulate", "--asset", asset(), "--out", name},
        {"config", "check", "--config", name},
        {"show", "XT03-MV2", "--config", config(), "--state", name},
        {"audit", "--config", config(), "--state", name},
        {"backup", "--config", config(), "--state", name, "--to", name},
        {"plant", "check", name},
        {"fleet", "fit", name}};
    for (std::vector<std::string> command : commands) {
      command.insert(command.begin(), "sealwatch");
      const Finished refused = run(command);
      EXPECT_EQ(refused.status, 2) << command[1] << " " << command[2] << ": " << refused.output.substr(0, 300);
    }
  }
}

TEST_F(Commands, ReplayOfAnotherAssetsRecordingIsRefused) {
  const auto [recording, truth] = worn_test();
  const std::string other = write("other.yaml", "asset_id: XT04-MV2\n");
  const Finished replay =
      run({"sealwatch", "replay", "--config", config(), "--offline", "--quiet", "--asset", other, recording});
  EXPECT_EQ(replay.status, 2) << replay.output;
  EXPECT_THAT(replay.output,
              ::testing::AllOf(HasSubstr("XT03-MV2"), HasSubstr("is not the asset XT04-MV2"), Not(HasSubstr("R_CL"))));
}

TEST_F(Commands, ReplayWhoseResultsFindNoRoomSaysSo) {
  const auto [recording, truth] = worn_test();
  const auto results = folder_ / "results";
  std::filesystem::create_directory(results);
  std::filesystem::create_symlink("/dev/full", results / "advisory.jsonl");
  const Finished replay = run(
      {"sealwatch", "replay", "--config", config(), "--offline", "--quiet", "--results", results.string(), recording});
  EXPECT_EQ(replay.status, 2) << replay.output;
  EXPECT_THAT(replay.output, ::testing::AllOf(HasSubstr("advisory.jsonl"), HasSubstr("make room")));
}

TEST_F(Commands, EachProgramNamesVersionCommitAndBuild) {
  const Finished own = run({"sealwatch", "--version"});
  EXPECT_THAT(own.output, ::testing::MatchesRegex("sealwatch [0-9.]+ \\(commit [^,]+, [^,]+, [^,]+\\)\n"));
  for (const std::string name :
       {"verify", "data-acquisition", "data-manipulation", "state-detection", "health-assessment",
        "prognostic-assessment", "advisory-generation", "virtual-bench"}) {
    const Finished other = run({"sealwatch-" + name, "--version"});
    EXPECT_EQ(other.status, 0) << name;
    EXPECT_EQ(other.output, own.output) << name;
  }
}

/// Half an answer must not look like a whole one: in scripts, the exit status is all that is looked at.
TEST_F(Commands, AnswersThatFindNoRoomAreNoSuccess) {
  const std::string sealwatch = program("sealwatch"), asset_file = "'" + asset() + "'";
  for (const std::string& command :
       {std::string("manual"), std::string("laws"), std::string("laws --json"), std::string("completion bash"),
        std::string("--help"), std::string("--version"), std::string("replay --help"), std::string("plant show eha"),
        "config check --config '" + config() + "'", "forecast --json --history '" + history(40, 0.003) + "'"}) {
    const Finished full = run({"/bin/sh", "-c", "'" + sealwatch + "' " + command + " > /dev/full"});
    EXPECT_EQ(full.status, 2) << command;
    EXPECT_THAT(full.output, HasSubstr("standard output: could not be written")) << command;
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they take all addresses there are
TEST_F(Commands, MemoryThatEndsIsToldAsSuch) {
  const std::string folder = (folder_ / "fast").string();
  const Finished made = run({"sealwatch", "simulate", "--asset", asset(), "--rate", "1000", "--out", folder});
  ASSERT_EQ(made.status, 0) << made.output;
  const Finished ended = run({"/bin/sh", "-c",
                              "ulimit -v 200000; exec '" + program("sealwatch") + "' explain --asset '" + asset() +
                                  "' --fit '" + folder + "'/*.csv --out '" + folder + "'"});
  EXPECT_EQ(ended.status, 3) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("memory is used up: give fewer or shorter recordings"));
}
#endif

/// Those that a help text describes.
std::set<std::string> options_in(const std::string& text) {
  std::set<std::string> options;
  const std::regex option(R"((?:^|\n) +(?:-\w,)?(--[a-z-]+))");
  for (std::sregex_iterator one(text.begin(), text.end(), option), end; one != end; ++one) options.insert((*one)[1]);
  return options;
}

TEST_F(Commands, HelpIsACommandToo) {
  EXPECT_EQ(run({"sealwatch", "help"}).output, run({"sealwatch", "--help"}).output);
  const Finished help = run({"sealwatch", "help", "fit"});
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.output, run({"sealwatch", "fit", "--help"}).output);
}

/// Options in groups are options too.
TEST_F(Commands, CompletionAndManualHaveEveryOptionThatHelpShows) {
  const std::string arms = run({"sealwatch", "completion", "bash"}).output, page = run({"sealwatch", "manual"}).output;
  const std::string help = run({"sealwatch", "--help"}).output;
  const std::regex command(R"((?:^|\n)  ([a-z-]+) )");
  int commands = 0;
  for (std::sregex_iterator one(help.begin(), help.end(), command), end; one != end; ++one, ++commands) {
    const std::string name = (*one)[1];
    const auto of_command = [&](const std::string& text, const std::string& begin, const std::string& after) {
      const std::size_t at = text.find(begin);
      return at == std::string::npos ? std::string() : text.substr(at, text.find(after, at + begin.size()) - at);
    };
    const std::string arm = of_command(arms, "\"sealwatch " + name + "\") words=", ";;");
    std::string section = of_command(page, ".SS \"sealwatch " + name + "\"\n", ".SS ");
    std::erase(section, '\\');
    for (const std::string& option : options_in(run({"sealwatch", name, "--help"}).output)) {
      EXPECT_THAT(arm, HasSubstr(option + " ")) << name;
      if (option != "--help") {
        EXPECT_THAT(section, HasSubstr(option)) << name;
      }
    }
  }
  EXPECT_GT(commands, 25);
}

TEST_F(Commands, ReplayWritesThePageOfTheForecastThatItShows) {
  const std::string page = (folder_ / "life.html").string();
  std::vector<std::string> command{"sealwatch", "replay", "--config", config(),    "--offline",
                                   "--quiet",   "--page", page,       "--results", folder_.string()};
  command.insert(command.end(), recordings().begin(), recordings().end());
  const Finished replay = run(command);
  ASSERT_EQ(replay.status, 0) << replay.output;
  EXPECT_THAT(replay.output, HasSubstr("wrote " + page));
  std::ifstream lives(folder_ / "remaining_life.jsonl");
  std::string last;
  for (std::string line; std::getline(lives, line);) last = line;
  const json in_charge = json::parse(last)["forecasts"][0];
  ASSERT_EQ(in_charge["state"], "ok");
  std::ostringstream html;
  html << std::ifstream(page).rdbuf();
  const std::string end_of_life = format_date(UtcTime{in_charge["end_of_life_ns"].get<std::int64_t>()});
  EXPECT_THAT(html.str(),
              ::testing::AllOf(HasSubstr("<h1>Piston seal of XT03-MV2"),
                               HasSubstr("<span class=\"whole\">" + end_of_life + "</span></b><span>end of life"),
                               HasSubstr("left out by the services: not judged")));
  std::ifstream advisories(folder_ / "advisory.jsonl");
  for (std::string line; std::getline(advisories, line);) last = line;
  const std::string recommendation = json::parse(last)["recommendation"];  // its first sentence is the headline
  EXPECT_THAT(html.str(), HasSubstr(recommendation.substr(0, recommendation.find(". "))));
}

TEST_F(Commands, HelpGroupsTheCommandsInFewWordsAndEachHasAnExample) {
  const Finished help = run({"sealwatch", "--help"});
  ASSERT_EQ(help.status, 0) << help.output;
  for (const char* group : {"Analyse:", "Run:", "Operate:", "Maintain:"}) EXPECT_THAT(help.output, HasSubstr(group));
  EXPECT_THAT(help.output, Not(HasSubstr("Subcommands:"))) << "a command in no group";
  std::istringstream lines(help.output.substr(help.output.find("Analyse:")));
  std::size_t commands = 0;
  for (std::string line; std::getline(lines, line) && !line.starts_with("First steps");) {
    if (!line.starts_with("  ") || line.starts_with("   ")) continue;
    std::istringstream words(line);
    std::string name, word;
    words >> name;
    std::size_t count = 0;
    while (words >> word) ++count;
    EXPECT_LE(count, 10U) << line;
    const Finished one = run({"sealwatch", name, "--help"});
    EXPECT_EQ(one.status, 0) << name;
    EXPECT_THAT(one.output, HasSubstr("Example")) << name;
    ++commands;
  }
  EXPECT_GE(commands, 31U);
}

TEST_F(Commands, WithoutACommandTheFirstOnesAreShownWithAnExampleEach) {
  const Finished bare = run({"sealwatch"});
  EXPECT_EQ(bare.status, 2);
  EXPECT_THAT(bare.output, ::testing::AllOf(::testing::StartsWith("sealwatch: condition monitoring"),
                                            HasSubstr("sealwatch --help lists all")));
  const std::string help = run({"sealwatch", "--help"}).output;
  std::istringstream lines(bare.output);
  int examples = 0;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 120U) << line;
    std::istringstream words(line);
    std::vector<std::string> example{std::istream_iterator<std::string>(words), {}};
    if (!line.starts_with("   ") || example.size() < 3 || example[0] != "sealwatch") continue;
    ++examples;
    EXPECT_THAT(help, HasSubstr("  " + line.substr(line.find("sealwatch")) + "\n")) << "not among the first steps";
    std::vector<std::string> asks{"sealwatch", example[1]};
    if (std::ranges::all_of(example[2], [](char letter) { return std::islower(letter) != 0; }))
      asks.push_back(example[2]);
    asks.emplace_back("--help");
    const Finished command = run(asks);
    EXPECT_EQ(command.status, 0) << line;
    const std::set<std::string> known = options_in(command.output);
    for (const std::string& word : example) {
      EXPECT_TRUE(!word.starts_with("--") || known.contains(word)) << word << " in: " << line;
      EXPECT_TRUE(!word.starts_with("config/") || std::filesystem::exists(SEALWATCH_SOURCE_DIR "/" + word)) << word;
    }
  }
  EXPECT_EQ(examples, 6);
  const std::string shown = (folder_ / "shown.txt").string();
  const std::string unheard = std::string(SEALWATCH_BINARY_DIR "/bin/sealwatch 2>/dev/null >") + shown;
  EXPECT_NE(std::system(unheard.c_str()), 0);
  EXPECT_EQ(std::filesystem::file_size(shown), 0U) << "not on standard error";
}

TEST_F(Commands, WhatIsKeptIsLookedForWithWords) {
  const Finished nothing = run({"sealwatch", "show", "advisory/A", "--state", folder_.string()});
  EXPECT_EQ(nothing.status, 2) << nothing.output;
  EXPECT_THAT(nothing.output, ::testing::AllOf(HasSubstr("holds no journal of a service"), HasSubstr("--state")));
  const Finished forecast = run({"sealwatch", "forecast", "--config", config(), "--state", folder_.string()});
  EXPECT_EQ(forecast.status, 2) << forecast.output;
  EXPECT_THAT(forecast.output, HasSubstr("holds no journal of a service"));
}

TEST_F(Commands, WatchSaysThatNobodyWritesWhatIsWatched) {
  const Finished watch = run({"sealwatch", "watch", "--config", config(), "--seconds", "2.2", "advisory"});
  EXPECT_EQ(watch.status, 0) << watch.output;
  EXPECT_THAT(watch.output, ::testing::AllOf(HasSubstr("no heartbeat from advisory_generation in DDS domain"),
                                             HasSubstr("`sealwatch up`")));
  EXPECT_THAT(run({"sealwatch", "watch", "--config", config(), "--seconds", "2.2", "raw_samples"}).output,
              ::testing::IsEmpty())
      << "a control system writes these";
  EXPECT_THAT(run({"sealwatch", "watch", "--config", config(), "--seconds", "2.2", "service_status"}).output,
              HasSubstr("no heartbeat from any service"));
}

TEST_F(Commands, ReplayWithoutServicesSaysWhatToDo) {
  const auto [recording, truth] = worn_test();
  const Finished replay = run({"sealwatch", "replay", "--config", config(), recording});
  EXPECT_EQ(replay.status, 1) << replay.output;
  EXPECT_THAT(replay.output, HasSubstr("sealwatch up"));
}

TEST_F(Commands, ConfigurationIsCheckedAsAWhole) {
  EXPECT_EQ(run({"sealwatch", "config", "check", "--config", config()}).status, 0);
  const std::string file = write("sealwatch.yaml", "domain: 900\nservises: {}\n");
  const Finished check = run({"sealwatch", "config", "check", "--config", file});
  EXPECT_EQ(check.status, 2);
  EXPECT_THAT(check.output, ::testing::AllOf(HasSubstr("line 1"), HasSubstr("900"), HasSubstr("line 2"),
                                             HasSubstr("did you mean 'services'?")));
  const std::string places =
      write("places.yaml", "state_directory: " + folder_.string() +
                               "\ncyclonedds_uri: \"<CycloneDDS><Domain "
                               "Id='any'><Nonsense/></Domain></CycloneDDS>\"\n"
                               "services: {state_detection: {journal: \"sqlite3:///nowhere/at/all.db\"}}\n");
  const Finished surroundings = run({"sealwatch", "config", "check", "--config", places});
  EXPECT_EQ(surroundings.status, 2);
  EXPECT_THAT(surroundings.output,
              ::testing::AllOf(HasSubstr("key cyclonedds_uri"), HasSubstr("services.state_detection.journal"),
                               HasSubstr("mkdir -p /nowhere/at"), HasSubstr("2 faults found")));
  const std::string unwritable = write("unwritable.yaml",
                                       "state_directory: /proc/x\nassets: []\nservices:\n  data_acquisition:\n    "
                                       "recordings_directory: /proc/y\nlogging: {directory: /dev/full}\n");
  const Finished proc = run({"sealwatch", "config", "check", "--config", unwritable});
  EXPECT_EQ(proc.status, 2);
  EXPECT_THAT(proc.output, ::testing::AllOf(HasSubstr("line 1, key state_directory: '/proc/x': cannot be made"),
                                            HasSubstr("line 5, key services.data_acquisition.recordings_directory"),
                                            HasSubstr("line 6, key logging.directory: '/dev/full': cannot be made"),
                                            HasSubstr("3 faults found")));
  std::filesystem::create_symlink("round", folder_ / "round");
  const Finished round =
      run({"sealwatch", "config", "check", "--config",
           write("round.yaml", "assets: []\nstate_directory: " + (folder_ / "round").string() + "\n")});
  EXPECT_EQ(round.status, 2);
  EXPECT_THAT(round.output, HasSubstr("round is in the way"));
  const Finished without =
      run({"sealwatch", "config", "check", "--config",
           write("without.yaml", "assets: []\nservices: {state_detection: {enabled: false}}\nstate_directory: " +
                                     folder_.string() + "\n")});
  EXPECT_EQ(without.status, 0);
  EXPECT_THAT(without.output, HasSubstr("warning: services.state_detection is disabled here"));
  (void)write("a_asset.yaml", "asset_id: Ventil-\u00C4\n");
  (void)write("o_asset.yaml", "asset_id: Ventil-\u00D6\n");
  const Finished alike =
      run({"sealwatch", "config", "check", "--config",
           write("alike.yaml", "assets: [a_asset.yaml, o_asset.yaml]\nstate_directory: " + folder_.string() + "\n")});
  EXPECT_EQ(alike.status, 0);
  EXPECT_THAT(alike.output, HasSubstr("warning: asset 'Ventil-\u00D6': all but ASCII letters"));
  (void)write("large_asset.yaml", "asset_id: XT03-\u00C4\n");
  (void)write("small_asset.yaml", "asset_id: xt03-a\u0308\n");
  const Finished look_alike = run({"sealwatch", "config", "check", "--config",
                                   write("look_alike.yaml",
                                         "assets: [large_asset.yaml, small_asset.yaml]\nsites: [{site: "
                                         "North}, {site: north}]\nstate_directory: " +
                                             folder_.string() + "\n")});
  EXPECT_EQ(look_alike.status, 0);
  EXPECT_THAT(look_alike.output, ::testing::AllOf(HasSubstr("warning: asset 'xt03-a\u0308' differs from 'XT03-\u00C4'"),
                                                  HasSubstr("warning: site 'north' differs from 'North'")));
  (void)write("two_lines_asset.yaml", "asset_id: \"XT03\\nMV2\"\n");
  const Finished two_lines =
      run({"sealwatch", "config", "check", "--config",
           write("two_lines.yaml", "assets: [two_lines_asset.yaml]\nstate_directory: " + folder_.string() + "\n")});
  EXPECT_EQ(two_lines.status, 2);
  EXPECT_THAT(two_lines.output, ::testing::AllOf(HasSubstr("key asset_id"), HasSubstr("control characters")));
  const Finished empty = run({"sealwatch", "config", "check", "--config",
                              write("empty.yaml", "assets: []\nstate_directory: " + folder_.string() + "\n")});
  EXPECT_EQ(empty.status, 0);
  EXPECT_THAT(empty.output, HasSubstr("no asset is configured"));
}

/// Of /proc/<pid>/stat; empty for a process that ended meanwhile, where an istreambuf_iterator would throw.
std::string stat_of(const std::filesystem::path& process) {
  std::ostringstream text;
  text << std::ifstream(process / "stat").rdbuf();
  return text.str();
}

/// Processes that this one started and that still run.
std::set<pid_t> children_of(pid_t parent) {
  std::set<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    if (std::isdigit(static_cast<unsigned char>(entry.path().filename().string()[0])) == 0) continue;
    const std::string text = stat_of(entry.path());
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) continue;
    std::istringstream rest(text.substr(name_end + 1));
    char state = 0;
    pid_t of = 0;
    if (rest >> state >> of && of == parent && state != 'Z') children.insert(std::stoi(text));
  }
  return children;
}

bool runs(pid_t process) {
  const std::string text = stat_of("/proc/" + std::to_string(process));
  return !text.empty() && text.find(") Z ") == std::string::npos;
}

struct Told {
  std::vector<std::string> words;  ///< behind "sealwatch"
  int after_ms = 1500;             ///< when it is told to end
  bool for_ever = true;            ///< it is at work then, on any machine
};

class EndAtSigterm : public Commands {
 protected:
  static constexpr int kBadUsage = 2;

  /// Ended within two seconds, and all that it had started with it.
  void tell(const Told& told) {
    std::vector<std::string> arguments = told.words;
    if (!told.words[0].starts_with('/')) arguments.insert(arguments.begin(), "sealwatch");
    SCOPED_TRACE(told.words[0] + " " + (told.words.size() > 1 ? told.words[1] : ""));
    const pid_t command = start(arguments, folder_ / "endless.log");
    std::this_thread::sleep_for(std::chrono::milliseconds(told.after_ms));
    int status = 0;
    if (waitpid(command, &status, WNOHANG) == command) {
      std::ifstream log(folder_ / "endless.log");
      EXPECT_FALSE(told.for_ever) << "it was done: " << log.rdbuf();
      EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == kBadUsage) << "it did not begin: " << log.rdbuf();
      return;
    }
    const std::set<pid_t> children = children_of(command);
    const auto begin = std::chrono::steady_clock::now();
    kill(command, SIGTERM);
    const bool ended = happens_within_two_seconds(
        [&] { return waitpid(command, &status, WNOHANG) != 0 && std::ranges::none_of(children, runs); });
    EXPECT_TRUE(ended) << "it goes on after two seconds";
    const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
    std::cout << told.words[0] << ": " << took.count() << " ms, " << children.size() << " children\n";
    if (!ended) kill(command, SIGKILL), waitpid(command, nullptr, 0);
  }
  [[nodiscard]] static json a_block() {
    RawSamples block;
    block.asset_id = "XT03-MV2";
    block.header.message_id = "raw_samples/a trial/0";
    block.recording_id = "a trial";
    block.source_id = "plc";
    block.samples.time_s = {0.0, 0.1};
    return json::parse(to_json(Message(block)));
  }
  /// As many rows as a test may have, `times` times over.
  [[nodiscard]] std::string large(int times) const {
    const std::string file = (folder_ / ("large" + std::to_string(times) + ".csv")).string();
    std::ofstream out(file);
    out << "time[s],position[m],voltage[V],flow[m3/s]\n";
    for (int row = 0; row < times * 500'000; ++row)
      out << 1e-3 * row << ',' << 1e-6 * (row % 50'000) << ',' << row % 7 << ',' << 1e-9 * (row % 1000) << '\n';
    return file;
  }
};

TEST_F(EndAtSigterm, EveryCommandThatComputesOrWaits) {
  const auto [recording, truth] = worn_test();
  const std::string other = (folder_ / "other_life.csv").string(), out = (folder_ / "out").string();
  std::filesystem::rename(history(60, 0.002), other);
  const std::string falling = history(60, 0.003);
  const fmi::TestFolder fmus;
  const std::string hanging = fmus.build(fmi::spring_return("fmu_spring_hang2"));
  std::vector<std::string> fit = {"fit", "--asset", asset()};
  fit.insert(fit.end(), 400, recording);
  std::vector<std::string> explain = {"explain", "--asset", asset(), "--out", out + "5", "--fit"};
  std::ifstream recorded(recording);
  std::string rows{std::istreambuf_iterator<char>(recorded), {}};
  for (int k = 0; k < 40; ++k) explain.push_back(write("again" + std::to_string(k) + ".csv", rows += '\n'));
  const std::vector<std::string> by = {"--by", "J. Silva", "--config", config()};
  const auto said_by = [&by](std::vector<std::string> words) {
    words.insert(words.end(), by.begin(), by.end());
    return words;
  };
  // Lines that may still come, and a block that no service confirms.
  const auto lines = folder_ / "lines";
  ASSERT_EQ(mkfifo(lines.c_str(), 0600), 0);
  const std::shared_ptr<void> writer(nullptr, [held = open(lines.c_str(), O_RDWR | O_CLOEXEC)](void*) { close(held); });
  const auto publish = [](const std::filesystem::path& input) -> Told {
    return {{"/bin/sh", "-c", "exec \"$0\" publish --config \"$1\" <\"$2\"", program("sealwatch"), config(),
             input.string()}};
  };
  const std::vector<Told> all = {
      {{"verify", "rul", "--asset", asset(), "--lives", "100000", "--out", out + "1"}},
      {{"verify", "mismatch", "--sets", "1000", "--out", out + "2"}},
      {{"simulate", "--asset", asset(), "--months", "600", "--rate", "5000", "--out", out + "3"}},
      {{"simulate", "--asset", asset(), "--ageing", "--months", "600", "--rate", "5000", "--out", out + "4"}},
      {explain, 1000},
      {fit, 1000},
      {{"validate", "--fit", "--asset", asset(), recording, recording, "--out", out + "6"}, 300, false},
      {{"validate", "--simulated", large(1), large(1)}, 200, false},
      {{"asset", "new", "--from", large(4), "--out", out + "7.yaml"}, 200, false},
      {{"plant", "import", hanging, "--out", out + "8.yaml"}},
      {{"replay", "--offline", "--config", config(), recording}, 200, false},
      {{"replay", "--with-services", "--config", config(), "--state", out + "9", "--speed", "1", recording}, 3000},
      {{"fleet", "fit", falling, other}, 100, false},
      {{"forecast", "--history", falling}, 50, false},
      {{"show", "XT03-MV2", "--config", config(), "--state", out + "9"}, 20, false},
      {{"audit", "--state", out + "9"}, 20, false},
      {{"backup", "--state", out + "9", "--to", out + "10"}, 20, false},
      {{"watch", "--config", config()}},
      {{"status", "--config", config(), "--seconds", "60"}},
      publish(lines),
      publish(write("block.jsonl", json{{"topic", "raw_samples"}, {"message", a_block()}}.dump() + "\n")),
      {said_by({"retract", "XT03-MV2", "--since", "2031-01-01", "--reason", "a trial"}), 500, false},
      {said_by({"replaced", "XT03-MV2", "--at", "2018-06-10"}), 500, false},
      {said_by({"acknowledge", "XT03-MV2", "advisory/1", "--remark", "a trial"}), 500, false},
      {{"up", "--config", config(), "--state", out + "11"}, 3000}};
  for (const Told& told : all) tell(told);
}

}  // namespace
}  // namespace sealwatch::testing
