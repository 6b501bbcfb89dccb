// Layer 5 of ISO 13374: the estimate of the leakage resistance from each test, the remaining useful life, and the
// request for the next test.
//
// Driven by health_report, joined with the test_window of the same pst_id, in whatever order they come. A
// maintenance_event is answered at once by a remaining_life that says so, by which the layer finds the replacement
// again after a restart, and, where no test since is known, by a new pst_request. So is one that retracts tests
// (message/retraction.hpp), with the remaining life that the others tell. Tests that are concluded while a
// model_acceptance is in force are estimated with the accepted model.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/forecast/forecaster.hpp"
#include "sealwatch/port/accepted_model.hpp"
#include "sealwatch/port/estimator.hpp"
#include "sealwatch/port/halves.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/prognostic_assessment/asset_history.hpp"

namespace sealwatch::prognostic_assessment {

inline constexpr const char* kProducer = "prognostic_assessment 0.1.0";

struct Options {
  std::vector<forecast::ForecasterSettings> forecasters = forecast::default_forecasters();  ///< the primary one first
  /// A test whose theta is less certain tells nothing: a tenth of theta is a quarter of the way from new to failed.
  double largest_condition_std = 0.10;

  [[nodiscard]] Status validate() const;
};

class PrognosticAssessment final : public Layer {
 public:
  /// Keeps a reference to `estimator`. An Error for options that make no sense.
  [[nodiscard]] static Result<std::unique_ptr<PrognosticAssessment>> make(const Configuration& configuration,
                                                                          const Estimator& estimator,
                                                                          const Options& options = {});

  [[nodiscard]] std::string_view name() const override { return "prognostic_assessment"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  [[nodiscard]] Conclusion receive(const Message& input) override;
  [[nodiscard]] Conclusion receive_until(const Message& input, const std::stop_token& stop) override;
  [[nodiscard]] std::size_t held() const override;
  [[nodiscard]] std::vector<Refusal> waiting() const override;
  [[nodiscard]] Conclusion tick(UtcTime now) override;

 private:
  /// Inputs of tests of which not both are there.
  struct Pending {
    Halves<HealthReport> health;
    Halves<TestWindow> windows;
  };

  PrognosticAssessment(const Configuration& configuration, const Estimator& estimator, const Options& options,
                       forecast::ForecastPanel panel, std::unique_ptr<const forecast::Forecaster> in_charge)
      : configuration_(configuration),
        estimator_(estimator),
        options_(options),
        panel_(std::move(panel)),
        in_charge_(std::move(in_charge)) {}

  template <class Input>
  [[nodiscard]] Conclusion join(const Input& input, Halves<Input> Pending::*halves, const std::stop_token& stop);
  void learn_replacements(const std::string& asset_id, const Header& header);
  [[nodiscard]] std::vector<Message> conclude(const HealthReport& health, const TestWindow& window,
                                              const std::stop_token& stop);
  void remember(const LeakageEstimate& estimate);
  void meet(const std::string& asset_id, const std::string& pst_id);
  [[nodiscard]] Conclusion replaced(const MaintenanceEvent& event);
  void learn_retractions(const std::string& asset_id, const Header& header);
  void apply(const std::string& asset_id, const Retraction& retraction);
  [[nodiscard]] Conclusion retracted(const MaintenanceEvent& event);
  [[nodiscard]] const AcceptedModel& accepted(const std::string& asset_id) const;
  [[nodiscard]] LeakageEstimate estimate(const HealthReport& health, const TestWindow& window,
                                         const std::stop_token& stop) const;
  /// Also marks `estimate` when it stands alone.
  [[nodiscard]] RemainingLife remaining_life(LeakageEstimate& estimate) const;
  [[nodiscard]] std::vector<forecast::FailureHorizon> campaigns(const AssetConfig& asset) const;
  void add_decision(const AssetConfig& asset, UtcTime now, const forecast::ForecastPanel::Answer& answer,
                    RemainingLife& life) const;
  [[nodiscard]] std::vector<Forecast> no_forecast(const std::string& explanation) const;

  Configuration configuration_;
  const Estimator& estimator_;
  Options options_;
  forecast::ForecastPanel panel_;
  std::unique_ptr<const forecast::Forecaster> in_charge_;
  std::map<std::string, Pending> pending_;         ///< by asset_id
  std::map<std::string, AssetHistory> history_;    ///< by asset_id
  std::map<std::string, LeakageEstimate> latest_;  ///< by asset_id: of the latest test
  std::map<std::string, AcceptedModel> accepted_;  ///< by asset_id
};

}  // namespace sealwatch::prognostic_assessment
