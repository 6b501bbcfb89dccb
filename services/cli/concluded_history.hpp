// The history of a seal as prognosis judged it, out of its own conclusions: what the services forecast from, test by
// test, with the reasons for which a test was left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/cli/forecast_question.hpp"
#include "services/cli/state_journals.hpp"
#include "services/prognostic_assessment/asset_history.hpp"

namespace sealwatch::cli {

class ConcludedHistory {
 public:
  /// Takes estimates, advice, and the replacements and retractions that remaining_life tells, be it of a test or of a
  /// maintenance_event that no test has followed yet; passes over all else.
  void take(const Message& message);
  [[nodiscard]] bool empty() const { return estimates_.empty(); }
  /// Those that were taken.
  [[nodiscard]] const std::vector<LeakageEstimate>& estimates() const { return estimates_; }

  /// What prognosis asked its forecasters with the latest test: the tests since the last replacement that were not
  /// retracted, the campaigns and costs of the asset's site. Without tests where it was replaced and not tested since.
  /// Nothing where the asset has no seal condition, or neither a test that counts, with a date, nor a replacement.
  [[nodiscard]] std::optional<ForecastQuestion> question(const AssetConfig& asset,
                                                         const Configuration& configuration) const;

 private:
  /// What a remaining_life tells besides its forecasts.
  struct Told {
    std::string pst_id;  ///< "" of no test
    std::vector<Retraction> retractions;
    std::optional<prognostic_assessment::Replacement> replacement;
  };
  /// All that counts, or counted: each test and each act in its place among the others.
  [[nodiscard]] prognostic_assessment::AssetHistory history() const;

  std::vector<LeakageEstimate> estimates_;
  std::vector<Told> told_;
  std::optional<Advisory> advice_;  ///< the latest by its event, not superseded
};

/// The history of one asset in prognosis's journal; a fault is complained of.
[[nodiscard]] std::optional<ConcludedHistory> history_in(StateJournals& journals, const std::string& asset_id);

}  // namespace sealwatch::cli
