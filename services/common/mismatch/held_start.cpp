#include "services/common/mismatch/held_start.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFarOff = 0.1;        // of the spread of a channel
constexpr double kTimeShare = 0.25;    // of the time limit: a start, and no more
constexpr double kHeldSamples = 10.0;  // within so many distances between samples: noise is averaged, little drifts

double held_within_s(const Data& data) {
  double distance_s = 0.0;
  for (const TimeSeries& samples : data.samples)
    distance_s = std::max(
        distance_s, (samples.time_s.back() - samples.time_s.front()) / static_cast<double>(samples.time_s.size() - 1));
  return kHeldSamples * distance_s;
}

// Sensors and the clock decide which course the simulation is held to.
bool acts_in_the_plant(const Law& law) { return !is_sensor(law.kind) && law.kind != SiteKind::clock_rate; }

double misfit_of(const Trial& trial) { return trial.model->misfit / trial.model->residuals; }

// Nearly in proportion, the laws that promise most are those that bring most: few refits do.
// What explains less than half of what is left is asked in free runs.
bool add_best(Trial& found, const Data& held, const ExplainOptions& options) {
  constexpr std::size_t kRefits = 4;
  const auto asked = screen(*found.model, held, {.seed = options.seed, .threads = options.threads});
  if (!asked) return false;
  std::vector<std::vector<LawStart>> starts;
  for (LawStart& start : ranked_laws(*asked, asked->candidates.size(), true))
    if (starts.size() < kRefits && acts_in_the_plant(*start.effect.law)) starts.push_back({std::move(start)});
  const std::vector<Trial> trials = refit(found, starts, held, options.threads);
  if (trials.empty() || share_explained(misfit_of(found), misfit_of(trials.front())) < kExplainedAtLeast) return false;
  found = with_derivatives(trials.front(), held, options.threads);
  return true;
}

// What the simulations are held to, and for how long they are.
Data held_data(const Data& data, const Deadline& until) {
  Data held = data;
  held.held_within_s = held_within_s(data);
  held.weight.clear();  // an input's course between samples adds up in free runs alone
  held.deadline = &until;
  return held;
}

}  // namespace

bool is_far_off(const FittedModel& model) {
  if (excess(model) <= kGross) return false;
  for (Eigen::Index channel = 0; channel < model.problem.recordings.front().noise_std.size(); ++channel) {
    double missed = 0.0, spread = 0.0;
    for (std::size_t k = 0; k < model.problem.recordings.size(); ++k) {
      const auto recorded = model.problem.recordings[k].simulation->recorded().col(channel);
      missed += (recorded - model.optimum.at_optimum[k].simulated.col(channel)).squaredNorm();
      spread += (recorded.array() - recorded.mean()).square().sum();
    }
    if (missed > kFarOff * kFarOff * spread) return true;
  }
  return false;
}

std::optional<Trial> start_from_held(const FittedModel& baseline, const Data& data, const ExplainOptions& options) {
  if (passed(data.deadline)) return std::nullopt;
  Deadline until(options.cancel);
  until.set_in(kTimeShare * options.time_limit_s);
  const Data held = held_data(data, until);
  Result<FittedModel> model = fit_model(baseline.asset, held, &baseline, options.threads);
  if (!model) return std::nullopt;
  Trial found{{}, std::make_shared<const FittedModel>(std::move(*model))};
  while (static_cast<int>(found.effects.size()) < options.maximum_laws && add_best(found, held, options)) {
  }
  if (found.effects.empty()) return std::nullopt;
  Result<FittedModel> free = fit_model(found.model->asset, data, found.model.get(), options.threads);
  if (!free || free->misfit >= baseline.misfit) return std::nullopt;
  return Trial{std::move(found.effects), std::make_shared<const FittedModel>(std::move(*free))};
}

}  // namespace sealwatch::mismatch
