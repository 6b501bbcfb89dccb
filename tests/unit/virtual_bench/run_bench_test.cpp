// The process of the virtual bench: what its parts throw ends it in words.
#include "services/virtual_bench/run_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::bench {
namespace {

TEST(RunBench, EndsInWordsWhateverIsThrown) {
  const sealwatch::testing::YamlPlace place;
  const std::string config =
      place.write("sealwatch.yaml", "state_directory: " + place.directory() + "/state\nlogging: {directory: log}\n");
  const char* const arguments[] = {"sealwatch-virtual-bench", "--config", config.c_str()};
  ::testing::internal::CaptureStderr();
  const int status = run_bench(3, arguments, [](const Configuration&) -> Result<std::unique_ptr<Bus>> {
    throw std::runtime_error("the bus broke");
  });
  constexpr int kStatusOfAFault = 3;
  EXPECT_EQ(status, kStatusOfAFault);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("virtual_bench: the bus broke"));
}

}  // namespace
}  // namespace sealwatch::bench
