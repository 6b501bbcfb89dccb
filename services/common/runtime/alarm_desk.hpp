// Keeps the states of all alarms of all services, and of the advisories that ask for something, after ISA-18.2 and
// IEC 62682 (message/alarm_state.hpp). One service has it, advisory generation; services only say what stands.
//
//   heartbeats, advisories --> entries --> service_status.desk
//   acts of people         --^
//
// An alarm that was told is over when its service has no longer told it for a while, so that a restart or a moment's
// chatter ends nothing. Over and never acknowledged, it stays. Which alarm suppresses which stands in one table
// (alarm_desk.cpp). A new alarm has a name of its own: what people said of another never holds for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/alarm_state.hpp"
#include "sealwatch/port/standing_alarms.hpp"

namespace sealwatch {

class AlarmDesk {
 public:
  using Steady = std::chrono::nanoseconds;  ///< since some fixed moment, by a clock that nobody sets
  struct Options {
    std::string service;                          ///< whose desk it is
    std::vector<std::string> services;            ///< whose heartbeats are expected
    std::chrono::milliseconds silence{10'000};    ///< of a service: it is an alarm
    std::chrono::milliseconds off_delay{10'000};  ///< not told for so long: it is over
  };
  static constexpr std::size_t kMostTold = 64;      ///< entries in a heartbeat
  static constexpr std::size_t kMostOfAKind = 256;  ///< active ones, and returned ones, that strangers may cause

  /// `kept` is what an earlier desk left.
  AlarmDesk(Options options, std::vector<AlarmEntry> kept, Steady now, UtcTime time);

  void hear(const ServiceStatus& status, Steady now, UtcTime time);
  /// What the newest advisory of an asset asks for.
  void stand(const StandingAdvice& said, UtcTime time);
  /// Lets time pass: services that are silent, shelves that end.
  void look(Steady now, UtcTime time);

  /// Whether the acknowledgement is of an alarm here; one of an advisory in force is advisory generation's affair.
  [[nodiscard]] bool takes(const Acknowledgement& seen) const;
  void acknowledge(const Acknowledgement& seen, UtcTime time);
  /// The alarm that was acknowledged is over: what stands under its name is another.
  void take_back(const Acknowledgement& over);
  /// Does what the event says, or says why not.
  [[nodiscard]] std::optional<std::string> apply(const MaintenanceEvent& event, UtcTime time);

  /// As people name it; nullptr where there is none.
  [[nodiscard]] const AlarmEntry* entry_of(const std::string& asset_id, const std::string& id) const;
  /// Whether each service that is expected has told all of its alarms since this desk began.
  [[nodiscard]] bool has_heard_all() const;

  void tell(ServiceStatus& status, UtcTime time) const;

  struct Changes {
    std::vector<AlarmEntry> kept;
    std::vector<ServiceAlarm> forgotten;
  };
  [[nodiscard]] bool changed() const { return !touched_.empty(); }
  /// Since the last call.
  [[nodiscard]] Changes take_changes();
  /// Since the last call, of the alarms that somebody had acknowledged: that they are over.
  [[nodiscard]] std::vector<Acknowledgement> take_over() { return std::exchange(over_, {}); }

 private:
  using Key = std::tuple<std::string, std::string, std::string>;  ///< kind, asset, subject
  struct Entry {
    AlarmEntry kept;
    std::map<std::string, Steady> told_by;  ///< by service, when last
  };
  using Entries = std::map<Key, Entry>;

  [[nodiscard]] Entry& raise(const std::string& service, const ServiceAlarm& alarm, Steady now);
  void end(const Key& key, UtcTime time);
  void note_over(const AlarmEntry& kept, UtcTime time);
  void end_untold(const ServiceStatus& status, Steady now, UtcTime time);
  void end_shelves(UtcTime time);
  void forget(const Key& key);
  void drop_oldest_returned(const std::string& kind);
  [[nodiscard]] std::size_t active_of(const std::string& kind) const;
  [[nodiscard]] Entries::iterator find(const std::string& asset_id, const std::string& id);
  [[nodiscard]] std::optional<std::string> shelve(const MaintenanceEvent& event, const AlarmAct& act, UtcTime time);
  [[nodiscard]] AlarmEntry as_told(const AlarmEntry& kept, UtcTime time) const;
  [[nodiscard]] std::string cause_of(const ServiceAlarm& alarm, UtcTime time) const;
  [[nodiscard]] std::string out_of_service_by(const std::string& asset_id) const;

  const Options options_;
  Entries entries_;
  std::set<Key> touched_;
  std::vector<Acknowledgement> over_;
  std::map<std::string, Steady> heard_;  ///< the last heartbeat of each expected service
  std::set<std::string> heard_ever_;     ///< of them, those that were heard since the start
  std::set<std::string> told_all_;       ///< of them, those that have told all alarms since the start
};

}  // namespace sealwatch
