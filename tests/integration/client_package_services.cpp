// Stands for the services: publishes one advisory, then prints the raw samples that come, until it is killed.
#include <array>
#include <iostream>

#include "services/common/transport/dds_bus.hpp"

namespace {

sealwatch::Message advisory() {
  sealwatch::Advisory advisory;
  advisory.asset_id = "XT03-MV2";
  advisory.advisory_id = "advisory-1";
  advisory.priority = sealwatch::AdvisoryPriority::high;
  advisory.recommendation = "Book a vessel for the replacement of XT03-MV2.";
  advisory.latest_by_known = true;
  advisory.latest_by_ns = 1'934'496'000'000'000'000;  // 2031-04-21
  advisory.reasons = {"the seal reaches its threshold in 14 months"};
  return advisory;
}

void print(const sealwatch::RawSamples& block) {
  const sealwatch::TimeSeries& samples = block.samples;
  std::cout << block.asset_id << ' ' << block.recording_id << ' ' << block.block_number << ' '
            << name_of(block.boundary) << ": " << samples.channels.front().name << '[' << samples.channels.front().unit
            << "] " << samples.channels.front().values.size() << " of " << samples.time_s.size() << ", from "
            << samples.time_s.front() << " s to " << samples.time_s.back() << " s\n"
            << std::flush;
}

}  // namespace

int main() {
  constexpr std::array kRawSamples = {sealwatch::Topic::raw_samples};
  const auto bus = sealwatch::make_dds_bus({});
  const sealwatch::Status ready =
      !bus ? sealwatch::fail(bus.error())
           : (*bus)->publish(advisory()).and_then([&] { return (*bus)->subscribe(kRawSamples); });
  if (!ready) {
    std::cerr << ready.error().describe() << '\n';
    return 1;
  }
  while (true)
    for (const sealwatch::BusItem& item : (*bus)->receive(std::chrono::seconds(1)))
      print(std::get<sealwatch::RawSamples>(std::get<sealwatch::Message>(item)));
}
