// What state detection remembers of one asset. All of it comes back from the asset's own earlier reports: restore() of
// the layer plays them through the same two functions as the live run.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/message/state_detection.hpp"
#include "services/state_detection/baseline.hpp"
#include "services/state_detection/region.hpp"
#include "services/state_detection/schedule.hpp"

namespace sealwatch {

/// Two years of monthly tests.
inline constexpr std::size_t kTestsForChannels = 24;

class AssetHistory {
 public:
  AssetHistory(const RegionOptions& region, const BaselineOptions& baseline);

  /// The actuator is a new one: baseline, regions and expected channels start anew.
  void restart();
  /// The tests from here on are judged with the model of this model_discrepancy besides ("": with none): its baseline
  /// and regions start anew where it is another than before.
  void use_accepted(const std::string& discrepancy_id);
  /// Takes one test's judgements into their quantities' filters and fills in their regions. A poor recording is looked
  /// at but moves no filter: warm oil leaks more, and that is no wear. A channel without a judgement is expected no
  /// more.
  void judge(std::vector<RegionJudgement>& judgements);
  /// Takes a finished report whose judgements went through judge() already.
  void learn(const StateReport& report);

  [[nodiscard]] const Baseline& baseline() const { return baseline_; }
  [[nodiscard]] const Baseline& accepted_baseline() const { return accepted_baseline_; }
  /// Channels that a test is expected to have: OK in more than half of the judged tests since the last replacement, of
  /// the last kTestsForChannels where there are more. Not one that a test or two had besides; and one that is recorded
  /// no more is expected for a year of monthly tests, then no longer.
  [[nodiscard]] std::set<std::string> expected_channels() const;
  /// Worst region of all quantities, those included that the last test could not give.
  [[nodiscard]] AlertRegion worst_region() const;

  Schedule schedule;
  bool last_was_replay = false;
  bool has_live_tests = false;  ///< neither played back nor made up
  std::string last_overdue_id;  ///< message id of the last report on an overdue test
  std::string last_judged_id;   ///< message id of the last report with a verdict of passed or failed

 private:
  void learn_channels(const std::vector<RegionJudgement>& judgements);

  RegionOptions region_options_;
  BaselineOptions baseline_options_;
  Baseline baseline_;
  Baseline accepted_baseline_;
  std::string accepted_;
  std::map<std::string, RegionFilter> filters_;  // by quantity and reference
  std::deque<std::set<std::string>> channels_;   // OK in the last judged tests, oldest first
};

/// Whether a quantity speaks of the recording and not of the actuator.
[[nodiscard]] bool concerns_recording(std::string_view quantity);

[[nodiscard]] inline bool is_judged(PstVerdict verdict) {
  return verdict == PstVerdict::passed || verdict == PstVerdict::failed;
}

}  // namespace sealwatch
