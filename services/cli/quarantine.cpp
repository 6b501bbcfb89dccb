// `sealwatch quarantine`: what services have set aside, and having it tried again. It looks into their journals, as the
// one who asks must be one who may write there.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/core/text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/store/quarantine_desk.hpp"

namespace sealwatch::cli {
namespace {

struct Desk {
  std::string service;
  QuarantineDesk desk;
  std::vector<QuarantineDesk::Entry> entries;
};

/// None where a journal cannot be looked into, or there is none.
std::optional<std::vector<Desk>> open_desks(const QuarantineOptions& options) {
  const auto connections = journals_at_hand(options.state_directory, options.config);
  if (!connections) return std::nullopt;
  std::vector<Desk> desks;
  for (const auto& [service, connection] : *connections) {
    auto desk = QuarantineDesk::open(connection, service);
    auto entries = desk.and_then([](QuarantineDesk& opened) { return opened.list(); });
    if (!entries) {
      complain(entries.error());
      return std::nullopt;
    }
    desks.push_back({service, std::move(*desk), std::move(*entries)});
  }
  return desks;
}

nlohmann::ordered_json as_json(const std::string& service, const QuarantineDesk::Entry& entry) {
  const SetAside& message = entry.message;
  return {{"service", service},
          {"message_id", message.message_id},
          {"asset_id", message.asset_id},
          {"pst_id", message.pst_id},
          {"since", format_utc({message.since_ns})},
          {"reason", message.reason},
          {"state", entry.state},
          {"asked_by", entry.asked_by},
          {"asked", entry.asked_ns == 0 ? "" : format_utc({entry.asked_ns})}};
}

void print(const std::string& service, const QuarantineDesk::Entry& entry) {
  const SetAside& message = entry.message;
  std::printf("%s  %s  since %s  %s\n  %s\n", service.c_str(), message.asset_id.c_str(),
              to_the_second({message.since_ns}).c_str(), message.message_id.c_str(),
              wrapped("set aside: " + message.reason, 100, 2).c_str());
  if (entry.state == "retry")
    std::printf("  %s asked for another try, which has not begun yet\n", entry.asked_by.c_str());
  if (entry.state == "released")
    std::printf("  tried again for %s at %s\n", entry.asked_by.c_str(), to_the_second({entry.asked_ns}).c_str());
}

}  // namespace

int run_quarantine_list(const QuarantineOptions& options) {
  const auto desks = open_desks(options);
  if (!desks) return kBadInput;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::size_t set_aside = 0;
  for (const Desk& desk : *desks)
    for (const QuarantineDesk::Entry& entry : desk.entries) {
      set_aside += entry.state == "released" ? 0 : 1;
      if (entry.state == "released" && !options.all) continue;
      options.json ? list.push_back(as_json(desk.service, entry)) : print(desk.service, entry);
    }
  if (options.json)
    std::printf("%s\n",
                nlohmann::ordered_json{{"schema", "sealwatch.quarantine/1"}, {"messages", list}}.dump(1).c_str());
  else if (set_aside == 0)
    std::printf("nothing is set aside\n");
  return set_aside == 0 ? kOk : kAnswerIsNo;
}

int run_quarantine_retry(const QuarantineOptions& options) {
  auto desks = open_desks(options);
  if (!desks) return kBadInput;
  const UtcTime now{
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count()};
  std::vector<std::string> known;
  std::size_t asked = 0;
  for (Desk& desk : *desks)
    for (const QuarantineDesk::Entry& entry : desk.entries) {
      if (entry.state == "released") continue;
      known.push_back(entry.message.message_id);
      if (entry.message.message_id != options.message_id && entry.message.pst_id != options.message_id) continue;
      const auto done = desk.desk.ask_again(entry.message.message_id, options.by, now);
      if (!done) {
        complain(done.error());
        return kInternalFailure;
      }
      if (!*done) continue;  // it was tried again meanwhile
      ++asked;
      std::printf("%s tries %s again; what becomes of it: sealwatch quarantine list\n", desk.service.c_str(),
                  entry.message.message_id.c_str());
    }
  if (asked > 0) return kOk;
  complain(Error{.file = {},
                 .place = {},
                 .value = options.message_id,
                 .rule = "is not set aside",
                 .advice = known.empty() ? "nothing is" : suggest(options.message_id, known)});
  return kBadInput;
}

}  // namespace sealwatch::cli
