// A huge file is refused early, and memory stays bounded while it is found out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <charconv>
#include <istream>
#include <streambuf>

#include "services/common/recording/csv_reader.hpp"
#include "services/common/recording/recording_file.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

/// A recording of four columns without an end; counts what was read of it.
class EndlessCsv : public std::streambuf {
 public:
  std::size_t bytes = 0;

 private:
  int_type underflow() override {
    text_ = bytes == 0 ? "time[s],position[m],pressure_a[Pa],pressure_b[Pa]\n" : "";
    while (text_.size() < 60000) {
      text_ += std::to_string(++row_);
      text_ += ",0.060,11373266.3,1065156.6\n";
    }
    bytes += text_.size();
    setg(text_.data(), text_.data(), text_.data() + text_.size());
    return traits_type::to_int_type(text_[0]);
  }
  std::string text_;
  int row_ = 0;
};

double peak_memory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

TEST(HugeFile, IsRefusedAfterTheMostNumbersWithBoundedMemory) {
  const double before_MB = peak_memory_MB();
  EndlessCsv endless;
  std::istream in(&endless);
  const Result<ColumnarSamples> result = read_csv(in, test_plant());
  ASSERT_FALSE(result);
  // 2 million numbers in four columns: row 1 is the header, so row 500002 is the first one too many.
  EXPECT_THAT(result.error().describe(),
              HasSubstr("row 500002, column pressure_b: the file holds more than 2000000 numbers"));
  EXPECT_LT(endless.bytes, 20'000'000U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // their shadow memory counts as well
  EXPECT_LT(peak_memory_MB() - before_MB, 40.0);  // 16 MB of numbers, up to twice that while the vectors grow
#else
  (void)before_MB;
#endif
}

using HugeFileOnDisk = ScratchFolder;

TEST_F(HugeFileOnDisk, AGigabyteWithoutLineBreaksIsRefusedEarly) {
  const double before_MB = peak_memory_MB();
  const std::string file = write("huge.csv", "time,position\n0,1\n");
  std::filesystem::resize_file(file, std::uintmax_t{1} << 30U);  // sparse: takes no space on the disk
  const Result<Recording> result = read_recording(file, test_plant());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().describe(), HasSubstr("row 3, column 1: the row is longer than 1048576 bytes"));
  EXPECT_LT(peak_memory_MB() - before_MB, 50.0);
}

}  // namespace
}  // namespace sealwatch
