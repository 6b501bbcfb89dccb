// HDF5 and MATLAB files as h5py, PyTables, NetCDF, LabVIEW, dSPACE and Simulink write them: what attributes say of the
// numbers, tables, matrices, structs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include "services/common/recording/recording_file.hpp"
#include "services/common/recording/vector_file.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<double> kTime = {0.0, 0.5, 1.0}, kVoltage = {1.0, 2.0, 4.0}, kPosition_mm = {60.0, 59.0, 57.0};

void expect_samples(const Result<Recording>& recording) {
  ASSERT_TRUE(recording) << recording.error().describe();
  ASSERT_TRUE(recording->samples.has("motor_voltage") && recording->samples.has("position"));
  EXPECT_THAT(recording->samples.time_s, ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(recording->samples.find("motor_voltage")->values, ElementsAre(1.0, 2.0, 4.0));
  EXPECT_THAT(recording->samples.find("position")->values,
              ElementsAre(DoubleEq(0.060), DoubleEq(0.059), DoubleEq(0.057)));
}

ChannelMap map_of(const std::string& time, const std::string& voltage, const std::string& position,
                  const std::string& position_unit = {}) {
  return {.columns = {{"time", {.column = time, .unit = {}}},
                      {"motor_voltage", {.column = voltage, .unit = {}}},
                      {"position", {.column = position, .unit = position_unit}}},
          .log = {}};
}

/// An HDF5 file, closed at its end.
class Hdf5File {
 public:
  explicit Hdf5File(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Hdf5File() { H5Fclose(file_); }
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void numbers(const std::string& name, const std::vector<double>& values, std::vector<hsize_t> size = {},
               hid_t type = H5T_NATIVE_DOUBLE) {
    if (size.empty()) size = {values.size()};
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t data = H5Dcreate2(file_, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data), H5Pclose(links), H5Sclose(space);
  }
  void text(const std::string& name, const char* attribute, const std::vector<std::string>& texts) {
    constexpr std::size_t kSize = 40;
    std::string bytes;
    for (const std::string& text : texts) bytes += text + std::string(kSize - text.size(), '\0');
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, kSize);
    const hsize_t count = texts.size();
    attach(name, attribute, type, texts.size() == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr),
           bytes.data());
    H5Tclose(type);
  }
  void number(const std::string& name, const char* attribute, double value) {
    attach(name, attribute, H5T_NATIVE_DOUBLE, H5Screate(H5S_SCALAR), &value);
  }
  void table(const std::string& name) {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 3 * sizeof(double));
    std::size_t at = 0;
    for (const char* member : {"time", "motor_voltage", "position"})
      H5Tinsert(type, member, sizeof(double) * at++, H5T_NATIVE_DOUBLE);
    std::vector<double> rows;
    for (std::size_t k = 0; k < kTime.size(); ++k)
      for (const auto* column : {&kTime, &kVoltage, &kPosition_mm}) rows.push_back((*column)[k]);
    const hsize_t size = kTime.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t data = H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
    H5Dclose(data), H5Sclose(space), H5Tclose(type);
  }

 private:
  void attach(const std::string& name, const char* attribute, hid_t type, hid_t space, const void* data) {
    const hid_t object = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
    const hid_t id = H5Acreate2(object, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(id, type, data);
    H5Aclose(id), H5Sclose(space), H5Dclose(object);
  }
  hid_t file_;
};

class VectorFiles : public ScratchFolder {
 protected:
  [[nodiscard]] Result<Recording> read(const std::string& name, const ChannelMap& map = {}) const {
    return read_recording(path(name), test_plant(), map);
  }
  [[nodiscard]] std::string error_of(const std::string& name, const ChannelMap& map = {}) const {
    const Result<Recording> result = read(name, map);
    EXPECT_FALSE(result) << "accepted " << name;
    return result ? "" : result.error().describe();
  }
};

TEST_F(VectorFiles, UnitsInAttributesOfManyNames) {
  for (const char* attribute : {"unit", "units", "Unit", "Units", "unit_string"}) {
    {
      Hdf5File file(path("a.h5"));
      file.numbers("run/time", kTime), file.text("run/time", attribute, {"s"});
      file.numbers("run/motor_voltage", kVoltage, {3, 1}), file.text("run/motor_voltage", attribute, {"V"});
      file.numbers("run/position", kPosition_mm, {1, 3}), file.text("run/position", attribute, {"mm"});
    }
    expect_samples(read("a.h5"));
  }
}

TEST_F(VectorFiles, ATablesUnitsStandInOneAttribute) {
  {
    Hdf5File file(path("a.h5"));
    file.table("log"), file.text("log", "units", {"s", "V", "mm"});
  }
  expect_samples(read("a.h5"));
}

TEST_F(VectorFiles, AMatrixIsAsManyVectorsAsItHasColumns) {
  std::vector<double> by_row, by_column;
  for (std::size_t k = 0; k < 4; ++k)
    for (const double value : {0.5 * static_cast<double>(k), 2.0, 59.0 - static_cast<double>(k)})
      by_row.push_back(value);
  for (std::size_t column = 0; column < 3; ++column)
    for (std::size_t k = 0; k < 4; ++k) by_column.push_back(by_row[3 * k + column]);
  {
    Hdf5File file(path("a.h5"));
    file.numbers("log", by_row, {4, 3});
    file.text("log", "columns", {"time", "motor_voltage", "position"}), file.text("log", "units", {"s", "V", "mm"});
    file.numbers("rows", by_column, {3, 4});
  }
  for (const ChannelMap& map : {ChannelMap{}, map_of("rows/1", "rows/2", "rows/3", "mm"),
                                map_of("log/time", "log/motor_voltage", "rows/3", "mm")}) {
    const Result<Recording> recording = read("a.h5", map);
    ASSERT_TRUE(recording) << recording.error().describe();
    EXPECT_THAT(recording->samples.time_s, ElementsAre(0.0, 0.5, 1.0, 1.5));
    EXPECT_THAT(recording->samples.find("position")->values,
                ElementsAre(DoubleEq(0.059), DoubleEq(0.058), DoubleEq(0.057), DoubleEq(0.056)));
  }
}

// The CF conventions of NetCDF: value = scale_factor number + add_offset, and _FillValue is none.
TEST_F(VectorFiles, PackedNumbersAreUnpacked) {
  {
    Hdf5File file(path("a.h5"));
    file.numbers("time", {0.0, 0.5, 0.75, 1.0}), file.text("time", "units", {"seconds since 2031-04-12 03:00:00"});
    file.numbers("motor_voltage", {1.0, 2.0, 3.0, 4.0}), file.text("motor_voltage", "units", {"V"});
    file.numbers("position", {100.0, 90.0, -999.0, 70.0}, {}, H5T_STD_I16BE);
    file.text("position", "units", {"mm"}), file.number("position", "_FillValue", -999.0);
    file.number("position", "scale_factor", 0.1), file.number("position", "add_offset", 50.0);
  }
  EXPECT_THAT(error_of("a.h5"), AllOf(HasSubstr("row 3, channel position: 'nan': must be a finite number"),
                                      HasSubstr("log: {incomplete_rows: skip} leaves such rows out")));
  ChannelMap map;
  map.log.incomplete_rows = "skip";
  const Result<Recording> recording = read("a.h5", map);
  expect_samples(recording);
  EXPECT_EQ(format_utc(*recording->start_time), "2031-04-12T03:00:00Z");
}

TEST_F(VectorFiles, AnAttributeThatSaysScaledIsNotPassedOver) {
  {
    Hdf5File file(path("a.h5"));
    file.numbers("time", kTime), file.numbers("motor_voltage", kVoltage), file.number("motor_voltage", "gain", 1.0);
    file.numbers("position", {6000.0, 5900.0, 5700.0}), file.number("position", "gain", 0.01);
    file.text("position", "unit", {"mm"});
  }
  EXPECT_THAT(
      error_of("a.h5"),
      AllOf(HasSubstr("a.h5: channel position: 'position': has the attribute gain 0.01, so its numbers are scaled"),
            HasSubstr("give scale and offset in the map")));
  ChannelMap map = map_of("time", "motor_voltage", "position", "mm");
  map.columns["position"].scale = 0.01, map.columns["position"].is_scaled = true;
  expect_samples(read("a.h5", map));
}

TEST_F(VectorFiles, OneNameInSeveralGroupsIsAskedByItsPath) {
  {
    Hdf5File file(path("a.h5"));
    for (const char* run : {"run1/", "run2/"}) {
      file.numbers(std::string(run) + "time", kTime);
      file.numbers(std::string(run) + "motor_voltage", kVoltage);
      file.numbers(std::string(run) + "position", {0.060, 0.059, 0.057});
    }
  }
  EXPECT_THAT(error_of("a.h5"), HasSubstr("channel time: is missing and required"));
  expect_samples(read("a.h5", map_of("run2/time", "run2/motor_voltage", "run2/position")));
}

matvar_t* vector_of(const char* name, std::vector<double> values, std::array<std::size_t, 2> size = {0, 1}) {
  if (size[0] == 0) size[0] = values.size();
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
}

matvar_t* struct_of(const char* name, const std::vector<std::pair<const char*, matvar_t*>>& fields) {
  std::vector<const char*> names;
  for (const auto& field : fields) names.push_back(field.first);
  std::array<std::size_t, 2> one = {1, 1};
  matvar_t* out = Mat_VarCreateStruct(name, 2, one.data(), names.data(), static_cast<unsigned>(names.size()));
  for (const auto& [field, content] : fields) Mat_VarSetStructFieldByName(out, field, 0, content);
  return out;
}

matvar_t* text_of(const char* name, std::string text) {
  std::array<std::size_t, 2> size = {1, text.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), text.data(), 0);
}

struct Version {
  mat_ft version;
  matio_compression compression;
};

void save(const std::string& path, const Version& version, const std::vector<matvar_t*>& variables) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version.version);
  for (matvar_t* variable : variables) {
    Mat_VarWrite(file, variable, version.compression);
    Mat_VarFree(variable);
  }
  Mat_Close(file);
}

class MatlabStructs : public VectorFiles, public ::testing::WithParamInterface<Version> {};

TEST_P(MatlabStructs, FieldsAreVectorsByTheirPath) {
  save(path("a.mat"), GetParam(),
       {struct_of("rec", {{"time", vector_of(nullptr, kTime)},
                          {"motor_voltage", vector_of(nullptr, kVoltage, {1, 3})},
                          {"position", vector_of(nullptr, {0.060, 0.059, 0.057})}}),
        text_of("operator", "J. Miller")});
  expect_samples(read("a.mat", map_of("time", "motor_voltage", "rec/position")));
}

TEST_P(MatlabStructs, SimulinksStructureWithTime) {
  save(path("a.mat"), GetParam(),
       {struct_of("logsout",
                  {{"time", vector_of(nullptr, {0.0, 0.5, 1.0, 1.5})},
                   {"signals", struct_of(nullptr, {{"values", vector_of(nullptr, {1, 2, 4, 8, 60, 59, 57, 53}, {4, 2})},
                                                   {"label", text_of(nullptr, "u, x")}})}})});
  const Result<Recording> recording =
      read("a.mat", map_of("time", "logsout/signals/values/1", "logsout/signals/values/2", "mm"));
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_THAT(recording->samples.find("motor_voltage")->values, ElementsAre(1.0, 2.0, 4.0, 8.0));
  EXPECT_THAT(recording->samples.find("position")->values,
              ElementsAre(DoubleEq(0.060), DoubleEq(0.059), DoubleEq(0.057), DoubleEq(0.053)));
}

TEST(OfferedVectors, HaveNamesAndUnitsThatNoTerminalObeys) {
  MatVariable vector;
  vector.name = "run/x\x1b[31m";
  vector.unit = "mm\x07";
  const auto offered = offered_vectors({vector}, {});
  ASSERT_EQ(offered.size(), 1U);
  EXPECT_EQ(offered[0].text, "x\\x1B[31m");
  EXPECT_EQ(offered[0].unit, "mm\\x07");
}

TEST_P(MatlabStructs, TextIsNoChannelAndNamed) {
  save(path("a.mat"), GetParam(),
       {vector_of("time", kTime), text_of("position", "far away"), vector_of("motor_voltage", kVoltage)});
  EXPECT_THAT(error_of("a.mat", map_of("time", "motor_voltage", "position")),
              AllOf(HasSubstr("a.mat: channel position: 'position': "), HasSubstr("text"),
                    HasSubstr("one number for each sample is needed")));
}

TEST_P(MatlabStructs, ANumberThatIsNoneIsRefusedOrItsRowLeftOut) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  save(path("a.mat"), GetParam(),
       {vector_of("time", {0.0, 0.5, 0.75, 1.0}), vector_of("motor_voltage", {1.0, 2.0, 3.0, 4.0}),
        vector_of("position", {0.060, 0.059, none, 0.057})});
  ChannelMap map = map_of("time", "motor_voltage", "position");
  EXPECT_THAT(error_of("a.mat", map), HasSubstr("row 3, channel position: 'nan': must be a finite number; log: "
                                                "{incomplete_rows: skip} leaves such rows out"));
  map.log.incomplete_rows = "skip";
  expect_samples(read("a.mat", map));
}

INSTANTIATE_TEST_SUITE_P(Versions, MatlabStructs,
                         ::testing::Values(Version{MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                                           Version{MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                                           Version{MAT_FT_MAT73, MAT_COMPRESSION_ZLIB}));

}  // namespace
}  // namespace sealwatch
