// What becomes of a unit whose processes end in the middle of a call. A search tries hundreds of values, each in a process
// of its own if the last one was lost: a unit that hangs would be waited for as often, one that always crashes started
// as often.
#pragma once

#include <chrono>
#include <optional>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/core/result.hpp"
#include "services/common/fmi/host_process.hpp"

namespace sealwatch::fmi {

/// Of one unit, shared by the threads that run it.
class LostProcesses {
 public:
  using Clock = std::chrono::steady_clock;
  /// How often it may crash with no run between: values far from all measurements bring single crashes.
  static constexpr int kMostCrashes = 6;
  /// After which it is tried again: a service runs for months, and what a unit waited for may be back.
  static constexpr std::chrono::minutes kForgotten{10};

  /// Why no process is to be started; nothing: one may be.
  [[nodiscard]] std::optional<Error> given_up(Clock::time_point now = Clock::now());
  /// After a run or a part of it in `process`.
  void note(const HostProcess& process, Clock::time_point now = Clock::now());

 private:
  FreeInCopies mutex_;
  int crashes_ = 0;
  std::optional<Error> given_up_;
  Clock::time_point since_;
};

}  // namespace sealwatch::fmi
