// Any bytes as sealwatch.yaml and, behind a line of "=== asset", as asset files: faults that all say what is wrong, or a
// configuration whose assets can be written and read back the same; never a crash.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "services/common/runtime/configuration_loader.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kAsset = "\n=== asset\n";

void require(bool holds) {
  if (!holds) std::abort();
}

/// A configuration's directory in memory, for this process.
const std::filesystem::path& folder() {
  static const std::filesystem::path made = [] {
    const std::filesystem::path memory = "/dev/shm";
    const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
    return (has_memory ? memory : std::filesystem::temp_directory_path()) /
           ("fuzz_configuration_" + std::to_string(::getpid()));
  }();
  return made;
}

void write(const std::filesystem::path& file, std::string_view content) {
  std::ofstream(file, std::ios::binary) << content;
}

void check(const AssetConfig& asset) {
  const std::filesystem::path file = folder() / "again.yaml";
  write(file, asset_to_yaml(asset));
  const auto again = check_asset(file.string());
  require(again.has_value());
  require(asset_to_yaml(*again) == asset_to_yaml(asset));
}

}  // namespace
}  // namespace sealwatch

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sealwatch;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::filesystem::remove_all(folder());
  std::filesystem::create_directories(folder() / "assets");
  for (int number = 0;; ++number) {
    const std::size_t end = rest.find(kAsset);
    write(number == 0 ? folder() / "sealwatch.yaml" : folder() / "assets" / (std::to_string(number) + ".yaml"),
          rest.substr(0, end));
    if (end == std::string_view::npos || number == 4) break;
    rest.remove_prefix(end + kAsset.size());
  }
  const auto configuration = load_configuration(folder().string());
  if (configuration)
    for (const AssetConfig& asset : configuration->assets) check(asset);
  else
    for (const Error& error : configuration.error()) require(!error.rule.empty());
  return 0;
}
