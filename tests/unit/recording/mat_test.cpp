// MATLAB files, version 5 (plain and compressed) and 7.3.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <new>
#include <numeric>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/hdf5_child.hpp"
#include "services/common/recording/recording_file.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Format {
  const char* name;
  mat_ft version;
  matio_compression compression;
};
constexpr std::array kFormats = {Format{"v5", MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                                 Format{"v5_compressed", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                                 Format{"v73", MAT_FT_MAT73, MAT_COMPRESSION_NONE}};

class MatWriter {
 public:
  MatWriter(const std::string& path, const Format& format)
      : file_(Mat_CreateVer(path.c_str(), nullptr, format.version)), compression_(format.compression) {}
  ~MatWriter() { Mat_Close(file_); }
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;

  void column(const char* name, std::vector<double> values) {
    put(name, MAT_C_DOUBLE, MAT_T_DOUBLE, {values.size(), 1}, values.data());
  }
  void complex_column(const char* name, std::vector<double> values) {
    std::array<std::size_t, 2> size = {values.size(), 1};
    mat_complex_split_t both{values.data(), values.data()};
    matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), &both, MAT_F_COMPLEX);
    Mat_VarWrite(file_, variable, compression_);
    Mat_VarFree(variable);
  }
  void put(const char* name, matio_classes kind, matio_types type, std::array<std::size_t, 2> size, void* data) {
    matvar_t* variable = Mat_VarCreate(name, kind, type, 2, size.data(), data, 0);
    Mat_VarWrite(file_, variable, compression_);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
  matio_compression compression_;
};

class MatRecording : public ScratchFolder, public ::testing::WithParamInterface<Format> {
 protected:
  [[nodiscard]] std::string error_of(const std::string& file) const {
    const Result<Recording> result = read_recording(file, test_plant());
    EXPECT_FALSE(result) << "accepted " << file;
    return result ? "" : result.error().describe();
  }
};

TEST_P(MatRecording, ReadsVectorsOfEveryNumericClass) {
  {
    MatWriter writer(path("a.mat"), GetParam());
    writer.column("time", {0.0, 0.01, 0.02});
    std::array<float, 3> pressure = {1.5F, 2.5F, 3.5F};
    writer.put("pressure_a", MAT_C_SINGLE, MAT_T_SINGLE, {1, 3}, pressure.data());  // a row vector
    std::array<std::int8_t, 3> valve = {-1, 0, 1};
    writer.put("valve_state", MAT_C_INT8, MAT_T_INT8, {3, 1}, valve.data());
    writer.column("position", {0.06, 0.061, 0.062});
  }
  std::ofstream(path("a.yaml")) << "asset_id: X1\nnoise_std: {pressure_a: 3}\n";
  const Result<Recording> result = read_recording(path("a.mat"), test_plant());
  ASSERT_TRUE(result) << result.error().describe();
  EXPECT_EQ(result->asset_id, "X1");
  EXPECT_THAT(result->samples.time_s, ElementsAre(0.0, 0.01, 0.02));
  EXPECT_THAT(result->samples.find("pressure_a")->values, ElementsAre(1.5, 2.5, 3.5));
  EXPECT_EQ(result->samples.find("pressure_a")->noise_std, 3.0);
  EXPECT_EQ(result->samples.find("pressure_a")->unit, "Pa");
  EXPECT_THAT(result->samples.find("valve_state")->values, ElementsAre(-1.0, 0.0, 1.0));
  EXPECT_THAT(result->samples.find("position")->values, ElementsAre(0.06, 0.061, 0.062));
  std::ifstream bytes(path("a.mat"), std::ios::binary);
  EXPECT_EQ(result->content_hash, content_hash(std::string(std::istreambuf_iterator<char>(bytes), {})));
}

TEST_P(MatRecording, BadVectorsAreErrors) {
  const auto error_with = [this](auto&& fill) {
    {
      MatWriter writer(path("bad.mat"), GetParam());
      fill(writer);
    }
    return error_of(path("bad.mat"));
  };
  EXPECT_THAT(error_with([](MatWriter& w) { w.column("position", {1.0}); }),
              HasSubstr("bad.mat: row 1, column time: is missing"));
  EXPECT_THAT(error_with([](MatWriter& w) {
                w.column("time", {0.0});
                w.column("positio", {1.0});
              }),
              HasSubstr("did you mean 'position'?"));
  EXPECT_THAT(
      error_with([](MatWriter& w) {
        w.column("time", {0.0, 1.0});
        w.column("position", {1.0});
      }),
      HasSubstr("row 1, column position: has 1 samples where time has 2; take it out, or store one real number"));
  EXPECT_THAT(error_with([](MatWriter& w) {
                w.column("time", {0.0, 1.0, 1.0});
              }),
              HasSubstr("row 3, column time: '1': time must increase from row to row: the one before is"));
  EXPECT_THAT(error_with([](MatWriter& w) {
                w.column("time", {0.0, 1.0});
                w.column("position", {0.0, std::nan("")});
              }),
              HasSubstr("row 2, column position: 'nan': must be a finite number"));
  EXPECT_THAT(error_with([](MatWriter& w) {
                std::array<double, 4> square{};
                w.put("time", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 2}, square.data());
              }),
              HasSubstr("row 1, column time: must be one vector"));
  EXPECT_THAT(error_with([](MatWriter& w) {
                std::string text = "abc";
                w.put("time", MAT_C_CHAR, MAT_T_UTF8, {1, 3}, text.data());
              }),
              HasSubstr("must be one vector"));
}

TEST_P(MatRecording, AComplexVectorIsToldAsThat) {
  {
    MatWriter writer(path("complex.mat"), GetParam());
    writer.column("time", {0.0, 1.0});
    writer.complex_column("position", {0.1, 0.2});
  }
  EXPECT_THAT(error_of(path("complex.mat")), HasSubstr("column position: is complex"));
  ChannelMap map;
  map.columns = {{"time", {.column = "time", .unit = "s"}}, {"position", {.column = "position", .unit = "mm"}}};
  const Result<Recording> mapped = read_recording(path("complex.mat"), test_plant(), map);
  ASSERT_FALSE(mapped);
  EXPECT_THAT(mapped.error().describe(),
              AllOf(HasSubstr("complex.mat"), HasSubstr("channel position: 'position': is complex")));
}

TEST_P(MatRecording, VariablesThatThePlantDoesNotKnowAreLeftAside) {
  {
    MatWriter writer(path("a.mat"), GetParam());
    writer.column("time", {0.0, 1.0});
    writer.column("position", {0.0, 1.0});
    writer.column("sampling_rate", {200.0});
  }
  const Result<Recording> recording = read_recording(path("a.mat"), test_plant());
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_THAT(recording->left_aside, testing::ElementsAre("sampling_rate"));
  EXPECT_EQ(recording->samples.channels.size(), 1U);
  {
    MatWriter writer(path("b.mat"), GetParam());
    writer.column("time", {0.0, 1.0});
    writer.column("posision", {0.0, 1.0});
  }
  EXPECT_THAT(error_of(path("b.mat")), HasSubstr("did you mean 'position'?"));
  {
    MatWriter writer(path("c.mat"), GetParam());
    writer.column("time", {0.0, 1.0});
    std::string text = "open";
    writer.put("position", MAT_C_CHAR, MAT_T_UINT8, {1, text.size()}, text.data());
  }
  EXPECT_THAT(error_of(path("c.mat")), HasSubstr("must be one vector of real numbers; take it out, or store one"));
}

TEST_P(MatRecording, ACutFileIsAnError) {
  {
    MatWriter writer(path("a.mat"), GetParam());
    std::vector<double> time, position;
    for (int row = 0; row < 500; ++row) {
      time.push_back(0.01 * row);
      position.push_back(std::sin(row));
    }
    writer.column("time", time);
    writer.column("position", position);
  }
  const std::uintmax_t size = std::filesystem::file_size(path("a.mat"));
  for (const double share : {0.999, 0.9, 0.6, 0.3, 0.01, 0.0}) {
    std::filesystem::copy_file(path("a.mat"), path("cut.mat"), std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(path("cut.mat"), static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    EXPECT_THAT(error_of(path("cut.mat")), HasSubstr("cut.mat: ")) << share;
  }
}

// matio would ask for as much memory as a damaged length says, 1.9 GB here, and fill it.
TEST_P(MatRecording, ADamagedLengthIsAnErrorBeforeMemoryIsAskedFor) {
  if (GetParam().version == MAT_FT_MAT73) GTEST_SKIP() << "HDF5 checks its own lengths";
  MatWriter(path("a.mat"), GetParam()).column("time", {0.0, 0.01, 0.02});
  std::ifstream file(path("a.mat"), std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(file), {});
  // Compressed, any byte behind the first tag breaks the checksum; plain, these are the lengths of flags and
  // dimensions, type and length of the name, and the length of the numbers.
  std::vector<std::size_t> places = {140, 156, 168, 170, 180};
  if (GetParam().compression == MAT_COMPRESSION_ZLIB) {
    places.resize(good.size() - 136);
    std::iota(places.begin(), places.end(), 136U);
  }
  for (const std::size_t at : places) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x74);
    write("bad.mat", bad);
    EXPECT_THAT(error_of(path("bad.mat")), HasSubstr("bad.mat: the file is cut off or damaged")) << at;
  }
}

// HDF5 follows what it finds: a damaged byte can end the process that reads it.
TEST_P(MatRecording, AnyDamagedByteIsAnErrorOrHarmless) {
  if (GetParam().version != MAT_FT_MAT73) GTEST_SKIP() << "the others have tests of their own";
  MatWriter(path("a.mat"), GetParam()).column("time", {0.0, 0.01, 0.02});
  std::ifstream file(path("a.mat"), std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(file), {});
  int errors = 0;
  for (std::size_t at = 520; at < good.size(); at += 5) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x74);
    write("bad.mat", bad);
    errors += read_recording(path("bad.mat"), test_plant()).has_value() ? 0 : 1;
  }
  EXPECT_GT(errors, 50);
}

TEST(Hdf5Child, ItsEndIsAnErrorAboutTheFile) {
  using Answer = Result<std::vector<MatVariable>>;
  const auto rule_of = [](const std::function<Answer()>& read) {
    const Answer answer = in_child(read);
    return answer ? "an answer" : answer.error().rule;
  };
  EXPECT_THAT(rule_of([]() -> Answer { return std::raise(SIGSEGV), fail("not reached"); }),
              HasSubstr("is damaged: the library that reads HDF5 and MATLAB 7.3 files was stopped"));
  EXPECT_THAT(rule_of([]() -> Answer { throw std::bad_alloc(); }), HasSubstr("ended without an answer"));
  EXPECT_EQ(rule_of([]() -> Answer { return fail("a rule"); }), "a rule");
  const Answer answer = in_child([]() -> Answer {
    return std::vector<MatVariable>{{"time", {0.0, 0.5}}, {"flow", {}}};
  });
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->size(), 2U);
  EXPECT_EQ(answer->front().name, "time");
  EXPECT_EQ(answer->front().values, (std::vector<double>{0.0, 0.5}));
  EXPECT_THAT(answer->back().values, testing::IsEmpty());
}

TEST_P(MatRecording, NumbersOfAnotherTypeThanTheirTagAreAnError) {
  if (GetParam().version == MAT_FT_MAT73 || GetParam().compression == MAT_COMPRESSION_ZLIB)
    GTEST_SKIP() << "HDF5 and checksums see to that";
  MatWriter(path("a.mat"), GetParam()).column("time", {0.0, 0.01, 0.02});
  std::ifstream file(path("a.mat"), std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(file), {});
  constexpr std::size_t kType = 176;  // of the numbers: 9, double
  ASSERT_EQ(good[kType], 9);
  for (const char type : {'\0', '\1', '\5', '\7', '\10', '\16', 'M'}) {
    std::string bad = good;
    bad[kType] = type;
    write("bad.mat", bad);
    EXPECT_THAT(error_of(path("bad.mat")), HasSubstr("bad.mat: the file is cut off or damaged")) << int{type};
  }
}

TEST_P(MatRecording, ReadsWholeNumbersOf64Bits) {
  {
    MatWriter writer(path("a.mat"), GetParam());
    std::array<std::int64_t, 3> time = {0, 1, 2};
    writer.put("time", MAT_C_INT64, MAT_T_INT64, {3, 1}, time.data());
    std::array<std::uint64_t, 3> position = {1, 2, 3};
    writer.put("position", MAT_C_UINT64, MAT_T_UINT64, {3, 1}, position.data());
  }
  const Result<Recording> result = read_recording(path("a.mat"), test_plant());
  ASSERT_TRUE(result) << result.error().describe();
  EXPECT_THAT(result->samples.time_s, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(result->samples.find("position")->values, ElementsAre(1.0, 2.0, 3.0));
}

INSTANTIATE_TEST_SUITE_P(Formats, MatRecording, ::testing::ValuesIn(kFormats),
                         [](const auto& format) { return format.param.name; });

class OtherFile : public ScratchFolder {};

TEST_F(OtherFile, SuffixInCapitalsIsTheSame) {
  EXPECT_EQ(suffix_of("a/PST.MAT"), ".mat");
  EXPECT_EQ(suffix_of("a/PST.Csv"), ".csv");
  const std::string text = "time[s],position[m]\n0,0.1\n1,0.2\n";
  EXPECT_TRUE(read_recording(write("x.CSV", text), test_plant()));
  EXPECT_FALSE(read_recording(write("x.MAT", text), test_plant())) << "read as the MATLAB file that its name says";
}

TEST_F(OtherFile, Version4IsRefusedByName) {
  { MatWriter(path("old.mat"), {"v4", MAT_FT_MAT4, MAT_COMPRESSION_NONE}).column("time", {0.0, 0.01}); }
  const Result<Recording> result = read_recording(path("old.mat"), test_plant());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().describe(),
              HasSubstr("old.mat: is a MATLAB file of version 4, which is not read; save it"));
}

TEST_F(OtherFile, CsvNamedMatIsAnError) {
  const Result<Recording> result = read_recording(write("a.mat", "time,position\n0,1\n"), test_plant());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().describe(), HasSubstr("a.mat: is not a MATLAB file"));
}

}  // namespace
}  // namespace sealwatch
