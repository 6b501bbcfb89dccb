// One side of the throughput measurement (sample_throughput.sh): RawSamples blocks of 1000 doubles, as fast as the bus
// takes them, from one process to another.
//   sample_throughput publish SECONDS     publishes once a subscriber is there
//   sample_throughput subscribe SECONDS   prints blocks a second between the first and the last block received
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>

#include "sealwatch/port/patient_publish.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace {

using namespace sealwatch;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// 125 instants of seven channels and their time: 1000 doubles.
RawSamples block_of_1000_doubles() {
  RawSamples block;
  block.asset_id = "XT03-MV2";
  block.source_id = "benchmark";
  block.recording_id = "throughput";
  block.samples.time_s.assign(125, 1.0);
  for (const char* name :
       {"motor_voltage", "motor_current", "shaft_speed", "pressure_a", "pressure_b", "flow", "position"})
    block.samples.channels.push_back({name, "Pa", 0.1, std::vector<double>(125, 2.0)});
  return block;
}

Status publish(DdsBus& bus, Clock::duration duration) {
  if (Status found = bus.wait_for_subscribers(Topic::raw_samples, 1, milliseconds(10'000)); !found) return found;
  Message message = block_of_1000_doubles();
  auto& block = std::get<RawSamples>(message);
  for (const auto end = Clock::now() + duration; Clock::now() < end; ++block.block_number)
    if (Status sent = publish_patiently(bus, message); !sent) return sent;
  return {};
}

Status subscribe(DdsBus& bus, Clock::duration duration) {
  constexpr std::array kTopics = {Topic::raw_samples};
  if (Status made = bus.subscribe(kTopics); !made) return made;
  std::uint64_t count = 0;
  Clock::time_point first;
  Clock::time_point last;
  for (auto end = Clock::now() + milliseconds(10'000); Clock::now() < end;) {
    const auto items = bus.receive(milliseconds(200));
    if (items.empty() && count > 0) break;
    for (const BusItem& item : items) {
      last = Clock::now();
      if (count == 0) first = last, end = last + duration;
      if (std::get<RawSamples>(std::get<Message>(item)).block_number != count) return fail("a block was lost");
      ++count;
    }
  }
  std::cout << static_cast<double>(count) / std::chrono::duration<double>(last - first).count() << '\n';
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto duration = std::chrono::milliseconds(static_cast<long>(1000.0 * std::atof(argv[2])));
  Configuration configuration;
  configuration.domain = 97;  // as in sample_throughput.sh
  const auto bus = open_dds_bus(configuration);
  const Status done = !bus                                ? fail(bus.error())
                      : argv[1] == std::string("publish") ? publish(**bus, duration)
                                                          : subscribe(**bus, duration);
  if (!done) std::cerr << done.error().describe() << '\n';
  return done ? 0 : 1;
}
