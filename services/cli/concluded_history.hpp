// The history of a seal as prognosis judged it, out of its own conclusions: what the services forecast from, test by
// test, with the reasons for which a test was left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/cli/forecast_question.hpp"
#include "services/cli/state_journals.hpp"

namespace sealwatch::cli {

class ConcludedHistory {
 public:
  /// Takes estimates, advice, and the replacements that remaining_life tells, be it of a test or of a maintenance_event
  /// that no test has followed yet; passes over all else.
  void take(const Message& message);
  [[nodiscard]] bool empty() const { return estimates_.empty(); }
  /// Those that were taken.
  [[nodiscard]] const std::vector<LeakageEstimate>& estimates() const { return estimates_; }

  /// What prognosis asked its forecasters with the latest test: the tests since the last replacement, the campaigns and
  /// costs of the asset's site. Without tests where it was replaced and not tested since. Nothing where the asset has
  /// no seal condition, or neither a test with a date nor a replacement.
  [[nodiscard]] std::optional<ForecastQuestion> question(const AssetConfig& asset,
                                                         const Configuration& configuration) const;

 private:
  std::vector<LeakageEstimate> estimates_;
  std::vector<UtcTime> replacements_;
  std::optional<Advisory> advice_;  ///< the latest by its event, not superseded
};

/// The history of one asset in prognosis's journal; a fault is complained of.
[[nodiscard]] std::optional<ConcludedHistory> history_in(StateJournals& journals, const std::string& asset_id);

}  // namespace sealwatch::cli
