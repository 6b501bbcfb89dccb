// Which tests of one asset count, after what operators retracted and withdrew: the one place that knows it, for layers
// that remember tests and for who judges the dates of new ones. Tests that the virtual bench made up count until the
// first recorded one of the asset is known, and never again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/made_up.hpp"
#include "sealwatch/message/retraction.hpp"

namespace sealwatch {

class RetractedTests {
 public:
  /// A test that is known from now on: "all since a date" means the tests that are known when it is said.
  void know(const std::string& pst_id, std::optional<UtcTime> time) {
    (void)meet(pst_id);
    tests_[pst_id] = time;
  }

  /// A test that is about to be known. Whether others that counted do not any more: they were made up, and it was not.
  [[nodiscard]] bool meet(const std::string& pst_id) {
    if (has_recorded_ || pst_id.empty() || is_made_up_test(pst_id)) return false;
    has_recorded_ = true;
    return std::ranges::any_of(tests_, [](const auto& test) { return is_made_up_test(test.first); });
  }

  [[nodiscard]] bool knows(const std::string& pst_id) const { return tests_.contains(pst_id); }

  void forget(const std::string& pst_id) { tests_.erase(pst_id); }

  /// From now on the tests that it means do not count, or count again; or a replacement was none. What was withdrawn
  /// holds no more, in whichever order the two are told.
  void apply(const Retraction& retraction) {
    release(retraction.withdrawn_id);
    if (!retraction.withdrawn_id.empty()) {
      withdrawn_.insert(retraction.withdrawn_id);
      return;
    }
    if (withdrawn_.contains(retraction.id)) return;
    mean(retraction.id, meant_by(retraction));
  }

  /// The tests that a retraction of many means, by the record of it, which may be told before or after the act. Whether
  /// others count now.
  bool name(const std::string& retraction_id, const std::vector<std::string>& tests) {
    const auto& named = named_[retraction_id] = {tests.begin(), tests.end()};
    const auto meant = meant_.find(retraction_id);
    if (meant == meant_.end() || meant->second == named) return false;
    mean(retraction_id, named);
    return true;
  }

  /// By the record of it, else by what is known.
  [[nodiscard]] std::set<std::string> meant_by(const Retraction& retraction) const {
    if (!retraction.since) return {retraction.pst_id};
    if (retraction.tests) return {retraction.tests->begin(), retraction.tests->end()};
    if (const auto named = named_.find(retraction.id); named != named_.end()) return named->second;
    std::set<std::string> meant;
    for (const auto& [pst_id, time] : tests_)
      if (time && *time >= *retraction.since) meant.insert(pst_id);
    return meant;
  }

  /// Whether it means nothing that is known: no test that counts, no retraction in force, no replacement of
  /// `replacements`.
  [[nodiscard]] bool changes_nothing(const Retraction& retraction, const std::set<std::string>& replacements) const {
    const std::string& withdrawn = retraction.withdrawn_id;
    if (is_replacement_id(withdrawn)) return !replacements.contains(withdrawn) || !holds(withdrawn);
    if (!withdrawn.empty()) return !meant_.contains(withdrawn);
    if (!retraction.since) return !tests_.contains(retraction.pst_id) || !counts(retraction.pst_id);
    return std::ranges::none_of(meant_by(retraction), [this](const std::string& pst_id) { return counts(pst_id); });
  }

  /// Whether no retraction in force means it, and it was recorded where any was.
  [[nodiscard]] bool counts(const std::string& pst_id) const {
    return !retractions_of_.contains(pst_id) && !(has_recorded_ && is_made_up_test(pst_id));
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
  void mean(const std::string& retraction_id, std::set<std::string> tests) {
    release(retraction_id);
    for (const std::string& pst_id : tests) ++retractions_of_[pst_id];
    meant_[retraction_id] = std::move(tests);
  }

  void release(const std::string& retraction_id) {
    const auto found = meant_.find(retraction_id);
    if (found == meant_.end()) return;
    for (const std::string& pst_id : found->second)
      if (const auto by = retractions_of_.find(pst_id); --by->second == 0) retractions_of_.erase(by);
    meant_.erase(found);
  }

  std::map<std::string, std::optional<UtcTime>> tests_;
  bool has_recorded_ = false;                           ///< of them, one that nobody made up
  std::map<std::string, std::set<std::string>> named_;  ///< by the id of a retraction of many, as recorded
  std::map<std::string, std::set<std::string>> meant_;  ///< by the id of the retraction in force
  std::map<std::string, std::size_t> retractions_of_;   ///< how many of them mean it, by test
  std::set<std::string> withdrawn_;                     ///< ids of what was taken back
};

}  // namespace sealwatch
