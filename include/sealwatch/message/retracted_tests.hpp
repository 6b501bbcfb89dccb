// Which tests of one asset count, after what operators retracted and withdrew: the one place that knows it, for layers
// that remember tests and for who judges the dates of new ones.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "sealwatch/message/retraction.hpp"

namespace sealwatch {

class RetractedTests {
 public:
  /// A test that is known from now on: "all since a date" means the tests that are known when it is said.
  void know(const std::string& pst_id, std::optional<UtcTime> time) { tests_[pst_id] = time; }

  void forget(const std::string& pst_id) { tests_.erase(pst_id); }

  /// From now on the tests that it means do not count, or count again; or a replacement was none.
  void apply(const Retraction& retraction) {
    meant_.erase(retraction.withdrawn_id);
    if (!retraction.withdrawn_id.empty()) {
      withdrawn_.insert(retraction.withdrawn_id);
      return;
    }
    std::set<std::string>& meant = meant_[retraction.id];
    if (!retraction.since) {
      meant = {retraction.pst_id};
      return;
    }
    for (const auto& [pst_id, time] : tests_)
      if (time && *time >= *retraction.since) meant.insert(pst_id);
  }

  /// Whether no retraction in force means it.
  [[nodiscard]] bool counts(const std::string& pst_id) const {
    return std::ranges::none_of(meant_, [&](const auto& one) { return one.second.contains(pst_id); });
  }

  /// Whether nobody took the replacement of this message id back.
  [[nodiscard]] bool holds(const std::string& replacement_id) const { return !withdrawn_.contains(replacement_id); }

  /// The date of the newest test that counts.
  [[nodiscard]] std::optional<UtcTime> newest() const {
    std::optional<UtcTime> newest;
    for (const auto& [pst_id, time] : tests_)
      if (time && (!newest || *time > *newest) && counts(pst_id)) newest = time;
    return newest;
  }

 private:
  std::map<std::string, std::optional<UtcTime>> tests_;
  std::map<std::string, std::set<std::string>> meant_;  ///< by the id of the retraction in force
  std::set<std::string> withdrawn_;                     ///< ids of what was taken back
};

}  // namespace sealwatch
