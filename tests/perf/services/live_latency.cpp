// The two ends of the latency measurement (latency.py): actuators that send blocks of 10 samples at 200 Hz in real
// time, and a reader of what arrives.
//
//   live_latency send spread|together|endings ACTUATORS SECONDS
//   live_latency receive SECONDS    prints "topic asset message_id recording/block sampled_ns arrived_ns" for each
//   block
//
// spread: one test of each actuator, their samples taken evenly between each other's. together: all actuators take
// their samples at the same instants: the worst burst. endings: each test (31 s) begins a fiftieth of its length after
// the last actuator's and is followed by the next, so that some test ends every 0.6 s. sampled_ns: when the block's
// last sample was taken, sent in publishing_time_ns. Clock: the system's, nanoseconds.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/port/patient_publish.hpp"
#include "services/common/runtime/system_clock.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/virtual_bench/simulate_test.hpp"

namespace {

using namespace sealwatch;
using std::chrono::milliseconds;

constexpr std::size_t kSamples = 10;
constexpr std::int64_t kBlock_ns = 50'000'000;
constexpr std::int32_t kDomain = 97;  // of its own: what others multicast in domain 0 would be received here too
constexpr std::size_t kReaders = 2;   // data acquisition and `receive`

/// A whole test of the virtual bench at 200 Hz, cut into blocks.
std::vector<RawSamples> blocks_of_one_test() {
  AssetConfig asset;
  for (const ParameterDescription& p : (*find_plant("eha"))->parameters)
    asset.parameters[p.name] = {.value = p.value, .min = p.min, .max = p.max, .estimate = p.estimate};
  const TimeSeries recorded = bench::simulate_test(asset, bench::pst_profile({}), {}, {}).value().samples;
  std::vector<RawSamples> blocks(recorded.time_s.size() / kSamples);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const auto cut = [from = static_cast<std::ptrdiff_t>(k * kSamples)](const std::vector<double>& all) {
      return std::vector<double>(all.begin() + from, all.begin() + from + kSamples);
    };
    RawSamples& block = blocks[k];
    block.source_id = "latency";
    block.block_number = k;
    block.boundary = k == 0                   ? BlockBoundary::begin
                     : k + 1 == blocks.size() ? BlockBoundary::end
                                              : BlockBoundary::inside;
    block.samples.time_s = cut(recorded.time_s);
    for (const Series& channel : recorded.channels)
      block.samples.channels.push_back({channel.name, channel.unit, channel.noise_std, cut(channel.values)});
  }
  return blocks;
}

struct Actuator {
  std::string asset_id;
  std::int64_t next_ns = 0;  ///< when the next block's last sample is taken
  std::size_t block = 0;
  int test = 0;
};

void wait_until(const Clock& clock, std::int64_t time_ns) {
  const std::int64_t left_ns = time_ns - clock.now().nanoseconds;
  if (left_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(left_ns));
}

/// How much later than the actuator before it an actuator takes its samples.
std::int64_t lag_ns(const std::string& mode, std::size_t blocks_of_a_test, std::size_t actuators) {
  if (mode == "together") return 0;
  const std::int64_t spread_ns = kBlock_ns / static_cast<std::int64_t>(actuators);
  if (mode == "spread") return spread_ns;
  const std::int64_t test_ns = static_cast<std::int64_t>(blocks_of_a_test) * kBlock_ns;
  return test_ns / static_cast<std::int64_t>(actuators) / kBlock_ns * kBlock_ns + spread_ns;
}

Status send(DdsBus& bus, const std::string& mode, std::size_t actuators, double seconds) {
  const SystemClock clock;
  const std::vector<RawSamples> blocks = blocks_of_one_test();
  if (Status ready = bus.wait_for_subscribers(Topic::raw_samples, kReaders, milliseconds(15'000)); !ready) return ready;
  const std::int64_t begin_ns = clock.now().nanoseconds + 200'000'000;
  std::vector<Actuator> all;
  for (std::size_t k = 0; k < actuators; ++k)
    all.push_back(
        {.asset_id = "LIVE-" + std::to_string(k + 1),
         .next_ns = begin_ns + kBlock_ns + static_cast<std::int64_t>(k) * lag_ns(mode, blocks.size(), actuators)});
  const std::int64_t end_ns = begin_ns + static_cast<std::int64_t>(seconds * 1e9);
  while (true) {
    Actuator& next = *std::ranges::min_element(all, {}, &Actuator::next_ns);
    if (next.next_ns > end_ns) return {};
    RawSamples block = blocks[next.block];
    block.asset_id = next.asset_id;
    block.recording_id = "live-" + std::to_string(next.test);
    block.header.publishing_time_ns = next.next_ns;
    wait_until(clock, next.next_ns);
    if (Status sent = publish_patiently(bus, Message(std::move(block))); !sent) return sent;
    next.next_ns += kBlock_ns;
    if (++next.block == blocks.size()) next.block = 0, ++next.test;
  }
}

void print(const Message& message, std::int64_t arrived_ns) {
  const auto line = [&](const char* topic, const auto& block, std::int64_t sampled_ns) {
    std::printf("%s %s %s %s/%llu %lld %lld\n", topic, block.asset_id.c_str(),
                block.header.message_id.empty() ? "-" : block.header.message_id.c_str(), block.recording_id.c_str(),
                static_cast<unsigned long long>(block.block_number), static_cast<long long>(sampled_ns),
                static_cast<long long>(arrived_ns));
  };
  if (const auto* raw = std::get_if<RawSamples>(&message)) line("raw", *raw, raw->header.publishing_time_ns);
  if (const auto* block = std::get_if<SampleBlock>(&message)) line("block", *block, 0);
}

Status receive(DdsBus& bus, double seconds) {
  const SystemClock clock;
  constexpr std::array kTopics = {Topic::raw_samples, Topic::sample_block};
  if (Status made = bus.subscribe(kTopics); !made) return made;
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
       std::chrono::steady_clock::now() < end;)
    for (BusItem& item : bus.receive(milliseconds(200)))
      if (auto* message = std::get_if<Message>(&item)) print(*message, clock.now().nanoseconds);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool sends = words.size() == 4 && words[0] == "send";
  if (!sends && !(words.size() == 2 && words[0] == "receive")) return 2;
  Configuration configuration;
  configuration.domain = kDomain;
  const auto bus = open_dds_bus(configuration);
  const Status done = !bus    ? fail(bus.error())
                      : sends ? send(**bus, words[1], std::stoul(words[2]), std::atof(words[3].c_str()))
                              : receive(**bus, std::atof(words[1].c_str()));
  if (!done) std::cerr << done.error().describe() << '\n';
  return done ? 0 : 1;
}
