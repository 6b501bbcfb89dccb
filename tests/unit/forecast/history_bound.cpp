// How much of a forecast's error no forecaster can avoid: the exact Bayes posterior of docs/records/verification.md.
//
//   forecast_history_bound [LIVES] [SEED]   300 lives of the constants published_ln_t; first seed 500001, which no
//                                           verification and no calibration has used
//
// Four levels of knowledge about the same lives, from all to what a test tells, with the mean |error| of the median:
//   oracle     the law, its constants, theta, gamma, Gamma_max of today: what is left is the future's irregularity
//   Gamma_max  the law, its constants, Gamma_max and every past theta without any error; gamma by Bayes' rule
//   history    the law, its constants and every past theta without any error; gamma and Gamma_max by Bayes' rule.
//              The median of the exact posterior has the least mean |error| of all functions of the history
//   tests      the law, its constants and the estimates, theta +- 4.5e-4; theta, gamma and Gamma_max by Bayes' rule
//   exact      fleet and state_space, given every past theta without any error
//   estimated  the same, given theta +- 4.5e-4, the standard error of a test at 50 Hz
//
// Bayes' rule is a particle filter: given theta(n-1) and theta(n), Upsilon = fall / ln(...) - gamma is uniform, so that
// a particle lives when it lies within the limits and dies otherwise. Given an estimate, theta(n) is normal about it
// and cut to what Upsilon's limits allow (the optimal proposal): drawn so, weighed by the mass within. Each particle
// then plays one future.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "sealwatch/forecast/forecaster.hpp"
#include "sealwatch/forecast/normal.hpp"
#include "services/verification/lives/oracle.hpp"
#include "services/virtual_bench/random.hpp"
#include "tests/unit/forecast/lives.hpp"

using namespace sealwatch;
using namespace sealwatch::forecast;

namespace {

constexpr double kThreshold = 0.60;
constexpr int kParticles = 3000;
constexpr double kEstimateStd = 4.5e-4;
const DegradationSetting kLaw{
    .n_0 = 6.0, .initial_gamma = {0.03, 0.06}, .steepening_limit = {0.0022, 0.0036}, .irregularity = {-0.26, 0.28}};

double step_of(double month) { return std::log((month + kLaw.n_0) / (month - 1.0 + kLaw.n_0)); }

struct Particle {
  double gamma, limit;
};

/// Months until failure in one future that the law allows.
double one_future(UniformRandom& random, Particle particle, double month, double condition) {
  double months = 0.0;
  while (true) {
    particle.gamma += random.between(0.0, particle.limit);
    const double upsilon = random.between(kLaw.irregularity.min, kLaw.irregularity.max);
    const double fall = (particle.gamma + upsilon) * step_of(month + months + 1.0);
    if (condition - fall <= kThreshold) return months + (condition - kThreshold) / fall;
    condition -= fall;
    months += 1.0;
  }
}

class HistoryFilter {
 public:
  /// `known_limit` > 0: Gamma_max is known.
  HistoryFilter(std::uint64_t seed, double known_limit) : random_(seed) {
    for (int k = 0; k < kParticles; ++k)
      particles_.push_back(
          {random_.between(kLaw.initial_gamma.min, kLaw.initial_gamma.max),
           known_limit > 0.0 ? known_limit : random_.between(kLaw.steepening_limit.min, kLaw.steepening_limit.max)});
  }

  void observe(double month, double before, double now) {
    const double rate = (before - now) / step_of(month);
    std::vector<Particle> alive;
    for (Particle particle : particles_) {
      particle.gamma += random_.between(0.0, particle.limit);
      const double upsilon = rate - particle.gamma;
      if (upsilon >= kLaw.irregularity.min && upsilon <= kLaw.irregularity.max) alive.push_back(particle);
    }
    if (alive.empty()) std::abort();      // the truth is within the limits
    if (alive.size() < kParticles / 2) {  // all alike: drawn again by lot
      particles_.resize(kParticles);
      for (Particle& particle : particles_)
        particle = alive[static_cast<std::size_t>(random_.unit() * static_cast<double>(alive.size()))];
    } else {
      particles_ = std::move(alive);
    }
  }

  /// Median of the months until failure.
  double median(double month, double condition) {
    std::vector<double> lives;
    for (const Particle& particle : particles_) lives.push_back(one_future(random_, particle, month, condition));
    const auto middle = lives.begin() + static_cast<std::ptrdiff_t>(lives.size() / 2);
    std::nth_element(lives.begin(), middle, lives.end());
    return *middle;
  }

 private:
  UniformRandom random_;
  std::vector<Particle> particles_;
};

/// |error| of each life at each lead, and the life's mean over its last year.
constexpr std::array<double, 4> kLeads{36.0, 24.0, 12.0, 6.0};
struct Errors {
  std::array<std::vector<double>, kLeads.size() + 1> at;
};

struct Now {
  double month, left;
  int lead;  ///< index into kLeads, or -1
  bool last_year;
};

struct LastYear {
  double sum = 0.0;
  int months = 0;
};

void score(Errors& errors, LastYear& year, const Now& now, double forecast) {
  const double error = std::abs(forecast - now.left);
  if (now.lead >= 0) errors.at[static_cast<std::size_t>(now.lead)].push_back(error);
  if (!now.last_year) return;
  year.sum += error;
  ++year.months;
}

/// As HistoryFilter, but of estimates with a standard error: theta is a part of the particle.
class TestFilter {
 public:
  explicit TestFilter(std::uint64_t seed) : random_(seed) {
    for (int k = 0; k < kParticles; ++k)
      particles_.push_back({1.0, random_.between(kLaw.initial_gamma.min, kLaw.initial_gamma.max),
                            random_.between(kLaw.steepening_limit.min, kLaw.steepening_limit.max)});
  }

  void observe(double month, double estimate) {
    const double step = step_of(month);
    std::vector<double> weights;
    double sum = 0.0;
    for (State& state : particles_) {
      state.gamma += random_.between(0.0, state.limit);
      const double low = state.condition - (state.gamma + kLaw.irregularity.max) * step;
      const double high = state.condition - (state.gamma + kLaw.irregularity.min) * step;
      const double from = normal_probability((low - estimate) / kEstimateStd);
      const double to = normal_probability((high - estimate) / kEstimateStd);
      weights.push_back(std::max(to - from, 0.0));
      sum += weights.back();
      const double drawn = std::clamp(from + (to - from) * random_.unit(), 1e-12, 1.0 - 1e-12);
      state.condition = std::clamp(estimate + kEstimateStd * normal_quantile(drawn), low, high);
    }
    std::vector<State> next;  // systematic resampling
    double reached = 0.0;
    const double offset = random_.unit();
    for (std::size_t k = 0; k < particles_.size(); ++k) {
      reached += weights[k] / sum * kParticles;
      while (static_cast<double>(next.size()) + offset < reached) next.push_back(particles_[k]);
    }
    particles_ = std::move(next);
  }

  double median(double month) {
    std::vector<double> lives;
    for (const State& state : particles_)
      lives.push_back(state.condition <= kThreshold
                          ? 0.0
                          : one_future(random_, {state.gamma, state.limit}, month, state.condition));
    const auto middle = lives.begin() + static_cast<std::ptrdiff_t>(lives.size() / 2);
    std::nth_element(lives.begin(), middle, lives.end());
    return *middle;
  }

 private:
  struct State {
    double condition, gamma, limit;
  };
  UniformRandom random_;
  std::vector<State> particles_;
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Mean, and its ratio to the oracle's with the standard error of a ratio of paired means.
void print(const char* name, const Errors& errors, const Errors& oracle) {
  std::printf("%-24s", name);
  for (std::size_t h = 0; h < errors.at.size(); ++h) {
    const std::vector<double>&e = errors.at[h], &o = oracle.at[h];
    const double ratio = mean(e) / mean(o);
    double squares = 0.0;
    for (std::size_t k = 0; k < e.size(); ++k) squares += std::pow(e[k] - ratio * o[k], 2);
    const auto n = static_cast<double>(e.size());
    std::printf(" | %5.2f %5.3f +- %.3f", mean(e), ratio, std::sqrt(squares / n / (n - 1.0)) / mean(o));
  }
  std::printf("\n");
}

struct Panel {
  std::vector<std::unique_ptr<const Forecaster>> forecasters;
  Panel() {
    for (const char* method : {"fleet", "state_space"})
      forecasters.push_back(std::move(*make_forecaster(
          {.method = method, .window_months = kWholeLife_months, .population = reference_population(kLaw)})));
  }
};

constexpr std::array<const char*, 8> kNames{
    "oracle",       "history and Gamma_max", "history",          "tests",
    "fleet, exact", "state_space, exact",    "fleet, estimated", "state_space, estimated"};

std::vector<double> ask(const Panel& panel, const std::vector<ConditionSample>& history) {
  std::vector<double> answers;
  for (const auto& forecaster : panel.forecasters)
    answers.push_back(forecaster
                          ->forecast({.history = history,
                                      .threshold = kThreshold,
                                      .now = history.back().time,
                                      .installed = test::kInstalled})
                          .value()
                          .rul_months);
  return answers;
}

void run_life(std::uint64_t seed, const Panel& panel, std::vector<Errors>& errors) {
  Degradation seal(seed, kLaw);
  std::vector<TrueState> states{{0.0, 1.0, seal.gamma(), seal.steepening_limit()}};
  while (seal.condition() > kThreshold) {
    seal.advance();
    states.push_back({static_cast<double>(seal.month()), seal.condition(), seal.gamma(), seal.steepening_limit()});
  }
  const double before = states[states.size() - 2].condition;
  const double end = static_cast<double>(states.size() - 2) + (before - kThreshold) / (before - seal.condition());
  if (end > 240.0) return;  // outlasts its service, as in the verification
  HistoryFilter history(seed + 1, 0.0), with_limit(seed + 2, seal.steepening_limit());
  TestFilter tests(seed + 4);
  bench::NormalRandom noise(seed + 3);
  std::vector<ConditionSample> exact, estimated;
  std::vector<LastYear> year(kNames.size());
  for (std::size_t n = 1; n + 1 < states.size(); ++n) {
    const TrueState& state = states[n];
    history.observe(state.month, states[n - 1].condition, state.condition);
    with_limit.observe(state.month, states[n - 1].condition, state.condition);
    exact.push_back({test::month(state.month), state.condition, 1e-6});
    estimated.push_back({test::month(state.month), state.condition + kEstimateStd * noise.next(), kEstimateStd});
    tests.observe(state.month, estimated.back().condition);
    Now now{.month = state.month, .left = end - state.month, .lead = -1, .last_year = end - state.month <= 12.0};
    for (std::size_t h = 0; h < kLeads.size(); ++h)
      if (now.left > kLeads[h] - 0.5 && now.left <= kLeads[h] + 0.5) now.lead = static_cast<int>(h);
    if (now.lead < 0 && !now.last_year) continue;
    std::vector<double> answers{oracle_distribution(state, kThreshold, kLaw).value().quantile(0.5),
                                with_limit.median(state.month, state.condition),
                                history.median(state.month, state.condition), tests.median(state.month)};
    for (const auto* samples : {&exact, &estimated})
      for (const double answer : ask(panel, *samples)) answers.push_back(answer);
    for (std::size_t k = 0; k < answers.size(); ++k) score(errors[k], year[k], now, answers[k]);
  }
  for (std::size_t k = 0; k < errors.size(); ++k) errors[k].at.back().push_back(year[k].sum / year[k].months);
}

}  // namespace

int main(int argc, char** argv) {
  const int lives = argc > 1 ? std::atoi(argv[1]) : 300;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 500001;
  const Panel panel;
  std::vector<Errors> errors(kNames.size());
  for (int k = 0; k < lives; ++k) run_life(first + 10 * static_cast<std::uint64_t>(k), panel, errors);
  std::printf("%zu of %d lives fail within 240 months; mean |error| in months, over the oracle's +- standard error\n",
              errors.front().at.back().size(), lives);
  std::printf("%-24s | %-21s | %-21s | %-21s | %-21s | last year\n", "", "36 months before", "24", "12", "6");
  for (std::size_t k = 0; k < errors.size(); ++k) print(kNames[k], errors[k], errors.front());
  return 0;
}
