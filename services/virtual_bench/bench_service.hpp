// The virtual bench as a process: simulated actuators that send their tests on the bus and listen for requests.
#pragma once

#include <chrono>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/port/bus.hpp"
#include "services/virtual_bench/simulated_actuator.hpp"

namespace sealwatch::bench {

/// Time that passes `acceleration` times as fast as `real`, from `start` on.
class AcceleratedClock final : public Clock {
 public:
  AcceleratedClock(const Clock& real, UtcTime start, double acceleration)
      : real_(real), real_start_(real.now()), start_(start), acceleration_(acceleration) {}
  [[nodiscard]] UtcTime now() const override {
    return add_seconds(start_, acceleration_ * seconds_between(real_start_, real_.now()));
  }

 private:
  const Clock& real_;
  UtcTime real_start_;
  UtcTime start_;
  double acceleration_;
};

class BenchService {
 public:
  /// Assets whose model is not `eha` are left to others. `clock` is the bench's time, accelerated or not.
  BenchService(Bus& bus, const Clock& clock, const std::vector<AssetConfig>& assets, const ActuatorSetting& setting);

  /// Subscribes. Call once, before the first step.
  [[nodiscard]] Status start();
  /// Waits at most `timeout` for messages, takes them, and publishes what the actuators recorded until now.
  [[nodiscard]] Status step(std::chrono::milliseconds timeout);

  [[nodiscard]] std::vector<SimulatedActuator>& actuators() { return actuators_; }

 private:
  void take(const Message& message);

  Bus& bus_;
  const Clock& clock_;
  std::vector<SimulatedActuator> actuators_;
};

}  // namespace sealwatch::bench
