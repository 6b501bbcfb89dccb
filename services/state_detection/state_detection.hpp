// State detection (ISO 13374 SD): alert regions, verdict on the partial stroke test, overdue tests, stale channels.
// docs/health.md has all rules with their defaults and reasons.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/port/accepted_model.hpp"
#include "sealwatch/port/estimator.hpp"
#include "sealwatch/port/halves.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/state_detection/baseline.hpp"
#include "services/state_detection/history.hpp"
#include "services/state_detection/past_tests.hpp"
#include "services/state_detection/region.hpp"

namespace sealwatch {

struct StateDetectionOptions {
  RegionOptions region = {};
  BaselineOptions baseline = {};
  double overdue_grace_share = 0.5;  ///< of the test interval, see schedule.hpp
  /// By asset, where it is known: one that was never heard is overdue from there.
  std::map<std::string, UtcTime> commissioned = {};
  [[nodiscard]] Status validate() const;
};

/// Concludes each asset's tests in the order of their test_features, each as soon as its test_window is there too. A
/// maintenance_event starts the asset's history anew with the first test after it; it counts as consumed when a test
/// after it has been judged. An asset of which nothing was ever heard is asked for its first test, where it is known when
/// it was commissioned; one of which only recordings were played back, for the next after the last of them. After a
/// retraction the asset's tests are judged anew from those that count (past_tests.hpp), and a report of no test says so.
/// While a model_acceptance is in force the accepted model is judged beside the nominal one.
class StateDetection final : public Layer {
 public:
  /// `simulator` may be null: then there are no residuals. `options` must be valid.
  StateDetection(std::span<const AssetConfig> assets, std::shared_ptr<const Simulator> simulator,
                 const StateDetectionOptions& options = {});

  [[nodiscard]] std::string_view name() const override { return "state_detection"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  [[nodiscard]] Conclusion receive(const Message& input) override;
  [[nodiscard]] Conclusion receive_until(const Message& input, const std::stop_token& stop) override;
  [[nodiscard]] Conclusion tick(UtcTime now) override;
  [[nodiscard]] std::size_t held() const override;
  [[nodiscard]] std::vector<Refusal> waiting() const override;

 private:
  struct AssetState {
    AssetHistory history;
    Halves<TestFeatures> tests;  // not concluded yet
    Halves<TestWindow> windows;
    std::vector<MaintenanceEvent> events;  // not consumed yet
    AcceptedModel accepted;
    PastTests past;
    bool has_input = false;                   ///< since the last tick
    std::optional<UtcTime> quiet_since = {};  ///< the tick from which on nothing was received
  };

  [[nodiscard]] AssetState& state_of(const std::string& asset_id);
  void conclude_if_ready(AssetState& state, const std::string& pst_id, const std::stop_token& stop,
                         Conclusion& conclusion);
  void conclude(AssetState& state, const TestFeatures& features, const TestWindow& window, const std::stop_token& stop,
                Conclusion& conclusion);
  [[nodiscard]] Conclusion retracted(const MaintenanceEvent& event, AssetState& state);
  /// Makes the history what the tests that count make of it, and returns the last of these.
  std::optional<StateReport> judge_anew(const std::string& asset_id, AssetState& state) const;
  void judge(AssetState& state, const AssetConfig& asset, const TestFeatures& features, const TestWindow& window,
             const std::stop_token& stop, StateReport& report) const;
  /// Marks a test that is judged so far but takes too long to simulate. Not compared with its model it has not passed;
  /// a stroke that failed has failed.
  static void refuse(const std::string& too_long, StateReport& report);
  /// Value of what wears with which the simulation comes nearest to the recording, where it was asked.
  std::optional<double> add_residuals(const AssetState& state, const AssetConfig& asset, const TestFeatures& features,
                                      const TestWindow& window, const std::stop_token& stop, StateReport& report) const;
  void note_lateness(const AssetState& state, const AssetConfig& asset, StateReport& report) const;
  /// Whether tests are due though none was live: its sender may never have worked, whatever history was played back.
  [[nodiscard]] bool waits_for_first_live_test(const std::string& asset_id, const AssetState& state) const;
  /// Whether a history is being played back, whose next test comes soon.
  [[nodiscard]] static bool is_under_way(AssetState& state, UtcTime now);
  [[nodiscard]] std::optional<StateReport> overdue_report(const std::string& asset_id, const AssetState& state,
                                                          UtcTime now) const;

  std::map<std::string, AssetConfig> assets_;
  std::shared_ptr<const Simulator> simulator_;
  StateDetectionOptions options_;
  std::map<std::string, AssetState> states_;
};

}  // namespace sealwatch
