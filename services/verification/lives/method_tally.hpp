// Collects one method's answers life by life, for summary.hpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/verification/lives/summary.hpp"

namespace sealwatch::verification {

[[nodiscard]] Share share_of(int count, int of);
[[nodiscard]] Mean mean_of(std::span<const forecast::Cluster> lives);
[[nodiscard]] Quantiles quantiles_of(std::vector<double> values);

/// Index of the test nearest to `months` before failure, at most half a month off; none where there is no such test.
[[nodiscard]] std::optional<std::size_t> test_before_failure(const LifeRecord& record, double months);

class MethodTally {
 public:
  explicit MethodTally(std::string label) : label_(std::move(label)) {}
  /// Only for lives that failed. `oracle`: the column of the oracle's answers.
  void add(const LifeRecord& record, std::size_t method, std::size_t oracle);
  [[nodiscard]] MethodSummary finish() const;

 private:
  using Clusters = std::vector<forecast::Cluster>;
  struct AtHorizon {
    int lives = 0;
    std::array<int, 3> covered{};
    std::vector<double> error;
    Clusters absolute_error, crps, width_95, score_80, score_95;
  };

  void add_verdict(std::span<const forecast::ScoredMonth> months);
  void add_published_metrics(std::span<const forecast::ScoredMonth> months);
  void add_errors(const LifeRecord& record, std::span<const forecast::ScoredMonth> months,
                  std::span<const forecast::ScoredMonth> oracle);
  void add_horizons(const LifeRecord& record, std::size_t method);
  void add_alpha_lambda(std::span<const forecast::ScoredMonth> months, std::span<const RecordedAnswer> answers);
  void add_curve(std::span<const forecast::ScoredMonth> months);
  [[nodiscard]] HorizonSummary finish(const AtHorizon& horizon, double months) const;

  std::string label_;
  int lives_ = 0;
  int converged_ = 0, reliable_ = 0, timely_ = 0, horizon_stable_ = 0;
  int alpha_lambda_ = 0, alpha_lambda_by_mass_ = 0;
  Clusters antecedence_, error_, error_since_converged_, final_error_, last_year_error_, last_year_width_, all_errors_;
  Clusters false_positive_, false_negative_, before_p10_, oracle_ratio_;
  Clusters alpha_lambda_mass_, horizon_first_, horizon_last_, relative_accuracy_, convergence_, asymmetric_;
  std::vector<double> final_errors_, antecedences_;
  std::array<AtHorizon, kHorizons_months.size()> horizons_;
  std::vector<double> pit_;
  std::vector<int> reliable_by_month_ = std::vector<int>(kCurveMonths + 1, 0);
  std::vector<int> seen_by_month_ = std::vector<int>(kCurveMonths + 1, 0);
  std::vector<WorstLife> worst_;
};

}  // namespace sealwatch::verification
