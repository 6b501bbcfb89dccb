// The bus of a command: what strangers send is made fit for a terminal, a log and a command to paste before anything
// is done with it (core/visible_text.hpp).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "sealwatch/port/bus.hpp"

namespace sealwatch::cli {

class VisibleBus final : public Bus {
 public:
  explicit VisibleBus(std::unique_ptr<Bus> bus) : bus_(std::move(bus)) {}
  [[nodiscard]] Status subscribe(std::span<const Topic> topics) override { return bus_->subscribe(topics); }
  [[nodiscard]] Status subscribe_service_topics() override { return bus_->subscribe_service_topics(); }
  [[nodiscard]] Status publish(const Message& message) override { return bus_->publish(message); }
  [[nodiscard]] Status publish(const ServiceStatus& status) override { return bus_->publish(status); }
  [[nodiscard]] Status publish(const ResendRequest& request) override { return bus_->publish(request); }
  [[nodiscard]] std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most) override;
  void wake() override { bus_->wake(); }

 private:
  std::unique_ptr<Bus> bus_;
};

}  // namespace sealwatch::cli
