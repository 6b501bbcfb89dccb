#include "services/common/mismatch/held_start.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <string>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/usual_ranges.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFarOff = 0.1;      // of the spread of a channel
constexpr double kTimeShare = 0.25;  // of the time limit: a start, and no more
constexpr int kIterations = 8;       // to see whether simulations come nearer where they are held, or go on from there
constexpr double kEnoughRows = 8000.0;
// Within so many distances between samples: what adds up slowly shows; where that is still far off, noise is averaged and
// little drifts; and where the plant swings faster than that, a few samples still see it swing.
constexpr double kLoosely = 100.0, kTightly = 10.0, kMostTightly = 3.0;

double distance_s(const Data& data) {
  double longest_s = 0.0;
  for (const TimeSeries& samples : data.samples)
    longest_s = std::max(
        longest_s, (samples.time_s.back() - samples.time_s.front()) / static_cast<double>(samples.time_s.size() - 1));
  return longest_s;
}

// Sensors and the clock decide which course the simulation is held to.
bool acts_in_the_plant(const Law& law) { return !is_sensor(law.kind) && law.kind != SiteKind::clock_rate; }

double misfit_of(const FittedModel& model) { return model.misfit / model.residuals; }

// Nearly in proportion, the laws that promise most are those that bring most, and pairs of them, too: few refits do.
std::vector<std::vector<LawStart>> most_promising(const Screening& asked, const Trial& found, int maximum_laws) {
  constexpr std::size_t kRefits = 4;
  std::vector<std::vector<LawStart>> starts;
  for (LawStart& start : ranked_laws(asked, asked.candidates.size(), true))
    if (starts.size() < kRefits && acts_in_the_plant(*start.effect.law)) starts.push_back({std::move(start)});
  if (static_cast<int>(found.effects.size()) + 2 <= maximum_laws)
    std::ranges::move(ranked_pairs(asked, found.model->misfit, false), std::back_inserter(starts));
  return starts;
}

bool are_listed(const std::vector<LawStart>& laws) {
  return std::ranges::none_of(laws, [](const LawStart& law) { return law.effect.law->closed_form; });
}

// What the simulations are held to, within so many samples, and until when.
Data held_data(const Data& data, double samples, const Deadline& until) {
  Data held = data;
  held.held_within_s = samples * distance_s(data);
  held.weight.clear();  // an input's course between samples adds up in free runs alone
  held.deadline = &until;
  return held;
}

// Whether a channel is missed by more than a tenth of its own course, far beyond its noise.
bool is_far_off(const FittedModel& model) {
  struct Sums {
    double missed = 0.0, spread = 0.0, noise = 0.0;
  };
  std::map<std::string, Sums> sums;  // of channels: recordings need not have the same
  for (std::size_t k = 0; k < model.problem.recordings.size(); ++k) {
    const PemRecording& recording = model.problem.recordings[k];
    const RowMatrix& recorded = recording.simulation->recorded();
    for (Eigen::Index c = 0; c < recorded.cols(); ++c) {
      if (!std::isfinite(recording.noise_std(c))) continue;
      Sums& sum = sums[recording.simulation->channels()[static_cast<std::size_t>(c)]];
      sum.missed += (recorded.col(c) - model.optimum.at_optimum[k].simulated.col(c)).squaredNorm();
      sum.spread += (recorded.col(c).array() - recorded.col(c).mean()).square().sum();
      sum.noise += static_cast<double>(recorded.rows()) * std::pow(recording.noise_std(c), 2);
    }
  }
  return std::ranges::any_of(sums, [](const auto& channel) {
    const Sums& sum = channel.second;
    return sum.missed > kFarOff * kFarOff * sum.spread && sum.missed > kGross * sum.noise;
  });
}

// Of recordings that are missed by far, some show what is missing as well as all: those that are missed most, until
// they have rows enough. Windows are few enough already.
std::vector<std::size_t> missed_most(const FittedModel& model, const Data& data) {
  std::vector<std::size_t> places(data.samples.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  if (!data.groups.empty()) return places;
  const auto misses = [&](std::size_t k) { return model.optimum.at_optimum[k].residual.squaredNorm(); };
  std::ranges::stable_sort(places, std::greater<>(), misses);
  double rows = 0.0;
  const auto enough = std::ranges::find_if(places, [&](std::size_t k) {
    return (rows += static_cast<double>(data.samples[k].time_s.size())) >= kEnoughRows;
  });
  if (enough != places.end()) places.erase(enough + 1, places.end());
  std::ranges::sort(places);
  return places;
}

Data some_of(Data data, const std::vector<std::size_t>& places) {
  for (std::size_t k = data.samples.size(); k-- > 0;)
    if (!std::ranges::binary_search(places, k)) data = without(data, k);
  return data;
}

// Of all recordings their places among some, or none of these.
std::vector<std::size_t> among(const std::vector<std::size_t>& places, const Data& data) {
  std::vector<std::size_t> back(data.samples.size(), places.size());
  for (std::size_t k = 0; k < places.size(); ++k) back[places[k]] = k;
  return back;
}

// Fitted to the recordings while it is held, as loosely as leaves it near; nothing where even held tightly it comes no
// nearer: too little of its state is measured. What the free run's fit bent its parameters to is no start to judge by.
// Windows set out from what was measured, and are held loosely by that: only where they are far off, and near at once
// when they are held tightly.
struct Held {
  Data data;
  FittedModel model;
};
std::optional<Held> hold(const FittedModel& baseline, const Data& data, const Deadline& until, int threads) {
  const bool in_windows = !data.groups.empty();
  if (in_windows && !is_far_off(baseline)) return std::nullopt;
  for (const double samples : {kLoosely, kTightly, kMostTightly}) {
    if (in_windows && samples != kTightly) continue;
    Data held = held_data(data, samples, until);
    Result<FittedModel> model = fit_model(baseline.asset, held, &baseline, threads, in_windows ? 0 : kIterations);
    if (!model) continue;
    const bool nearer = share_explained(misfit_of(baseline), misfit_of(*model)) >= kExplainedAtLeast;
    if (!is_far_off(*model) || (samples < kLoosely && nearer && !in_windows))
      return Held{std::move(held), std::move(*model)};
  }
  return std::nullopt;
}

// The search with simulations held. Its deadline is that of one list of laws.
class HeldSearch {
 public:
  HeldSearch(const FittedModel& baseline, const Data& data, const ExplainOptions& options)
      : baseline_(baseline),
        data_(data),
        options_(options),
        until_(options.cancel),
        places_(missed_most(baseline, data)) {}

  HeldStart run() {
    allow_its_share();
    const std::optional<Trial> nothing = held_without_laws();
    if (!nothing) return {};
    // Where the baseline ended in a local minimum, laws would make up for its values.
    if (HeldStart better = running_free(*nothing, kIterations); better.trial) return better;
    Trial found = laws_beside(*nothing, Laws::listed);
    // Where listed laws leave anything, a curve without a mechanism may show it all, and listed ones only parts of it.
    if (excess(*found.model) > kAtTheNoise) {
      allow_its_share();
      Trial forms = laws_beside(*nothing, Laws::all);
      if (share_explained(misfit_of(*found.model), misfit_of(*forms.model)) >= kExplainedAtLeast)
        found = std::move(forms);
    }
    return found.effects.empty() ? HeldStart{.trial = {}, .was_cut = was_cut_}
                                 : running_free(std::move(found), kSearchIterations);
  }

 private:
  void allow_its_share() {
    until_.set_in(std::min(kTimeShare * options_.time_limit_s,
                           data_.deadline == nullptr ? options_.time_limit_s : data_.deadline->left_s()));
  }

  // As in a first round (refit): tolerances, which bend to what is missing, come with the free run.
  std::optional<Trial> held_without_laws() {
    AsKnown plain = as_known(baseline_.asset, data_);
    const Data some = some_of(std::move(plain.data), places_);
    const Result<FittedModel> there = fit_to_some(baseline_, plain.asset, some, places_, options_.threads, 0);
    if (!there) return std::nullopt;
    std::optional<Held> held = hold(*there, some, until_, options_.threads);
    if (!held) return std::nullopt;
    held_ = std::move(held->data);
    FittedModel model = beyond_usual_ranges(std::move(held->model), held_, options_.threads);
    return polished({{}, std::make_shared<const FittedModel>(std::move(model))}, held_, options_.threads);
  }

  Trial laws_beside(Trial trial, Laws laws) {
    while (excess(*trial.model) > kAtTheNoise && static_cast<int>(trial.effects.size()) < options_.maximum_laws &&
           add_best(trial, laws)) {
    }
    was_cut_ = was_cut_ || until_.was_met();
    return trial;
  }

  // What explains less than half of what is left is asked in free runs; what does not run free (friction that falls
  // steeply with speed, and chatters) is no start.
  bool add_best(Trial& found, Laws laws) {
    const std::vector<Trial> trials = refits_beside(found, laws);
    const auto best = std::ranges::find_if(trials, [&](const Trial& trial) {
      return share_explained(misfit_of(*found.model), misfit_of(*trial.model)) >= kExplainedAtLeast && runs_free(trial);
    });
    if (best == trials.end()) return false;
    found = with_derivatives(*best, held_, options_.threads);
    return true;
  }

  // Best first. Listed laws that nothing is beside are refitted once, also where closed forms compete with them.
  std::vector<Trial> refits_beside(const Trial& found, Laws laws) {
    const auto asked =
        screen(*found.model, held_, {.draws = 1, .seed = options_.seed, .threads = options_.threads, .laws = laws});
    if (!asked) return {};
    std::vector<std::vector<LawStart>> starts = most_promising(*asked, found, options_.maximum_laws);
    const bool known = laws == Laws::all && found.effects.empty();
    if (known) std::erase_if(starts, are_listed);
    std::vector<Trial> trials = refit(found, starts, held_, options_.threads, {.first_round_only = true});
    if (known) {
      trials.insert(trials.end(), listed_.begin(), listed_.end());
      std::ranges::stable_sort(trials, {}, [](const Trial& trial) { return trial.model->misfit; });
    } else if (found.effects.empty()) {
      listed_ = trials;
    }
    return trials;
  }

  // As in a first round, with fixed values as they are known. Nothing where the first simulation fails.
  [[nodiscard]] Result<FittedModel> free_run_of(const Trial& trial, int iterations) const {
    const AsKnown plain = as_known(trial.model->asset, data_);
    return fit_to_some(*trial.model, plain.asset, plain.data, among(places_, data_), options_.threads, iterations);
  }
  [[nodiscard]] bool runs_free(const Trial& trial) const { return free_run_of(trial, 0).has_value(); }

  [[nodiscard]] HeldStart running_free(Trial found, int iterations) const {
    HeldStart start{.trial = {}, .was_cut = was_cut_};
    const Result<FittedModel> free = free_run_of(found, iterations);
    if (!free) return start;
    Result<FittedModel> model = fit_model(free->asset, data_, &*free, options_.threads);
    if (model && share_explained(misfit_of(baseline_), misfit_of(*model)) >= kExplainedAtLeast)
      start.trial = Trial{.effects = std::move(found.effects),
                          .model = std::make_shared<const FittedModel>(std::move(*model)),
                          .is_start = true};
    return start;
  }

  const FittedModel& baseline_;
  const Data& data_;
  const ExplainOptions& options_;
  Deadline until_;
  std::vector<std::size_t> places_;
  Data held_;
  std::vector<Trial> listed_;  ///< listed laws that nothing is beside
  bool was_cut_ = false;
};

}  // namespace

HeldStart start_from_held(const FittedModel& baseline, const Data& data, const ExplainOptions& options) {
  return HeldSearch(baseline, data, options).run();
}

}  // namespace sealwatch::mismatch
