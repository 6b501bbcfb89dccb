#include "services/common/forecast/seal_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace sealwatch::forecast {
namespace {

// A seal that is not of the population: three in a hundred, its rate anything between standing still and three times
// usual.
constexpr double kStrangerShare = 0.03;
// A relative: its constants spread so many times as widely about the population's.
constexpr double kRelativeSpread = 3.0;
constexpr double kStrangerInitialStd = 0.05;
constexpr double kStrangerRateStd = 0.06;
constexpr double kStrangerSteepeningStd = 0.003;
// Ages at the first test where the installation is not known, with their prior probabilities: nearly always histories
// begin with the seal.
constexpr std::array<std::pair<double, double>, 4> kUnknownAges{
    {{1.0, 0.85}, {24.0, 0.05}, {72.0, 0.05}, {144.0, 0.05}}};

// Tests since the change, newest first: finer where a change is young. Older ones are found by their nearest.
constexpr std::array<std::size_t, 11> kTestsSinceChange{2, 3, 5, 8, 12, 18, 26, 38, 54, 76, 108};
constexpr std::size_t kFewestBeforeChange = 6;
constexpr std::size_t kTestsOfJump = 3;     // after a step that shows among them all
constexpr std::size_t kJumps = 3;           // steps that are looked into
constexpr double kShortest_months = 0.5;    // between two tests, as far as priors go
constexpr double kLevelPerMonth = 1e-3;     // prior probability of another level
constexpr double kReplacedPerMonth = 1e-4;  // without anybody saying so
// What changes a seal's medium mostly harms it. Both chosen, with the prior probability of a change, on calibration
// lives (docs/records/verification.md, "When things happen").
constexpr double kFasterAgeing = 1.75;
constexpr double kFasterAgeingSpread = 0.3;  // of the factor
constexpr double kLevelChange = 0.03;        // standard deviation of a step of theta
constexpr double kSmallestWeight = 3e-4;

// Standard errors are believed unless the mean squared innovation, 0.97 when they are right, says otherwise.
constexpr std::size_t kFewestToJudge = 12;
constexpr double kTooMuchSurprise = 1.5;
constexpr double kTooLittleSurprise = 0.5;

struct Noise {
  double extra_std = 0.0;
  double irregularity_scale = 1.0;
};

/// A run of the filter over all tests with the belief before each: where a change can branch off.
struct Run {
  SealHypothesis hypothesis;
  double first_age = 0.0;
  double log_prior = 0.0;
  std::vector<SealBelief> before = {};
  [[nodiscard]] double log_posterior() const { return log_prior + hypothesis.belief.log_evidence; }
};

/// What one noise setting makes of the tests.
struct Weighed {
  SealOpinion opinion;
  double log_evidence = 0.0;
  double surprise = 0.0;  ///< mean squared standardised innovation of the likeliest hypothesis
};

double total_std(const DatedTest& test, const Noise& noise) { return std::hypot(test.condition_std, noise.extra_std); }

class Bank {
 public:
  Bank(const std::vector<DatedTest>& tests, const HypothesisOptions& options, const Noise& noise)
      : tests_(tests), options_(options), noise_(noise) {
    law_ = {.n_0 = options.population.n_0,
            .steepening_scatter = options.population.steepening_scatter * noise.irregularity_scale,
            .irregularity_std = options.population.irregularity_std * noise.irregularity_scale};
    run_unchanged();
  }

  [[nodiscard]] Weighed weigh() const {
    std::vector<std::pair<double, SealHypothesis>> all;  // with the logarithms of their posteriors
    for (const Run& one : runs_) all.emplace_back(one.log_posterior(), one.hypothesis);
    add_changes(all);
    const auto& likeliest_entry =
        *std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const double top = likeliest_entry.first;
    const SealBelief& likeliest = likeliest_entry.second.belief;
    const double surprise = likeliest.surprise_squares / std::max(likeliest.tests, 1);
    double sum = 0.0;
    for (auto& [log_posterior, hypothesis] : all) sum += hypothesis.weight = std::exp(log_posterior - top);
    SealOpinion opinion{
        .hypotheses = {}, .law = law_, .extra_std = noise_.extra_std, .irregularity_scale = noise_.irregularity_scale};
    for (auto& [log_posterior, hypothesis] : all)
      if (hypothesis.weight > kSmallestWeight * sum) opinion.hypotheses.push_back(hypothesis);
    double kept = 0.0;
    for (const SealHypothesis& hypothesis : opinion.hypotheses) kept += hypothesis.weight;
    for (SealHypothesis& hypothesis : opinion.hypotheses) hypothesis.weight /= kept;
    return {.opinion = std::move(opinion), .log_evidence = top + std::log(sum), .surprise = surprise};
  }

 private:
  void run_unchanged() {
    std::vector<std::pair<double, double>> ages(kUnknownAges.begin(), kUnknownAges.end());
    if (options_.age_at_first_test) ages = {{*options_.age_at_first_test, 1.0}};
    for (const auto& [age, probability] : ages)
      for (const auto& [kin, share] : kinships())
        if (share > 0.0) runs_.push_back(run(age, kin, std::log(probability * share)));
  }

  [[nodiscard]] std::array<std::pair<Kinship, double>, 3> kinships() const {
    const double related = 1.0 - kStrangerShare;
    return {{{Kinship::member, related * (1.0 - options_.relative_share)},
             {Kinship::relative, related * options_.relative_share},
             {Kinship::stranger, kStrangerShare}}};
  }

  [[nodiscard]] const Run& best() const {
    return *std::max_element(runs_.begin(), runs_.end(),
                             [](const Run& a, const Run& b) { return a.log_posterior() < b.log_posterior(); });
  }

  [[nodiscard]] SealBelief prior(Kinship kin) const {
    SealBelief belief = new_seal(options_.population, kin == Kinship::relative ? kRelativeSpread : 1.0);
    if (kin != Kinship::stranger) return belief;
    belief.covariance = {
        kStrangerInitialStd * kStrangerInitialStd, 0.0, 0.0,
        kStrangerRateStd * kStrangerRateStd,       0.0, kStrangerSteepeningStd * kStrangerSteepeningStd};
    return belief;
  }

  [[nodiscard]] Run run(double first_age, Kinship kin, double log_prior) const {
    Run run{.hypothesis = {.belief = prior(kin), .kin = kin}, .first_age = first_age, .log_prior = log_prior};
    SealBelief& belief = run.hypothesis.belief;
    run.before.reserve(tests_.size());
    for (const DatedTest& test : tests_) {
      run.before.push_back(belief);
      take_in(belief, test, first_age);
    }
    return run;
  }

  void take_in(SealBelief& belief, const DatedTest& test, double first_age) const {
    grow_old(belief, law_, first_age + test.months);
    observe(belief, test.condition, total_std(test, noise_));
  }

  void add_changes(std::vector<std::pair<double, SealHypothesis>>& all) const {
    const Run& base = best();
    const auto prior = [&](double per_month, double months) {
      return base.log_prior + std::log(per_month * std::max(months, kShortest_months));
    };
    double last_months = tests_.back().months;
    for (const std::size_t since : kTestsSinceChange) {
      if (since + kFewestBeforeChange > tests_.size()) break;
      const std::size_t first = tests_.size() - since;
      const double stands_for = last_months - tests_[first].months;  // months since the candidate before
      last_months = tests_[first].months;
      all.push_back(branch(base, SealChange::rate, first, prior(options_.change_per_month, stands_for)));
      if (since < kTestsOfJump)  // two tests that confirm each other count at once
        all.push_back(branch(base, SealChange::level, first, prior(kLevelPerMonth, stands_for)));
    }
    for (const std::size_t first : largest_jumps()) {
      const double stands_for = tests_[first + 1].months - tests_[first - 1].months + kShortest_months;
      all.push_back(branch(base, SealChange::level, first, prior(kLevelPerMonth, stands_for)));
      all.push_back(branch(base, SealChange::replaced, first, prior(kReplacedPerMonth, stands_for)));
    }
  }

  /// Where the medians of three tests before and three after are furthest apart: a step shows there or nowhere.
  [[nodiscard]] std::vector<std::size_t> largest_jumps() const {
    std::vector<std::size_t> places;
    if (tests_.size() < kFewestBeforeChange + 3) return places;
    std::vector<double> jumps(tests_.size(), 0.0);
    for (std::size_t i = kFewestBeforeChange; i + 2 < tests_.size(); ++i)
      jumps[i] = std::abs(middle_of(i) - middle_of(i - 3));
    while (places.size() < kJumps) {
      const auto largest = std::max_element(jumps.begin(), jumps.end());
      if (*largest <= 0.0) break;
      places.push_back(static_cast<std::size_t>(largest - jumps.begin()));
      const std::size_t from = places.back() - 2;  // the same step shows in its neighbours too
      std::fill_n(jumps.begin() + static_cast<std::ptrdiff_t>(from), std::min<std::size_t>(5, jumps.size() - from),
                  0.0);
    }
    return places;
  }

  [[nodiscard]] double middle_of(std::size_t i) const {
    const double a = tests_[i].condition;
    const double b = tests_[i + 1].condition;
    const double c = tests_[i + 2].condition;
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  }

  [[nodiscard]] std::pair<double, SealHypothesis> branch(const Run& base, SealChange change, std::size_t first,
                                                         double log_prior) const {
    SealHypothesis hypothesis{.belief = base.before[first],
                              .change = change,
                              .changed_months = tests_[first].months,
                              .kin = base.hypothesis.kin};
    SealBelief& belief = hypothesis.belief;
    double first_age = base.first_age;
    if (change == SealChange::replaced) {
      const double evidence = belief.log_evidence;
      belief = prior(base.hypothesis.kin);
      belief.log_evidence = evidence;
      const double gap = first > 0 ? tests_[first].months - tests_[first - 1].months : 1.0;
      first_age = 0.5 * gap - tests_[first].months;  // some time since the test before
    } else if (change == SealChange::rate) {
      age_faster(belief, kFasterAgeing, kFasterAgeingSpread);
    } else {
      belief.covariance[0] += kLevelChange * kLevelChange;
    }
    for (std::size_t i = first; i < tests_.size(); ++i) take_in(belief, tests_[i], first_age);
    return {log_prior + belief.log_evidence, hypothesis};
  }

  const std::vector<DatedTest>& tests_;
  const HypothesisOptions& options_;
  Noise noise_;
  DegradationLaw law_;
  std::vector<Run> runs_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Scatter of one test from second differences, in which any slow ageing cancels; robust. 0 for fewer than five.
double scatter_of(const std::vector<DatedTest>& tests) {
  std::vector<double> differences;
  for (std::size_t i = 2; i < tests.size(); ++i)
    differences.push_back(std::abs(tests[i].condition - 2.0 * tests[i - 1].condition + tests[i - 2].condition));
  if (differences.size() < 3) return 0.0;
  return 1.4826 * median(std::move(differences)) / std::sqrt(6.0);
}

constexpr double kUsualScatter = 0.003;  // of an estimate whose standard error is not known, before tests tell it
constexpr double kSmallestScatter = 1e-5;

std::vector<Noise> candidates(const std::vector<DatedTest>& tests, bool errors_known) {
  double scatter = scatter_of(tests);
  if (tests.size() < kFewestToJudge) scatter = std::max(scatter, kUsualScatter);
  scatter = std::max(scatter, kSmallestScatter);
  if (!errors_known) return {{scatter, 1.0}, {0.5 * scatter, 1.0}, {0.25 * scatter, 1.0}, {1.5 * scatter, 1.0}};
  return {{0.5 * scatter, 1.0}, {scatter, 1.0}, {2.0 * scatter, 1.0}, {0.0, 0.3}, {0.0, 2.0}, {0.0, 4.0}};
}

}  // namespace

SealOpinion weigh_hypotheses(const std::vector<DatedTest>& tests, const HypothesisOptions& options) {
  const bool errors_known =
      std::all_of(tests.begin(), tests.end(), [](const DatedTest& test) { return test.condition_std > 0.0; });
  std::optional<Weighed> best;
  if (errors_known) {
    best = Bank(tests, options, {}).weigh();
    const bool plausible = best->surprise > kTooLittleSurprise && best->surprise < kTooMuchSurprise;
    if (plausible || tests.size() < kFewestToJudge) return std::move(best->opinion);
  }
  for (const Noise& noise : candidates(tests, errors_known)) {
    Weighed trial = Bank(tests, options, noise).weigh();
    if (!best || trial.log_evidence > best->log_evidence) best = std::move(trial);
  }
  return std::move(best->opinion);
}

void grow_old(SealOpinion& opinion, double months) {
  for (SealHypothesis& hypothesis : opinion.hypotheses)
    grow_old(hypothesis.belief, opinion.law, hypothesis.belief.age_months + months);
}

}  // namespace sealwatch::forecast
