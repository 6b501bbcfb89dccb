// Any bytes as a MATLAB recording: an error or samples that keep their promises, never a crash. matio reads files only,
// so each input passes through one in the temporary folder.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "services/common/recording/mat_reader.hpp"
#include "tests/fuzz/plant.hpp"

namespace {

std::string temporary_file() {
  std::string name = "/tmp/sealwatch_fuzz_XXXXXX.mat";
  if (mkstemps(name.data(), 4) < 0) std::abort();
  return name;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sealwatch::PlantDescription plant = sealwatch::fuzz_plant();
  static const std::string file = temporary_file();
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto result = sealwatch::read_mat(file, plant);
  if (result) sealwatch::check(result->samples);
  (void)sealwatch::read_mat_vectors(file);  // structs and texts too
  return 0;
}
