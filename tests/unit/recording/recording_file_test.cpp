// Files as a whole: data file, sidecar, hash, writing and reading back.
#include "services/common/recording/recording_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "sealwatch/core/text.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

class RecordingFile : public ScratchFolder {
 protected:
  static Recording read(const std::string& file) {
    Result<Recording> result = read_recording(file, test_plant());
    EXPECT_TRUE(result) << result.error().describe();
    return result ? *result : Recording{};
  }
  static std::string error_of(const std::string& file) {
    const Result<Recording> result = read_recording(file, test_plant());
    EXPECT_FALSE(result) << "accepted " << file;
    return result ? "" : result.error().describe();
  }
};

Recording example() {
  Recording out;
  out.recording_id = "2031-04: \"PST\"";
  out.asset_id = "XT03-MV2";
  out.test = TestKind::other;
  out.start_time = parse_utc("2031-04-12T03:00:00.25Z").value();
  out.note = "two\nlines, # and: a 'colon'";
  out.samples.input_hold = true;
  out.samples.time_s = {0.0, 0.1, 1.0 / 3.0};
  out.samples.channels = {
      {.name = "pressure_a", .unit = "Pa", .noise_std = 1.0e4 / 3.0, .values = {1e7 / 3.0, -1e-5, 1e-99 / 3.0}},
      {.name = "position", .unit = "m", .noise_std = 0.0, .values = {0.06, 0.1 + 0.2, 1e18 / 3.0}}};
  return out;
}

TEST_F(RecordingFile, NamesItsAssetBeforeThePlantIsKnown) {
  const std::string file = write("a.csv", "time,anything\n");
  EXPECT_EQ(recorded_asset_id(file).value(), "");
  write("a.yaml", "asset_id: XT03-MV2\nnoise_std: {channel_of_another_plant: 1.0}\n");
  EXPECT_EQ(recorded_asset_id(file).value(), "XT03-MV2");
  write("a.yaml", "asset: XT03-MV2\n");
  EXPECT_THAT(recorded_asset_id(file).error().describe(),
              HasSubstr("a.yaml: line 1, key asset: 'XT03-MV2': is not a known key; did you mean 'asset_id'?"));
  write("a.yaml", "asset_id: [unclosed\n");
  EXPECT_THAT(recorded_asset_id(file).error().describe(), HasSubstr("a.yaml: line"));
}

TEST_F(RecordingFile, WritesAndReadsBackTheVeryWordsAndNumbers) {
  const Recording written = example();
  ASSERT_TRUE(write_recording_csv(written, path("a.csv")));
  const Recording back = read(path("a.csv"));
  EXPECT_EQ(back.recording_id, written.recording_id);
  EXPECT_EQ(back.asset_id, written.asset_id);
  EXPECT_EQ(back.test, written.test);
  EXPECT_EQ(back.start_time, written.start_time);
  EXPECT_EQ(back.note, written.note);
  EXPECT_EQ(back.samples, written.samples);
  EXPECT_FALSE(std::filesystem::exists(path("a.csv.part")));
}

TEST_F(RecordingFile, RoundedFilesReadBackToTheirPrintedDigits) {
  const Recording written = example();
  ASSERT_TRUE(write_recording_csv(written, path("a.csv"), 6));
  const Recording once = read(path("a.csv"));
  EXPECT_NEAR(once.samples.channels[0].values[0], 1e7 / 3.0, 5.0);  // half a unit of the sixth digit of 3333333
  EXPECT_EQ(once.samples.time_s, written.samples.time_s);           // times stay exact
  ASSERT_TRUE(write_recording_csv(once, path("b.csv"), 6));
  EXPECT_EQ(read(path("b.csv")).content_hash, once.content_hash);
}

TEST_F(RecordingFile, WithoutSidecarOnlyTheFileSpeaks) {
  const std::string text = "time,position\n0,1\n";
  const Recording recording = read(write("2009-03.csv", text));
  EXPECT_EQ(recording.file, path("2009-03.csv"));
  EXPECT_EQ(recording.recording_id, "2009-03");
  EXPECT_EQ(recording.asset_id, "");
  EXPECT_FALSE(recording.start_time);
  EXPECT_EQ(recording.content_hash, content_hash(text));
}

TEST_F(RecordingFile, ANameThatIsNotUtf8IsMadePrintable) {
  EXPECT_EQ(read(write("t\xE9st.csv", "time,position\n0,1\n")).recording_id, "t?st");
}

TEST_F(RecordingFile, NoiseIsInTheColumnsUnit) {
  write("a.yaml", "noise_std: {pressure_a: 0.1, fluid_temperature: 0.5}\n");
  const Recording recording = read(write("a.csv", "time,fluid_temperature[degC],pressure_a[bar]\n0,4,1\n"));
  EXPECT_EQ(recording.samples.find("pressure_a")->noise_std, 1e4);
  EXPECT_EQ(recording.samples.find("fluid_temperature")->noise_std, 0.5);  // a difference: no offset
}

TEST_F(RecordingFile, NoiseOfAChannelThatIsNotRecordedIsRefused) {
  write("a.yaml", "noise_std: {pressure_a: 0.1, flow: 1}\n");
  EXPECT_THAT(error_of(write("a.csv", "time,pressure_a[bar]\n0,1\n")),
              HasSubstr("a.yaml: key noise_std.flow: its channel is not in the recording"));
}

TEST_F(RecordingFile, TheSidecarDoesNotChangeTheHash) {
  const std::string file = write("a.csv", "time,position\n0,1\n");
  const std::string before = read(file).content_hash;
  write("a.yaml", "note: mended\n");
  EXPECT_EQ(read(file).content_hash, before);
}

TEST_F(RecordingFile, ErrorsNameTheFile) {
  EXPECT_THAT(error_of(path("none.csv")), HasSubstr("none.csv: cannot be opened: No such file"));
  EXPECT_THAT(error_of(path(".")), HasSubstr("is a directory"));
  EXPECT_THAT(error_of(write("bad.csv", "time,position\n0,x\n")), HasSubstr("bad.csv: row 2, column position: 'x'"));
  write("side.yaml", "tset: pst\n");
  EXPECT_THAT(error_of(write("side.csv", "time,position\n0,1\n")), HasSubstr("side.yaml: line 1, key tset"));
  write("long.yaml", "note: " + std::string(kLongestSidecar_bytes, 'x'));
  EXPECT_THAT(error_of(write("long.csv", "time,position\n0,1\n")), HasSubstr("long.yaml: is longer than"));
}

TEST_F(RecordingFile, WritingNowhereIsAnError) {
  const Status status = write_recording_csv(example(), path("no/such/folder/a.csv"));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().describe(), HasSubstr("a.yaml: cannot be written"));
}

TEST(SharedRecordings, AllCanBeRead) {
  const std::filesystem::path folder = std::filesystem::path(SEALWATCH_SHARED_DATA) / "pst_life" / "xt03-mv2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the public recordings are not there: " << folder;
  PlantDescription plant = test_plant();
  for (const auto& [name, unit] : {std::pair{"motor_current", "A"}, {"velocity", "m/s"}})
    plant.channels.push_back({.name = name, .unit = unit, .meaning = "of the test"});
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    const Result<Recording> recording = read_recording(entry.path().string(), plant);
    ASSERT_TRUE(recording) << recording.error().describe();
    EXPECT_TRUE(recording->start_time) << entry.path();
    EXPECT_GE(recording->samples.time_s.size(), 300U);
    ++count;
  }
  EXPECT_GT(count, 100);
}

using WildNumbers = ScratchFolder;

TEST_F(WildNumbers, AreRefusedByRowAndColumn) {
  const auto error_of = [this](const std::string& text) {
    const Result<Recording> result = read_recording(write("wild.csv", text), test_plant());
    return result ? std::string("was read") : result.error().describe();
  };
  EXPECT_THAT(error_of("time,position\n0,1e308\n1,2\n"),
              HasSubstr("row 2, column position: '1e+308': cannot be measured here: more than"));
  EXPECT_THAT(error_of("time,position\n0,1\n1,-1e300\n"), HasSubstr("row 3, column position: '-1e+300'"));
  EXPECT_THAT(error_of("time,position\n0,1\n1e300,2\n"),
              HasSubstr("row 3, column time: '1e+300': cannot be measured here: more than"));
  EXPECT_THAT(error_of("time,position\n0,1\n5e-12,2\n1e-11,3\n"), HasSubstr("rows 5e-12 s apart, closer than"));
  EXPECT_THAT(error_of("time,position\n0,1\n1e6,2\n"), HasSubstr("1000000 s long, more than the 604800 s"));
  const Result<Recording> tiny = read_recording(write("tiny.csv", "time,position\n0,5e-324\n1,2\n"), test_plant());
  ASSERT_TRUE(tiny) << tiny.error().describe();
  EXPECT_EQ(tiny->samples.channels[0].values, (std::vector<double>{0.0, 2.0}));
}

/// The library would read any file of this machine, and wait for the writer of a pipe.
TEST_F(RecordingFile, AnHdf5FileWhoseDataLieInAnotherIsRefused) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string file = path("a.h5");
  const hid_t made = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t rows = 100;
  const hid_t space = H5Screate_simple(1, &rows, nullptr), elsewhere = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(elsewhere, path("pipe").c_str(), 0, 800);
  H5Dclose(H5Dcreate2(made, "time", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, elsewhere, H5P_DEFAULT));
  H5Pclose(elsewhere);
  H5Sclose(space);
  H5Fclose(made);
  EXPECT_THAT(error_of(file), HasSubstr("a.h5: data set time: its data lies in another file"));
}

TEST_F(RecordingFile, AnHdf5FileOfDeepGroupsIsRefused) {
  const std::string file = path("a.h5");
  const hid_t made = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  hid_t inner = H5Gopen2(made, "/", H5P_DEFAULT);
  for (int depth = 0; depth < 1000; ++depth) {
    const hid_t next = H5Gcreate2(inner, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(inner);
    inner = next;
  }
  H5Gclose(inner);
  H5Fclose(made);
  EXPECT_THAT(error_of(file), HasSubstr("nested too deeply"));
}

}  // namespace
}  // namespace sealwatch
