// From residuals that persist to the mismatch analysis: which tests are kept for it, and when it is due.
//
// A test deviates when a residual of the model in force (the accepted one, else the nominal one) or against the
// asset's own first tests stands in the warning region or above. The last six deviating tests in a row are kept: a
// judged test that does not deviate ends the row, one that is not fit to be judged does neither. The analysis is due
// with the third test of a row, again with the sixth, then with every six more. It fits the earlier two thirds of the
// tests and keeps the last third aside. docs/health.md has the reasons.
//
// Everything here comes back from inputs that were not consumed (the kept tests) and from model_discrepancy (what was
// analysed), so that an analysis that was cut off is made again, the same. What is no longer needed is consumed behind
// the analyses that are still running.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "sealwatch/port/explainer.hpp"
#include "sealwatch/port/halves.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch {

inline constexpr std::size_t kTestsOfFirstAnalysis = 3;
inline constexpr std::size_t kTestsOfAnalysis = 6;

/// Residuals of this test that stand in the warning region or above, in words; empty: it does not deviate. Of the
/// nominal model only where no accepted one is judged.
[[nodiscard]] std::vector<std::string> persistent_residuals(const StateReport& report);

/// Of one asset.
class DiscrepancyWatch {
 public:
  void restore(const HealthReport& own_output, bool first_after_replacement);
  void restore(const ModelDiscrepancy& own_output);
  /// Whether the health of this test has been concluded, and if so whether it was admissible.
  [[nodiscard]] std::optional<bool> concluded(const std::string& pst_id) const;

  /// Takes a window in; it may come before or after its test's report.
  void take(const TestWindow& window, const AssetConfig& asset, const Explainer& explainer, Conclusion& conclusion);
  /// Takes the report of a test whose health is concluded, and says when it is no longer needed. A report may come a
  /// second time, after a restart.
  void take(const StateReport& report, bool admissible, bool first_after_replacement, const AssetConfig& asset,
            const Explainer& explainer, Conclusion& conclusion);
  /// Takes tests out that no longer count, an analysis of them included: the next one is of others.
  void forget(const std::function<bool(const std::string& pst_id)>& is_retracted, Conclusion& conclusion);
  /// Inputs that wait for nothing: kept for the next analysis, or until the next report shows that they are not needed.
  [[nodiscard]] std::size_t held() const;

 private:
  using Window = std::shared_ptr<const TestWindow>;
  /// Between two replacements.
  struct Era {
    std::set<std::string> analysed;  ///< pst_ids of the latest analysis
    std::int32_t version = 0;        ///< of the latest analysis
  };
  struct Concluded {
    bool admissible = false;
    std::size_t era = 0;
  };
  struct StoredTest {
    StateReport report;
    Window window;
  };

  void note_concluded(const std::string& pst_id, bool admissible, bool first_after_replacement);
  void end_row(Conclusion& conclusion);
  void settle(const StateReport& report, Conclusion& conclusion);
  /// Concluded, and its report was let go of: perhaps before this process was started, which then does not know whether
  /// the report is still to come back.
  [[nodiscard]] bool seems_settled(const std::string& pst_id) const;
  void forget_windows_of_settled_tests();
  void keep_complete_test(const std::string& pst_id, const AssetConfig& asset, const Explainer& explainer,
                          Conclusion& conclusion);
  [[nodiscard]] Era& era_of_row() { return eras_[concluded_.at(row_.back().report.header.pst_id).era]; }
  [[nodiscard]] bool due();
  [[nodiscard]] std::function<Conclusion(const std::stop_token&)> analysis(const AssetConfig& asset,
                                                                           const Explainer& explainer);
  void release(Conclusion& conclusion);

  std::map<std::string, Concluded> concluded_;  ///< by pst_id
  std::vector<Era> eras_{1};
  std::deque<std::string> settled_;    ///< pst_ids whose windows are not needed, should they still come: the last few
  Halves<TestWindow> windows_;         ///< whose tests are not kept yet
  std::deque<StateReport> deviating_;  ///< whose windows are not there yet: the last few
  std::deque<StoredTest> row_;         ///< at most kTestsOfAnalysis
  std::vector<std::string> no_longer_needed_;
  bool analysis_begun_ = false;  ///< in this process: it may still be running
};

}  // namespace sealwatch
