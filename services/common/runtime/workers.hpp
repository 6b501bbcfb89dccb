// Threads that do a service's computing, so that its main thread only receives, stores and publishes. They are made as
// work comes, so that a piece of work that takes long holds up no other. Long work has a few threads of its own, as each
// piece of it may take much memory, and these give way to all others where processors are few.
//
// Each piece of work has a deadline: so much time of its thread's processor, or so much more by the clock, as it may use
// other threads or wait, for one that is busy too. Then it is asked to stop; if it does not, within the grace, it is stuck: a thread
// cannot be ended from outside, so that only the end of the process helps.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace sealwatch {

/// 120000 ms -> "120 s", 500 ms -> "0.5 s".
[[nodiscard]] std::string in_seconds(std::chrono::milliseconds time);

class Workers {
 public:
  struct Limits {
    std::size_t threads = 16;
    std::size_t long_work = 2;
    std::chrono::milliseconds deadline{120'000};  ///< of processor time
    std::chrono::milliseconds by_clock{600'000};
    std::chrono::milliseconds grace{10'000};
  };
  struct Work {
    std::string name;
    bool is_long = false;
    std::function<void(const std::stop_token&)> run;  ///< raises nothing
    std::stop_source stop = {};
  };

  explicit Workers(const Limits& limits) : limits_(limits) {}
  /// Asks all to stop, forgets what has not begun, and waits for the rest.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  void add(Work work);
  /// Asks what is beyond its deadline to stop. The name of one that is stuck, once.
  [[nodiscard]] std::optional<std::string> look_after();
  /// Asks all to stop and waits so long; false when some go on.
  [[nodiscard]] bool stop(std::chrono::milliseconds patience);
  [[nodiscard]] const Limits& limits() const { return limits_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// The threads that do short work, or those that do long work.
  struct Crew {
    std::size_t most = 0;
    std::size_t made = 0;
    std::size_t idle = 0;
    std::deque<Work> waiting = {};
    std::condition_variable changed = {};
  };
  struct Worker {
    std::thread thread;
    std::optional<Work> work;  ///< what it is doing
    Clock::time_point begun;
    double processor_s_at_begin = 0.0;
    std::optional<Clock::time_point> asked_to_stop;
    bool told_of = false;  ///< that it is stuck
  };
  void run(Worker& worker, Crew& crew);
  void ask_all_to_stop();
  [[nodiscard]] bool is_overdue(const Worker& worker, Clock::time_point now) const;

  const Limits limits_;
  std::mutex mutex_;
  Crew short_{.most = limits_.threads};
  Crew long_{.most = limits_.long_work};
  std::condition_variable ended_;  ///< while stopping: a piece of work has
  std::list<Worker> workers_;
  bool stopping_ = false;
};

}  // namespace sealwatch
