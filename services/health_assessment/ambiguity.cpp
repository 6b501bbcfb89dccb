#include "services/health_assessment/ambiguity.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "services/health_assessment/evidence.hpp"
#include "services/health_assessment/iso14224.hpp"

namespace sealwatch {
namespace {

constexpr double kKappa = 3.0;
constexpr double kLogPriorLeakage = -4.5;
constexpr double kLogPriorLoad = -5.0;
constexpr double kLogPriorOther = -6.0;
constexpr double kUnexplainedFailure = -9.0;
constexpr double kLeastLikelihood = 0.02;
/// Two faults whose signatures are nearly one are not tried as a pair: their difference would only fit noise.
constexpr double kLargestCosine = 0.95;

using Key = std::pair<FaultKind, std::string>;  // kind and element

/// One fault, or two at once.
struct Hypothesis {
  std::size_t first = 0;
  std::optional<std::size_t> second;
  double score = 0.0;
  double share_of_first = 1.0;  ///< of the explained deviation
};

class Matcher {
 public:
  Matcher(const std::vector<Deviation>& deviations, const std::vector<Signature>& signatures,
          const std::map<std::string, SensorRemark>& remarks, bool failed)
      : signatures_(signatures), remarks_(remarks), failed_(failed) {
    for (const Deviation& deviation : deviations)
      if (deviation.informative) z_.push_back(deviation.value);
    for (const Signature& signature : signatures) scaled_.push_back(scale(signature, deviations));
  }

  [[nodiscard]] double score_of_no_fault() const { return unexplained(false); }

  [[nodiscard]] std::vector<Hypothesis> all() const {
    std::vector<Hypothesis> hypotheses;
    for (std::size_t h = 0; h < signatures_.size(); ++h) hypotheses.push_back(single(h));
    for (std::size_t h = 0; h < signatures_.size(); ++h)
      for (std::size_t k = h + 1; k < signatures_.size(); ++k)
        if (auto both = pair(h, k)) hypotheses.push_back(*both);
    return hypotheses;
  }

  /// The signature of that fault which explains most on its own.
  [[nodiscard]] const Signature& best_of(const Key& key) const {
    std::optional<Hypothesis> best;
    for (std::size_t h = 0; h < signatures_.size(); ++h) {
      if (key_of(h) != key) continue;
      if (const Hypothesis one = single(h); !best || one.score > best->score) best = one;
    }
    assert(best);
    return signatures_[best->first];
  }

 private:
  using Vector = std::vector<double>;

  [[nodiscard]] static Vector scale(const Signature& signature, const std::vector<Deviation>& deviations) {
    Vector scaled;
    for (const Deviation& deviation : deviations) {
      if (!deviation.informative) continue;
      const auto move = signature.moves.find(deviation.judgement.quantity);
      scaled.push_back(move == signature.moves.end() ? 0.0 : move->second / deviation.width);
    }
    const double length = std::sqrt(dot(scaled, scaled));
    if (length > 0.0)
      for (double& value : scaled) value /= length;
    return scaled;
  }
  [[nodiscard]] static double dot(const Vector& a, const Vector& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }
  [[nodiscard]] double unexplained(bool explains) const { return failed_ && !explains ? kUnexplainedFailure : 0.0; }
  [[nodiscard]] Key key_of(std::size_t h) const { return {signatures_[h].kind, signatures_[h].element}; }
  [[nodiscard]] double log_prior(std::size_t h) const {
    const FaultKind kind = signatures_[h].kind;
    // Sticking is what stops a piston; a seal that leaks as one at its threshold does still moves the valve.
    if (failed_ && kind == FaultKind::friction) return kLogPriorLeakage;
    if (!failed_ && kind == FaultKind::internal_leakage) return kLogPriorLeakage;
    return kind == FaultKind::load ? kLogPriorLoad : kLogPriorOther;
  }
  [[nodiscard]] double bonus(std::size_t h) const {
    const auto remark = remarks_.find(signatures_[h].element);
    return remark == remarks_.end() ? 0.0 : remark->second.bonus;
  }
  [[nodiscard]] bool allowed(std::size_t h, double amplitude) const {
    return signatures_[h].either_sign || amplitude > 0.0;
  }

  [[nodiscard]] Hypothesis single(std::size_t h) const {
    const double amplitude = dot(z_, scaled_[h]);
    const double gain = allowed(h, amplitude) ? 0.5 * kKappa * kKappa * amplitude * amplitude : 0.0;
    return {h, std::nullopt, gain + bonus(h) + log_prior(h) + unexplained(signatures_[h].can_fail_a_test), 1.0};
  }

  /// Least squares of z on two unit signatures; nothing where one of them has the wrong sign or they are nearly one.
  [[nodiscard]] std::optional<Hypothesis> pair(std::size_t h, std::size_t k) const {
    if (key_of(h) == key_of(k)) return std::nullopt;
    const double cosine = dot(scaled_[h], scaled_[k]);
    if (std::abs(cosine) > kLargestCosine) return std::nullopt;
    const double projection_h = dot(z_, scaled_[h]);
    const double projection_k = dot(z_, scaled_[k]);
    const double determinant = 1.0 - cosine * cosine;
    const double a = (projection_h - cosine * projection_k) / determinant;
    const double b = (projection_k - cosine * projection_h) / determinant;
    if (!allowed(h, a) || !allowed(k, b)) return std::nullopt;
    const double gain = 0.5 * kKappa * kKappa * (a * projection_h + b * projection_k);
    const double weight_h = kKappa * kKappa * a * a + bonus(h);
    const double weight_k = kKappa * kKappa * b * b + bonus(k);
    if (!(weight_h > 0.0) || !(weight_k > 0.0)) return std::nullopt;
    const bool explains = signatures_[h].can_fail_a_test || signatures_[k].can_fail_a_test;
    return Hypothesis{h, k, gain + bonus(h) + bonus(k) + log_prior(h) + log_prior(k) + unexplained(explains),
                      weight_h / (weight_h + weight_k)};
  }

  const std::vector<Signature>& signatures_;
  const std::map<std::string, SensorRemark>& remarks_;
  bool failed_;
  Vector z_;
  std::vector<Vector> scaled_;
};

/// Likelihood of each fault, and of none; `no_fault` comes in as its score.
std::map<Key, double> likelihoods_of(const std::vector<Signature>& signatures,
                                     const std::vector<Hypothesis>& hypotheses, double& no_fault) {
  double largest = no_fault;
  for (const Hypothesis& hypothesis : hypotheses) largest = std::max(largest, hypothesis.score);
  no_fault = std::exp(no_fault - largest);
  double sum = no_fault;
  std::map<Key, double> likelihood;
  const auto add = [&](std::size_t h, double weight) {
    likelihood[{signatures[h].kind, signatures[h].element}] += weight;
    sum += weight;
  };
  for (const Hypothesis& hypothesis : hypotheses) {
    const double weight = std::exp(hypothesis.score - largest);
    add(hypothesis.first, weight * hypothesis.share_of_first);
    if (hypothesis.second) add(*hypothesis.second, weight * (1.0 - hypothesis.share_of_first));
  }
  double kept = no_fault;
  std::erase_if(likelihood, [&](const auto& entry) { return entry.second < kLeastLikelihood * sum; });
  for (const auto& [key, weight] : likelihood) kept += weight;
  for (auto& [key, weight] : likelihood) weight /= kept;
  no_fault /= kept;
  return likelihood;
}

}  // namespace

AmbiguityGroup find_ambiguity_group(const std::vector<Deviation>& deviations, const std::vector<Signature>& signatures,
                                    const std::map<std::string, SensorRemark>& remarks, const std::string& failure) {
  AmbiguityGroup group;
  const Matcher matcher(deviations, signatures, remarks, !failure.empty());
  std::vector<Proposal> proposals;
  group.no_fault_likelihood = matcher.score_of_no_fault();
  for (const auto& [key, likelihood] : likelihoods_of(signatures, matcher.all(), group.no_fault_likelihood)) {
    const FailureCode code = failure_code(key.first);
    proposals.push_back({{key.first, key.second, likelihood, code.mode, code.mechanism, {}}, matcher.best_of(key)});
    if (!failure.empty()) proposals.back().fault.evidence.push_back("the test failed: " + failure);
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.fault.likelihood > b.fault.likelihood; });
  add_evidence(proposals, deviations, remarks);
  for (Proposal& proposal : proposals) group.faults.push_back(std::move(proposal.fault));
  return group;
}

}  // namespace sealwatch
