// Any bytes as a sidecar: an error or a sidecar whose text reads back the same, never a crash.
#include <cstdint>

#include "services/common/recording/sidecar.hpp"
#include "tests/fuzz/plant.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sealwatch::PlantDescription plant = sealwatch::fuzz_plant();
  const auto sidecar = sealwatch::parse_sidecar(std::string(reinterpret_cast<const char*>(data), size), plant);
  if (!sidecar) {
    if (sidecar.error().rule.empty()) std::abort();
    return 0;
  }
  sealwatch::Recording recording;
  (void)sealwatch::apply_sidecar(*sidecar, {}, recording);
  const auto again = sealwatch::parse_sidecar(sealwatch::format_sidecar(recording), plant);
  if (!again || again->test != sidecar->test || again->start_time != sidecar->start_time) std::abort();
  return 0;
}
