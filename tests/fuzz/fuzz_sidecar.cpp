// Any bytes as a sidecar: an error or a sidecar whose text reads back the same, never a crash.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "services/common/recording/sidecar.hpp"
#include "tests/fuzz/plant.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sealwatch::PlantDescription plant = sealwatch::fuzz_plant();
  const auto sidecar = sealwatch::parse_sidecar(std::string(reinterpret_cast<const char*>(data), size), plant);
  if (!sidecar) {
    if (sidecar.error().rule.empty()) std::abort();
    return 0;
  }
  std::vector<sealwatch::Column> columns;  // a recording of every channel, so that noise of any is accepted
  sealwatch::Recording recording;
  for (const auto& channel : plant.channels) {
    columns.push_back({channel.name, channel.unit, {}});
    recording.samples.channels.push_back({.name = channel.name, .unit = channel.unit, .noise_std = 0.0, .values = {}});
  }
  if (!sealwatch::apply_sidecar(*sidecar, columns, recording)) std::abort();
  const auto again = sealwatch::parse_sidecar(sealwatch::format_sidecar(recording), plant);
  if (!again || again->test != sidecar->test || again->start_time != sidecar->start_time) std::abort();
  return 0;
}
