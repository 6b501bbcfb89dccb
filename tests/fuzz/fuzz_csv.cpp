// Any bytes as a CSV recording: an error or samples that keep their promises, never a crash.
#include <cstdint>
#include <sstream>

#include "services/common/recording/csv_reader.hpp"
#include "tests/fuzz/plant.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sealwatch::PlantDescription plant = sealwatch::fuzz_plant();
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  const bool jumps = size % 2 == 1;
  const sealwatch::Result<sealwatch::ColumnarSamples> result = sealwatch::read_csv(in, plant, jumps);
  if (result)
    sealwatch::check(result->samples);
  else if (result.error().place.empty() || result.error().rule.empty())
    std::abort();
  return 0;
}
