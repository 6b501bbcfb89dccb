// What prognosis remembers of one asset, all of it rebuilt from its own outputs: estimates of each test and
// replacements.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/forecast/condition_history.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"
#include "sealwatch/message/retracted_tests.hpp"

namespace sealwatch::prognostic_assessment {

/// How the reason begins by which a test is left out only until the next one confirms it (condition_history.hpp).
inline constexpr const char* kUnconfirmed = "stands alone: ";

/// One test of the history.
struct HistoryEntry {
  std::string estimate_id;  ///< message id of its leakage_estimate
  forecast::ConditionSample sample;
  bool eligible = false;  ///< its estimate may take part in forecasts (an isolated outlier may too, once confirmed)
  std::string pst_id = {};
};

/// A replacement of the seal or the actuator, as somebody reported it.
struct Replacement {
  std::string id;  ///< message id of the report
  UtcTime time;
};

/// Says in `life` that only tests since this replacement count: by its time, and by its id among the sources.
void tell_of(const Replacement& replacement, RemainingLife& life);
/// The replacement that `life` tells of, where one is known.
[[nodiscard]] Replacement replacement_of(const RemainingLife& life);

class AssetHistory {
 public:
  /// Before a test is concluded: whether earlier ones do not count any more (message/retracted_tests.hpp).
  [[nodiscard]] bool meet(const std::string& pst_id) { return retracted_.meet(pst_id); }
  [[nodiscard]] bool counts(const std::string& pst_id) const { return retracted_.counts(pst_id); }
  /// Takes an own output. Tests without event time are only remembered as concluded.
  void add(const LeakageEstimate& estimate);
  void add_replacement(const Replacement& replacement);
  /// From now on the tests that it means do not count, or count again, or the replacement that it means was none.
  void apply(const Retraction& retraction);
  /// The tests that a retraction of many means, by the record of it.
  void name_tests(const std::string& retraction_id, const std::vector<std::string>& tests) {
    (void)retracted_.name(retraction_id, tests);
  }
  /// Whether nobody took the replacement of this message id back.
  [[nodiscard]] bool holds(const std::string& replacement_id) const { return retracted_.holds(replacement_id); }

  [[nodiscard]] bool has_estimate(const std::string& estimate_id) const;
  /// The latest replacement of all; nullptr where there was none.
  [[nodiscard]] const Replacement* last_replacement() const;
  /// The last one not after `now`.
  [[nodiscard]] const Replacement* replaced_before(UtcTime now) const;
  /// Tests after the last replacement up to and including `now`, in the order of time.
  [[nodiscard]] std::vector<HistoryEntry> until(UtcTime now) const;
  /// The latest test that counts, a replacement or not; nullptr when none does.
  [[nodiscard]] const HistoryEntry* last_counted() const;
  /// Whether a later test than `time` is known, and counts.
  [[nodiscard]] bool has_later_than(UtcTime time) const;

 private:
  std::vector<std::string> concluded_;
  std::vector<HistoryEntry> entries_;      ///< in the order of time; equal times by id
  std::vector<Replacement> replacements_;  ///< that hold, in the order of time; equal times by id
  RetractedTests retracted_;
};

}  // namespace sealwatch::prognostic_assessment
