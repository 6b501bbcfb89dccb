// A first asset file from somebody's own log: what is written is accepted, and reads the log by the right columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "sealwatch/model/plant_description.hpp"
#include "services/cli/commands.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::cli {
namespace {

class AssetNew : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("sealwatch_asset_new_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  int make(const char* text, const std::string& model = {}) const {
    std::ofstream(path("log.csv"), std::ios::binary) << text;
    return run_asset_new({.log = path("log.csv"), .file = path("a.yaml"), .model = model, .asset_id = {}, .yes = true});
  }
  /// A plant of its own, pump.yaml: plants that were loaded stay for the process, each with a name that no other has.
  void write_pump() const {
    std::ofstream(path("pump.yaml")) << "name: pump_of_" << folder_.filename().string() << R"(
meaning: a pump
inputs: {opening: {unit: "1"}}
outputs: {pressure: {value: p, unit: Pa, noise_std: 10}, valve_lift: {value: p/k, unit: m, noise_std: 1}}
parameters: {a: {value: 0.1, unit: Pa/s}, k: {value: 1, unit: Pa/m}}
states: {p: {der: a*opening, unit: Pa, start: pressure}}
elements: {}
law_sizes: {}
)";
  }
  std::filesystem::path folder_;
};

TEST_F(AssetNew, TheWrittenFileReadsTheLogWithoutFurtherWork) {
  ASSERT_EQ(make("Prüfstand 3;;\n\nZeit;Spannung Motor;Druck A;Druck B;Weg;Bemerkung\n;V;barg;barg;mm;\n"
                 "12.04.2031 03:00:00,000;1,0;100,5;20,1;60,0;Start\n12.04.2031 03:00:00,010;1,1;100,4;20,2;59,9;\n"),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->asset_id, "log");
  EXPECT_EQ(asset->model, "eha") << "three channels that only it has together";
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  const TimeSeries& samples = recording->samples;
  EXPECT_NEAR(samples.time_s.back(), 0.01, 1e-9);
  EXPECT_NEAR(samples.find("pressure_b")->values.front(), 20.1e5 + 101325.0, 1e-3);
  EXPECT_NEAR(samples.find("position")->values.back(), 0.0599, 1e-12);
  EXPECT_EQ(samples.find("motor_voltage")->values.back(), 1.1);
  EXPECT_EQ(recording->left_aside, std::vector<std::string>{"Bemerkung"});
  EXPECT_TRUE(std::filesystem::exists(path("a.html")));
}

TEST_F(AssetNew, SaysHowFarAGuessedPlantCanBeReliedOn) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("time[s],u[V],y[V]\n0,1.5,0.1\n0.1,1.2,0.2\n0.2,1.7,0.3\n"), kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::HasSubstr("was chosen by the units alone and is probably not your machine"));
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("time[s],position[mm],pressure_a[bar],rod_force[N]\n0,1.5,0.1,3\n0.1,1.2,0.2,4\n"), kBadInput)
      << "it is there already";
  (void)testing::internal::GetCapturedStdout();
  std::filesystem::remove(path("a.yaml"));
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("time[s],position[mm],pressure_a[bar],rod_force[N]\n0,1.5,0.1,3\n0.1,1.2,0.2,4\n"), kOk);
  const std::string said = testing::internal::GetCapturedStdout();
  EXPECT_THAT(said, testing::HasSubstr("plant eha is a guess: of the built-in plants it fits the columns best"));
  EXPECT_THAT(said,
              testing::HasSubstr("plant eha cannot be simulated as a whole: the log lacks its input motor_voltage"));
}

TEST_F(AssetNew, ALogWithoutATimeIsRefused) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(make("U [V];Weg [mm]\n1,5;60\n1,2;59\n1,7;58\n"), kBadInput);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, testing::HasSubstr("log.csv: no column is a time"));
  EXPECT_THAT(said, testing::HasSubstr("time: {column: row, unit: s, scale: SECONDS_BETWEEN_ROWS}"));
  EXPECT_FALSE(std::filesystem::exists(path("a.yaml")));
}

TEST_F(AssetNew, VectorsWithHolesAreReadAsTheWrittenFileSays) {
  write_pump();
  mat_t* file = Mat_CreateVer(path("log.mat").c_str(), nullptr, MAT_FT_MAT5);
  const double hole = std::numeric_limits<double>::quiet_NaN();
  const auto add = [&](const char* name, std::array<double, 4> values) {
    std::array<std::size_t, 2> size = {4, 1};
    matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE);
    Mat_VarFree(variable);
  };
  add("t", {0, 1, 2, 3}), add("opening", {0, 0.5, 0.5, 1}), add("pressure", {1, 2, hole, 4});
  Mat_Close(file);
  ASSERT_EQ(
      run_asset_new(
          {.log = path("log.mat"), .file = path("a.yaml"), .model = path("pump.yaml"), .asset_id = {}, .yes = true}),
      kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  const auto recording = read_recording(path("log.mat"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_THAT(recording->samples.time_s, testing::ElementsAre(0.0, 1.0, 3.0));
}

TEST_F(AssetNew, ADateThatMayBeReadInTwoWaysIsRemarkedOn) {
  write_pump();
  const auto remark_of = [&](const std::string& date) {
    std::filesystem::remove(path("a.yaml"));
    const std::string text = "time,opening,pressure [bar]\n" + date + " 03:00:00,0.5,1\n" + date + " 03:00:01,0.5,2\n";
    testing::internal::CaptureStdout();
    EXPECT_EQ(make(text.c_str(), path("pump.yaml")), kOk);
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(remark_of("3/4/2031"),
              testing::HasSubstr("the time 3/4/2031 03:00:00 is taken for day/month: where it is "
                                 "month/day, write '%m/%d/%Y %H:%M:%S' as its unit"));
  EXPECT_THAT(remark_of("25/4/2031"), testing::Not(testing::HasSubstr("day/month")));
}

TEST_F(AssetNew, ADayInAColumnOfItsOwnIsRead) {
  write_pump();
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("Date;Time;opening;pressure [bar]\n25.04.2031;23:59:59;0,5;1\n26.04.2031;00:00:00;0,5;2\n",
                 path("pump.yaml")),
            kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::AllOf(testing::HasSubstr("1 test of 2 samples"), testing::HasSubstr("Date + Time")));
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").column, "Date + Time");
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_EQ(recording->samples.time_s.back(), 1.0);
  EXPECT_EQ(format_utc(*recording->start_time), "2031-04-25T23:59:59Z");
}

// A column called by the day alone is not the time where another one has the clock.
TEST_F(AssetNew, TheClockBesideADayIsTheTimeWhateverItIsCalled) {
  write_pump();
  ASSERT_EQ(make("Datum;Uhrzeit;opening;pressure [bar]\n25.04.2031;23:59:59;0,5;1\n26.04.2031;00:00:00;0,5;2\n",
                 path("pump.yaml")),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").column, "Datum + Uhrzeit");
}

TEST_F(AssetNew, ADayThatIsNoneIsRemarkedOn) {
  write_pump();
  testing::internal::CaptureStdout();
  EXPECT_EQ(
      make("Date;Time;opening;pressure [bar]\nMonday;23:59:59;0,5;1\nTuesday;00:00:00;0,5;2\n", path("pump.yaml")),
      kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::AllOf(testing::HasSubstr("1 test of 2 samples"),
                             testing::HasSubstr("the day in column Date is not read: give the test's start_time")));
}

TEST_F(AssetNew, GapsAreNamedWithTheLongest) {
  write_pump();
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("t [s],opening,pressure [bar]\n0,1,1\n0.5,1,1\n1,1,1\n2,1,1\n2.5,1,1\n3,1,1\n9.5,1,1\n10,1,1\n",
                 path("pump.yaml")),
            kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::HasSubstr(
                  "2 gaps between rows that are usually 0.500 s apart: the longest, 6.50 s, after 3.00 s; inputs "
                  "are taken as ramps across them"));
  std::filesystem::remove(path("a.yaml"));
  testing::internal::CaptureStdout();
  EXPECT_EQ(make("t [s],opening,pressure [bar]\n0,1,1\n0.5,1,1\n1.1,1,1\n1.6,1,1\n", path("pump.yaml")), kOk);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::Not(testing::HasSubstr("gap")));
}

TEST_F(AssetNew, DaysAsMatlabCountsThemAreRecognised) {
  write_pump();
  ASSERT_EQ(make("when,opening,pressure [bar]\n736696.25,0.5,1\n736696.250005787,0.5,2\n736696.250011574,0.5,4\n",
                 path("pump.yaml")),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").unit, "datenum");
}

// The same rule as in a map: the unit may end the name.
TEST_F(AssetNew, ATimeInMillisecondsByItsNameIsTakenForThat) {
  ASSERT_EQ(make("t_ms,motor_voltage [V],position [mm]\n0,1,60\n10,1,60\n20,1,59\n"), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").unit, "ms");
}

// A count of samples rises as time does.
TEST_F(AssetNew, AColumnThatIsCalledByAUnitOfTimeIsTheTime) {
  ASSERT_EQ(make("sample,ms,motor_voltage [V],position [mm]\n0,0,1,60\n1,10,1,60\n2,20,1,59\n"), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").column, "ms");
  EXPECT_EQ(asset->channel_map.columns.at("time").unit, "ms");
}

TEST_F(AssetNew, OfTwoColumnsWithOneHeaderThePlaceIsWritten) {
  ASSERT_EQ(make("time [s],motor_voltage [V],position [mm],position [mm]\n0,1,60,0\n1,1,60,0\n2,1,59,0\n"), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("position").column, "column 3");
}

// Logs of several devices have a time for each.
TEST_F(AssetNew, OfTwoTimesWithOneHeaderThePlaceIsWritten) {
  ASSERT_EQ(make("Time,Motor voltage [V],Time,Position [mm]\n0.0,1,0.0,60\n0.5,1,0.5,59\n"), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").column, "column 1");
  EXPECT_EQ(asset->channel_map.columns.at("position").column, "Position [mm]");
}

TEST_F(AssetNew, AFractionOfASecondMayStandBeforeTheHalfOfTheDay) {
  ASSERT_EQ(make("Time,Motor voltage [V],Position [mm]\n04/25/2031 11:59:59.750000 AM,1,60\n"
                 "04/25/2031 12:00:00.250000 PM,1,59\n"),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_NEAR(recording->samples.time_s.back(), 0.5, 1e-9);
}

TEST_F(AssetNew, OfALogWithManyColumnsSomeAreNamed) {
  std::string header = "time", row = "0";
  for (int k = 0; k < 200; ++k) header += ",Ei" + std::to_string(k) + " [mm/kg]", row += ",1";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(make((header + "\n" + row + "\n").c_str()), kBadInput);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("Ei28 [mm/kg], and 171 more"));
}

TEST_F(AssetNew, TestsInOneFileAndRowsWithHolesAreSeen) {
  ASSERT_EQ(make("t [s],motor_voltage [V],position [mm]\n0,1,60\n1,1,\n2,1,59\n0,1,60\n1,1,59\n"), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.log.time_resets, "split");
  EXPECT_EQ(asset->channel_map.log.incomplete_rows, "skip");
  const auto tests = read_recordings(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(tests) << tests.error().describe();
  EXPECT_EQ(tests->size(), 2U);
}

TEST_F(AssetNew, AColumnInPercentIsOfferedWithItsScale) {
  std::ofstream(path("plant.yaml")) << R"(name: block_of_asset_new
meaning: a heated block
inputs: {power: {unit: W}}
outputs: {temperature: {value: T, unit: K, noise_std: 0.1}}
parameters: {C: {value: 1000.0, unit: J/K}}
states: {T: {der: power/C, unit: K, start: temperature}}
)";
  ASSERT_EQ(make("t [s],Heater [%],Block temp (C)\n0,1,60\n1,1,61\n2,1,62\n", path("plant.yaml")), kOk);
  std::ostringstream text;
  text << std::ifstream(path("a.yaml")).rdbuf();
  EXPECT_THAT(text.str(), ::testing::HasSubstr("{column: \"Heater [%]\", scale: 0.01, unit: \"W\"}"));
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("temperature").column, "Block temp (C)");
}

// What a count or a percent is worth stands in no log: volts and radians a second would be a guess.
TEST_F(AssetNew, ColumnsCalledCountsOrPercentAreNotTakenForTheChannelsUnit) {
  std::ofstream(path("motor.yaml")) << R"(name: motor_of_asset_new
meaning: a motor
inputs: {u: {unit: V}}
outputs: {current: {value: i, unit: A, noise_std: 0.01}, speed: {value: w, unit: rad/s, noise_std: 0.2}}
parameters: {a: {value: 1.0, unit: A/(V s)}, k: {value: 1.0, unit: rad/(A s2)}}
states: {i: {der: a*u, unit: A, start: current}, w: {der: k*i, unit: rad/s, start: speed}}
elements: {}
law_sizes: {}
)";
  ASSERT_EQ(make("t [s],U_counts,n_%,i [A]\n0,100,50,1\n1,200,51,1\n2,300,52,1\n", path("motor.yaml")), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_TRUE(asset->channel_map.columns.contains("current"));
  EXPECT_FALSE(asset->channel_map.columns.contains("u"));
  EXPECT_FALSE(asset->channel_map.columns.contains("speed"));
  std::ostringstream text;
  text << std::ifstream(path("a.yaml")).rdbuf();
  EXPECT_THAT(text.str(), ::testing::HasSubstr("{column: \"U_counts\", scale: 1, unit: \"V\"}"));
  EXPECT_THAT(text.str(), ::testing::HasSubstr("{column: \"n_%\", scale: 0.01, unit: \"rad/s\"}"));
}

TEST_F(AssetNew, APlantFileIsNamedAsSeenFromTheAsset) {
  std::filesystem::create_directories(folder_ / "plants");
  std::ofstream(folder_ / "plants" / "shaft.yaml") << R"(name: shaft_of_asset_new
meaning: a shaft
inputs: {torque: {unit: N m}}
outputs: {speed: {value: w, unit: rad/s, noise_std: 0.1}}
parameters: {J: {value: 0.1, unit: kg m2}}
states: {w: {der: (torque - lost)/J, unit: rad/s, start: speed}}
elements: {bearing: {sites: [{kind: shaft_torque, symbol: lost, signals: {speed: w}}]}}
law_sizes: {N m: 1, N m s/rad: 1, rad/s: 1}
)";
  constexpr const char* kLog = "t [s];Moment [Nm];Drehzahl [rpm]\n0;1,5;60\n1;1,5;59\n2;1,6;58\n";
  EXPECT_EQ(make(kLog, path("plants/sheft.yaml")), kBadInput) << "there is no such file";
  ASSERT_EQ(make(kLog, path("plants/shaft.yaml")), kOk);
  std::ifstream written(path("a.yaml"));
  const std::string text{std::istreambuf_iterator<char>(written), {}};
  EXPECT_THAT(text, ::testing::HasSubstr("model: plants/shaft.yaml"));
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_NEAR(recording->samples.find("speed")->values.front(), 6.2832, 1e-3);
  EXPECT_EQ(recording->samples.find("torque")->values.back(), 1.6);
}

// "Drehzahl_rpm", "Zulauf %": the unit is the header's last word; a switch has none, and is no ramp between samples.
TEST_F(AssetNew, AUnitAtTheEndOfAHeaderIsSeenAndASwitchIsNamed) {
  std::ofstream(path("oven.yaml")) << R"(name: oven_of_asset_new
meaning: an oven with a fan
inputs: {heater: {unit: "1"}, damper: {unit: "1"}, fan_speed: {unit: rad/s}}
outputs: {pressure: {value: p, unit: Pa, noise_std: 10}}
parameters: {a: {value: 0.1, unit: Pa/s}, b: {value: 0.1, unit: Pa}}
states: {p: {der: "a*(heater - damper) - b*fan_speed", unit: Pa, start: pressure}}
elements: {}
law_sizes: {}
)";
  constexpr const char* kLog =
      "t s,Heater [on/off],Damper %,fan_speed_rpm,PT-1 psig\n0,1,5,60,1\n1,1,6,60,1.1\n2,0,7,61,1.2\n3,0,8,62,1.1\n"
      "4,1,8,60,1.0\n5,1,8,60,1.1\n6,0,8,60,1.1\n7,0,8,60,1.1\n";
  ASSERT_EQ(make(kLog, path("oven.yaml")), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_NEAR(recording->samples.find("damper")->values.front(), 0.05, 1e-12);
  EXPECT_NEAR(recording->samples.find("fan_speed")->values.front(), 6.2832, 1e-3);
  EXPECT_NEAR(recording->samples.find("pressure")->values.front(), 101325.0 + 6894.757, 0.1);
  EXPECT_EQ(recording->samples.find("heater")->values.front(), 1.0);
  std::ifstream written(path("a.yaml"));
  const std::string text{std::istreambuf_iterator<char>(written), {}};
  EXPECT_THAT(text, ::testing::HasSubstr("heater stays and jumps"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("damper stays")));
}

// Whatever columns are called: a unit that only one of them and only one channel has says which is which; where several
// have it, the file names them.
TEST_F(AssetNew, UnitsTellColumnsThatNamesDoNot) {
  std::ofstream(path("cabinet.yaml")) << R"(name: cabinet_of_asset_new
meaning: a heated plate
inputs: {heater: {unit: W}, fan: {unit: Hz}, ambient: {unit: K}}
outputs: {plate: {value: T, unit: K, noise_std: 0.1}}
parameters: {C: {value: 900, unit: J/K}, G: {value: 1, unit: J/K}}
states: {T: {der: "(heater - G*fan*(T - ambient))/C", unit: K, start: plate}}
elements: {}
law_sizes: {}
)";
  constexpr const char* kLog =
      "Zeit [s];Leistung [kW];Luefter [1/min];Aussen [degC];Blech [degC]\n"
      "0;1,5;600;20;30\n1;1,5;600;20;31\n2;1,6;600;20;32\n";
  ASSERT_EQ(make(kLog, path("cabinet.yaml")), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("heater").column, "Leistung [kW]");
  EXPECT_EQ(asset->channel_map.columns.at("fan").column, "Luefter [1/min]");
  EXPECT_FALSE(asset->channel_map.columns.contains("plate")) << "two columns are temperatures";
  std::ifstream written(path("a.yaml"));
  const std::string text{std::istreambuf_iterator<char>(written), {}};
  EXPECT_THAT(text, ::testing::HasSubstr("of that unit: Aussen [degC], Blech [degC]"));
  EXPECT_THAT(text, ::testing::HasSubstr("uncertain"));
}

// The command that is offered next must work: the log's sidecar says whose test it is, and an asset file in its place
// would be read for it.
TEST_F(AssetNew, TheFileGoesWithTheSidecarOfItsLog) {
  std::ofstream(path("log.yaml")) << "asset_id: MV2\n";
  constexpr const char* kLog = "t [s],motor_voltage [V],position [mm]\n0,1,60\n1,1,59\n2,1,58\n";
  ASSERT_EQ(make(kLog), kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->asset_id, "MV2");
  std::filesystem::remove(path("log.yaml"));
  EXPECT_EQ(run_asset_new({.log = path("log.csv"), .file = path("log.yaml"), .model = {}, .asset_id = {}, .yes = true}),
            kBadInput);
  std::ofstream(path("log.yaml")) << "asset_id: MV2\nmodel: eha\n";
  const auto recording = read_recording(path("log.csv"), **find_plant("eha"), asset->channel_map);
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().describe(), ::testing::HasSubstr("is read as the sidecar of " + path("log.csv")));
}

TEST_F(AssetNew, DateAndTimeInTwoColumnsAndMissingValuesAreRead) {
  write_pump();
  ASSERT_EQ(make("Date;Time;Opening [%];Pressure [psi(g)]\n04.03.2026;09:00:00,000;10;1\n"
                 "04.03.2026;09:00:00,100;11;---\n04.03.2026;09:00:00,200;11;1,5\n",
                 path("pump.yaml")),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").column, "Date + Time");
  EXPECT_EQ(asset->channel_map.log.incomplete_rows, "skip");
  const auto recording = read_recording(path("log.csv"), **find_plant(asset->model), asset->channel_map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_NEAR(recording->samples.time_s.back(), 0.2, 1e-9);
  EXPECT_NEAR(recording->samples.find("pressure")->values.front(), 101325.0 + 6894.757, 0.1);
}

TEST_F(AssetNew, MillisecondsSince1970AreSeen) {
  write_pump();
  ASSERT_EQ(make("Timestamp,Opening [%],Pressure [bar]\n1772614800000,1,2\n1772614800010,1,3\n1772614800020,1,3\n",
                 path("pump.yaml")),
            kOk);
  const Result<AssetConfig> asset = load_asset(path("a.yaml"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map.columns.at("time").unit, "ms since 1970-01-01");
}

// What the log does not give is said where one looks first, on the screen, and with columns that may be it.
TEST_F(AssetNew, WhatIsUncertainIsSaidOnTheScreen) {
  write_pump();
  ::testing::internal::CaptureStdout();
  ASSERT_EQ(make("t [s],Stellung [%],LVDT [counts],Pressure\n0,1,2000,1\n1,1,2001,1\n2,1,2003,1\n", path("pump.yaml")),
            kOk);
  const std::string told = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(told, ::testing::HasSubstr("the log gives no unit: taken for Pa"));
  EXPECT_THAT(told, ::testing::HasSubstr("output valve_lift [m] not found in "));
  EXPECT_THAT(told, ::testing::HasSubstr("{column: \"LVDT [counts]\", scale: 1, unit: \"m\"}"));
  EXPECT_THAT(
      told, ::testing::HasSubstr("asset id: log, from the log's name; change it under asset_id in " + path("a.yaml")));
  std::ostringstream text;
  text << std::ifstream(path("a.yaml")).rdbuf();
  EXPECT_THAT(text.str(), ::testing::HasSubstr("{column: \"LVDT [counts]\", scale: 1, unit: \"m\"}"));
}

TEST_F(AssetNew, AColumnWhoseCellsAreNoNumbersIsNamed) {
  write_pump();
  ::testing::internal::CaptureStdout();
  ASSERT_EQ(make("t [s],Opening [%],Pressure [psig]\n0,1,1\n1,1,12.5 or so\n", path("pump.yaml")), kOk);
  const std::string told = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(told, ::testing::HasSubstr("output pressure [Pa] not found in "));
  EXPECT_THAT(told, ::testing::HasSubstr("may be it, but '12.5 or so' in row 3"));
  EXPECT_THAT(told, ::testing::HasSubstr("has the unit of valve_lift [m]"));
  std::ostringstream text;
  text << std::ifstream(path("a.yaml")).rdbuf();
  EXPECT_THAT(text.str(), ::testing::HasSubstr("Pressure [psig] may be it, but '12.5 or so' in row 3 is not a number"));
}

/// What `make` reads of motor_voltage [V] and position [m], and says of it.
struct ReadBack {
  TimeSeries samples;
  std::string told;
};

class StrangeLogs : public AssetNew {
 protected:
  ReadBack read_back(const std::string& text) {
    std::filesystem::remove(path("a.yaml"));
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = make(text.c_str(), "eha");
    ReadBack back{.samples = {}, .told = ::testing::internal::GetCapturedStdout()};
    EXPECT_EQ(code, kOk) << ::testing::internal::GetCapturedStderr() << text;
    if (code != kOk) return back;
    ::testing::internal::GetCapturedStderr();
    const Result<AssetConfig> asset = load_asset(path("a.yaml"));
    EXPECT_TRUE(asset);
    const auto recording = read_recording(path("log.csv"), **find_plant("eha"), asset->channel_map);
    EXPECT_TRUE(recording) << recording.error().describe();
    back.samples = recording->samples;
    return back;
  }
  void expect_three_rows(const std::string& text) {
    const ReadBack back = read_back(text);
    ASSERT_TRUE(back.samples.has("motor_voltage") && back.samples.has("position")) << text << back.told;
    EXPECT_THAT(back.samples.time_s, ::testing::Pointwise(::testing::DoubleNear(1e-9), {0.0, 0.25, 1.0})) << text;
    EXPECT_THAT(back.samples.find("motor_voltage")->values,
                ::testing::Pointwise(::testing::DoubleNear(1e-12), {1.5, 2.0, 4.0}));
    EXPECT_THAT(back.samples.find("position")->values,
                ::testing::Pointwise(::testing::DoubleNear(1e-12), {0.060, 0.059, 0.057}));
  }
};

TEST_F(StrangeLogs, FractionsOfASecondInAColumnOfTheirOwn) {
  const std::string rows = ";1.5;60\n", next = ";2;59\n", last = ";4;57\n";
  for (const char* name : {"ms", "Millisecond", "MSEC", "Time [ms]"})
    expect_three_rows("Date;Time;" + std::string(name) + ";motor_voltage [V];position [mm]\n12.04.2031;03:00:00;0" +
                      rows + "12.04.2031;03:00:00;250" + next + "12.04.2031;03:00:01;0" + last);
  expect_three_rows(
      "Timestamp;Milliseconds;motor_voltage [V];position [mm]\n2031-04-12 03:00:00;000;1.5;60\n"
      "2031-04-12 03:00:00;250;2;59\n2031-04-12 03:00:01;000;4;57\n");
  expect_three_rows("secs;nsecs;motor_voltage [V];position [mm]\n0;0;1.5;60\n0;250000000;2;59\n1;0;4;57\n");
}

TEST_F(StrangeLogs, UnitsInTheMiddleOfANameAndBehindASlash) {
  for (const char* head : {"Time(s)\tMotor Voltage (V) (Formula Result)\tPosition(mm) - Raw\n",
                           "t/s\tmotor_voltage/V\tposition/mm\n", "TIME\tMOTOR VOLTAGE\tPOSITION\nSEC\tV\tMM\n",
                           "Time\tRoot/Motor Voltage[V]{SubArray1}\tRoot/Position[mm]{1}\n"})
    expect_three_rows(std::string(head) + "0\t1.5\t60\n0.25\t2\t59\n1\t4\t57\n");
  expect_three_rows("TIME\tMOTOR VOLTAGE\tPOSITION\nMSEC\tMV\tMM\n0\t1500\t60\n250\t2000\t59\n1000\t4000\t57\n");
}

TEST_F(StrangeLogs, ClocksWithAZoneOrWithoutHours) {
  const auto rows = [](const char* first, const char* second, const char* third) {
    return "Time;motor_voltage [V];position [mm]\n" + std::string(first) + ";1.5;60\n" + second + ";2;59\n" + third +
           ";4;57\n";
  };
  expect_three_rows(
      rows("2031-04-12 03:00:00.00 +0200", "2031-04-12 03:00:00.25 +0200", "2031-04-12 03:00:01.00 +0200"));
  expect_three_rows(rows("12.04.2031 03:00:00 +02:00", "12.04.2031 03:00:00.25 +02:00", "12.04.2031 03:00:01 +02:00"));
  expect_three_rows(rows("02:00.00", "02:00.25", "02:01.00"));
}

TEST_F(StrangeLogs, RowsWhoseStepOnlyTheHeadTells) {
  const auto rows = [](const std::string& head, const char* before) {
    std::string text = head;
    for (const char* row : {"1.5;60\n", "2;59\n", "4;57\n"}) text.append(before).append(row);
    return text;
  };
  for (const std::string& text : {rows("Delta_X;0.25;0.25\nX_Value;motor_voltage [V];position [mm]\n", ";"),
                                  rows("Sample rate: 4\nmotor_voltage [V];position [mm]\n", ""),
                                  rows("Sample Interval [ms];250\n\nmotor_voltage [V];position [mm]\n", "")}) {
    const ReadBack back = read_back(text);
    EXPECT_THAT(back.samples.time_s, ::testing::ElementsAre(0.0, 0.25, 0.5)) << text;
    EXPECT_THAT(back.told, ::testing::HasSubstr("the rows are taken as 250 ms apart, as the log's head says"));
  }
}

TEST_F(StrangeLogs, ATimeThatIsThereIsReadWhateverStepTheHeadTells) {
  expect_three_rows("Delta_X;0.25;0.25\nX_Value;motor_voltage [V];position [mm]\n0;1.5;60\n0.25;2;59\n1;4;57\n");
}

TEST_F(StrangeLogs, BlocksUnderTheSameHeadAreOneTable) {
  expect_three_rows(
      "Time;motor_voltage;position\ns;V;mm\n0;1.5;60\n0.25;2;59\n\nTime;motor_voltage;position\ns;V;mm\n1;4;57\n");
}

TEST_F(StrangeLogs, RemarksBelowTheUnitsAreNoHeader) {
  expect_three_rows(
      "Time\tmotor_voltage\tposition\ns\tV\tmm\nChannel comment\t\t\nDT=0.25\t\t\n0\t1.5\t60\n0.25\t2\t59\n1\t4\t57\n");
}

TEST_F(StrangeLogs, AFirstRowWithoutValuesIsNoHeader) {
  const std::string head = "Time [s];motor_voltage [V];position [mm]\n";
  for (const char* first : {"-0.5;NaN;---\n", "-0.5;;\n-0.25;n/a;60\n"}) {
    const ReadBack back = read_back(head + first + "0;1.5;60\n0.25;2;59\n1;4;57\n");
    EXPECT_THAT(back.samples.time_s, ::testing::ElementsAre(0.0, 0.25, 1.0)) << first;
    EXPECT_THAT(back.told, ::testing::HasSubstr("incomplete_rows: skip"));
  }
}

TEST_F(StrangeLogs, ANumberThatStandsForNoValueIsRemarkedOn) {
  std::string text = "Time [s];motor_voltage [V];position [mm]\n";
  for (int row = 0; row < 20; ++row)
    text += std::to_string(row) + ";" + std::to_string(row % 3) + ";" +
            (row % 7 == 3 ? "-9999" : std::to_string(50 + row)) + "\n";
  EXPECT_THAT(read_back(text).told, ::testing::HasSubstr("position is −10.0 m in 3 rows, far from all others"));
}

TEST_F(StrangeLogs, OfNamesThatSayNothingTheLinesToCompleteAreTold) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(make("TIME,CH1 [counts],CH2\n0,100,60\n1,200,59\n2,300,57\n", "eha"), kBadInput);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, ::testing::HasSubstr("no column looks like a channel of plant eha"));
  EXPECT_THAT(said, ::testing::HasSubstr("time: {column: \"TIME\", unit: \"s\"}"));
  EXPECT_THAT(said, ::testing::HasSubstr("motor_voltage: {column: \"CH1 [counts]\", scale: 1, unit: \"V\"}"));
}

TEST_F(StrangeLogs, ALogOfNoBuiltInPlantAsksForAPlantFile) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(make("Zeit,CH1 [counts],CH2\n0,100,60\n1,200,59\n2,300,57\n", ""), kBadInput);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, ::testing::HasSubstr("its columns look like no channel of a built-in plant"));
  EXPECT_THAT(said, ::testing::HasSubstr("give --model PLANT.yaml"));
}

TEST_F(StrangeLogs, HeaderCellsMayHaveLineBreaks) {
  for (const char* end : {"\n", "\r\n"}) {
    const std::string line = end;
    expect_three_rows("Rig 3\" bore" + line + "\"Time" + line + "[s]\";\"Motor" + line + "voltage" + line +
                      "[V]\";\"Position" + line + "(mm)\"" + line + "0;1.5;60" + line + "0.25;2;59" + line + "1;4;57" +
                      line);
  }
}

TEST_F(StrangeLogs, OfAnOscilloscopeAndOfAHistorian) {
  expect_three_rows(
      "Resolution,0.25\nVerticalUnit,V\nTime in s,motor_voltage in V,position in mm\n0,1.5,60\n0.25,2,59\n1,4,57\n");
  for (const char* day : {"12-Apr-31 ", "12-Apr-2031 "})
    for (const char* half : {"", " AM"}) {
      const std::string date = std::string("\n") + day, end = half;
      expect_three_rows("Timestamp,motor_voltage [V],position [mm]" + date + "03:00:00.000" + end + ",1.5,60" + date +
                        "03:00:00.250" + end + ",2,59" + date + "03:00:01.000" + end + ",4,57\n");
    }
  expect_three_rows(
      "Elapsed;motor_voltage [V];position [mm]\n23:59:59.75;1.5;60\n24:00:00.000;2;59\n24:00:00.750;4;57\n");
  expect_three_rows(
      "Elapsed;motor_voltage [V];position [mm]\n100:59:59.75;1.5;60\n101:00:00;2;59\n101:00:00.75;4;57\n");
}

TEST_F(StrangeLogs, AStepInTheHeadMayHaveItsUnitBehindIt) {
  for (const char* head : {"Sampling rate;4 Hz\n", "Sampling rate: 4 Hz\n", "Sample rate;4;Hz\n", "Rate;4 S/s\n",
                           "Sample interval;250 ms\n", "Sample rate [kHz];0.004\n"}) {
    const ReadBack back =
        read_back(std::string(head) + "\nNo.;motor_voltage [V];position [mm]\n1;1.5;60\n2;2;59\n3;4;57\n");
    EXPECT_THAT(back.samples.time_s, ::testing::ElementsAre(0.0, 0.25, 0.5)) << head << back.told;
  }
}

TEST_F(StrangeLogs, AUnitInBracketsMayBeFollowedByWords) {
  for (const char* time : {"Uhrzeit (ms seit Start)", "Temps (ms depuis le debut)", "Clock (ms, since start)"}) {
    const ReadBack back =
        read_back(std::string(time) + ";motor_voltage (V an M1);Weg (mm, rel.)\n0;1.5;60\n250;2;59\n500;4;57\n");
    EXPECT_THAT(back.samples.time_s, ::testing::ElementsAre(0.0, 0.25, 0.5)) << time << back.told;
    EXPECT_THAT(back.told, ::testing::Not(::testing::HasSubstr("no unit")));
  }
}

// Seconds that are a count of samples are wrong by the sampling rate, and nothing else shows it.
TEST_F(StrangeLogs, AColumnThatOnlyRisesIsNamedAsTheTime) {
  EXPECT_THAT(read_back("No.;motor_voltage [V];position [mm]\n1;1.5;60\n2;2;59\n3;4;57\n").told,
              ::testing::HasSubstr("no unit for the time, column \"No.\": taken for s; if it counts samples: "
                                   "{column: \"No.\", unit: s, scale: SECONDS_BETWEEN_SAMPLES}"));
  EXPECT_THAT(
      read_back("ts;motor_voltage [V];position [mm]\n1772614800000;1.5;60\n1772614800010;2;59\n1772614800020;4;57\n")
          .told,
      ::testing::HasSubstr("column \"ts\": taken for ms since 1970-01-01\n"));
}

TEST_F(StrangeLogs, EveryDoubtOfAColumnIsTold) {
  const std::string rows = "0,1,0.060,0.050\n1,1,0.060,0.050\n2,1,0.059,0.051\n";
  EXPECT_THAT(read_back("time [s],motor_voltage [V],position,position\n" + rows).told,
              ::testing::HasSubstr("uncertain, check it; the log gives no unit: taken for m, check it"));
  EXPECT_THAT(read_back("time [s],motor_voltage [V],position_mA,x\n" + rows).told,
              ::testing::HasSubstr("'mA' may be its unit, of another quantity: taken for m, check it"));
  std::string text = "Time [s];motor_voltage [V];position [mm]\n";
  for (int row = 0; row < 20; ++row)
    text += std::to_string(row) + ";" + std::to_string(row % 3) + ";" +
            (row == 3 ? "-9999" : std::to_string(50 + row)) + "\n";
  EXPECT_THAT(read_back(text).told, ::testing::HasSubstr("position is −10.0 m in 1 row, far from all others"));
}

TEST_F(StrangeLogs, ALogOfOneValueARowIsToldToBeMadeATable) {
  std::string text = "VarName;TimeString;VarValue\n";
  for (const char* time : {"00", "01", "02"})
    for (const char* name : {"Druck", "Weg"}) text += std::string(name) + ";12.04.2031 03:00:" + time + ";1,5\n";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(make(text.c_str(), "eha"), kBadInput);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::HasSubstr("one value, named in column \"VarName\", give each name a column of its own"));
}

TEST_F(AssetNew, AColumnWithoutAUnitIsMarked) {
  ASSERT_EQ(make("t [s],motor_voltage [V],position\n0,1,2048\n1,1,2049\n2,1,2050\n"), kOk);
  std::ifstream written(path("a.yaml"));
  const std::string text{std::istreambuf_iterator<char>(written), {}};
  EXPECT_THAT(text, ::testing::HasSubstr("the log gives no unit: taken for m"));
}

TEST_F(AssetNew, AUnitThatIsNotKnownIsNotSaidToBeMissing) {
  ASSERT_EQ(make("t [s],motor_voltage [V],position (furlongs/x)\n0,1,2048\n1,1,2049\n2,1,2050\n"), kOk);
  std::ifstream written(path("a.yaml"));
  const std::string text{std::istreambuf_iterator<char>(written), {}};
  EXPECT_THAT(text, ::testing::HasSubstr("(furlongs/x) is not a known unit: taken for m, check it"));
}

TEST_F(AssetNew, NothingIsWrittenOverAndNothingIsMadeUp) {
  ASSERT_EQ(make("t [s],position [mm]\n0,60\n1,59\n"), kOk);
  EXPECT_EQ(make("t [s],position [mm]\n0,60\n1,59\n"), kBadInput) << "the file is there already";
  std::filesystem::remove(path("a.yaml"));
  EXPECT_EQ(make("t [s],Huhn [mm/kg],Ei\n0,60,1\n1,59,2\n"), kBadInput) << "no column is a channel";
  EXPECT_FALSE(std::filesystem::exists(path("a.yaml")));
}

}  // namespace
}  // namespace sealwatch::cli
