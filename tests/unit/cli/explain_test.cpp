// `sealwatch explain` around an analysis that is given: what it reads, writes, says and returns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "services/cli/explain_command.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class ExplainCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    options_.asset_file = write("asset.yaml", "asset_id: A\nmodel: eha\n");
    options_.fit = {recording("a", 1.0), recording("b", 2.0)};
    options_.holdout = {recording("c", 3.0)};
    options_.directory = (folder_ / "out" / "deep").string();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string recording(const std::string& name, double voltage) const {
    std::string text = "time[s],motor_voltage[V],pressure_a[bar]\n";
    for (int k = 0; k < 5; ++k) text += std::to_string(0.01 * k) + "," + std::to_string(voltage) + ",100\n";
    return write(name + ".csv", text);
  }
  /// Runs with an analysis that finds `found_`; keeps what was said.
  int run() {
    CaptureStdout();
    CaptureStderr();
    const int status = explain_with(
        [this](const AssetConfig& asset, std::span<const Recording> fit, std::span<const Recording> holdout,
               const mismatch::ExplainOptions& options, const mismatch::Progress& progress) {
          progress("thinking", 0.5);
          ++analyses_;
          given_ = options;
          found_.asset_id = asset.asset_id;
          found_.model = asset.model;
          found_.explained = asset;
          if (estimate_ > 0.0) found_.explained.parameters.at("R_CL").value = estimate_;
          for (const Recording& one : fit) found_.fit_recordings.push_back(one.recording_id);
          for (const Recording& one : holdout) found_.holdout_recordings.push_back(one.recording_id);
          return Result<mismatch::Explanation>(found_);
        },
        options_);
    out_ = GetCapturedStdout();
    err_ = GetCapturedStderr();
    return status;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("sealwatch_explain_test." + std::to_string(getpid()));
  ExplainOptions options_;
  mismatch::Explanation found_;
  mismatch::ExplainOptions given_;
  int analyses_ = 0;
  double estimate_ = 0.0;  ///< of R_CL
  std::string out_, err_;
};

TEST_F(ExplainCommand, WritesTheThreeFilesAndSaysWhereToLook) {
  found_.verdict = mismatch::Verdict::mismatch;
  found_.summary = "The piston meets dry friction.";
  found_.effects.resize(1);
  found_.effects[0].what = {"coulomb_friction", "", "piston", "F_c tanh(v / v_s)", ""};
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  found_.effects[0].parameters = {
      {"F_c", "N", 4010.0, 60.0, false}, {"v_s", "m/s", 0.05, kInfinite, true}, {"v_t", "m/s", 0.02, kInfinite, false}};
  options_.seed = 7;
  options_.threads = 3;
  EXPECT_EQ(run(), kOk);
  EXPECT_THAT(out_, HasSubstr("A: mismatch"));
  EXPECT_THAT(out_, HasSubstr("The piston meets dry friction."));
  EXPECT_THAT(out_, HasSubstr("Coulomb friction of the piston"));
  EXPECT_THAT(out_, HasSubstr("F_c = 4.010 ± 0.060 kN\n"));
  EXPECT_THAT(out_, ContainsRegex("v_s = [^\n]*, at its bound\n"));
  EXPECT_THAT(out_, ContainsRegex("v_t = [^\n]*, not identifiable\n"));
  EXPECT_THAT(out_, HasSubstr("report.html"));
  EXPECT_THAT(err_, HasSubstr("thinking"));
  EXPECT_EQ(given_.seed, 7U);
  EXPECT_EQ(given_.threads, 3);

  const std::filesystem::path out(options_.directory);
  const auto report = nlohmann::json::parse(content(out / "report.json"));
  EXPECT_EQ(report["recordings"]["fit"], (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(report["recordings"]["holdout"], std::vector<std::string>{"c"});
  EXPECT_THAT(content(out / "report.html"), HasSubstr("The piston meets dry friction."));
  const auto asset = load_asset((out / "asset.explained.yaml").string());
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->asset_id, "A");
}

TEST_F(ExplainCommand, TheAssetHasNoDigitsThatTheRecordingsDoNotTell) {
  estimate_ = 25955123187728.89;
  found_.verdict = mismatch::Verdict::consistent;
  found_.parameters = {{.name = "R_CL", .unit = "Pa s/m3", .after = estimate_, .after_std = 2.2e10}};
  EXPECT_EQ(run(), kOk);
  const std::string asset = content(std::filesystem::path(options_.directory) / "asset.explained.yaml");
  EXPECT_THAT(asset, HasSubstr("R_CL: {value: 2.595512e+13, "));
  EXPECT_THAT(asset, Not(ContainsRegex("000000[0-9]|999999")));
}

TEST_F(ExplainCommand, JsonIsTheReport) {
  found_.verdict = mismatch::Verdict::consistent;
  options_.json = true;
  EXPECT_EQ(run(), kOk);
  EXPECT_EQ(out_, content(std::filesystem::path(options_.directory) / "report.json"));
}

TEST_F(ExplainCommand, AnAnswerEndsWithWhatToDoNext) {
  found_.verdict = mismatch::Verdict::consistent;
  EXPECT_EQ(run(), kOk);
  EXPECT_THAT(out_, HasSubstr("next: No repair is needed."));
  EXPECT_THAT(out_, HasSubstr("sealwatch validate --asset"));
}

TEST_F(ExplainCommand, UndeterminedIsTheAnswerNo) {
  found_.verdict = mismatch::Verdict::undetermined;
  found_.next_test = "Record a faster stroke.";
  found_.parameters = {{.name = "R_M", .unit = "ohm", .before = 0.05, .after = 0.05, .datasheet = 0.5},
                       {.name = "f_C", .unit = "N s/m", .before = 6e6, .after = 6e6, .datasheet = 2e6}};
  found_.parameters[0].before_at_bound = found_.parameters[0].after_at_bound = true;
  EXPECT_EQ(run(), kAnswerIsNo);
  EXPECT_THAT(out_, HasSubstr("at a bound of their range: R_M 0.0500 ohm (datasheet 0.500 ohm)\n"));
  EXPECT_THAT(out_, HasSubstr("next: Record a faster stroke."));
}

TEST_F(ExplainCommand, AHoldoutThatIsAlsoFittedProvesNothing) {
  options_.holdout = {recording("copy_of_b", 2.0)};
  EXPECT_EQ(run(), kBadInput);
  EXPECT_THAT(err_, HasSubstr("copy_of_b.csv: is held out, but has the same content as the fitted "));
  EXPECT_THAT(err_, HasSubstr("b.csv"));
  EXPECT_EQ(analyses_, 0);
  EXPECT_FALSE(std::filesystem::exists(options_.directory));
}

TEST_F(ExplainCommand, ARecordingGivenTwiceIsNoSecondTest) {
  options_.fit.push_back(options_.fit.front());
  EXPECT_EQ(run(), kBadInput);
  EXPECT_THAT(err_, HasSubstr("has the same content as"));
}

TEST_F(ExplainCommand, RecordingsOfAnotherAssetAreRefused) {
  write("c.yaml", "asset_id: B\n");
  EXPECT_EQ(run(), kBadInput);
  EXPECT_THAT(err_, HasSubstr("'B': is not the asset A"));
}

TEST_F(ExplainCommand, ColumnsThatThePlantDoesNotKnowAreListedAndLeftAside) {
  options_.fit = {write("odd.csv", "time,motor_voltage,colour\n0,1,2\n1,1,2\n")};
  EXPECT_NE(run(), kBadInput);
  EXPECT_EQ(analyses_, 1);
  EXPECT_THAT(err_, HasSubstr("colour"));
}

TEST_F(ExplainCommand, AColumnThatIsNearlyAChannelIsATypingError) {
  options_.fit = {write("odd.csv", "time,motor_voltag,position\n0,1,2\n1,1,2\n")};
  EXPECT_EQ(run(), kBadInput);
  EXPECT_EQ(analyses_, 0);
  EXPECT_THAT(err_, HasSubstr("odd.csv"));
  EXPECT_THAT(err_, HasSubstr("motor_voltag"));
}

TEST_F(ExplainCommand, APlaceThatCannotBeWrittenCostsNoWaiting) {
  options_.directory = options_.asset_file + "/out";
  EXPECT_EQ(run(), kBadInput);
  EXPECT_THAT(err_, HasSubstr("cannot be made"));
  EXPECT_EQ(analyses_, 0);
}

TEST_F(ExplainCommand, WhatTheAnalysisRefusesIsBadInput) {
  CaptureStderr();
  const int status = explain_with(
      [](const AssetConfig&, std::span<const Recording>, std::span<const Recording>, const mismatch::ExplainOptions&,
         const mismatch::Progress&) -> Result<mismatch::Explanation> {
        return fail("no channel that the plant simulates");
      },
      options_);
  EXPECT_EQ(status, kBadInput);
  EXPECT_THAT(GetCapturedStderr(), HasSubstr("no channel that the plant simulates"));
  EXPECT_FALSE(std::filesystem::exists(options_.directory)) << "nothing was written";
}

TEST_F(ExplainCommand, ARefusalSaysThatTheReportThatStandsThereIsOld) {
  run();
  ASSERT_TRUE(std::filesystem::exists(options_.directory + "/report.json"));
  CaptureStderr();
  const int status = explain_with(
      [](const AssetConfig&, std::span<const Recording>, std::span<const Recording>, const mismatch::ExplainOptions&,
         const mismatch::Progress&) -> Result<mismatch::Explanation> { return fail("no"); },
      options_);
  EXPECT_EQ(status, kBadInput);
  EXPECT_THAT(GetCapturedStderr(), HasSubstr("report.json is of an earlier run"));
  EXPECT_TRUE(std::filesystem::exists(options_.directory + "/report.json"));
}

TEST_F(ExplainCommand, AValueOfTheAssetFileInPlaceOfLawsIsShownBeforeAndAfter) {
  found_.verdict = mismatch::Verdict::undetermined;
  found_.summary = "A value that the asset file fixes may be wrong.";
  found_.asset_values = {{{.name = "A_C", .unit = "m2", .in_asset_file = 5.89e-3, .fitted = 6e-3, .std_error = 1e-6}}};
  found_.holdout.channels = {{.channel = "flow", .rms_before = 7.25, .rms_after = 1.5}};
  EXPECT_EQ(run(), kAnswerIsNo);
  EXPECT_THAT(out_, ContainsRegex("flow +7.25 +1.50 "));
  EXPECT_THAT(out_, HasSubstr("the asset with the value that explains as much: "));
}

TEST_F(ExplainCommand, WhereNothingWasFoundWhatWasFittedIsToldBesideTheAssetFiles) {
  found_.verdict = mismatch::Verdict::consistent;
  found_.parameters = {{.name = "A_C", .unit = "m2", .after = 6.0e-3, .after_std = 1e-6, .datasheet = 5.0e-3},
                       {.name = "R_M", .unit = "ohm", .after = 0.501, .after_std = 1e-4, .datasheet = 0.5}};
  EXPECT_EQ(run(), kOk);
  EXPECT_THAT(out_, ContainsRegex("fitted: A_C .*·10⁻³ m² .asset file 5.00·10⁻³ m²"));
  EXPECT_THAT(out_, HasSubstr("; R_M within 2.0 % of the asset"));
}

}  // namespace
}  // namespace sealwatch::cli
