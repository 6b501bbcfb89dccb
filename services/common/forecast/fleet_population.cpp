#include "sealwatch/forecast/fleet_population.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sealwatch/forecast/degradation_filter.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::forecast {
namespace {

constexpr int kMaximisationSteps = 200;
constexpr double kUnknownErrorStd = 0.003;  // of an estimate that comes without one
// Multiples of the reference irregularity among which the likelihood chooses; upwards by this factor until it falls.
constexpr std::array<double, 7> kIrregularityScales{0.25, 0.5, 0.71, 1.0, 1.41, 2.0, 4.0};
constexpr double kNextScale = 2.0, kLargestScale = 1000.0;
constexpr double kOneSided95 = 2.706;  // of -2 ln likelihood

/// (g(0), mu) of one life, or a symmetric 2 x 2 matrix by (11, 12, 22).
using Pair = std::array<double, 2>;
using Matrix = std::array<double, 3>;

Matrix inverse(const Matrix& m) {
  const double determinant = m[0] * m[2] - m[1] * m[1];
  return {m[2] / determinant, -m[1] / determinant, m[0] / determinant};
}
Pair times(const Matrix& m, const Pair& v) { return {m[0] * v[0] + m[1] * v[1], m[1] * v[0] + m[2] * v[1]}; }

/// Least-squares estimate of one life's constants: information Z x = z.
struct LifeEstimate {
  Matrix information{};
  Pair projection{};
  double constant = 0.0;  ///< sum of e0^2 / S + ln S
  /// -2 ln likelihood, apart from a constant, at the life's own best constants.
  [[nodiscard]] double misfit() const {
    const Pair best = times(inverse(information), projection);
    return constant - best[0] * projection[0] - best[1] * projection[1];
  }
};

// The filter's innovations are linear in (g(0), mu): one run with both zero, and one for each with unit input and no
// measurement, give all of them, e = e0 - g(0) h_g - mu h_mu.
LifeEstimate estimate(const FleetLife& life, const FleetPopulation& population, const DegradationLaw& law) {
  std::array<SealBelief, 3> runs;
  for (SealBelief& run : runs) run.covariance[0] = std::pow(population.initial_condition_std, 2);
  runs[0].mean[0] = population.initial_condition;
  runs[1].mean[1] = 1.0;
  runs[2].mean[2] = 1.0;
  LifeEstimate result;
  for (const ConditionSample& sample : life.history) {
    for (SealBelief& run : runs) grow_old(run, law, std::max(months_between(life.installed, sample.time), 0.0));
    const auto c = runs[0].covariance;
    const double s = sample.condition_std > 0.0 ? sample.condition_std : kUnknownErrorStd;
    const double S = c[0] + s * s;
    const double e0 = sample.condition - runs[0].mean[0];
    const Pair h{runs[1].mean[0], runs[2].mean[0]};
    result.information[0] += h[0] * h[0] / S;
    result.information[1] += h[0] * h[1] / S;
    result.information[2] += h[1] * h[1] / S;
    result.projection[0] += h[0] * e0 / S;
    result.projection[1] += h[1] * e0 / S;
    result.constant += e0 * e0 / S + std::log(S);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      const double innovation = r == 0 ? e0 : -h[r - 1];
      for (std::size_t i = 0; i < 3; ++i) runs[r].mean[i] += c[i] / S * innovation;
      runs[r].covariance = {c[0] - c[0] * c[0] / S, c[1] - c[0] * c[1] / S, c[2] - c[0] * c[2] / S,
                            c[3] - c[1] * c[1] / S, c[4] - c[1] * c[2] / S, c[5] - c[2] * c[2] / S};
    }
  }
  return result;
}

std::vector<LifeEstimate> estimate_all(const std::vector<FleetLife>& lives, const FleetPopulation& population) {
  const DegradationLaw law{.n_0 = population.n_0,
                           .steepening_scatter = population.steepening_scatter,
                           .irregularity_std = population.irregularity_std};
  std::vector<LifeEstimate> estimates;
  for (const FleetLife& life : lives) estimates.push_back(estimate(life, population, law));
  return estimates;
}

struct Moments {
  Pair mean{};
  Matrix spread{};
};

Moments moments_of(const FleetPopulation& population) {
  const double g = population.initial_rate_std;
  const double m = population.steepening_std;
  return {{population.initial_rate, population.steepening},
          {g * g, population.rate_steepening_correlation * g * m, m * m}};
}

/// One step of expectation-maximisation; the reference counts as `k` lives.
Moments maximise(const Moments& now, const std::vector<LifeEstimate>& estimates, const Moments& reference, double k) {
  const Matrix precision = inverse(now.spread);
  const Pair pull = times(precision, now.mean);
  const double n = static_cast<double>(estimates.size()) + k;
  std::vector<std::pair<Pair, Matrix>> posteriors;
  Moments next{{k * reference.mean[0] / n, k * reference.mean[1] / n}, {}};
  for (const LifeEstimate& one : estimates) {
    const Matrix covariance = inverse(
        {one.information[0] + precision[0], one.information[1] + precision[1], one.information[2] + precision[2]});
    const Pair mean = times(covariance, {one.projection[0] + pull[0], one.projection[1] + pull[1]});
    posteriors.emplace_back(mean, covariance);
    for (std::size_t i = 0; i < 2; ++i) next.mean[i] += mean[i] / n;
  }
  posteriors.emplace_back(reference.mean, reference.spread);
  for (std::size_t p = 0; p < posteriors.size(); ++p) {
    const auto& [mean, covariance] = posteriors[p];
    const double share = (p + 1 == posteriors.size() ? k : 1.0) / n;
    const double a = mean[0] - next.mean[0];
    const double b = mean[1] - next.mean[1];
    next.spread[0] += share * (covariance[0] + a * a);
    next.spread[1] += share * (covariance[1] + a * b);
    next.spread[2] += share * (covariance[2] + b * b);
  }
  return next;
}

/// Of the means, which the reference pulls as `k` lives that scatter nowhere.
Matrix covariance_of_means(const Matrix& spread, const std::vector<LifeEstimate>& estimates, double k) {
  Matrix told{}, pulled = inverse(spread);
  for (double& entry : pulled) entry *= k;
  for (const LifeEstimate& one : estimates) {
    const Matrix own = inverse(one.information);
    const Matrix weight = inverse({spread[0] + own[0], spread[1] + own[1], spread[2] + own[2]});
    for (std::size_t i = 0; i < told.size(); ++i) told[i] += weight[i], pulled[i] += weight[i];
  }
  const Matrix gain = inverse(pulled);
  const Pair first = times(told, {gain[0], gain[1]}), second = times(told, {gain[1], gain[2]});
  return {gain[0] * first[0] + gain[1] * first[1], gain[0] * second[0] + gain[1] * second[1],
          gain[1] * second[0] + gain[2] * second[1]};
}

/// Where the parabola through three points, of which the middle one is lowest, is lowest.
double lowest_between(const std::array<double, 3>& x, const std::array<double, 3>& y) {
  const double left = (y[1] - y[0]) / (x[1] - x[0]), right = (y[2] - y[1]) / (x[2] - x[1]);
  return right > left ? 0.5 * (x[0] + x[1]) - left * 0.5 * (x[2] - x[0]) / (right - left) : x[1];
}

struct Irregularity {
  double likeliest = 0.0, value = 0.0;
  bool is_limit = false;
};

// -2 ln likelihood of the multiples of the reference irregularity, up to one beyond the best.
struct Misfits {
  std::vector<double> scales, values;
  std::size_t best = 0;
};

Misfits misfits_of(const std::vector<FleetLife>& lives, const FleetPopulation& reference) {
  Misfits misfits;
  const auto add = [&](double scale) {
    FleetPopulation trial = reference;
    trial.irregularity_std *= scale;
    double sum = 0.0;
    for (const LifeEstimate& one : estimate_all(lives, trial)) sum += one.misfit();
    misfits.scales.push_back(scale);
    misfits.values.push_back(sum);
    if (sum < misfits.values[misfits.best]) misfits.best = misfits.values.size() - 1;
  };
  for (const double scale : kIrregularityScales) add(scale);
  while (misfits.best + 1 == misfits.scales.size() && misfits.scales.back() < kLargestScale)
    add(kNextScale * misfits.scales.back());
  return misfits;
}

/// The multiple above which the irregularity is not, at 95 %, where the least one that is tried is the likeliest.
double limit_above(const Misfits& misfits) {
  for (std::size_t k = 1; k < misfits.values.size(); ++k) {
    const double before = misfits.values[k - 1] - misfits.values[0], after = misfits.values[k] - misfits.values[0];
    if (after < kOneSided95) continue;
    const double share = (kOneSided95 - before) / (after - before);
    return misfits.scales[k - 1] * std::pow(misfits.scales[k] / misfits.scales[k - 1], share);
  }
  return misfits.scales.back();
}

// Between the multiples by the parabola through the best and its neighbours: a fleet that is a little other has an
// irregularity that is a little other, which its standard error by leaving lives out is made of.
Result<Irregularity> irregularity_of(const std::vector<FleetLife>& lives, const FleetPopulation& reference) {
  const Misfits misfits = misfits_of(lives, reference);
  const std::vector<double>&x = misfits.scales, &y = misfits.values;
  const std::size_t best = misfits.best;
  const double unit = reference.irregularity_std;
  if (best == 0) return Irregularity{.likeliest = unit * x[0], .value = unit * limit_above(misfits), .is_limit = true};
  if (best + 1 == x.size())
    return fail("the histories scatter more than " + text::general(unit * x[best]) + " from test to test",
                "theta is 1 of a new part and falls; check the files");
  const double found = unit * std::exp(lowest_between({std::log(x[best - 1]), std::log(x[best]), std::log(x[best + 1])},
                                                      {y[best - 1], y[best], y[best + 1]}));
  return Irregularity{.likeliest = found, .value = found, .is_limit = false};
}

}  // namespace

Status FleetPopulation::validate() const {
  const auto check = [](bool good, const char* place, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = place, .value = text::general(value), .rule = rule, .advice = {}});
  };
  const std::pair<const char*, double> positive[] = {{"n_0", n_0},
                                                     {"initial_condition", initial_condition},
                                                     {"initial_condition_std", initial_condition_std},
                                                     {"initial_rate_std", initial_rate_std},
                                                     {"steepening_std", steepening_std},
                                                     {"steepening_scatter", steepening_scatter},
                                                     {"irregularity_std", irregularity_std}};
  for (const auto& [place, value] : positive)
    if (auto s = check(value > 0.0 && std::isfinite(value), place, value, "must be positive"); !s) return s;
  if (auto s = check(std::isfinite(initial_rate), "initial_rate", initial_rate, "must be finite"); !s) return s;
  if (auto s = check(std::isfinite(steepening), "steepening", steepening, "must be finite"); !s) return s;
  return check(std::abs(rate_steepening_correlation) < 1.0, "rate_steepening_correlation", rate_steepening_correlation,
               "must be within -1 and 1");
}

double mean_remaining_months(double condition, double threshold, const FleetPopulation& population) {
  constexpr int kLongest_months = 1200;
  if (!std::isfinite(condition)) return std::numeric_limits<double>::quiet_NaN();
  const auto passed = [](double before, double after, double level) {
    return std::clamp((before - level) / (before - after), 0.0, 1.0);
  };
  double theta = population.initial_condition, from = 0.0;
  bool reached = condition >= theta;
  for (int n = 1; n <= kLongest_months; ++n) {
    const double rate = population.initial_rate + population.steepening * n;
    const double next = theta - rate * std::log((n + population.n_0) / (n - 1 + population.n_0));
    if (!reached && next <= condition) {
      from = n - 1 + passed(theta, next, condition);
      reached = true;
    }
    if (next <= threshold) return std::max(0.0, n - 1 + passed(theta, next, threshold) - (reached ? from : n));
    theta = next;
  }
  return std::numeric_limits<double>::infinity();
}

FleetPopulation reference_population(const DegradationSetting& setting) {
  const double uniform_std = 1.0 / std::sqrt(12.0);  // of a width of one
  const auto mean = [](const Range& range) { return 0.5 * (range.min + range.max); };
  const auto width = [](const Range& range) { return range.max - range.min; };
  const double mean_limit = mean(setting.steepening_limit);
  const double limit_std = uniform_std * width(setting.steepening_limit);
  FleetPopulation population;
  population.n_0 = setting.n_0;
  population.initial_condition = setting.initial_condition;
  population.initial_rate = mean(setting.initial_gamma) + mean(setting.irregularity);
  population.initial_rate_std = uniform_std * width(setting.initial_gamma);
  population.steepening = 0.5 * mean_limit;  // Gamma ~ U(0, Gamma_max)
  population.steepening_std = 0.5 * limit_std;
  population.steepening_scatter = uniform_std * std::hypot(mean_limit, limit_std);  // root mean square over the fleet
  population.irregularity_std = uniform_std * width(setting.irregularity);
  return population;
}

Result<FleetFit> fit_population(std::span<const FleetLife> fleet, const FleetPopulation& reference,
                                double reference_lives) {
  if (const Status valid = reference.validate(); !valid) return fail(valid.error());
  if (fleet.empty()) return fail("the fleet is empty", "give the history of at least one actuator");
  if (!(reference_lives > 0.0)) return fail("the reference must count as more than 0 lives");
  FleetFit fit;
  std::vector<FleetLife> lives;
  for (const FleetLife& life : fleet) {
    FleetLife clean{.history = {}, .installed = life.installed};
    const std::vector<bool> outlier = isolated_outliers(life.history);
    for (std::size_t i = 0; i < life.history.size(); ++i)
      if (!outlier[i] && life.history[i].time > life.installed) clean.history.push_back(life.history[i]);
    if (clean.history.size() < static_cast<std::size_t>(kFewestTestsOfLife))
      ++fit.passed_over;
    else
      lives.push_back(std::move(clean));
  }
  fit.lives = static_cast<int>(lives.size());
  if (lives.empty())
    return fail("no life of the fleet has at least " + std::to_string(kFewestTestsOfLife) +
                " tests since installation");
  fit.population = reference;
  const Result<Irregularity> irregularity = irregularity_of(lives, reference);
  if (!irregularity) return fail(irregularity.error());
  fit.population.irregularity_std = irregularity->value;
  fit.likeliest_irregularity = irregularity->likeliest;
  fit.irregularity_is_limit = irregularity->is_limit;
  const std::vector<LifeEstimate> estimates = estimate_all(lives, fit.population);
  const Moments start = moments_of(reference);
  Moments moments = start;
  for (int step = 0; step < kMaximisationSteps; ++step) moments = maximise(moments, estimates, start, reference_lives);
  fit.population.initial_rate = moments.mean[0];
  fit.population.steepening = moments.mean[1];
  fit.population.initial_rate_std = std::sqrt(moments.spread[0]);
  fit.population.steepening_std = std::sqrt(moments.spread[2]);
  fit.population.rate_steepening_correlation = moments.spread[1] / std::sqrt(moments.spread[0] * moments.spread[2]);
  const Matrix of_means = covariance_of_means(moments.spread, estimates, reference_lives);
  fit.initial_rate_error = std::sqrt(of_means[0]);
  fit.steepening_error = std::sqrt(of_means[2]);
  return fit;
}

}  // namespace sealwatch::forecast
