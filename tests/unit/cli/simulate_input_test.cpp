// `sealwatch simulate --input`: from an FMU, over its plant file and an asset file, to a recording.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "services/cli/commands.hpp"
#include "services/common/recording/recording_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;

void write(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A unit, imported as a user would, with an asset file and a file of inputs.
class SimulateInput : public ::testing::Test {
 protected:
  std::string prepare(const fmi::TestUnit& unit, const std::string& name, const std::string& inputs,
                      const std::string& interface = {}) {
    const PlantImportOptions import{
        .fmu = folder_.build(unit), .file = (folder_ / "plant.yaml").string(), .interface = interface, .settings = {}};
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(run_plant_import(import), kOk);
    ::testing::internal::GetCapturedStdout();
    std::string plant = content_of(import.file);
    plant.replace(plant.find("name: test"), 10, "name: " + name);
    write(import.file, plant);
    write(folder_ / "asset.yaml", "asset_id: V-7\nmodel: plant.yaml\n");
    write(folder_ / "inputs.csv", inputs);
    return (folder_ / "asset.yaml").string();
  }
  SimulateOptions options(const std::string& asset) const {
    SimulateOptions chosen;
    chosen.asset_file = asset;
    chosen.inputs = {(folder_ / "inputs.csv").string()};
    chosen.directory = (folder_ / "out").string();
    return chosen;
  }
  int run(const SimulateOptions& chosen) {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int status = run_simulate(chosen);
    ::testing::internal::GetCapturedStdout();
    said_ = ::testing::internal::GetCapturedStderr();
    return status;
  }
  [[nodiscard]] std::vector<std::vector<double>> rows(std::string* header = nullptr) const {
    std::istringstream text(content_of(folder_ / "out/inputs.csv"));
    std::vector<std::vector<double>> all;
    std::string line, cell;
    std::getline(text, line);
    if (header != nullptr) *header = line;
    while (std::getline(text, line)) {
      std::vector<double>& row = all.emplace_back();
      for (std::istringstream cells(line); std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    }
    return all;
  }
  fmi::TestFolder folder_;
  std::string said_;
};

constexpr std::size_t kX = 11;  // column of x in what the mixed unit gives

TEST_F(SimulateInput, WritesWhatTheUnitGivesAtTheSamplesOfItsInputs) {
  const std::string asset = prepare(fmi::mixed("fmu_mixed2"), "simulated_mixed",
                                    "time[s],u_real[1],u_discrete[1],u_integer[1],u_boolean[1]\n"
                                    "0,1.5,2.5,3,1\n0.5,1.5,2.5,3,0\n1.0,4,5,6,1\n");
  ASSERT_EQ(run(options(asset)), kOk) << said_;
  std::string header;
  const auto table = rows(&header);
  EXPECT_EQ(header,
            "time[s],u_real[1],u_discrete[1],u_integer[1],u_boolean[1],y_real[1],y_discrete[1],y_integer[1],"
            "y_boolean[1],steps[1],length[1],x[1],now[1],began[1]");
  ASSERT_EQ(table.size(), 3U);
  for (const auto& row : table) {
    for (std::size_t k = 1; k <= 4; ++k) EXPECT_EQ(row[4 + k], row[k]);
    EXPECT_NEAR(row[kX], 2.0 * std::exp(-row[0]), 1e-5);
  }
  EXPECT_EQ(run(options(asset)), kBadInput) << "written over";
  EXPECT_THAT(said_, HasSubstr("is there already"));
}

TEST_F(SimulateInput, AUnitWithoutInputsNeedsTimesAlone) {
  const std::string asset =
      prepare(fmi::bouncing("fmu_bouncing3"), "simulated_ball", "time[s]\n0\n0.1\n0.2\n0.3\n0.4\n");
  ASSERT_EQ(run(options(asset)), kOk) << said_;
  for (const auto& row : rows()) EXPECT_NEAR(row[1], 1.0 - 0.5 * 9.81 * row[0] * row[0], 1e-5);
}

TEST_F(SimulateInput, AUnitThatIsNotTheMapsIsAWarning) {
  const std::string asset = prepare(fmi::bouncing("fmu_bouncing3"), "simulated_ball_units",
                                    "t [ms],h [m]\n0,1\n0.1,1\n0.2,1\n0.3,1\n0.4,1\n");
  write(asset, "asset_id: V-7\nmodel: plant.yaml\nchannels:\n  time: {column: t, unit: s}\n");
  ASSERT_EQ(run(options(asset)), kOk) << said_;
  EXPECT_THAT(said_, HasSubstr("warning: "));
  EXPECT_THAT(said_, HasSubstr("inputs.csv: column 't [ms]', channel time: the log's unit is ms and the map's s"));
  EXPECT_NEAR(rows().back()[0], 0.4, 1e-12);
}

TEST_F(SimulateInput, StartsAtTheFirstSampleOfWhatMoves) {
  const std::string asset = prepare(fmi::mixed("fmu_mixed2"), "simulated_moving",
                                    "time[s],u_real[1],u_discrete[1],u_integer[1],u_boolean[1],x[1]\n"
                                    "0,1.5,2.5,3,1,7\n0.5,1.5,2.5,3,0,4.2\n1.0,4,5,6,1,2.6\n1.5,4,5,6,1,1.6\n");
  std::string plant = content_of(folder_ / "plant.yaml");
  plant.replace(plant.find(", start: fmu,"), 13, ", start: x,");
  write(folder_ / "plant.yaml", plant);
  ASSERT_EQ(run(options(asset)), kOk) << said_;
  for (const auto& row : rows()) EXPECT_NEAR(row[kX], 7.0 * std::exp(-row[0]), 1e-4);
}

TEST_F(SimulateInput, RowsOfOneTimeAreBeforeAndAfterAJump) {
  int number = 0;
  for (const char* interface : {"me", "cs"}) {
    const std::string asset = prepare(fmi::mixed("fmu_mixed3"), "simulated_jumping_" + std::to_string(++number),
                                      "time[s],u_real[1],u_discrete[1],u_integer[1],u_boolean[1]\n"
                                      "0,1,2,3,0\n0.5,1,2,3,0\n0.5,4,5,6,1\n1,5,5,6,1\n1.5,6,5,6,1\n",
                                      interface);
    ASSERT_EQ(run(options(asset)), kOk) << said_;
    const auto table = rows();
    ASSERT_EQ(table.size(), 5U);
    EXPECT_NEAR(table[1][0], 0.5, 1e-6);
    for (const auto& row : table) {
      for (std::size_t k = 1; k <= 4; ++k) EXPECT_EQ(row[4 + k], row[k]) << interface << " at " << row[0];
      EXPECT_NEAR(row[kX], 2.0 * std::exp(-row[0]), 1e-3) << interface;
    }
    std::filesystem::remove(folder_ / "plant.yaml");
    std::filesystem::remove_all(folder_ / "out");
  }
}

TEST_F(SimulateInput, NoiseIsThatOfTheSensorsAndOfTheSeed) {
  std::string inputs = "time[s],u[1]\n";
  for (int k = 0; k < 400; ++k) inputs += std::to_string(0.01 * k) + ",0\n";
  const std::string asset = prepare(fmi::spring_return("fmu_spring_return2"), "simulated_spring", inputs);
  write(asset, content_of(asset) + "sensors:\n  position: {noise_std: 0.25}\n");
  SimulateOptions chosen = options(asset);
  chosen.noise = true;
  ASSERT_EQ(run(chosen), kOk) << said_;
  const auto first = rows();
  double sum = 0.0;
  for (const auto& row : first) sum += row[2] * row[2];
  EXPECT_NEAR(std::sqrt(sum / 400.0), 0.25, 0.03);
  std::filesystem::remove_all(folder_ / "out");
  ASSERT_EQ(run(chosen), kOk) << said_;
  EXPECT_EQ(rows(), first);
  std::filesystem::remove_all(folder_ / "out");
  ++chosen.seed;
  ASSERT_EQ(run(chosen), kOk) << said_;
  EXPECT_NE(rows(), first);
}

TEST_F(SimulateInput, WithoutInputAPlantOfOnesOwnIsToldWhatToGive) {
  const std::string asset = prepare(fmi::bouncing("fmu_bouncing2"), "simulated_without", "time[s]\n0\n1\n");
  SimulateOptions chosen = options(asset);
  chosen.inputs.clear();
  EXPECT_EQ(run(chosen), kBadInput);
  EXPECT_THAT(said_, HasSubstr("--input"));
}

}  // namespace
}  // namespace sealwatch::cli
