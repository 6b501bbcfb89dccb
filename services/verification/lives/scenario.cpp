#include "services/verification/lives/scenario.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::verification {
namespace {

using forecast::Degradation;
using forecast::DegradationSetting;
using forecast::TrueState;
using forecast::UniformRandom;

constexpr std::array<std::pair<Scenario, std::string_view>, 7> kNames = {{{Scenario::reference, "reference"},
                                                                          {Scenario::outliers, "outliers"},
                                                                          {Scenario::missing, "missing"},
                                                                          {Scenario::aborted, "aborted"},
                                                                          {Scenario::replaced, "replaced"},
                                                                          {Scenario::load_change, "load_change"},
                                                                          {Scenario::contamination, "contamination"}}};
constexpr int kLongestLife_months = 2400;
constexpr double kOutlierShare = 0.05;
constexpr double kOutlierLeast = 0.02, kOutlierMost = 0.10;  // of theta
constexpr double kMissingShare = 0.25;
constexpr double kCutShare = 0.25;
constexpr double kFirstReplacement_months = 36.0, kLastReplacement_months = 72.0;
constexpr double kReplacedBefore = 0.8;           // of the first seal's life
constexpr double kEarliest = 0.3, kLatest = 0.6;  // a change, as share of the life
constexpr double kLoadRise = 0.3;                 // of the nominal load
constexpr double kFasterAgeing = 1.5;             // times
constexpr double kUnforeseeable_months = 6.0;

/// Ages a seal to its failure, `faster` times as fast from month `from` on; states by its own age, from 0.
std::vector<TrueState> age(std::uint64_t seed, const DegradationSetting& setting, double threshold, double from,
                           double faster) {
  Degradation seal(seed, setting);
  std::vector<TrueState> states{{0.0, seal.condition(), seal.gamma(), seal.steepening_limit()}};
  double further = 0.0;  // what the faster ageing has taken besides
  while (states.back().condition > threshold && seal.month() < kLongestLife_months) {
    const double before = seal.condition();
    seal.advance();
    const bool fast = seal.month() > from;
    const double times = fast ? faster : 1.0;
    further += (times - 1.0) * (before - seal.condition());
    states.push_back({static_cast<double>(seal.month()), fast ? seal.condition() - further : seal.condition(),
                      times * seal.gamma(), times * seal.steepening_limit()});
  }
  return states;
}

/// Between two months the condition falls straight.
double end_of_life(const std::vector<TrueState>& states, double threshold) {
  const std::size_t last = states.size() - 1;
  const double before = states[last - 1].condition;
  return static_cast<double>(last - 1) + (before - threshold) / (before - states[last].condition);
}

forecast::Range scaled(const forecast::Range& range, double times) { return {times * range.min, times * range.max}; }

}  // namespace

std::string_view name_of(Scenario scenario) {
  for (const auto& [one, name] : kNames)
    if (one == scenario) return name;
  return "unknown";
}

Result<Scenario> scenario_named(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& [scenario, its_name] : kNames) {
    if (its_name == name) return scenario;
    known.emplace_back(its_name);
  }
  return fail(
      Error{.file = {}, .place = "--scenario", .value = name, .rule = "is not known", .advice = suggest(name, known)});
}

std::vector<Scenario> all_scenarios() {
  std::vector<Scenario> all;
  for (const auto& [scenario, name] : kNames) all.push_back(scenario);
  return all;
}

ScenarioShares shares_of(Scenario scenario) {
  return {.missing = scenario == Scenario::missing ? kMissingShare : 0.0,
          .cut = scenario == Scenario::aborted ? kCutShare : 0.0};
}

SealLife seal_life(std::uint64_t life_seed, const DegradationSetting& setting, double threshold, Scenario scenario) {
  const std::uint64_t first_seed = bench::sub_seed(life_seed, "seal");  // the stream that plan_life takes
  UniformRandom random(bench::sub_seed(life_seed, "scenario"));
  SealLife life{.months = age(first_seed, setting, threshold, 0.0, 1.0), .law = setting};
  const double undisturbed = end_of_life(life.months, threshold);
  life.end_of_life_months = undisturbed;
  if (scenario == Scenario::replaced) {
    const double drawn = random.between(kFirstReplacement_months, kLastReplacement_months);
    life.change_months = life.installed_months = std::floor(std::min(drawn, kReplacedBefore * undisturbed));
    const auto second = age(bench::sub_seed(life_seed, "second seal"), setting, threshold, 0.0, 1.0);
    life.months.resize(static_cast<std::size_t>(life.change_months) + 1);
    life.months.insert(life.months.end(), second.begin() + 1, second.end());
    life.end_of_life_months = life.installed_months + end_of_life(second, threshold);
  } else if (scenario == Scenario::load_change || scenario == Scenario::contamination) {
    life.change_months = std::floor(random.between(kEarliest, kLatest) * undisturbed);
    if (scenario == Scenario::contamination) {
      life.months = age(first_seed, setting, threshold, life.change_months, kFasterAgeing);
      life.end_of_life_months = end_of_life(life.months, threshold);
      life.law.irregularity = scaled(setting.irregularity, kFasterAgeing);
    }
  }
  if (life.change_months > 0.0) life.scored_from_months = life.change_months + kUnforeseeable_months;
  return life;
}

bench::PlannedTest as_it_comes(bench::PlannedTest test, const ConditionSetting& seal, const SealLife& life,
                               std::uint64_t life_seed, Scenario scenario) {
  test.condition = life.months[static_cast<std::size_t>(test.month)].condition;
  if (scenario == Scenario::outliers) {
    UniformRandom random(bench::sub_seed(life_seed, "outlier of month " + std::to_string(test.month)));
    const bool off = random.unit() < kOutlierShare;
    const double sign = random.unit() < 0.5 ? -1.0 : 1.0;
    if (off) test.condition += sign * random.between(kOutlierLeast, kOutlierMost);
  }
  if (scenario == Scenario::load_change && test.month > life.change_months) test.load_factor += kLoadRise;
  test.resistance_Pa_s_m3 = seal.value(test.condition);
  return test;
}

}  // namespace sealwatch::verification
