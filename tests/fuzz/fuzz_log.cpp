// Any bytes as somebody's own log: an error or samples that keep their promises, never a crash. The first byte chooses
// the map.
#include <cstdint>
#include <sstream>

#include "services/common/recording/log_reader.hpp"
#include "tests/fuzz/plant.hpp"

namespace {

sealwatch::ChannelMap map_by(std::uint8_t choice) {
  constexpr const char* kTimes[] = {"s", "iso8601", "excel", "%d.%m.%Y %H:%M:%S"};
  constexpr const char* kResets[] = {"refuse", "join", "split"};
  sealwatch::ChannelMap map;
  map.columns["time"] = {.column = "t", .unit = kTimes[choice % 4]};
  map.columns["position"] = {.column = "x", .unit = {}, .scale = 0.5, .offset = 1.0};
  map.log.time_resets = kResets[choice / 4 % 3];
  map.log.incomplete_rows = choice % 2 == 0 ? "skip" : "refuse";
  return map;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sealwatch::PlantDescription plant = sealwatch::fuzz_plant();
  if (size == 0) return 0;
  std::istringstream in(std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  const sealwatch::Result<sealwatch::Log> log = sealwatch::read_log(in, plant, map_by(data[0]));
  if (log)
    for (const sealwatch::LogTest& test : log->tests) sealwatch::check(test.read.samples);
  else if (log.error().place.empty() || log.error().rule.empty())
    std::abort();
  return 0;
}
