// Any bytes as an FMU: an error or an unpacked folder that holds nothing but plain files and folders, never a crash,
// and nothing left behind.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "services/common/fmi/fmu_archive.hpp"

namespace {

std::string temporary_file() {
  std::string name = "/tmp/sealwatch_fuzz_XXXXXX.fmu";
  if (mkstemps(name.data(), 4) < 0) std::abort();
  return name;
}

constexpr sealwatch::fmi::ArchiveLimits kSmall{
    .members = 50, .description_bytes = 1U << 16U, .member_bytes = 1U << 16U, .total_bytes = 1U << 18U};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string file = temporary_file();
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  std::filesystem::path folder;
  if (const auto unpacked = sealwatch::fmi::unpack_fmu(file, kSmall)) {
    folder = unpacked->folder.path();
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_symlink() || !(entry.is_regular_file() || entry.is_directory())) std::abort();
  }
  if (!folder.empty() && std::filesystem::exists(folder)) std::abort();
  return 0;
}
