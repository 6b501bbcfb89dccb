#include "services/virtual_bench/bench_service.hpp"

#include <algorithm>
#include <array>
#include <variant>

#include "sealwatch/message/retraction.hpp"
#include "sealwatch/port/patient_publish.hpp"

namespace sealwatch::bench {

BenchService::BenchService(Bus& bus, const Clock& clock, const std::vector<AssetConfig>& assets,
                           const ActuatorSetting& setting)
    : bus_(bus), clock_(clock) {
  for (const AssetConfig& asset : assets)
    if (asset.model == "eha") actuators_.emplace_back(asset, setting);
}

Status BenchService::start() {
  constexpr std::array kInputs = {Topic::pst_request, Topic::maintenance_event};
  return bus_.subscribe(kInputs);
}

Status BenchService::step(std::chrono::milliseconds timeout) {
  for (const BusItem& item : bus_.receive(timeout))
    if (const auto* message = std::get_if<Message>(&item)) take(*message);
  for (SimulatedActuator& actuator : actuators_) {
    Result<std::vector<RawSamples>> blocks = actuator.advance(clock_.now());
    if (!blocks) return fail(blocks.error());
    for (RawSamples& block : *blocks) {
      block.header.publishing_time_ns = clock_.now().nanoseconds;
      stamp_clock(block.header, read_clock());
      if (Status status = publish_patiently(bus_, Message(std::move(block))); !status) return status;
    }
  }
  return {};
}

void BenchService::take(const Message& message) {
  const auto actuator = std::find_if(
      actuators_.begin(), actuators_.end(),
      [&message](const SimulatedActuator& candidate) { return candidate.asset().asset_id == asset_of(message); });
  if (actuator == actuators_.end()) return;
  if (const auto* request = std::get_if<PstRequest>(&message)) actuator->request(*request, clock_.now());
  if (const auto* event = std::get_if<MaintenanceEvent>(&message); event && is_replacement(*event))
    actuator->maintain(*event);
}

}  // namespace sealwatch::bench
