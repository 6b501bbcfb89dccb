// Which of the services that should run are heard: one that is dead, hung or starts again and again is told, not left
// out.
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/service.hpp"
#include "sealwatch/message/topics.hpp"

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

  /// `conclusions` are the topics of which the last word on each asset is listened for.
  explicit ServicesHeard(std::vector<std::string> expected, std::vector<Topic> conclusions = {})
      : expected_(std::move(expected)), conclusions_(std::move(conclusions)) {}
  void take(const ServiceStatus& status, Clock::time_point now);
  void take(const Message& message);
  /// The expected services in their order, then others that were heard.
  [[nodiscard]] std::vector<Service> list(Clock::time_point now) const;
  /// Whether every expected service is well.
  [[nodiscard]] bool all_well(Clock::time_point now) const;
  [[nodiscard]] bool none() const { return heard_.empty(); }
  /// Whether some services are heard and an expected one is not: just started, or found last.
  [[nodiscard]] bool incomplete() const;
  /// Whether a service that is heard has concluded something of which nothing has come: its last word is on its way.
  [[nodiscard]] bool awaits_conclusions() const;

 private:
  struct Heard {
    ServiceStatus last;
    Clock::time_point at;
    std::set<std::int32_t> processes;
    std::string last_words;  ///< why a process ended: the last error of one that stopped
  };
  [[nodiscard]] Service service(const std::string& name, Clock::time_point now) const;

  std::vector<std::string> expected_;
  std::vector<Topic> conclusions_;
  std::set<std::pair<std::string, std::string>> come_;  ///< writers and topics of which something has come
  std::map<std::string, Heard> heard_;
};

/// One line of `sealwatch status`.
[[nodiscard]] std::string one_line(const ServicesHeard::Service& service);

}  // namespace sealwatch::cli
