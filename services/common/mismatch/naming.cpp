#include "services/common/mismatch/naming.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "services/common/core/in_parallel.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/datasheet.hpp"
#include "services/common/mismatch/form_error.hpp"
#include "services/common/mismatch/one_shape.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/own_gains.hpp"
#include "services/common/mismatch/plain_laws.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/replacement.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/value_search.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kSingles = 8;      // refits of single laws
constexpr double kWorthRoughly = 2.0;    // criterion that a law must bring in a gross misfit
constexpr std::size_t kClosedForms = 5;  // refits of closed forms

bool same(const Effect& a, const Effect& b) { return a.law->id == b.law->id && a.element == b.element; }

// Largest gain first.
std::vector<Forbidden> forbidden_by_physics(const Screening& screening, const FittedModel& model) {
  std::vector<Forbidden> found;
  const double best_gain = by_gain(screening).empty() ? 0.0 : by_gain(screening).front()->gain;
  const double beyond_noise = std::max(model.misfit - model.residuals, 1.0);
  const auto share = [&](double gain) { return std::clamp(gain / beyond_noise, 0.0, 1.0); };
  for (const Variant& variant : screening.variants) {
    const Candidate& candidate = screening.candidates[variant.candidate];
    if (variant.physical || variant.columns.size() != 1) continue;
    const Eigen::Index column = variant.columns.front();
    const double gradient = screening.gradient(column), gram = screening.gram(column, column);
    const double gain = gradient * gradient / gram;
    if (gain < std::max(0.5 * best_gain, 27.0)) continue;
    const Effect effect{candidate.law, candidate.element};
    const Forbidden forbidden{.effect = effect,
                              .strength = gradient / gram * screening.unit[static_cast<std::size_t>(column)],
                              .score = variant.score,
                              .share = share(gain),
                              .allowed_share = share(best_gain)};
    const auto known = std::ranges::find_if(found, [&](const Forbidden& other) { return same(other.effect, effect); });
    if (known == found.end())
      found.push_back(forbidden);
    else if (known->share < forbidden.share)
      *known = forbidden;  // the point of its shape's grid that fits best
  }
  std::ranges::stable_sort(found, std::greater<>(), &Forbidden::share);
  return found;
}

// What a law must bring to stay. In a gross misfit the criterion, with its correlation time from the residuals, is wary
// enough: there the recordings that took no part decide.
double worth_keeping(const Naming& naming) {
  return excess(*naming.best.model) > kGross ? kWorthRoughly : kWorthAnother;
}

// A model with fewer laws is not worth its search once it cannot come to this.
SearchBound worth_dropping_to(const Naming& naming) {
  const double phi = dispersion(*naming.best.model);
  return {.cost = 0.5 * phi * (criterion(*naming.best.model, phi) + worth_keeping(naming)), .optimism = kOptimistic};
}

// Laws of the best that may not be needed. In a gross misfit the linear model does not tell.
std::vector<std::size_t> may_be_needless(const Trial& best) {
  std::vector<std::size_t> slots(best.effects.size());
  std::iota(slots.begin(), slots.end(), std::size_t{0});
  if (excess(*best.model) <= kGross)
    std::erase_if(slots, [&](std::size_t slot) { return !Replacement(best, {slot}).may_go(); });
  return slots;
}

// The best without each of its laws in turn, where that can be simulated and is worth its search.
std::vector<Trial> each_with_one_less(const Naming& naming, const Data& data, int threads) {
  const Trial& best = naming.best;
  const SearchBound bound = worth_dropping_to(naming);
  const std::vector<std::size_t> slots = may_be_needless(best);
  std::vector<Trial> all = in_parallel<Trial>(slots.size(), threads, [&](std::size_t k) {
    const std::size_t out = slots[k];
    Trial fewer{.effects = best.effects, .model = nullptr};
    fewer.effects.erase(fewer.effects.begin() + static_cast<std::ptrdiff_t>(out));
    AssetConfig asset = best.model->asset;
    asset.physics.erase(asset.physics.end() - static_cast<std::ptrdiff_t>(best.effects.size() - out));
    Result<FittedModel> model = fit_model(asset, data, best.model.get(), 1, kSearchIterations, bound);
    if (model) fewer.model = std::make_shared<const FittedModel>(std::move(*model));
    return fewer;
  });
  std::erase_if(all, [](const Trial& fewer) { return fewer.model == nullptr; });
  return all;
}

// Laws whose removal does not cost what another law must bring are taken out again, the one that costs least first.
void drop_what_is_not_needed(Naming& naming, const Data& data, int threads) {
  while (naming.best.effects.size() > 1) {
    const std::vector<Trial> fewer = each_with_one_less(naming, data, threads);
    naming.trials.insert(naming.trials.end(), fewer.begin(), fewer.end());
    const double phi = dispersion(*naming.best.model);
    const Trial* least = best_of(fewer, phi);
    if (least == nullptr || criterion(*least->model, phi) >= criterion(*naming.best.model, phi) + worth_keeping(naming))
      break;
    naming.best = with_derivatives(*least, data, threads);
  }
  const double phi = dispersion(*naming.best.model);
  if (criterion(*naming.baseline, phi) < criterion(*naming.best.model, phi) + worth_keeping(naming))
    naming.best = {{}, naming.baseline};
}

// What the best law of a screening promises to take off the misfit, on the linearised model.
double most_promised(const Screening& screening) {
  const std::vector<const Variant*> order = by_gain(screening);
  return order.empty() ? 0.0 : order.front()->gain;
}

// Whether what the laws found leave is so little that their forms may take it.
bool forms_may_take_it(const Naming& naming) {
  return !naming.best.effects.empty() &&
         leaves_its_form_at_most(*naming.baseline, *naming.best.model, most_promised(naming.last));
}

// Whether that is what another law must bring.
bool promising(const Screening& screening, const FittedModel& model) {
  const double penalty = std::log(model.residuals);  // of one more parameter
  return most_promised(screening) / excess(model) > kWorthAnother + penalty;
}

// In a gross misfit, beside laws: whether another may take more than these laws' form may be off by, even if it takes ten
// times what the linear model promises.
bool may_be_more_than_form(const Screening& screening, const FittedModel& model, const FittedModel& baseline) {
  constexpr double kHopeful = 10.0;
  return excess(model) <= kGross || kHopeful * most_promised(screening) >= kForm * (baseline.misfit - model.misfit);
}

// What closed forms do beside the trial.
Result<Screening> screen_closed_forms(const Trial& trial, const Data& data, const ExplainOptions& options) {
  return screen(*trial.model, data,
                {.draws = 1, .seed = options.seed, .threads = options.threads, .laws = Laws::closed_forms});
}

// Closed forms that promise what another law must bring, as starts of refits from the trial.
std::vector<std::vector<LawStart>> closed_forms_for(const Trial& from, const FittedModel& baseline, const Data& data,
                                                    const ExplainOptions& options) {
  std::vector<std::vector<LawStart>> starts;
  const auto screening = screen_closed_forms(from, data, options);
  if (!screening || !promising(*screening, *from.model)) return starts;
  if (!from.effects.empty() && !may_be_more_than_form(*screening, *from.model, baseline)) return starts;
  for (LawStart& start : ranked_laws(*screening, kClosedForms)) starts.push_back({std::move(start)});
  return starts;
}

// The same beside the laws found. Where the forms of these may take what is left, closed forms at their elements are
// such forms, and no further law.
std::vector<std::vector<LawStart>> closed_forms_beside(const Naming& naming, const Data& data,
                                                       const ExplainOptions& options) {
  std::vector<std::vector<LawStart>> starts = closed_forms_for(naming.best, *naming.baseline, data, options);
  if (!forms_may_take_it(naming)) return starts;
  std::vector<LawStart> elsewhere;
  for (std::vector<LawStart>& start : starts)
    if (std::ranges::find(naming.best.effects, start.front().effect.element, &Effect::element) ==
        naming.best.effects.end())
      elsewhere.push_back(std::move(start.front()));
  starts.clear();
  for (LawStart& start : more_than_form(*naming.best.model, naming.best.effects, std::move(elsewhere), data, options))
    starts.push_back({std::move(start)});
  return starts;
}

// Whether each of these trials leaves more than half of what the model misses beyond the noise.
bool leave_most(const std::vector<Trial>& trials, const FittedModel& model) {
  const double before = model.misfit / model.residuals;
  return std::ranges::none_of(trials, [&](const Trial& trial) {
    return share_explained(before, trial.model->misfit / trial.model->residuals) > kExplainedAtLeast;
  });
}

// The laws found that a closed form takes the place of: those at its element, or all.
std::vector<std::size_t> slots_for(const Effect& form, const std::vector<Effect>& found) {
  std::vector<std::size_t> there, all;
  for (std::size_t slot = 0; slot < found.size(); ++slot) {
    all.push_back(slot);
    if (found[slot].element == form.element) there.push_back(slot);
  }
  return there.empty() ? all : there;
}

// Closed forms in place of laws found, from where these stand.
std::vector<Trial> closed_forms_in_place(const Naming& naming, const std::vector<std::vector<LawStart>>& forms,
                                         const Data& data, const ExplainOptions& options) {
  std::map<std::vector<std::size_t>, std::vector<LawStart>> asked;
  for (const std::vector<LawStart>& form : forms)
    asked[slots_for(form.front().effect, naming.best.effects)].push_back(form.front());
  std::vector<Trial> trials;
  for (const auto& [out, laws] : asked) {
    const auto starts = stand_ins(naming.best, out, candidates_of(laws, *naming.best.model), data, options);
    for (Trial& trial : refit(naming.best, starts, data, options.threads,
                              {.in_place_of = out, .sized = true, .to_beat = naming.best.model->misfit}))
      trials.push_back(std::move(trial));
  }
  return trials;
}

// Where listed laws leave something beyond the noise: closed forms in place of the laws found, and beside them.
void try_closed_forms(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (options.maximum_laws == 0) return;
  const double to_beat = naming.best.model->misfit;
  const Trial nothing{{}, naming.baseline};
  const auto instead = closed_forms_for(nothing, *naming.baseline, data, options);
  const bool from_laws = !naming.best.effects.empty() && excess(*naming.best.model) <= kGross;
  std::vector<Trial> trials = from_laws ? closed_forms_in_place(naming, instead, data, options)
                                        : refit(nothing, instead, data, options.threads, {.to_beat = to_beat});
  const auto laws = static_cast<int>(naming.best.effects.size());
  if (laws > 0 && laws < options.maximum_laws)
    for (Trial& trial :
         refit(naming.best, closed_forms_beside(naming, data, options), data, options.threads, {.to_beat = to_beat}))
      trials.push_back(std::move(trial));
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  const double phi = smallest_dispersion(trials, *naming.best.model);
  const Trial* best = best_of(trials, phi);
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi) - kWorthAnother) return;
  if (!take(naming, *best, data, options)) return;
  const Trial whole = naming.best;
  drop_what_is_not_needed(naming, data, options.threads);
  if (naming.best.model == whole.model) return;
  const auto next = screen(*naming.best.model, data, {.seed = options.seed, .threads = options.threads});
  next ? static_cast<void>(naming.last = *next) : static_cast<void>(naming.best = whole);
}

// A channel that stays at its largest value shows by itself that its sensor has reached the end of its range. In a
// gross misfit that comes first: what lies beyond the end would otherwise be asked of the plant.
void begin_with_what_shows(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (excess(*naming.baseline) <= kGross) return;
  std::vector<LawStart> ends;
  for (const Candidate& candidate : naming.first.candidates)
    if (candidate.law->kind == SiteKind::sensor_saturation && ends.empty())
      ends.push_back({{candidate.law, candidate.element}, candidate.grid.front()});
  if (ends.empty()) return;
  const std::vector<Trial> trials = refit(naming.best, {ends}, data, options.threads);
  if (trials.empty() || trials.front().model->misfit >= naming.baseline->misfit) return;
  naming.trials.push_back(trials.front());
  Result<Screening> next = screen(*trials.front().model, data, {.seed = options.seed, .threads = options.threads});
  if (!next) return;  // the plant's laws are asked without it
  naming.best = trials.front();
  naming.last = std::move(*next);
}

// Whether the search goes on from the best of these trials without asking for pairs: it ends a gross misfit, or leaves
// nothing.
bool one_law_does(const std::vector<Trial>& trials, Naming& naming, const Data& data, const ExplainOptions& options) {
  const Trial* best = best_of(trials, smallest_dispersion(trials, *naming.best.model));
  if (best == nullptr) return false;
  if (excess(*naming.best.model) > kGross) return excess(*best->model) <= kGross;
  if (best->model->misfit > kAtTheNoise * best->model->residuals) return false;
  const auto left = look(naming, best->model, data, options);
  return left && !differs(left->p_value, *best->model, options.false_alarm_rate);
}

// The model with all sensors off by what they may be. Beside the laws found so far it competes with every further one.
class InexactSensors {
 public:
  InexactSensors(const FittedModel& exact, const Data& data, int threads)
      : exact_(exact), data_(data), inexact_(data), threads_(threads) {
    std::ranges::copy(data.sensors, std::back_inserter(inexact_.known));
    if (data.sensors.empty()) return;
    auto there = fit_model(exact.asset, inexact_, &exact, threads, 0);
    if (there) there_ = std::move(*there);
  }

  // What any single law must promise to do better, however well its refit went. Nothing where the linear model does not
  // tell what a refit brings, in a gross misfit, or where sensors cannot do better than the best of the laws.
  [[nodiscard]] std::optional<double> least_gain(const Screening& asked) {
    if (!there_ || excess(exact_) > kGross || by_gain(asked).empty()) return std::nullopt;
    const double most = there_->misfit - could_reach(*there_);
    if (most < by_gain(asked).front()->gain + kWorthAnother * dispersion(exact_) || !fitted()) return std::nullopt;
    const double phi = std::min(dispersion(exact_), dispersion(*model_));
    return (criterion(exact_, phi) - score(phi) - kWorthAnother) * phi / kOptimistic;
  }

  // Whether they explain more than the best law tried. What the recordings tell of the sensors is paid for
  // (occam_factor): else they could imitate much of what small effects do. Not asked beside a law whose other forms were
  // not: sensors would bend to what its form lacks.
  [[nodiscard]] bool beat(const std::vector<Trial>& trials) {
    if (!fitted()) return false;
    const double phi = std::min(smallest_dispersion(trials, exact_), dispersion(*model_));
    const Trial* law = best_of(trials, phi);
    const double known = criterion(exact_, phi),
                 with_law = law == nullptr ? known : std::min(known, criterion(*law->model, phi));
    if (score(phi) >= with_law - kWorthAnother) return false;
    if (!a_value_explains_) a_value_explains_ = a_value_explains(exact_, score(phi), phi, data_, threads_);
    return !*a_value_explains_;
  }

  [[nodiscard]] const std::shared_ptr<const FittedModel>& model() const { return model_; }

 private:
  // Not where that leaves a gross misfit, or promises to.
  [[nodiscard]] bool fitted() {
    if (!there_ || model_ != nullptr) return model_ != nullptr;
    const bool hopeless = could_reach(*there_) > kGross * there_->residuals;
    Result<FittedModel> model = hopeless ? fail("") : continue_fit(*there_, inexact_, threads_, kSearchIterations);
    there_.reset();
    if (model && excess(*model) <= kGross) model_ = std::make_shared<const FittedModel>(std::move(*model));
    return model_ != nullptr;
  }
  [[nodiscard]] double score(double phi) const {
    return criterion(exact_, phi) - (exact_.misfit - model_->misfit) / phi + occam_factor(*model_, data_.sensors, phi);
  }

  const FittedModel& exact_;
  const Data& data_;
  Data inexact_;
  int threads_;
  std::optional<FittedModel> there_;  ///< not fitted yet, where it can be
  std::shared_ptr<const FittedModel> model_;
  std::optional<bool> a_value_explains_;
};

// The best with a parameter that each recording has for itself, of those that promise most on the linearised model.
class DifferingTests {
 public:
  DifferingTests(const Trial& from, const Data& data, int threads) : from_(from), data_(data), threads_(threads) {
    constexpr std::size_t kMost = 2;
    if (!data.may_differ.empty()) gains_ = gains_of_own_values(*from.model, data.may_differ);
    gains_.resize(std::min(gains_.size(), kMost));
  }

  // Before any law was tried: only what promises nearly as much as the best of them.
  void ask_before(const Screening& asked) {
    constexpr double kNearly = 0.5;
    if (!gains_.empty() && gains_.front().gain > kNearly * most_promised(asked)) ask({});
  }
  // Those that could do better than all laws tried.
  void ask_beside(const std::vector<Trial>& trials) { ask(trials); }

  [[nodiscard]] const std::vector<Trial>& trials() const { return trials_; }

 private:
  void ask(const std::vector<Trial>& laws) {
    const double phi = smallest_dispersion(laws, *from_.model);
    double best = criterion(*from_.model, phi) - kWorthAnother;
    for (const Trial& law : laws) best = std::min(best, criterion(*law.model, phi));
    std::erase_if(gains_, [&](const OwnGain& own) {
      const auto more = static_cast<double>(data_.samples.size() - 1);
      const double price = more * std::max(std::log(from_.model->residuals / phi), 2.0);
      if (criterion(*from_.model, phi) - kOptimistic * own.gain / phi + price >= best) return false;
      fit(own.parameter);
      return true;
    });
  }
  void fit(const std::string& parameter) {
    Data own = data_;
    own.own_parameter = parameter;
    Result<FittedModel> model = fit_model(from_.model->asset, own, from_.model.get(), threads_, kSearchIterations);
    if (model) trials_.push_back({from_.effects, std::make_shared<const FittedModel>(std::move(*model)), parameter});
  }

  const Trial& from_;
  const Data& data_;
  int threads_;
  std::vector<OwnGain> gains_;  ///< not fitted yet
  std::vector<Trial> trials_;
};

// Of these trials the causes; all, where none of them is worth another law.
std::vector<Trial> causes_if_any(const std::vector<Trial>& trials, const Trial& from, double phi) {
  std::vector<Trial> causes = causes_among(trials, from);
  const double worth = criterion(*from.model, phi) - kWorthAnother;
  const bool any = std::ranges::any_of(causes, [&](const Trial& one) { return criterion(*one.model, phi) < worth; });
  return any ? causes : trials;
}

// These starts, and the laws that promise most where the plant's parameters are as given: one that parameters imitate (a
// delay, viscous friction) promises little where they have bent to it.
std::vector<std::vector<LawStart>> also_from(const Trial& given, std::vector<std::vector<LawStart>> starts,
                                             const Data& data, const ExplainOptions& options) {
  for (std::vector<LawStart>& start : starts) start.front().promised = std::numeric_limits<double>::infinity();
  const auto asked = screen(*given.model, data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!asked) return starts;
  for (LawStart& start : ranked_laws(causes_in(*asked, *given.model), kSingles)) {
    const auto is_it = [&](const std::vector<LawStart>& one) { return same(one.front().effect, start.effect); };
    if (std::ranges::none_of(starts, is_it)) starts.push_back({std::move(start)});
  }
  return starts;
}

// What is asked beside the laws found: causes, and where the forms of these laws may take what is left, those that are
// more than that.
Screening asked_beside(Naming& naming, const Data& data, const ExplainOptions& options) {
  Screening asked = causes_in(naming.last, *naming.best.model);
  if (!forms_may_take_it(naming)) return asked;
  const std::vector<LawStart> more =
      more_than_form(*naming.best.model, naming.best.effects, ranked_laws(asked, kSingles), data, options);
  for (Variant& variant : asked.variants) {
    const Candidate& candidate = asked.candidates[variant.candidate];
    const Effect effect{candidate.law, candidate.element};
    if (std::ranges::none_of(more, [&](const LawStart& law) { return same(law.effect, effect); })) variant.gain = 0.0;
  }
  if (!more.empty()) naming.more_beside = naming.best.model;
  return asked;
}

// Refits with another law: first the single laws that promise most, in a gross misfit all and from second starts too.
// Where none of them does, sensors that are not exact; else the other laws, then pairs. Sensors that promise more than
// the laws come first, and only laws that could do better are refitted. A parameter of which each recording has its own
// competes with all of them. Beside laws that leave no more than their exact form sensors alone are asked.
std::vector<Trial> try_laws(Naming& naming, const Data& data, const ExplainOptions& options) {
  const std::size_t level = naming.best.effects.size();
  const bool gross = excess(*naming.best.model) > kGross;
  const Screening asked = asked_beside(naming, data, options);
  std::vector<std::vector<LawStart>> singles;
  for (LawStart& start : ranked_laws(asked, level == 0 || gross ? kSingles : kSingles / 2 + 1))
    singles.push_back({std::move(start)});
  if (gross)
    for (LawStart& start : second_starts(asked)) singles.push_back({std::move(start)});
  std::vector<Trial> trials;
  if (naming.best.model == naming.baseline) trials = naming.tried;
  for (const Trial& one : trials) {
    const Effect& tried = one.effects.front();
    const auto known = std::ranges::find_if(singles, [&](const std::vector<LawStart>& start) {
      return tried.law == start.front().effect.law && tried.element == start.front().effect.element;
    });
    if (known != singles.end()) singles.erase(known);  // its other starts stay
  }
  const auto refit_from = [&](const Trial& from, const std::vector<std::vector<LawStart>>& starts) {
    RefitOptions refits{.again_smaller = gross};
    for (const Trial& trial : trials) refits.to_beat = std::min(refits.to_beat, trial.model->misfit);
    for (Trial& trial : refit(from, starts, data, options.threads, refits)) trials.push_back(std::move(trial));
  };
  const auto refit_also = [&](const std::vector<std::vector<LawStart>>& starts) { refit_from(naming.best, starts); };
  InexactSensors sensors(*naming.best.model, data, options.threads);
  DifferingTests differing(naming.best, data, options.threads);
  const auto with_differing = [&](std::vector<Trial> all) {
    all.insert(all.end(), differing.trials().begin(), differing.trials().end());
    return all;
  };
  const auto are_inexact = [&] {
    naming.sensors_are_inexact = sensors.beat(with_differing(trials));
    if (naming.sensors_are_inexact) naming.with_sensors = sensors.model();
    if (level == 0) naming.baseline_with_sensors = sensors.model();
    return naming.sensors_are_inexact;
  };
  if (by_gain(asked).empty()) {
    static_cast<void>(are_inexact());
    return trials;
  }
  if (level > 0 && !may_be_more_than_form(asked, *naming.best.model, *naming.baseline)) {
    differing.ask_beside({});
    return with_differing({});
  }
  differing.ask_before(asked);
  const std::optional<double> least_gain = sensors.least_gain(asked);
  if (least_gain && by_gain(asked).front()->gain < *least_gain && are_inexact()) return trials;
  const auto first = static_cast<std::ptrdiff_t>(
      gross ? singles.size() : nearly_as_promising(asked, singles.size(), least_gain.value_or(0.0)));
  refit_also({singles.begin(), singles.begin() + first});
  // What each recording has for itself ends a gross misfit as a law does.
  const auto one_does = [&] {
    const auto ends_it = [](const Trial& trial) { return excess(*trial.model) <= kGross; };
    return (gross && std::ranges::any_of(differing.trials(), ends_it)) || one_law_does(trials, naming, data, options);
  };
  if (gross && !one_does() && leave_most(with_differing(trials), *naming.best.model))
    if (const auto given = with_given_values(naming.best, data))
      refit_from(*given, also_from(*given, singles, data, options));
  if (level == 0 && leave_most(with_differing(trials), *naming.best.model))
    refit_also(closed_forms_for(naming.best, *naming.baseline, data, options));
  differing.ask_beside(trials);
  if (least_gain && are_inexact()) return trials;
  if (!one_does()) {
    if (are_inexact()) return trials;
    refit_also({singles.begin() + first, singles.end()});
    if (static_cast<int>(level) + 2 <= options.maximum_laws && !one_does())
      refit_also(ranked_pairs(asked, naming.best.model->misfit, gross));
  }
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  return with_differing(std::move(trials));
}

// Single laws that may do as well as a value of the asset file that ends a gross misfit.
std::vector<Trial> laws_in_place_of(const ValueSwap& value, Naming& naming, const Data& data,
                                    const ExplainOptions& options) {
  const FittedModel& with_value = *value.with.model;
  const auto beside = look(naming, value.with.model, data, options);
  if (!beside) return try_laws(naming, data, options);
  const Replacement replacement(with_value, value.value);
  std::vector<std::vector<LawStart>> starts;
  for (LawStart& start : ranked_laws(naming.last, kSingles))
    if (const auto stand_in = replacement.stand_in(*beside, start.effect);
        !stand_in || replacement.may_do_as_well(*stand_in))
      starts.push_back({std::move(start)});
  std::vector<Trial> trials = refit(naming.best, starts, data, options.threads, {.to_beat = with_value.misfit});
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  return trials;
}

// Whether one of the laws found is a sensor within its tolerance: that is no fault, and the others are to be asked beside
// sensors that are off by what they may be. In a gross misfit that tells nothing yet.
bool takes_sensors_for_exact(Naming& naming, const Data& data, int threads) {
  if (excess(*naming.best.model) > kGross) return false;
  for (std::size_t slot = naming.best.effects.size(); slot-- > 0;) {
    if (!is_within_tolerance(naming.best.effects[slot], *naming.best.model, data.sensors)) continue;
    naming.best = without_law(naming, naming.best, slot, data, threads).value_or(Trial{{}, naming.baseline});
    naming.sensors_are_inexact = true;
  }
  return naming.sensors_are_inexact;
}

}  // namespace

const Naming& as_it_began(const Naming& naming) { return naming.with_laws == nullptr ? naming : *naming.with_laws; }

double share_left_by_best(const Naming& naming) {
  return share_left(*naming.baseline, *naming.best.model, most_promised(naming.last));
}

bool leaves_its_form(const Naming& naming) {
  return naming.best.effects.size() == 1 && naming.more_beside != naming.best.model && forms_may_take_it(naming);
}

bool a_value_explains(const FittedModel& model, double score, double phi, const Data& data, int threads) {
  std::vector<std::string> ends;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    const bool fixed = !unknown.quantity.is_of_sensor() && unknown.is_known();
    if (fixed && at_bound(unknown, model.optimum.point.shared[k])) ends.push_back(unknown.name);
  }
  const auto explains = [&](std::size_t k) {
    Data others = data;
    std::erase_if(others.known, [&](const KnownValue& value) { return value.name == ends[k]; });
    const auto there = fit_model(with_free_value(model.asset, ends[k]), others, &model, 1, 0);
    if (!there || criterion(*there, phi) - (there->misfit - could_reach(*there)) / phi >= score) return false;
    const auto freed = continue_fit(*there, others, 1, kSearchIterations);
    return freed && criterion(*freed, phi) < score;
  };
  return std::ranges::any_of(in_parallel<char>(ends.size(), threads, explains), [](char yes) { return yes != 0; });
}

void settle(Naming& naming, const Data& data, const ExplainOptions& options) {
  constexpr const char* kWhat = "whether each law is needed, and whether a plainer one does";
  std::erase(naming.not_asked, kWhat);
  if (!passed(data.deadline)) drop_what_is_not_needed(naming, data, options.threads);
  if (!passed(data.deadline)) prefer_plain_laws(naming, data, options.threads);
  naming.settled = !passed(data.deadline);
  if (!naming.settled) naming.not_asked.emplace_back(kWhat);
}

Result<Naming> name_effects(std::shared_ptr<const FittedModel> baseline, const Data& data,
                            const ExplainOptions& options, const Progress& progress, const Trial& from,
                            const KnownOfBaseline* known) {
  const ScreeningOptions screening{.seed = options.seed, .threads = options.threads};
  const std::vector<KnownValue> freed = freed_by(from, *baseline, data);
  Result<Screening> first = known != nullptr ? known->first : screen(*baseline, data, screening);
  if (!first) return fail(first.error());
  Naming naming{
      .baseline = baseline, .best = {{}, baseline}, .trials = {{{}, baseline}}, .first = *first, .last = *first};
  if (known != nullptr) naming.tried = known->tried;
  naming.forbidden = forbidden_by_physics(naming.first, *baseline);
  const auto in_time = [&](const char* step) {
    if (!passed(data.deadline)) return true;
    naming.not_asked.emplace_back(step);
    return false;
  };
  if (!freed.empty()) {
    Result<Naming> beside = beside_values(naming, freed, from, data, options, progress);
    if (!beside && !from.effects.empty()) return fail(beside.error());  // what was found stays that
    if (!beside) naming.not_asked.emplace_back("what was found beside a value of the asset file");
    if (!beside) return naming;
    beside->behind_laws = std::min(beside->behind_laws, criterion_behind(*beside->best.model, *baseline));
    beside->with_laws = std::make_shared<const Naming>(naming);
    return beside;
  }
  if (from.effects.empty()) {
    begin_with_what_shows(naming, data, options);
  } else {
    naming.trials.push_back(naming.best = from);
    if (excess(*from.model) < data.least_excess || !in_time("which of the laws found before are needed")) return naming;
    drop_what_is_not_needed(naming, data, options.threads);
    Result<Screening> last = screen(*naming.best.model, data, screening);
    if (!last && !in_time("what the laws found before leave")) return naming;
    if (!last) return fail(last.error());
    naming.last = std::move(*last);
    const char* const again =
        from.is_start ? "other laws in place of those found with held states" : "other laws in place of the one found";
    if (const bool asks = in_time(again); asks && from.is_start) {
      from_other_shapes(naming, {{}, naming.baseline}, naming.first, data, options);
      another_law_for_each(naming, data, options);
      one_law_for_several(naming, data, options);
    } else if (asks) {
      compete_again(naming, data, options);
    }
  }
  const auto is_near = [&] { return excess(*naming.best.model) < data.least_excess; };
  while (static_cast<int>(naming.best.effects.size()) < options.maximum_laws) {
    if (is_near()) return naming;
    if (!differs(naming.last.p_value, *naming.best.model, options.false_alarm_rate) ||
        !promising(naming.last, *naming.best.model))
      break;
    if (!in_time("laws beside those found")) break;
    const std::size_t level = naming.best.effects.size();
    const bool gross = excess(*naming.best.model) > kGross;
    if (progress) progress("trying laws", 0.3 + 0.15 * static_cast<double>(level));
    const std::optional<ValueSwap> value = value_that_ends_it(naming, data, options.threads);
    std::vector<Trial> trials =
        value ? laws_in_place_of(*value, naming, data, options) : try_laws(naming, data, options);
    if (naming.sensors_are_inexact) return naming;
    const Trial* best = best_of(trials, smallest_dispersion(trials, *naming.best.model));
    if (value && (best == nullptr || criterion_behind(*value->with.model, *best->model) < -kCannotTell)) {
      if (auto beside = search_beside(naming, *value, data, options, progress)) return std::move(*beside);
      if (!in_time("what is beside a value of the asset file that explains more than any law")) break;
      trials = try_laws(naming, data, options);
      if (naming.sensors_are_inexact) return naming;
    }
    const double phi = smallest_dispersion(trials, *naming.best.model);
    trials = causes_if_any(trials, naming.best, phi);
    best = best_of(trials, phi);
    // Where much is missing the first law may bring little before the second is there: what is not needed in the end is
    // taken out again.
    const double worth = gross ? 0.0 : kWorthAnother;
    if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi) - worth) break;
    if (!best->differs_in.empty()) {
      if (criterion(*best->model, phi) <= criterion(*naming.best.model, phi) - kWorthAnother)
        naming.differs_in = best->differs_in;
      break;
    }
    if (!in_time("laws that were not fitted, and what the best of the others leaves")) {
      naming.best = *best;
      break;
    }
    const Screening asked = naming.last;
    const Trial before = naming.best;
    if (!take(naming, *best, data, options)) break;
    if (is_near()) return naming;
    if (takes_sensors_for_exact(naming, data, options.threads)) return naming;
    if (in_time("values of the asset file in place of laws"))
      if (auto beside = value_in_place(naming, true, data, options, progress)) return std::move(*beside);
    if (in_time("other shapes of the law found")) from_other_shapes(naming, before, asked, data, options);
    if (in_time("values of the asset file in place of laws with shapes"))
      if (auto beside = value_in_place(naming, false, data, options, progress)) return std::move(*beside);
    if (in_time("other laws in place of those found before")) another_law_for_each(naming, data, options);
    if (in_time("one law in place of several")) one_law_for_several(naming, data, options);
    if (takes_sensors_for_exact(naming, data, options.threads)) return naming;
  }
  if (!naming.differs_in.empty()) return naming;
  settle(naming, data, options);
  if (!is_at_the_noise(naming, options) && in_time("closed forms that no law of the list has"))
    try_closed_forms(naming, data, options);
  one_shape_for_several(naming, data, options);
  return naming;
}

}  // namespace sealwatch::mismatch
