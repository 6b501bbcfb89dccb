#include "services/common/mismatch/effects.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "sealwatch/forecast/fleet_population.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/replacement.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/standard_errors.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kAlternatives = 5;  // refits in the place of an effect
constexpr std::size_t kAskedToCarryOver = 3;

bool same(const Effect& a, const Effect& b) { return a.law == b.law && a.element == b.element; }

// The same law at the plant's other elements of that kind (the other chamber, the other valve), with the shape at which the
// search ended here and the strengths that the linear model gives it there (behind a gear a torque is another): from its
// own linear step that twin's refit may have ended in a local minimum, and the place would look certain.
std::vector<Candidate> twins_of(const Trial& best, std::size_t slot) {
  const Effect& effect = best.effects[slot];
  if (effect.law->evaluate == nullptr) return {};
  std::vector<double> found;
  for (const PhysicsTerm& term : best.model->asset.physics) {
    if (term.id != effect.law->id || term.element != effect.element) continue;
    found.clear();
    for (const LawParameter& parameter : effect.law->parameters)
      if (const auto setting = term.parameters.find(std::string(parameter.name)); setting != term.parameters.end())
        found.push_back(setting->second.value);
    if (found.size() == effect.law->parameters.size()) break;  // that form of the law
  }
  if (found.size() != effect.law->parameters.size()) return {};
  std::vector<Candidate> twins = find_candidates(*best.model->problem.recordings.front().simulation, {},
                                                 effect.law->closed_form ? Laws::closed_forms : Laws::listed);
  std::erase_if(twins, [&](const Candidate& candidate) {
    const auto is_it = [&](const Effect& one) { return one.law == candidate.law && one.element == candidate.element; };
    return candidate.law != effect.law || std::ranges::any_of(best.effects, is_it);
  });
  for (Candidate& twin : twins) twin.grid = {found};
  return twins;
}

// Whether a search that was ended early, as another had come further, may yet come as far as the best, near the noise.
bool may_come_as_far(const FittedModel& model, const FittedModel& best) {
  const double as_far = best.misfit + kCannotTell * dispersion(best);
  return excess(best) <= kGross && !model.optimum.converged && model.misfit > as_far && could_reach(model) <= as_far;
}

// Laws in the place of the effect `slot` that the search has not asked there. Near the noise they set out from the best
// model, each with the strengths at which it does there what the effect did, and what comes nowhere near that on the linear
// model is left out; in a gross misfit from the model without the effect.
std::vector<Trial> rivals_of(const Trial& best, std::size_t slot, const Trial& fewer,
                             const std::vector<LawStart>& asked, const Data& data, const ExplainOptions& options) {
  const double to_beat = best.model->misfit;
  std::vector<Candidate> twins = twins_of(best, slot);
  if (excess(*best.model) <= kGross) {
    for (Candidate& law : candidates_of(asked, *best.model))
      if (law.law != best.effects[slot].law) twins.push_back(std::move(law));
    return refit(best, stand_ins(best, {slot}, std::move(twins), data, options), data, options.threads,
                 {.in_place_of = {slot}, .sized = true, .to_beat = to_beat});
  }
  std::vector<std::vector<LawStart>> starts;
  for (const LawStart& law : asked) starts.push_back({law});
  const ScreeningOptions once{.draws = 1, .seed = options.seed, .threads = options.threads};
  if (const auto linear = twins.empty() ? fail("") : screen_laws(*fewer.model, twins, data, once))
    for (LawStart& twin : ranked_laws(*linear, twins.size(), true)) starts.push_back({std::move(twin)});
  return refit(fewer, starts, data, options.threads, {.again_smaller = true, .to_beat = to_beat});
}

// Trials that differ from `best` in the effect `slot` alone; `fewer`: the model without that effect, where there is one.
std::vector<Trial> alternatives_of(const Naming& naming, const Trial& best, std::size_t slot,
                                   const std::optional<Trial>& fewer, const Data& data, const ExplainOptions& options) {
  std::vector<Effect> others = best.effects;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(slot));
  std::vector<Trial> found;
  for (const Trial& trial : naming.trials) {
    if (trial.effects.size() != best.effects.size() || trial.model == best.model) continue;
    std::vector<Effect> first(trial.effects.begin(), trial.effects.end() - 1);
    if (same_effects(first, others))
      found.push_back(may_come_as_far(*trial.model, *best.model) ? polished(trial, data, options.threads) : trial);
  }
  if (!fewer) return found;
  // A search that began with this law, or with others beside it, has not asked for all of them in its place.
  const Result<Screening> without =
      others.empty() ? naming.first
                     : screen(*fewer->model, data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!without) return found;
  std::vector<LawStart> asked = ranked_laws(*without, kAlternatives);
  std::erase_if(asked, [&](const LawStart& law) {
    const auto is_it = [&](const Trial& trial) { return same(trial.effects.back(), law.effect); };
    return same(law.effect, best.effects[slot]) || std::ranges::any_of(found, is_it);
  });
  for (Trial& trial : rivals_of(best, slot, *fewer, asked, data, options)) {
    constexpr double kNear = 1.01;  // times the misfit: further off a law is told apart without its last iterations
    const bool near = trial.model->misfit < kNear * best.model->misfit;
    found.push_back(near ? polished(std::move(trial), data, options.threads) : std::move(trial));
  }
  return found;
}

// A strength is known no better than the simulation's own errors allow (k_0), whatever its standard error.
std::vector<FoundParameter> parameters_of(const Effect& effect, const FittedModel& model,
                                          const std::vector<double>& errors, const Resolution& resolution) {
  std::vector<FoundParameter> parameters;
  for (const LawParameter& parameter : effect.law->parameters) {
    const std::string name = physics_parameter_name(effect.element, effect.law->id, parameter.name);
    FoundParameter found{.name = std::string(parameter.name),
                         .unit = unit_of(parameter, effect.element, *resolution.plant)};
    for (const PhysicsTerm& term : model.asset.physics)
      if (term.id == effect.law->id && term.element == effect.element)
        if (const auto setting = term.parameters.find(found.name); setting != term.parameters.end())
          found.value = setting->second.value;
    for (std::size_t k = 0; k < errors.size(); ++k) {
      if (model.problem.shared[k].name != name) continue;
      const double feigned = parameter.strength ? resolution.of(parameter, outputs_moved_by(model, k)) : 0.0;
      found.std_error = std::hypot(errors[k], feigned);
      found.at_bound = at_bound(model.problem.shared[k], model.optimum.point.shared[k]);
    }
    parameters.push_back(std::move(found));
  }
  return parameters;
}

// A sensor's bias goes by its channel's range, which its candidate knows.
double engineering_share(const FoundEffect& effect, const Effect& chosen, const std::vector<Candidate>& candidates,
                         const PlantDescription& plant) {
  const Law& law = *chosen.law;
  for (std::size_t k = 0; k < law.parameters.size(); ++k)
    if (law.parameters[k].strength && law.parameters[k].significant > 0.0)
      return std::abs(effect.parameters[k].value) / sealwatch::significant_size(plant, law.parameters[k]);
  for (const Candidate& candidate : candidates) {
    if (candidate.law != chosen.law || candidate.element != chosen.element) continue;
    const double size = significant_size(candidate, plant);
    if (size > 0.0) return std::abs(effect.parameters[strengths_of(law).front()].value) / size;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

constexpr const char* kContains =
    "It contains the chosen law, and what it adds does not improve the fit: no recording can exclude it.";

// What a difference of the criterion means to a reader.
std::string is_worse_by(double behind) {
  return "is worse by " + number(behind) +
         " (the criterion: misfit plus a penalty for each parameter; 12 is decisive).";
}

// How far each alternative stands behind the best by the criterion. In a gross misfit that is no proof: the nearest
// laws do not count as behind where they predict recordings that took no part as well.
std::vector<double> how_far_behind(const std::vector<Trial>& alternatives, const Trial& best, double phi,
                                   const CarryOver* carry_over) {
  std::vector<double> behind;
  for (const Trial& trial : alternatives) behind.push_back(criterion(*trial.model, phi) - criterion(*best.model, phi));
  if (carry_over == nullptr) return behind;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < alternatives.size(); ++k)
    if (behind[k] >= kCannotTell) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return behind[k]; });
  std::vector<const Effect*> asked;
  for (const std::size_t k : order) {
    const Effect& effect = alternatives[k].effects.back();
    if (std::ranges::any_of(asked, [&](const Effect* one) { return same(*one, effect); })) continue;
    if (asked.size() == kAskedToCarryOver) break;
    asked.push_back(&effect);
    if (carry_over->predicts_as_well(alternatives[k], best)) behind[k] = 0.0;
  }
  return behind;
}

// The plainer law that the chosen one contains.
const Law* plainer(const Law& law) {
  const auto plain = std::ranges::find_if(all_laws(), [&](const Law& one) { return one.id == law.limit; });
  return law.limit.empty() || plain == all_laws().end() ? nullptr : &*plain;
}

// Probabilities from the criterion: exp(-difference / 2) over all laws tried in this place. `not_asked`: a law that there
// was no time to try.
void weigh(FoundEffect& effect, const Effect& chosen, const std::vector<Trial>& alternatives,
           const std::vector<double>& how_far, double best_misfit, double phi, const Law* not_asked,
           const PlantDescription& plant) {
  std::map<std::pair<std::string, std::string>, double> weight;  // by id and element
  weight[{effect.what.id, effect.what.element}] = 1.0;
  std::map<std::pair<std::string, std::string>, double> nearest;
  for (std::size_t k = 0; k < alternatives.size(); ++k) {
    const Trial& trial = alternatives[k];
    const Effect& other = trial.effects.back();
    const double behind = how_far[k];
    // A richer law of the same element that fits no worse cannot be excluded by data, only by thrift.
    const bool contains =
        other.element == effect.what.element && !other.law->closed_form && trial.model->misfit <= best_misfit + phi;
    const bool cannot_tell = behind < kCannotTell || contains;
    const std::pair key{std::string(other.law->id), other.element};
    if (key.first == effect.what.id && key.second == effect.what.element) {
      const auto same_form = [&](const LawAt& law) { return law.id == key.first && law.form == other.law->form; };
      if (other.law != chosen.law && cannot_tell && std::ranges::none_of(effect.indistinguishable, same_form))
        effect.indistinguishable.push_back(law_at(other, plant));
      continue;
    }
    weight[key] += std::exp(-0.5 * std::clamp(behind, 0.0, 1400.0));
    if (!nearest.contains(key) || behind < nearest[key]) nearest[key] = behind;
    const auto listed = [&](const LawAt& law) { return law.id == key.first && law.element == key.second; };
    if (cannot_tell && std::ranges::none_of(effect.indistinguishable, listed)) {
      effect.indistinguishable.push_back(law_at(other, plant));
      if (other.element != effect.what.element) effect.same_elements.push_back(other.element);
    }
    // A law that was refitted from several starts is one alternative: where it came nearest.
    const auto same_law = [&](const Alternative& one) {
      return one.what.id == other.law->id && one.what.form == other.law->form && one.what.element == other.element;
    };
    if (const auto twice = std::ranges::find_if(effect.alternatives, same_law); twice != effect.alternatives.end()) {
      if (twice->misfit_above_best <= std::max(behind, 0.0)) continue;
      effect.alternatives.erase(twice);
    }
    effect.alternatives.push_back({.what = law_at(other, plant),
                                   .misfit_above_best = std::max(behind, 0.0),
                                   .why_not = behind < kCannotTell
                                                  ? "These recordings cannot distinguish it from the chosen law."
                                              : contains ? kContains
                                              : trial.model->optimum.out_of_reach
                                                  ? "Stopped when it could no longer win, it " + is_worse_by(behind)
                                                  : "Refitted in its place, it " + is_worse_by(behind)});
  }
  if (not_asked != nullptr && !weight.contains({std::string(not_asked->id), chosen.element})) {
    weight[{std::string(not_asked->id), chosen.element}] = 1.0;
    effect.indistinguishable.push_back(law_at({not_asked, chosen.element}, plant));
    effect.alternatives.push_back({.what = effect.indistinguishable.back(),
                                   .misfit_above_best = 0.0,
                                   .why_not = "Not tried, as time was up: the chosen law contains it."});
  }
  double all = 0.0, element = 0.0;
  for (const auto& [key, share] : weight) {
    all += share;
    if (key.second == effect.what.element) element += share;
  }
  effect.probability = std::min(1.0 / all, kNeverCertain);
  effect.element_probability = std::min(element / all, kNeverCertain);
  std::ranges::stable_sort(effect.alternatives, {}, &Alternative::misfit_above_best);
  std::ranges::sort(effect.same_elements);
  effect.same_elements.erase(std::unique(effect.same_elements.begin(), effect.same_elements.end()),
                             effect.same_elements.end());
}

}  // namespace

LawAt law_at(const Effect& effect, const PlantDescription& plant) {
  return {.id = std::string(effect.law->id),
          .form = std::string(effect.law->form),
          .element = effect.element,
          .law = in_sizes_of(plant, *effect.law, effect.law->equation),
          .meaning = std::string(effect.law->meaning)};
}

std::string law_in_words(const Effect& effect) {
  return law_in_words(
      LawAt{.id = std::string(effect.law->id), .form = {}, .element = effect.element, .law = {}, .meaning = {}});
}

bool same_effects(const std::vector<Effect>& a, const std::vector<Effect>& b) {
  return a.size() == b.size() && std::ranges::all_of(a, [&](const Effect& one) {
           return std::ranges::any_of(b, [&](const Effect& other) { return same(one, other); });
         });
}

std::vector<double> parameters_in(const Effect& effect, const AssetConfig& asset) {
  std::vector<double> parameters;
  for (const PhysicsTerm& term : asset.physics)
    if (term.id == effect.law->id && term.element == effect.element && parameters.empty())
      for (const LawParameter& parameter : effect.law->parameters)
        parameters.push_back(term.parameters.at(std::string(parameter.name)).value);
  return parameters;
}

std::vector<FoundEffect> describe_effects(Naming& naming, const Trial& best, const Data& data,
                                          const ExplainOptions& options, const CarryOver* carry_over) {
  const std::vector<double> errors = standard_errors(*best.model);
  const PlantDescription& plant = best.model->problem.recordings.front().simulation->plant();
  const Resolution resolution = resolution_of(data, plant);
  const auto describe_effect = [&](std::size_t slot) {
    const std::optional<Trial> fewer = without_law(naming, best, slot, data, options.threads);
    const std::vector<Trial> alternatives = alternatives_of(naming, best, slot, fewer, data, options);
    const double phi = smallest_dispersion(alternatives, *best.model);
    FoundEffect effect;
    effect.what = law_at(best.effects[slot], plant);
    effect.parameters = parameters_of(best.effects[slot], *best.model, errors, resolution);
    effect.engineering_share = engineering_share(effect, best.effects[slot], naming.first.candidates, plant);
    weigh(effect, best.effects[slot], alternatives, how_far_behind(alternatives, best, phi, carry_over),
          best.model->misfit, phi, naming.settled ? nullptr : plainer(*best.effects[slot].law), plant);
    effect.delta_bic = criterion(*best.model, phi) - criterion(fewer ? *fewer->model : *naming.baseline, phi);
    return effect;
  };
  std::vector<FoundEffect> effects;
  for (std::size_t slot = best.effects.size(); slot-- > 0;) {
    effects.insert(effects.begin(), describe_effect(slot));
    const bool is_last = slot + 1 == best.effects.size();  // a remainder, that is
    if (is_last && slot > 0 && excess(*best.model) <= kGross && could_sit_anywhere(effects.front())) return effects;
  }
  std::ranges::stable_sort(effects, std::greater<>(), &FoundEffect::probability);
  return effects;
}

namespace {

std::string uncapitalised(std::string sentence) {
  if (!sentence.empty()) sentence[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(sentence[0])));
  return sentence;
}

std::string against_elsewhere(const FoundEffect& effect) {
  const Alternative* best = nullptr;
  for (const Alternative& other : effect.alternatives)
    if (other.what.element != effect.what.element &&
        (best == nullptr || other.misfit_above_best < best->misfit_above_best))
      best = &other;
  if (best == nullptr) return "No law that sits elsewhere came near it.";
  return "The best law that sits elsewhere (" + law_in_words(best->what) + ") " + is_worse_by(best->misfit_above_best);
}

}  // namespace

std::vector<Location> locate(const std::vector<FoundEffect>& effects) {
  std::vector<Location> places;
  for (const FoundEffect& effect : effects) {
    if (std::ranges::find(places, effect.what.element, &Location::element) != places.end()) continue;
    places.push_back({.element = effect.what.element,
                      .probability = effect.element_probability,
                      .indistinguishable_from = effect.same_elements,
                      .evidence = against_elsewhere(effect)});
  }
  const std::size_t found = places.size();
  for (const FoundEffect& effect : effects)
    for (const Alternative& other : effect.alternatives) {
      const Location place{
          .element = other.what.element,
          .probability = std::exp(-0.5 * std::min(other.misfit_above_best, 1400.0)) * effect.probability,
          .indistinguishable_from = {},
          .evidence = law_in_words(other.what) + ": " + uncapitalised(other.why_not)};
      const auto known = std::ranges::find(places, place.element, &Location::element);
      if (known == places.end())
        places.push_back(place);
      else if (static_cast<std::size_t>(known - places.begin()) >= found && known->probability < place.probability)
        *known = place;  // in the place of another effect it comes nearer
    }
  std::ranges::stable_sort(places, std::greater<>(), &Location::probability);
  return places;
}

std::vector<Location> locate_without_law(const Screening& screening) {
  std::map<std::string, double> gain;
  double all = 0.0;
  for (const Variant& variant : screening.variants) {
    double& best = gain[screening.candidates[variant.candidate].element];
    best = std::max(best, variant.gain);
  }
  for (const auto& [element, best] : gain) all += best;
  std::vector<Location> places;
  for (const auto& [element, best] : gain)
    if (all > 0.0 && best > 0.05 * all)
      places.push_back(
          {.element = element,
           .probability = best / all,
           .indistinguishable_from = {},
           .evidence = "Share of the misfit that laws of this element could take, on the linearised model."});
  std::ranges::stable_sort(places, std::greater<>(), &Location::probability);
  return places;
}

std::vector<Location> locate_at_a_sensor(const PooledFit& fit) {
  const auto worst = std::ranges::max_element(fit.channels, {}, &ChannelComparison::weighed_rms_after);
  if (worst == fit.channels.end()) return {};
  return {{.element = "sensor:" + worst->channel,
           .probability = kNeverCertain,
           .indistinguishable_from = {},
           .evidence = "It misses by " + text::misfit_text(worst->rms_after) +
                       " times the noise, and no law asks for any of that: single samples are far off, or something "
                       "disturbs its signal."}};
}

Rejected describe(const Forbidden& forbidden, const PlantDescription& plant) {
  const LawParameter& strength = forbidden.effect.law->parameters[strengths_of(*forbidden.effect.law).front()];
  std::string why = "The data would want ";
  why.append(strength.name).append(" = ").append(text::with_unit(forbidden.strength, strength.unit));
  why.append("; physics demands: ").append(forbidden.effect.law->energy).append(".");
  return {.what = law_at(forbidden.effect, plant),
          .why = std::move(why),
          .share = forbidden.share,
          .allowed_share = forbidden.allowed_share};
}

std::vector<ParameterShift> parameter_shifts(const AssetConfig& datasheet, const FittedModel& before,
                                             const FittedModel& after) {
  const std::vector<double> old_errors = standard_errors(before), new_errors = standard_errors(after);
  std::vector<ParameterShift> shifts;
  for (std::size_t j = 0; j < before.problem.shared.size(); ++j) {
    const Unknown& unknown = before.problem.shared[j];
    if (unknown.is_known()) continue;
    const std::string name = parameter_of(unknown);
    const auto sheet = datasheet.parameters.find(name);
    std::erase_if(shifts, [&](const ParameterShift& one) { return one.name == name; });  // of an earlier recording
    for (std::size_t k = 0; k < after.problem.shared.size() && sheet != datasheet.parameters.end(); ++k)
      if (after.problem.shared[k].name == unknown.name)
        shifts.push_back({.name = name,
                          .unit = unknown.unit,
                          .before = *estimate_of(before, unknown.name),
                          .before_std = old_errors[j],
                          .after = *estimate_of(after, unknown.name),
                          .after_std = new_errors[k],
                          .datasheet = sheet->second.value,
                          .before_at_bound = at_bound(unknown, before.optimum.point.shared[j]),
                          .after_at_bound = at_bound(after.problem.shared[k], after.optimum.point.shared[k])});
  }
  return shifts;
}

PrognosisShift prognosis_shift(const AssetConfig& asset, const std::vector<ParameterShift>& parameters) {
  PrognosisShift shift;
  if (!asset.condition) return shift;
  const auto leakage = std::ranges::find(parameters, asset.condition->parameter, &ParameterShift::name);
  if (leakage == parameters.end()) return shift;
  if (!std::isfinite(leakage->before_std) || !std::isfinite(leakage->after_std))
    return shift;  // at a bound, or not told
  shift.known = true;
  shift.part = asset.condition->part;
  shift.parameter = leakage->name;
  shift.unit = leakage->unit;
  shift.R_CL_before = leakage->before;
  shift.R_CL_after = leakage->after;
  shift.theta_before = asset.condition->condition(leakage->before);
  shift.theta_after = asset.condition->condition(leakage->after);
  const bool of_population = shift.part.ends_with("seal");  // which is one of seals: nothing is known of other parts
  const auto months_left = [&](double theta) {
    return of_population ? forecast::mean_remaining_months(theta, asset.condition->threshold)
                         : std::numeric_limits<double>::quiet_NaN();
  };
  shift.months_before = months_left(shift.theta_before);
  shift.months_after = months_left(shift.theta_after);
  const std::string of_what = "The condition of the " + shift.part;
  const std::string condition = number(100.0 * shift.theta_after, 4) + " %";
  const double months = std::round(shift.months_after), months_before = std::round(shift.months_before);
  if (condition == number(100.0 * shift.theta_before, 4) + " %" && (months == months_before || !of_population)) {
    const bool nothing_found = leakage->after == leakage->before;
    shift.sentence = of_what + " is " + condition + (nothing_found ? "." : " with and without what was found.");
    return shift;
  }
  const std::string not_before = months == months_before ? ", as before" : ", not " + number(months_before);
  shift.sentence = of_what + " is " + condition + " instead of " + number(100.0 * shift.theta_before, 4) + " %";
  if (of_population)
    shift.sentence += "; an average " + shift.part + " then has " + number(months) + " months left until " +
                      number(100.0 * asset.condition->threshold) + " %" + not_before;
  shift.sentence += ". This asset's own remaining life comes from its history (sealwatch forecast).";
  return shift;
}

}  // namespace sealwatch::mismatch
