// Acts on alarms that were fetched back from a neighbour (layer_runner_records.cpp): each counts for what it was said of,
// once the desk knows that, whatever order they come in.
//
//   acknowledged             of the alarm that stands, where that began before it; of none that came later. Since when a
//                            service is silent nobody may know any more: hence the desk keeps also that an alarm was over
//   shelved, unshelved       the last said of each alarm; a shelf waits for its alarm, which may come again, to its end
//   out of and in service    the last said of each asset
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sealwatch/message/topics.hpp"
#include "services/common/runtime/alarm_desk.hpp"

namespace sealwatch {

class RecalledAlarmActs {
 public:
  /// Strangers cause alarms, and people act on few of them.
  static constexpr std::size_t kMostWaiting = 4096;

  struct Decided {
    Message act;
    std::optional<std::string> why_not;  ///< nothing where the desk has done it
  };

  /// Of an act that the desk was told, by its id: what was said before it of the same counts no more.
  void note_said(std::string_view kind, const std::string& asset_id, const std::string& act_id);
  /// Of what the desk itself kept: that an alarm was over.
  void note_over(const std::string& asset_id, const std::string& act_id);
  [[nodiscard]] bool is_full() const { return waiting_.size() >= kMostWaiting; }
  void add(Message act);
  /// Has the desk do what it can now.
  void decide(AlarmDesk& desk, UtcTime time);
  [[nodiscard]] bool has_decided() const { return !decided_.empty(); }
  [[nodiscard]] std::vector<Decided> take_decided() { return std::exchange(decided_, {}); }

 private:
  using Subject = std::pair<std::string, std::string>;  ///< asset and alarm id; no alarm id: the asset's service

  /// Whether it waits no longer; why it counts for nothing, if so, in `why_not`.
  [[nodiscard]] bool is_decided(const Message& act, AlarmDesk& desk, UtcTime time,
                                std::optional<std::string>& why_not) const;
  [[nodiscard]] bool is_decided(const Acknowledgement& seen, AlarmDesk& desk, UtcTime time,
                                std::optional<std::string>& why_not) const;
  [[nodiscard]] bool is_decided(const MaintenanceEvent& event, AlarmDesk& desk, UtcTime time,
                                std::optional<std::string>& why_not) const;

  std::map<Subject, UtcTime> last_said_;
  std::map<Subject, UtcTime> last_over_;  ///< when an alarm that was acknowledged was over
  std::vector<Message> waiting_;          ///< in the order of what they say of their time
  std::vector<Decided> decided_;
};

}  // namespace sealwatch
