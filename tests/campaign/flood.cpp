// A stranger that floods the services' topics, for the campaign (campaign.py, trial flood):
//
//   flood raw|known|statuses|resends SECONDS DOMAIN
//
// raw: tests of ever new actuators, as fast as DDS takes them. known: the same of one configured actuator. statuses: each from a writer that nobody heard before, as
// fast as DDS takes them, 100 000 at least. resends: of the streams that heartbeats name, all ranges. lines: messages of
// any topic from standard input, {"topic": ..., "message": {...}} as `watch --json` prints them. Prints how many it sent.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "services/common/message/json.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace {

using namespace sealwatch;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kRows = 10;

RawSamples block_of(std::uint64_t number, bool is_known) {
  RawSamples block;
  block.asset_id = is_known ? "FLOOD-KNOWN" : "FLOOD-" + std::to_string(number / 100 % 1000);
  block.recording_id = "flood-" + std::to_string(number / 100);
  block.source_id = "flood";
  block.block_number = number % 100;
  block.boundary = number % 100 == 0 ? BlockBoundary::begin : BlockBoundary::inside;
  for (std::size_t k = 0; k < kRows; ++k)
    block.samples.time_s.push_back(0.005 * static_cast<double>(number % 100 * kRows + k));
  block.samples.channels.push_back({"position", "m", 0.0, std::vector<double>(kRows, 0.01)});
  return block;
}

ServiceStatus status_of(std::uint64_t number) {
  ServiceStatus status;
  status.service = "data_acquisition";
  status.writer_id = "data_acquisition-flood-" + std::to_string(number);
  status.state = "running";
  status.started_ns = static_cast<std::int64_t>(number);
  status.written = {{"sample_block", status.writer_id, 1'000'000 + number}};
  return status;
}

/// Of the streams that somebody has spoken of, all of each.
std::vector<ResendRequest> requests_for(Bus& bus) {
  std::vector<ResendRequest> requests;
  for (const auto end = Clock::now() + std::chrono::seconds(3); Clock::now() < end;)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(100)))
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        for (const StreamPosition& position : status->written)
          requests.push_back({position.writer_id, position.topic, 1, ~std::uint64_t{0}, "flood"});
  return requests;
}

std::uint64_t flood(Bus& bus, const std::string& what, std::chrono::seconds duration) {
  const std::vector<ResendRequest> requests = what == "resends" ? requests_for(bus) : std::vector<ResendRequest>();
  std::uint64_t sent = 0;
  const auto end = Clock::now() + duration;
  for (std::uint64_t number = 0; Clock::now() < end || (what == "statuses" && number < 100'000); ++number) {
    Status done = {};
    if (what == "raw" || what == "known") done = bus.publish(Message(block_of(number, what == "known")));
    if (what == "statuses") done = bus.publish(status_of(number));
    if (what == "resends" && !requests.empty()) done = bus.publish(requests[number % requests.size()]);
    sent += done ? 1 : 0;
  }
  return sent;
}

/// What the codec does not take is passed over: it cannot be sent.
std::uint64_t send_lines(Bus& bus, std::chrono::seconds wait) {
  std::uint64_t sent = 0;
  std::this_thread::sleep_for(wait);  // until the readers are known
  for (std::string line; std::getline(std::cin, line);) {
    const auto whole = nlohmann::json::parse(line, nullptr, false);
    const auto topic = value_of<Topic>(whole.value("topic", ""));
    const auto message =
        topic ? message_from_json(*topic, whole["message"].dump()) : Result<Message>(fail("is not a topic"));
    if (!message) std::fprintf(stderr, "%s\n", message.error().describe().c_str());
    sent += message && bus.publish(*message) ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));
  return sent;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() != 3) return 2;
  Configuration configuration;
  configuration.domain = std::atoi(words[2].c_str());
  const auto bus = open_dds_bus(configuration);
  if (!bus || !(*bus)->subscribe_service_topics()) return 1;
  const auto duration = std::chrono::seconds(std::atoi(words[1].c_str()));
  const std::uint64_t sent = words[0] == "lines" ? send_lines(**bus, duration) : flood(**bus, words[0], duration);
  std::printf("%llu\n", static_cast<unsigned long long>(sent));
  return sent > 0 ? 0 : 1;
}
