#include "sealwatch/forecast/degradation_filter.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/forecast/normal.hpp"

namespace sealwatch::forecast {
namespace {

// Of the outlier component: one test in a hundred, and so far off that any gross error finds a place in it.
constexpr double kOutlierShare = 0.01;
constexpr double kOutlierErrors = 5.0;  // times the standard error
constexpr double kOutlierWidth = 0.05;  // of theta
constexpr double kSmallestStd = 1e-6;   // rounding of histories in text files
constexpr double kLargestSurprise = 9.0;
constexpr double kLargestLogOdds = 60.0;
constexpr double kCertain = 0.9999;   // the table of a distribution ends here
constexpr double kNegligible = 1e-7;  // and its rise begins here

constexpr double kSteep = 0.03;  // rise of a distribution over one row that calls for points between
constexpr double kFarOut = 6.0;  // standard deviations, 1e-9

enum Entry { tt, tg, tm, gg, gm, mm };

void step(SealBelief& belief, const DegradationLaw& law, double d) {
  auto& [theta, g, mu] = belief.mean;
  auto& P = belief.covariance;
  const double A = std::log((belief.age_months + d + law.n_0) / (belief.age_months + law.n_0));
  g += mu * d;
  theta -= g * A;
  // F P F' of g' = g + d mu, theta' = theta - A g'
  P[gg] += d * (2.0 * P[gm] + d * P[mm]);
  P[tg] += d * P[tm];
  P[gm] += d * P[mm];
  const double faster = belief.ageing_factor * belief.ageing_factor;
  const double scatter = faster * law.steepening_scatter * law.steepening_scatter * d;
  P[gg] += scatter;  // w enters g first, and theta through it
  P[tt] += A * (A * P[gg] - 2.0 * P[tg]) + faster * law.irregularity_std * law.irregularity_std * A * A / d;
  P[tg] -= A * P[gg];
  P[tm] -= A * P[gm];
  belief.age_months += d;
}

/// What the future adds to theta(now) from a common age: theta(h) = theta - A g - B mu - noise of variance V.
struct Horizon {
  double months, A, B, V;
};

/// Monthly at first, then coarser: quantiles lie between by interpolation.
double spacing(double months) { return months < 72.0 ? 1.0 : months < 144.0 ? 2.0 : months < 300.0 ? 4.0 : 12.0; }

class HorizonTable {
 public:
  HorizonTable(double age_months, const DegradationLaw& law) : age_(age_months), law_(law) {}

  /// The horizon at `share` of the way from the row before to this one: theta goes straight between months.
  Horizon between(std::size_t row, double share) {
    while (rows_.size() <= row) extend();
    const Horizon& to = rows_[row];
    if (share == 1.0) return to;
    const Horizon& from = rows_[row - 1];
    const auto mix = [&](double a, double b) { return a + share * (b - a); };
    return {mix(from.months, to.months), mix(from.A, to.A), mix(from.B, to.B), mix(from.V, to.V)};
  }

 private:
  void extend() {
    if (rows_.empty()) {
      rows_.push_back({0.0, 0.0, 0.0, 0.0});
      return;
    }
    const double until = rows_.back().months + spacing(rows_.back().months);
    double A = rows_.back().A;
    for (double h = rows_.back().months + 1.0; h <= until; h += 1.0) {
      sum_A_ += A;
      sum_A_squares_ += A * A;
      const double now = std::log((age_ + h + law_.n_0) / (age_ + law_.n_0));
      const double a = now - A;
      B_ += h * a;
      irregularity_ += a * a;
      A = now;
    }
    // sum over the months i of (A(h) - A(i-1))^2: what each month's w has done to theta by h
    const double scatter = until * A * A - 2.0 * A * sum_A_ + sum_A_squares_;
    rows_.push_back({until, A, B_,
                     law_.irregularity_std * law_.irregularity_std * irregularity_ +
                         law_.steepening_scatter * law_.steepening_scatter * std::max(scatter, 0.0)});
  }

  double age_;
  DegradationLaw law_;
  std::vector<Horizon> rows_;
  double sum_A_ = 0.0;
  double sum_A_squares_ = 0.0;
  double B_ = 0.0;
  double irregularity_ = 0.0;
};

double below_threshold(const SealBelief& belief, const Horizon& h, double threshold) {
  const auto& P = belief.covariance;
  const double mean = belief.mean[0] - h.A * belief.mean[1] - h.B * belief.mean[2];
  const double variance = P[tt] - 2.0 * h.A * P[tg] - 2.0 * h.B * P[tm] + h.A * h.A * P[gg] + 2.0 * h.A * h.B * P[gm] +
                          h.B * h.B * P[mm] + belief.ageing_factor * belief.ageing_factor * h.V;
  const double z = (threshold - mean) / std::sqrt(std::max(variance, kSmallestStd * kSmallestStd));
  if (std::abs(z) > kFarOut) return z < 0.0 ? 0.0 : 1.0;  // most months of most lives: no error function needed
  return normal_probability(z);
}

}  // namespace

SealBelief new_seal(const FleetPopulation& population, double spread) {
  SealBelief belief;
  belief.mean = {population.initial_condition, population.initial_rate, population.steepening};
  const double t = spread * population.initial_condition_std;
  const double g = spread * population.initial_rate_std;
  const double m = spread * population.steepening_std;
  belief.covariance = {t * t, 0.0, 0.0, g * g, population.rate_steepening_correlation * g * m, m * m};
  return belief;
}

void grow_old(SealBelief& belief, const DegradationLaw& law, double age_months) {
  const double months = age_months - belief.age_months;
  if (months <= 0.0) return;
  const int steps = std::max(1, static_cast<int>(std::lround(months)));
  for (int k = 0; k < steps; ++k) step(belief, law, months / steps);
}

// (g, mu) k with k = times (1 + spread e), e standard normal: to first order, and e moves both together.
void age_faster(SealBelief& belief, double times, double spread) {
  auto& [theta, g, mu] = belief.mean;
  auto& P = belief.covariance;
  belief.ageing_factor *= times;
  g *= times;
  mu *= times;
  for (const Entry entry : {tg, tm}) P[entry] *= times;
  for (const Entry entry : {gg, gm, mm}) P[entry] *= times * times;
  P[gg] += spread * spread * g * g;
  P[gm] += spread * spread * g * mu;
  P[mm] += spread * spread * mu * mu;
}

// Both components' posteriors lie on the line through the prior along c = (tt, tg, tm), so that joining them is a
// matter of scalars.
void observe(SealBelief& belief, double condition, double condition_std) {
  auto& P = belief.covariance;
  const double s = std::max(condition_std, kSmallestStd);
  const double innovation = condition - belief.mean[0];
  const double S_good = P[tt] + s * s;
  const double S_outlier = P[tt] + kOutlierErrors * kOutlierErrors * s * s + kOutlierWidth * kOutlierWidth;
  const double half_square = 0.5 * innovation * innovation;
  const double log_odds = half_square * (1.0 / S_good - 1.0 / S_outlier);
  // Odds of the outlier component; beyond e^60 the other has no say, and nothing overflows.
  const double odds = kOutlierShare / (1.0 - kOutlierShare) * std::sqrt(S_good / S_outlier) *
                      std::exp(std::min(log_odds, kLargestLogOdds));
  const double p = 1.0 / (1.0 + odds);
  const double difference = 1.0 / S_good - 1.0 / S_outlier;
  const double gain = p / S_good + (1.0 - p) / S_outlier;
  const double shrink = gain - p * (1.0 - p) * difference * difference * innovation * innovation;
  const std::array<double, 3> c{P[tt], P[tg], P[tm]};
  for (std::size_t i = 0; i < 3; ++i) belief.mean[i] += gain * c[i] * innovation;
  P[tt] -= shrink * c[0] * c[0];
  P[tg] -= shrink * c[0] * c[1];
  P[tm] -= shrink * c[0] * c[2];
  P[gg] -= shrink * c[1] * c[1];
  P[gm] -= shrink * c[1] * c[2];
  P[mm] -= shrink * c[2] * c[2];
  // With odds cut off, the outlier component alone is left.
  belief.log_evidence += log_odds < kLargestLogOdds
                             ? std::log((1.0 - kOutlierShare) * (1.0 + odds) / std::sqrt(S_good)) - half_square / S_good
                             : std::log(kOutlierShare / std::sqrt(S_outlier)) - half_square / S_outlier;
  belief.surprise_squares += std::min(innovation * innovation / S_good, kLargestSurprise);
  ++belief.tests;
}

Result<PredictiveDistribution> crossing_distribution(std::span<const WeightedBelief> beliefs, const DegradationLaw& law,
                                                     double threshold, double longest_months) {
  if (beliefs.empty()) return fail("a forecast needs at least one belief about what wears");
  std::vector<HorizonTable> tables;
  std::vector<double> ages;
  std::vector<std::size_t> table_of;
  double total = 0.0;
  for (const WeightedBelief& one : beliefs) {
    total += one.weight;
    const auto known = std::find(ages.begin(), ages.end(), one.belief.age_months);
    table_of.push_back(static_cast<std::size_t>(known - ages.begin()));
    if (known != ages.end()) continue;
    ages.push_back(one.belief.age_months);
    tables.emplace_back(one.belief.age_months, law);
  }
  const auto mixture = [&](std::size_t row, double share) {
    double probability = 0.0;
    for (std::size_t k = 0; k < beliefs.size(); ++k)
      probability += beliefs[k].weight / total *
                     below_threshold(beliefs[k].belief, tables[table_of[k]].between(row, share), threshold);
    return probability;
  };
  std::vector<PredictiveDistribution::Point> points{{0.0, mixture(0, 1.0)}};
  const auto add = [&](double months, double probability) {
    // An early rise of theta takes no failure back.
    const double highest = std::clamp(probability, points.back().probability, 1.0);
    if (highest < kNegligible) points.clear();
    points.push_back({months, highest});
  };
  for (std::size_t row = 1; points.back().probability < kCertain && points.back().months < longest_months; ++row) {
    const double probability = mixture(row, 1.0);
    const bool steep = probability - points.back().probability > kSteep;
    for (const double share : {0.25, 0.5, 0.75})
      if (steep) add(std::min(tables.front().between(row, share).months, longest_months), mixture(row, share));
    add(std::min(tables.front().between(row, 1.0).months, longest_months), probability);
  }
  return PredictiveDistribution::make(std::move(points));  // refuses what is no number
}

}  // namespace sealwatch::forecast
