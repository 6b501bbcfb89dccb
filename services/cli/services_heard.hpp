// Which of the services that should run are heard: one that is dead, hung or starts again and again is told, not left
// out.
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/message/service.hpp"

namespace sealwatch::cli {

class ServicesHeard {
 public:
  using Clock = std::chrono::steady_clock;
  /// A service beats once a second: one that is silent for this long has gone or hangs.
  static constexpr std::chrono::milliseconds kSilence{2500};

  struct Service {
    std::string name;
    bool expected = false;  ///< the configuration enables it
    bool heard = false;     ///< `last` holds its last heartbeat
    ServiceStatus last;
    std::string trouble;  ///< "no heartbeat", ...; "" when all is well
  };

  explicit ServicesHeard(std::vector<std::string> expected) : expected_(std::move(expected)) {}
  void take(const ServiceStatus& status, Clock::time_point now);
  /// The expected services in their order, then others that were heard.
  [[nodiscard]] std::vector<Service> list(Clock::time_point now) const;
  /// Whether every expected service is well.
  [[nodiscard]] bool all_well(Clock::time_point now) const;
  [[nodiscard]] bool none() const { return heard_.empty(); }
  /// Whether some services are heard and an expected one is not: just started, or found last.
  [[nodiscard]] bool incomplete() const;

 private:
  struct Heard {
    ServiceStatus last;
    Clock::time_point at;
    std::set<std::int32_t> processes;
    std::string last_words;  ///< why a process ended: the last error of one that stopped
  };
  [[nodiscard]] Service service(const std::string& name, Clock::time_point now) const;

  std::vector<std::string> expected_;
  std::map<std::string, Heard> heard_;
};

/// One line of `sealwatch status`.
[[nodiscard]] std::string one_line(const ServicesHeard::Service& service);

}  // namespace sealwatch::cli
