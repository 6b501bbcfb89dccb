#include "services/cli/services_heard.hpp"

#include <algorithm>

#include "services/cli/summary.hpp"

namespace sealwatch::cli {

void ServicesHeard::take(const ServiceStatus& status, Clock::time_point now) {
  Heard& heard = heard_[status.service];
  heard.last = status;
  if (status.state == "stopping" && !status.last_error.empty()) heard.last_words = status.last_error;
  heard.at = now;
  heard.processes.insert(status.process_id);
}

void ServicesHeard::take(const Message& message) {
  if (std::ranges::find(conclusions_, topic_of(message)) == conclusions_.end()) return;
  come_.emplace(header_of(message).writer_id, name_of(topic_of(message)));
}

bool ServicesHeard::awaits_conclusions() const {
  const auto is_to_come = [this](const StreamPosition& written) {
    const auto topic = value_of<Topic>(written.topic);
    return topic && std::ranges::find(conclusions_, *topic) != conclusions_.end() && written.sequence > 0 &&
           !come_.contains({written.writer_id, written.topic});
  };
  return std::ranges::any_of(heard_, [&](const auto& one) {
    const ServiceStatus& last = one.second.last;
    return std::ranges::find(expected_, one.first) != expected_.end() && std::ranges::any_of(last.written, is_to_come);
  });
}

ServicesHeard::Service ServicesHeard::service(const std::string& name, Clock::time_point now) const {
  Service service;
  service.name = name;
  service.expected = std::ranges::find(expected_, name) != expected_.end();
  const auto found = heard_.find(name);
  service.heard = found != heard_.end();
  if (!service.heard) {
    service.trouble = "no heartbeat";
    return service;
  }
  const Heard& heard = found->second;
  service.last = heard.last;
  const auto silent = std::chrono::duration_cast<std::chrono::seconds>(now - heard.at).count();
  if (now - heard.at > kSilence)
    service.trouble = "no heartbeat for " + std::to_string(silent) + " s";
  else if (heard.processes.size() > 1)
    service.trouble = "heard from " + std::to_string(heard.processes.size()) +
                      " processes: it starts again and again, or runs twice" +
                      (heard.last_words.empty() || heard.last_words == heard.last.last_error
                           ? ""
                           : "; the last to end said: " + heard.last_words);
  else if (heard.last.state != "running")
    service.trouble = heard.last.state;
  return service;
}

std::vector<ServicesHeard::Service> ServicesHeard::list(Clock::time_point now) const {
  std::vector<Service> services;
  for (const std::string& name : expected_) services.push_back(service(name, now));
  for (const auto& [name, heard] : heard_)
    if (std::ranges::find(expected_, name) == expected_.end()) services.push_back(service(name, now));
  return services;
}

bool ServicesHeard::all_well(Clock::time_point now) const {
  return std::ranges::all_of(expected_, [&](const std::string& name) { return service(name, now).trouble.empty(); });
}

bool ServicesHeard::incomplete() const {
  return !none() && std::ranges::any_of(expected_, [&](const std::string& name) { return !heard_.contains(name); });
}

std::string one_line(const ServicesHeard::Service& service) {
  if (!service.heard) return service.name + "  " + service.trouble;
  const std::string line = one_line(service.last);
  const bool said = service.trouble.empty() || service.trouble == service.last.state;
  return said ? line : line + "  " + service.trouble;
}

}  // namespace sealwatch::cli
