#include "services/common/mismatch/analysis.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "services/common/mismatch/averaged_inputs.hpp"
#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/held_start.hpp"
#include "services/common/mismatch/own_gains.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/usual_ranges.hpp"
#include "services/common/mismatch/value_search.hpp"
#include "services/common/mismatch/value_swaps.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr const char* kAveraged =
    "The held input was averaged in the simulation, which takes fewer steps and changes less than a twentieth of the "
    "misfit.";
constexpr const char* kOnlyAveraged = "The held input was averaged in the simulation: there was no time for its jumps.";
constexpr const char* kSensorsAgain = "what was found beside sensors within their tolerances";

}  // namespace

Status Analysis::look_for_what_is_missing() {
  tell("screening all laws", 0.15);
  if (windowed() || !take_averaged_inputs()) return look_from(std::nullopt);
  if (const Status looked = look_from(std::nullopt); !looked) return looked;
  if (!averages_do()) look_with_held_inputs();
  return {};
}

bool Analysis::take_averaged_inputs() {
  std::optional<Averaged> rough = averaged(*baseline_, fit_, options_.threads);
  if (!rough) return false;
  as_held_ = {.fit = fit_, .holdout = holdout_, .baseline = baseline_};
  fit_ = std::move(rough->data);
  if (std::optional<Data> held_out = with_averaged_inputs(asset_, holdout_)) holdout_ = std::move(*held_out);
  baseline_ = std::move(rough->model);
  return true;
}

bool Analysis::averages_do() {
  const bool they_do = excess(*best_.model) >= fit_.least_excess;
  if (they_do) result_.notes.emplace_back(kAveraged);
  return they_do;
}

void Analysis::look_with_held_inputs() {
  const auto before = std::tuple(fit_, holdout_, baseline_, own_, naming_, best_, why_none_, asked_values_);
  std::optional<Trial> from;
  if (!own_ && (!best_.effects.empty() || !naming_.freed.empty())) {
    Result<FittedModel> model = fit_model(best_.model->asset, as_held_->fit, best_.model.get(), options_.threads);
    if (model) from = Trial{best_.effects, std::make_shared<const FittedModel>(std::move(*model))};
  }
  std::tie(fit_, holdout_, baseline_) = std::tie(as_held_->fit, as_held_->holdout, as_held_->baseline);
  forget_predictions();
  own_.reset();
  why_none_.reset();
  asked_values_.clear();
  if (!time_.deadline().passed() && look_from(from)) return;
  forget_predictions();
  std::tie(fit_, holdout_, baseline_, own_, naming_, best_, why_none_, asked_values_) = before;
  result_.notes.emplace_back(kOnlyAveraged);
}

Status Analysis::look_from(std::optional<Trial> from) {
  ExplainOptions options = options_;
  if (driven_unseen()) options.maximum_laws = 0;
  if (!windowed()) fit_.may_differ = may_differ(asset_, fit_);
  fit_.fixed = known_values(asset_, plant());
  const ScreeningOptions screening{.seed = options.seed, .threads = options.threads};
  Result<Screening> first = screen(*baseline_, prepared(fit_), screening);
  if (!first) return fail(first.error());
  say_how_likely_by_noise(*first);
  std::optional<Trial> common;  // the laws found beside a value of what wears for each test
  if (!from && !windowed() && may_age(asset_, fit_) && result_.statistically_significant) {
    own_ = each_its_own(what_wears(asset_), fit_, *baseline_, options.threads);
    if (own_ && !look_beside_own(*own_, {}, options)) own_.reset();
    if (own_ && !own_->naming.differs_in.empty()) {
      const Naming beside = own_->naming;
      if (look_beside_what_differs(beside, options)) return {};
      fit_.may_differ.clear();
      if (!time_.deadline().passed()) own_.reset();
    }
    if (own_ && !own_->naming.best.effects.empty()) common = found_in_common(*own_);
    const bool another = common && another_differs_rather(*common);
    if (own_ && !another && explains_everything(*own_, options)) {
      take_over(*own_);
      return {};
    }
    if (own_ && own_->fit.known.size() > fit_.known.size()) {
      first = look_with_inexact_sensors(own_->fit.known, screening);
      if (!first) return fail(first.error());
    }
    if (another) own_.reset();  // its laws are where the search sets out
  }
  if (own_) fit_.may_differ.clear();  // nothing else was found to differ beside it
  if (common) from = std::move(common);
  if (own_) tell("searching again, with one value for all tests", 0.5);
  KnownOfBaseline known{std::move(*first)};
  const bool asks = !from && options.maximum_laws > 0 && excess(*baseline_) > kGross && !a_value_ends_it(known.first);
  if (asks) known.tried = laws_that_may_end_it(known.first);
  const auto ends_it = [](const Trial& trial) { return excess(*trial.model) <= kGross; };
  if (asks && std::ranges::none_of(known.tried, ends_it)) {
    tell("starting from the recorded states", 0.2);
    HeldStart held = start_from_held(*baseline_, prepared(fit_), options);
    if (held.trial && held.trial->effects.empty()) return look_beside_better(std::move(held.trial->model));
    from = std::move(held.trial);
    if (from && held.was_cut) time_.add_not_asked({"further laws with the simulation held to the recorded states"});
  }
  Result<Naming> naming = look_in_common(from.value_or(Trial{{}, baseline_}), options, &known);
  if (!naming) return fail(naming.error());
  if (!naming->differs_in.empty()) {
    if (look_beside_what_differs(*naming, options)) return {};
    fit_.may_differ.clear();
    Result<Naming> again = look_in_common(naming->best, options, nullptr);
    if (!again && !time_.deadline().passed()) return fail(again.error());
    if (again)
      naming = std::move(again);
    else
      naming->not_asked.emplace_back("laws in common beside those found");
  }
  if (own_) keep_what_was_replaced(*naming, own_->naming);
  naming_ = std::move(*naming);
  say_how_likely_by_noise(as_it_began(naming_).first);
  look_at_what_is_left();
  if (!own_ || !result_.statistically_significant || !is_preferred(*own_, best_)) {
    own_.reset();
    return {};
  }
  if (!own_->goes_its_way) ask_values_in_place_of_own();
  if (!why_none_) take_over(*own_);
  return {};
}

Status Analysis::look_beside_better(std::shared_ptr<const FittedModel> baseline) {
  forget_predictions();
  baseline_ = std::move(baseline);
  for (std::string& sentence : wider_ranges_in_words(baseline_->asset, asset_))
    if (std::ranges::find(result_.notes, sentence) == result_.notes.end()) result_.notes.push_back(std::move(sentence));
  own_.reset();
  return look_from(std::nullopt);
}

bool Analysis::another_differs_rather(const Trial& common) const {
  std::vector<std::string> asked = fit_.may_differ;
  asked.push_back(what_wears(asset_));
  const std::vector<OwnGain> gains = gains_of_own_values(*common.model, asked);
  const auto wear = std::ranges::find(gains, what_wears(asset_), &OwnGain::parameter);
  return wear != gains.end() && gains.front().gain > wear->gain + kCannotTell * dispersion(*common.model);
}

bool Analysis::a_value_ends_it(const Screening& first) const {
  const Naming naming{.baseline = baseline_, .best = {{}, baseline_}, .trials = {}, .first = first, .last = first};
  return value_that_ends_it(naming, prepared(fit_), options_.threads).has_value();
}

std::vector<Trial> Analysis::laws_that_may_end_it(const Screening& first) const {
  constexpr std::size_t kAsked = 2;
  constexpr double kLeft = 0.1;  // of the misfit: more is left by most laws that the linear model favours
  std::vector<std::vector<LawStart>> starts;
  for (LawStart& start : ranked_laws(first, kAsked)) starts.push_back({std::move(start)});
  if (starts.empty() || baseline_->misfit - by_gain(first).front()->gain > kLeft * baseline_->misfit) return {};
  const Data data = prepared(fit_);
  const Trial nothing{{}, baseline_};
  std::vector<Trial> trials = refit(nothing, starts, data, options_.threads);
  // One that explains nearly all may be the right one beside parameters that had bent to it before.
  if (trials.empty() || excess(*trials.front().model) <= kGross ||
      trials.front().model->misfit > kLeft * baseline_->misfit)
    return trials;
  const auto given = with_given_values(nothing, data);
  if (!given) return trials;
  const RefitOptions nearer{.to_beat = trials.front().model->misfit};
  for (Trial& trial : refit(*given, {{last_law_of(trials.front())}}, data, options_.threads, nearer))
    if (trial.model->misfit < trials.front().model->misfit) trials.front() = std::move(trial);
  return trials;
}

Result<Screening> Analysis::look_with_inexact_sensors(const std::vector<KnownValue>& known,
                                                      const ScreeningOptions& options) {
  time_.allow(1.0);
  forget_predictions();
  fit_.known = known;
  Result<FittedModel> model = fit_model(baseline_->asset, fit_, baseline_.get(), options_.threads);
  if (!model) return fail(model.error());
  baseline_ = std::make_shared<const FittedModel>(std::move(*model));
  Result<Screening> first = screen(*baseline_, fit_, options);
  time_.allow(kSearchShare);
  return first;
}

std::optional<Trial> Analysis::found_in_common(const OwnValues& own) {
  time_.allow(1.0);
  std::optional<Trial> laws = in_common(own, options_.threads);
  time_.allow(kSearchShare);
  return laws;
}

Result<Naming> Analysis::look_in_common(const Trial& from, const ExplainOptions& options,
                                        const KnownOfBaseline* known) {
  Data data = prepared(fit_);
  data.sensors = unknown_sensors();
  Result<Naming> naming = name_effects(baseline_, data, options, progress_, from, known);
  if (!naming || !naming->sensors_are_inexact) return naming;
  Result<Naming> again = beside_inexact_sensors(*naming, options);
  // The search asked for a value in place of the sensors before it took them for inexact.
  const bool was_asked = again && naming->with_sensors && same_effects(naming->best.effects, again->best.effects);
  if (again && !was_asked && value_in_place_of_sensors(*again, data.sensors)) {
    tell("searching again, with exact sensors", 0.6);
    again->trials.clear();
    data.sensors.clear();
    again = name_effects(baseline_, data, options, progress_);
  } else if (again) {
    forget_predictions();
    std::ranges::copy(data.sensors, std::back_inserter(fit_.known));
    baseline_ = as_it_began(*again).baseline;
  }
  if (again) return again;
  naming->not_asked.emplace_back(kSensorsAgain);  // time is up, or these models cannot be simulated
  return naming;
}

std::vector<KnownValue> Analysis::unknown_sensors() const {
  std::vector<KnownValue> sensors = known_sensors(asset_, baseline_->problem);
  std::erase_if(sensors, [&](const KnownValue& one) {
    return std::ranges::find(fit_.known, one.name, &KnownValue::name) != fit_.known.end();
  });
  return sensors;
}

bool Analysis::look_beside_what_differs(const Naming& found, const ExplainOptions& options) {
  tell("repeating the search with one " + found.differs_in + " for each test", 0.5);
  auto own = each_its_own(found.differs_in, fit_, *baseline_, options.threads);
  if (!own) return false;
  own->fit.may_differ.clear();
  if (!look_beside_own(*own, found.best, options)) return false;
  const auto common = found_in_common(*own);
  if (!common || !is_preferred(*own, *common)) return false;
  own_ = std::move(own);
  ask_values_in_place_of_own();
  if (!why_none_) take_over(*own_);
  if (why_none_) naming_ = found;
  return true;
}

bool Analysis::look_beside_own(OwnValues& own, const Trial& found, const ExplainOptions& options) const {
  own.fit.sensors = unknown_sensors();
  if (!look_beside(own, options, progress_, with_own_values(found, own, options.threads))) return false;
  if (!own.naming.sensors_are_inexact) return true;
  OwnValues again = own;
  std::ranges::copy(own.fit.sensors, std::back_inserter(again.fit.known));
  again.fit.sensors.clear();
  Result<FittedModel> model = fit_model(own.baseline->asset, again.fit, own.baseline.get(), options.threads);
  if (model) again.baseline = std::make_shared<const FittedModel>(std::move(*model));
  const bool looked =
      model && look_beside(again, options, progress_, with_own_values(own.naming.best, again, options.threads));
  if (!looked && !time_.deadline().passed()) return false;
  if (looked) keep_what_was_replaced(again.naming, own.naming);
  if (looked)
    own = std::move(again);
  else
    own.naming.not_asked.emplace_back(kSensorsAgain);
  return true;
}

void Analysis::look_at_what_is_left() {
  const bool was_cut = !naming_.not_asked.empty() && !naming_.best.effects.empty();
  if (was_cut) {
    time_.allow(kSettledBy);
    naming_.best = polished(naming_.best, prepared(fit_), options_.threads);
    if (!naming_.settled) settle(naming_, prepared(fit_), options_);
    time_.allow_what_is_needed();  // without it what was found could not be told
    auto last = screen(*naming_.best.model, prepared(fit_), {.seed = options_.seed, .threads = options_.threads});
    if (last)
      naming_.last = std::move(*last);
    else
      naming_.best = {{}, baseline_};
    time_.allow(kSearchShare);
  }
  time_.add_not_asked(naming_.not_asked);
  best_ = naming_.best;
}

Result<Naming> Analysis::beside_inexact_sensors(const Naming& found, const ExplainOptions& options) const {
  Data inexact = fit_;
  std::ranges::copy(known_sensors(asset_, baseline_->problem), std::back_inserter(inexact.known));
  const Trial& laws = found.best;
  // What the search compared the laws with is one of the two models already.
  const auto fitted = [&](const FittedModel& from) -> Result<std::shared_ptr<const FittedModel>> {
    if (found.with_sensors && &from == laws.model.get()) return found.with_sensors;
    if (found.baseline_with_sensors && &from == baseline_.get()) return found.baseline_with_sensors;
    Result<FittedModel> model = fit_baseline(from.asset, prepared(inexact), from, options_.threads);
    if (!model) return fail(model.error());
    return std::make_shared<const FittedModel>(std::move(*model));
  };
  const auto with_sensors = fitted(*baseline_);
  if (!with_sensors) return fail(with_sensors.error());
  const auto with_laws = laws.model == baseline_ ? with_sensors : fitted(*laws.model);
  if (!with_laws) return fail(with_laws.error());
  const Trial from{laws.effects, *with_laws};
  tell("searching again, with sensors within their tolerances", 0.5);
  Result<Naming> beside = name_effects(*with_sensors, prepared(inexact), options, progress_, from);
  if (beside) keep_what_was_replaced(*beside, found);
  return beside;
}

void Analysis::keep_what_was_replaced(Naming& naming, const Naming& before) {
  if (!naming.freed.empty() && naming.replaced.empty()) naming.replaced = before.replaced;
}

bool Analysis::value_in_place_of_sensors(const Naming& found, const std::vector<KnownValue>& sensors) const {
  const FittedModel& inexact = *found.best.model;
  AssetConfig asset = inexact.asset;
  asset.sensors = baseline_->asset.sensors;
  const Data exact = prepared(fit_);
  const auto model = fit_model(asset, exact, &inexact, options_.threads);
  const double phi = dispersion(inexact);
  const double score = criterion(inexact, phi) + occam_factor(inexact, sensors, phi);
  return model && a_value_explains(*model, score, phi, exact, options_.threads);
}

void Analysis::say_how_likely_by_noise(const Screening& screening) {
  result_.p_value = largest_excess(*baseline_) > kGross ? kSmallestP : std::max(screening.p_value, kSmallestP);
  result_.statistically_significant = differs(screening.p_value, *baseline_, options_.false_alarm_rate);
}

void Analysis::take_over(const OwnValues& own) {
  forget_predictions();
  fit_ = own.fit;
  fit_.sensors.clear();
  baseline_ = own.baseline;
  naming_ = own.naming;
  best_ = naming_.best;
  time_.add_not_asked(naming_.not_asked);
}

void Analysis::look_for_a_change() {
  if (!result_.statistically_significant || windowed() || fit_.samples.size() < 2) return;
  if (leaves_nothing() || leaves_its_form(naming_)) return;
  if (const auto change = change_between_tests(asset_, fit_, *best_.model)) why_none_ = something_changed(*change);
}

void Analysis::say_what_differs() {
  const std::string course = course_in_words(*best_.model, fit_);
  const bool no_more = best_.effects.empty() && leaves_nothing();
  if (!own_->goes_its_way)
    why_none_ = part_changed_but_not_by_wear(course, worn_part(asset_), worn_element(asset_));
  else if (no_more)
    why_none_ = is_wear(*own_) ? part_aged_and_no_more(course, worn_part(asset_), worn_element(asset_))
                               : differed_and_no_more(course);
}

bool Analysis::leaves_nothing() const {
  return !differs(naming_.last.p_value, *best_.model, options_.false_alarm_rate);
}

void Analysis::look_again() {
  const bool little = best_.model->misfit > kExplainedAtLeast * baseline_->misfit;
  if (windowed() || !little || excess(*best_.model) <= kGross) return;
  const auto before = std::tuple(fit_.colour, holdout_.colour, baseline_, naming_, best_, proven_, result_.notes);
  const Status status = weigh_by_colour();
  if (status) {  // values were asked beside other laws
    beside_.reset();
    return result_.asset_values.clear();
  }
  forget_predictions();
  std::tie(fit_.colour, holdout_.colour, baseline_, naming_, best_, proven_, result_.notes) = before;
  result_.notes.push_back("A second look, weighed by the colour of what is left, was not possible (" +
                          reason_in_words(status.error()) + ").");
}

Status Analysis::weigh_by_colour() {
  const NoiseColour colour = residual_colour(*baseline_);
  forget_predictions();
  fit_.colour.assign(fit_.samples.size(), colour);
  holdout_.colour.assign(holdout_.samples.size(), colour);
  Result<FittedModel> model = fit_model(baseline_->asset, prepared(fit_), nullptr, options_.threads);
  if (!model) return fail(model.error());
  baseline_ = std::make_shared<const FittedModel>(std::move(*model));
  tell("searching again, with coloured residuals", 0.5);
  Data data = prepared(fit_);
  data.fixed.clear();
  Result<Naming> naming = name_effects(baseline_, data, options_, progress_);
  if (!naming) return fail(naming.error());
  naming_ = std::move(*naming);
  look_at_what_is_left();
  time_.allow(1.0);
  proven_ = false;
  result_.notes.emplace_back(
      "All models miss grossly: laws were weighed by the colour of what the fitted model leaves.");
  prove();
  return {};
}

}  // namespace sealwatch::mismatch
