// A service's sign of life: its status about once a second and right after progress, from a thread and a bus of its
// own, so that it goes on while a layer computes.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "sealwatch/core/time.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch {

class Heartbeat {
 public:
  struct Options {
    std::chrono::milliseconds interval{1000};
    std::chrono::milliseconds shortest{50};  ///< between two beats, however much progress there is
    /// Called at every beat with the time since the last update or touch: whether the main thread is still alive. Not
    /// after a beat that was not let out.
    std::function<void(std::chrono::milliseconds since_main_thread)> on_beat = {};
    /// Looks at what is about to be said, in the heartbeat's thread, and may wait for the disk. False: nothing is said,
    /// and whoever watches the service finds it dead.
    std::function<bool(ServiceStatus&)> before_beat = {};
  };

  /// Beats from now on. `bus` is used by the heartbeat's thread alone.
  Heartbeat(Bus& bus, const Clock& clock, ServiceStatus status, Options options);
  /// Says "stopping" and ends.
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  /// Changes the status (`change` is called once, now); it is published soon if that changed anything.
  void update(const std::function<void(ServiceStatus&)>& change);
  /// Beats again as after progress.
  void beat_soon();
  /// The main thread is alive.
  void touch();

 private:
  void beat();
  void publish(std::unique_lock<std::mutex>& lock);

  Bus& bus_;
  const Clock& clock_;
  const Options options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  ServiceStatus status_;
  bool let_out_ = true;  ///< the last beat; of the heartbeat's thread alone
  bool dirty_ = true;
  bool stopping_ = false;
  std::chrono::steady_clock::time_point main_thread_seen_ = std::chrono::steady_clock::now();
  std::thread thread_;
};

}  // namespace sealwatch
