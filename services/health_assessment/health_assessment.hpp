// Health assessment (ISO 13374 HA): health grade with trend, ambiguity group of proposed faults, admissibility of the
// recording for prognosis. docs/health.md has all rules with their defaults and reasons.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/port/explainer.hpp"
#include "sealwatch/port/halves.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/health_assessment/discrepancy_watch.hpp"
#include "services/health_assessment/past_health.hpp"

namespace sealwatch {

struct HealthAssessmentOptions {
  int trend_tests = 24;  ///< how many tests the trend looks back on: two years of monthly tests
  [[nodiscard]] Status validate() const;
};

/// Concludes each asset's tests in the order of their state reports, each as soon as its features are there too.
/// Reports on overdue tests belong to no test and change nobody's health: they are consumed.
///
/// A test that was not judged says nothing about health: its report carries over the grade and the proposals of the
/// last one that did, and says so. A state report concluded from a maintenance_event starts the asset's history anew.
/// After a retraction, which comes as state detection's answer to it, the history is that of the tests that count, and a
/// report of no test says what they say.
/// With an explainer, tests whose residuals persist are kept and analysed (discrepancy_watch.hpp).
class HealthAssessment final : public Layer {
 public:
  /// `explainer` may be null: then nothing is analysed.
  explicit HealthAssessment(std::span<const AssetConfig> assets, const HealthAssessmentOptions& options = {},
                            std::shared_ptr<const Explainer> explainer = nullptr);

  [[nodiscard]] std::string_view name() const override { return "health_assessment"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  [[nodiscard]] Conclusion receive(const Message& input) override;
  [[nodiscard]] std::size_t held() const override;

 private:
  struct AssetState {
    Halves<StateReport> reports;  // not concluded yet, and answers to retractions
    Halves<TestFeatures> features;
    std::string complete;  ///< the test of which both are there, until it is concluded
    PastHealth past;
    DiscrepancyWatch discrepancies;
  };

  /// The report that is next to be concluded from, by its key; none where all wait.
  [[nodiscard]] static std::optional<std::string> next_report(const AssetState& state);
  void take_report(AssetState& state, const StateReport& report, Conclusion& conclusion) const;
  void settle(AssetState& state, const StateReport& report, bool admissible, Conclusion& conclusion) const;
  [[nodiscard]] HealthReport conclude(AssetState& state, const StateReport& report, const TestFeatures& features) const;
  [[nodiscard]] AssetState& state_of(const std::string& asset_id);
  /// The health that the tests which count say, after `answer`, with which state detection answered a retraction.
  /// Lets go of kept tests that do not count any more.
  static void forget_uncounted(AssetState& state, Conclusion& conclusion);
  static void meet(AssetState& state, const std::string& pst_id, Conclusion& conclusion);
  static void retract(AssetState& state, const StateReport& answer, Conclusion& conclusion);

  std::map<std::string, AssetConfig> assets_;
  HealthAssessmentOptions options_;
  std::shared_ptr<const Explainer> explainer_;
  std::map<std::string, AssetState> states_;
};

}  // namespace sealwatch
