#include "services/common/mismatch/other_shapes.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/like_law.hpp"
#include "services/common/mismatch/plain_laws.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/replacement.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kOtherShapes = 8;  // refits of the best law from other points of its grid,
constexpr std::size_t kFormStarts = 3;   // and of each closed form that bears its id, in a gross misfit;
constexpr std::size_t kNearShapes = 3;   // near the noise the linearised model tells the best points of the grid,
constexpr std::size_t kNearStarts = 1;   // and a form that contains the law begins where that ended
constexpr double kNearly = 0.5;          // of what the best form promises
constexpr std::size_t kStartsOfForm = 2;
constexpr double kAlike = 0.1;           // share of a law's square that a closed form which is a form of it may lack
constexpr double kFar = 100.0;           // times the noise: further off no law's form can be told,
constexpr double kLeftByMost = 0.1;      // but of one that leaves no more of the misfit
constexpr std::size_t kOtherLaws = 4;    // refits in place of a law that was found before another one
constexpr std::size_t kSingleLaws = 10;  // refits of one law for several
constexpr long kStartsOfRich = 6;        // of them of a law that contains a plainer one

// Another form of the law that ended in this place (`term`), or one that contains it: what both have, by name, from
// there, the rest from a point of its own grid.
std::vector<double> from_fitted(const Candidate& form, std::size_t point, const PhysicsTerm& term) {
  std::vector<double> start = usual_size(form, point);
  for (std::size_t k = 0; k < start.size(); ++k)
    if (const auto known = term.parameters.find(std::string(form.law->parameters[k].name));
        known != term.parameters.end())
      start[k] = known->second.value;
  return start;
}

const PlantDescription& plant_of(const FittedModel& model) {
  return model.problem.recordings.front().simulation->plant();
}

// Start values of the law of an effect at its usual size and on its shape's grid; of its other forms, of laws that
// contain it and of the closed forms (`forms`) that bear its id, also from where it ended (`term`); in a gross misfit of
// all closed forms that can do about what it does, from where they do.
std::vector<std::vector<LawStart>> other_starts(const Effect& effect, const PhysicsTerm& term, const Screening& asked,
                                                const std::vector<Candidate>& forms, const FittedModel& model,
                                                bool gross) {
  const std::size_t shapes = gross ? kOtherShapes : kNearShapes, form_starts = gross ? kFormStarts : kNearStarts;
  std::vector<std::vector<LawStart>> starts;
  const auto add = [&](const Candidate& candidate, std::vector<double> parameters) {
    const auto same_start = [&](const std::vector<LawStart>& other) {
      return other.front().effect.law == candidate.law && other.front().parameters == parameters;
    };
    if (std::ranges::none_of(starts, same_start))
      starts.push_back({{{candidate.law, effect.element}, std::move(parameters)}});
  };
  for (const Variant* variant : by_gain(asked)) {
    const Candidate& candidate = asked.candidates[variant->candidate];
    const bool same_or_richer = (forms.empty() ? candidate.law == effect.law : candidate.law->id == effect.law->id) ||
                                candidate.law->limit == effect.law->id;
    if (same_or_richer && candidate.element == effect.element && starts.size() < shapes)
      add(candidate, usual_size(candidate, variant->point));
  }
  for (const Candidate& candidate : asked.candidates)
    for (std::size_t point = 0;
         candidate.element == effect.element && candidate.law->limit == effect.law->id && point < candidate.grid.size();
         ++point)
      add(candidate, from_fitted(candidate, point, term));
  // Near the noise it is a closed form's turn only where all laws leave something (try_closed_forms): it would take the
  // place of a law that the machine follows but for a little.
  const std::vector<double> found = parameters_in(effect, model.asset);
  std::vector<TermPath> paths;
  if (!forms.empty() && !found.empty() && excess(model) > kGross)
    paths = term_paths(model, effect.element, *effect.law, found);
  for (const Candidate& form : forms) {
    if (form.law == effect.law || form.element != effect.element) continue;
    if (const auto like = most_like(form, effect, paths, plant_of(model)); like && like->lacks < kAlike)
      add(form, like->parameters);
    if (form.law->id != effect.law->id) continue;
    add(form, from_fitted(form, 0, term));
    for (std::size_t point = 0; point < std::min(form.grid.size(), form_starts); ++point)
      add(form, usual_size(form, point));
  }
  return starts;
}

// The laws of an element, best first, at their usual size: at the best point of their grid, those that contain another
// law at several, as they can be taken for that one.
std::vector<std::vector<LawStart>> laws_of(const std::string& element, const Screening& asked) {
  std::vector<std::vector<LawStart>> starts;
  for (const Variant* variant : by_gain(asked)) {
    const Candidate& candidate = asked.candidates[variant->candidate];
    const auto known =
        std::ranges::count(starts, candidate.law, [](const auto& one) { return one.front().effect.law; });
    const long most = candidate.law->limit.empty() ? 1 : kStartsOfRich;
    if (candidate.element == element && known < most && starts.size() < kSingleLaws)
      starts.push_back({{.effect = {candidate.law, element},
                         .parameters = usual_size(candidate, variant->point),
                         .promised = variant->gain,
                         .asked_at = asked.misfit}});
  }
  return starts;
}

// Of these starts in place of one law, those of the laws that promise most. Near the noise two forms of a law differ by
// little, and the linear model tells what their difference brings: no more than what the other brings beside it. All of
// them further off.
std::vector<std::vector<LawStart>> most_promising(std::vector<std::vector<LawStart>> starts, const FittedModel& model,
                                                  const Data& data, const ExplainOptions& options) {
  if (starts.empty() || excess(model) > kGross) return starts;
  std::map<const Law*, double> promised;
  for (const std::vector<LawStart>& start : starts) promised[start.front().effect.law] = 0.0;
  std::vector<Candidate> laws;
  for (Candidate& law : find_candidates(*model.problem.recordings.front().simulation, {}, Laws::all))
    if (promised.contains(law.law) && law.element == starts.front().front().effect.element)
      laws.push_back(std::move(law));
  const auto beside =
      screen_laws(model, std::move(laws), data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!beside) return starts;
  for (const Variant& variant : beside->variants) {
    double& most = promised.at(beside->candidates[variant.candidate].law);
    most = std::max(most, variant.gain);
  }
  double least = kCannotTell * dispersion(model) / kOptimistic;
  for (const auto& [law, gain] : promised) least = std::max(least, kNearly * gain);
  std::map<const Law*, std::size_t> kept;
  std::erase_if(starts, [&](const std::vector<LawStart>& start) {
    const Law* law = start.front().effect.law;
    return promised.at(law) < least || kept[law]++ >= kStartsOfForm;
  });
  return starts;
}

// Starts of refits with another law in the place of one, elsewhere. Near the noise the linear model of the whole tells
// which may do as well; further off those are asked that promise most beside the other laws.
struct InPlace {
  const Trial* from = nullptr;
  std::vector<std::vector<LawStart>> starts;
  RefitOptions options;
};
InPlace elsewhere_in_place_of(std::size_t slot, const Naming& naming) {
  const Replacement replacement(naming.best, {slot});
  std::vector<StandIn> near;
  for (const Candidate& candidate : naming.last.candidates) {
    if (candidate.element == naming.best.effects[slot].element) continue;
    auto stand_in = replacement.stand_in(naming.last, {candidate.law, candidate.element});
    if (stand_in && replacement.may_do_as_well(*stand_in)) near.push_back(std::move(*stand_in));
  }
  std::ranges::stable_sort(near, {}, &StandIn::rise);
  InPlace in_place{&naming.best, {}, {.in_place_of = {slot}, .sized = true}};
  for (StandIn& stand_in : near)
    if (in_place.starts.size() < kOtherLaws) in_place.starts.push_back({std::move(stand_in.start)});
  return in_place;
}
InPlace elsewhere_beside(const Trial& fewer, std::size_t slot, const Naming& naming, const Data& data,
                         const ExplainOptions& options) {
  InPlace in_place{&fewer, {}, {}};
  const auto left = screen(*fewer.model, data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!left) return in_place;
  for (LawStart& start : ranked_laws(causes_in(*left, *fewer.model), kOtherLaws + kSingleLaws))
    if (start.effect.element != naming.best.effects[slot].element && in_place.starts.size() < kOtherLaws)
      in_place.starts.push_back({std::move(start)});
  return in_place;
}

std::string laws_in_words(const std::vector<Effect>& effects) {
  std::vector<std::string> laws;
  for (const Effect& effect : effects) laws.push_back(law_in_words(effect));
  return joined(laws, " and ");
}

// A first round in a gross misfit has none: such a model is no match for one that has them.
std::ptrdiff_t known_values_in(const FittedModel& model) {
  return std::ranges::count_if(model.problem.shared, [](const Unknown& unknown) { return unknown.is_known(); });
}

// An asset that lacks a law of `whole`. Where it misses grossly after some steps, and `whole` does not, the law is needed:
// the rest of its search would only tell how much.
Result<FittedModel> fit_less(const AssetConfig& asset, const Data& data, const FittedModel& whole, int threads) {
  constexpr int kSteps = 10;
  Result<FittedModel> model = fit_model(asset, data, &whole, threads, kSteps);
  if (!model || model->optimum.converged || (excess(whole) <= kGross && excess(*model) > kGross)) return model;
  return continue_fit(*model, data, threads, kSearchIterations - kSteps);
}

// What was fitted already from the same values, wherever that ended, or converged from others; null: nothing.
Trial* known_without(Naming& naming, const FittedModel& whole, const std::vector<Effect>& effects) {
  Trial* known = nullptr;
  const auto consider = [&](Trial& one) {
    if (one.model->optimum.converged && same_effects(one.effects, effects) &&
        known_values_in(*one.model) == known_values_in(whole) &&
        (known == nullptr || one.model->misfit < known->model->misfit))
      known = &one;
  };
  for (Trial& one : naming.trials) consider(one);
  for (WithoutLaw& one : naming.fewer) {
    if (one.whole.get() == &whole && same_effects(one.fewer.effects, effects)) return &one.fewer;
    consider(one.fewer);
  }
  return known;
}

// Forms of the same laws, or laws that contain these.
bool has_same_ids(const std::vector<Effect>& forms, const std::vector<Effect>& laws) {
  return std::ranges::all_of(forms, [&](const Effect& form) {
    return std::ranges::any_of(laws, [&](const Effect& law) {
      return form.element == law.element && (form.law->id == law.law->id || form.law->limit == law.law->id);
    });
  });
}

}  // namespace

bool is_at_the_noise(const Naming& naming, const ExplainOptions& options) {
  const FittedModel& model = *naming.best.model;
  return model.misfit < kAtTheNoise * model.residuals && !differs(naming.last.p_value, model, options.false_alarm_rate);
}

std::optional<Trial> without_law(Naming& naming, const Trial& trial, std::size_t slot, const Data& data, int threads) {
  Trial fewer{.effects = trial.effects, .model = nullptr};
  fewer.effects.erase(fewer.effects.begin() + static_cast<std::ptrdiff_t>(slot));
  if (fewer.effects.empty()) return Trial{{}, naming.baseline};
  if (Trial* known = known_without(naming, *trial.model, fewer.effects))
    return *known = with_derivatives(*known, data, threads);
  AssetConfig asset = trial.model->asset;
  asset.physics.erase(asset.physics.end() - static_cast<std::ptrdiff_t>(trial.effects.size() - slot));
  Result<FittedModel> model = fit_less(asset, data, *trial.model, threads);
  if (!model) return std::nullopt;
  fewer.model = std::make_shared<const FittedModel>(std::move(*model));
  if (!passed(data.deadline)) naming.fewer.push_back({trial.model, fewer});
  return fewer;
}

Result<Screening> look(Naming& naming, const std::shared_ptr<const FittedModel>& model, const Data& data,
                       const ExplainOptions& options) {
  if (naming.looked_at == model) return naming.seen;
  Result<Screening> screening = screen(*model, data, {.seed = options.seed, .threads = options.threads});
  if (!screening) return screening;
  naming.looked_at = model;
  naming.seen = *screening;
  return screening;
}

bool take(Naming& naming, const Trial& trial, const Data& data, const ExplainOptions& options) {
  Trial taken = with_derivatives(polished(trial, data, options.threads), data, options.threads);
  naming.trials.push_back(taken);
  Result<Screening> next = look(naming, taken.model, data, options);
  if (!next && passed(data.deadline)) {
    naming.not_asked.emplace_back("what the best of them leaves");
    naming.best = std::move(taken);
    return true;
  }
  if (!next) {
    naming.remarks.push_back("A model with " + laws_in_words(taken.effects) +
                             " fits better, but what it leaves cannot be looked at (" + reason_in_words(next.error()) +
                             "): it is not claimed, and the search ended there.");
    return false;
  }
  naming.best = std::move(taken);
  naming.last = std::move(*next);
  return true;
}

std::vector<Trial> causes_among(std::vector<Trial> trials, const Trial& from) {
  double least = from.model->misfit;
  for (const Trial& trial : trials) least = std::min(least, trial.model->misfit);
  std::erase_if(trials, [&](const Trial& trial) {
    const bool measured =
        trial.effects.size() == from.effects.size() + 1 && is_of_measurement(trial.effects.back().law->kind);
    return measured && takes_up_little(*from.model, *trial.model, least);
  });
  return trials;
}

double smallest_dispersion(const std::vector<Trial>& trials, const FittedModel& model) {
  double phi = dispersion(model);
  for (const Trial& trial : trials) phi = std::min(phi, dispersion(*trial.model));
  return phi;
}

void from_other_shapes(Naming& naming, const Trial& before, const Screening& asked, const Data& data,
                       const ExplainOptions& options) {
  if (is_at_the_noise(naming, options)) return;
  // Where everything misses by far, another form of one law that takes little says nothing.
  std::vector<Candidate> forms;
  if (excess(*naming.best.model) < kFar || naming.best.model->misfit < kLeftByMost * before.model->misfit)
    forms = find_candidates(*naming.baseline->problem.recordings.front().simulation, naming.baseline->asset.physics,
                            Laws::closed_forms);
  std::vector<Trial> trials;
  const bool gross = excess(*before.model) > kGross;
  for (std::size_t added = before.effects.size(); added < naming.best.effects.size(); ++added) {
    const auto& physics = naming.best.model->asset.physics;
    const PhysicsTerm& term = physics[physics.size() - naming.best.effects.size() + added];
    const auto starts =
        most_promising(other_starts(naming.best.effects[added], term, asked, forms, *naming.best.model, gross),
                       *naming.best.model, data, options);
    for (Trial& trial : refit(naming.best, starts, data, options.threads,
                              {.in_place_of = {added}, .to_beat = naming.best.model->misfit}))
      trials.push_back(std::move(trial));
  }
  const double phi = smallest_dispersion(trials, *naming.best.model);
  // A law that has a name keeps it, unless one without does clearly better.
  std::erase_if(trials, [&](const Trial& trial) {
    return !has_same_ids(trial.effects, naming.best.effects) &&
           criterion(*trial.model, phi) > criterion(*naming.best.model, phi) - kWorthAnother;
  });
  const Trial* best = best_of(trials, phi);
  // In a gross misfit the criterion hardly rises: any gain counts, as no law comes in.
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi)) return;
  static_cast<void>(take(naming, *best, data, options));  // else the form that was found first stays
}

void another_law_for_each(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (naming.best.effects.size() < 2 || is_at_the_noise(naming, options)) return;
  const bool near = excess(*naming.best.model) <= kGross;
  std::vector<Trial> trials;
  for (std::size_t slot = 0; slot + 1 < naming.best.effects.size(); ++slot) {
    InPlace in_place = near ? elsewhere_in_place_of(slot, naming) : InPlace{};
    if (near && in_place.starts.empty()) continue;
    const std::optional<Trial> fewer = without_law(naming, naming.best, slot, data, options.threads);
    if (!fewer) continue;
    naming.trials.push_back(*fewer);
    if (!near) in_place = elsewhere_beside(*fewer, slot, naming, data, options);
    in_place.options.to_beat = naming.best.model->misfit;
    std::vector<Trial> others = refit(*in_place.from, in_place.starts, data, options.threads, in_place.options);
    for (Trial& trial : causes_among(std::move(others), *fewer)) trials.push_back(std::move(trial));
  }
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  const double phi = smallest_dispersion(trials, *naming.best.model);
  const Trial* best = best_of(trials, phi);
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi)) return;
  static_cast<void>(take(naming, *best, data, options));
}

void compete_again(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (naming.best.effects.size() != 1 || excess(*naming.best.model) > kGross || is_at_the_noise(naming, options))
    return;
  const Effect& found = naming.best.effects.front();
  std::vector<std::vector<LawStart>> starts;
  for (LawStart& start : ranked_laws(causes_in(naming.first, *naming.baseline), kOtherLaws))
    if (start.effect.law != found.law || start.effect.element != found.element) starts.push_back({std::move(start)});
  const std::vector<Trial> trials =
      refit(naming.best, starts, data, options.threads, {.in_place_of = {0}, .to_beat = naming.best.model->misfit});
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  const double phi = smallest_dispersion(trials, *naming.best.model);
  const Trial* best = best_of(trials, phi);
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi)) return;
  static_cast<void>(take(naming, *best, data, options));
}

void one_law_for_several(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (excess(*naming.best.model) > kGross) return;
  std::set<std::string> elements;
  for (const Effect& effect : naming.best.effects) elements.insert(effect.element);
  std::vector<Trial> trials;
  for (const std::string& element : elements) {
    std::vector<std::size_t> several;
    for (std::size_t k = 0; k < naming.best.effects.size(); ++k)
      if (naming.best.effects[k].element == element) several.push_back(k);
    if (several.size() < 2) continue;
    for (Trial& trial : refit(naming.best, laws_of(element, naming.first), data, options.threads,
                              {.in_place_of = several, .to_beat = naming.best.model->misfit}))
      trials.push_back(std::move(trial));
  }
  const Trial* best = best_of(trials, smallest_dispersion(trials, *naming.best.model));
  if (best == nullptr) return;
  const Trial one = polished(*best, data, options.threads);
  const double phi = smallest_dispersion({one}, *naming.best.model);
  if (criterion(*one.model, phi) > criterion(*naming.best.model, phi) + kWorthAnother) return;
  static_cast<void>(take(naming, one, data, options));  // else the several stay
}

}  // namespace sealwatch::mismatch
