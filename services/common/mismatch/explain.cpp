#include "sealwatch/mismatch/explain.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>

#include "services/common/mismatch/baseline.hpp"
#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/datasheet.hpp"
#include "services/common/mismatch/drawn_terms.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/gross_mismatch.hpp"
#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/own_values.hpp"
#include "services/common/mismatch/pieces.hpp"
#include "services/common/mismatch/power.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/proven_laws.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/remarks.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/time_budget.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/trace.hpp"
#include "services/common/mismatch/value_swaps.hpp"
#include "services/common/mismatch/verdict.hpp"
#include "services/common/mismatch/why_none.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kHeldOutAgrees = 1.5;  // noise-normalised rms of a channel: the noise's own estimate is off by less
constexpr double kSearchShare = 0.75;   // of the time limit, before what was found is proven and told
constexpr const char* kSensorsAgain = "what was found beside sensors within their tolerances";

// The analysis of one asset, step by step; everything it learns goes into `result`.
class Analysis {
 public:
  Analysis(const AssetConfig& asset, Data fit, Data holdout, const ExplainOptions& options, const Progress& progress)
      : asset_(asset),
        fit_(std::move(fit)),
        holdout_(std::move(holdout)),
        options_(options),
        progress_(progress),
        time_(options.time_limit_s, options.cancel) {
    fit_.deadline = holdout_.deadline = &time_.deadline();
    for (const auto& [name, setting] : asset_.parameters) fit_.given[name] = setting.value;
  }

  [[nodiscard]] Result<Explanation> run() {
    Result<Explanation> result = analyse();
    if (time_.deadline().cancelled()) return fail("the analysis was called off");
    if (result) std::ranges::copy(time_.not_asked(), std::back_inserter(result->not_asked));
    if (result && time_.deadline().was_met()) say_what_was_cut(*result);
    return result;
  }

 private:
  [[nodiscard]] Result<Explanation> analyse() {
    time_.allow(kSearchShare);
    result_.asset_id = asset_.asset_id;
    result_.model = asset_.model;
    result_.fit_recordings = fit_.names;
    result_.holdout_recordings = holdout_.names;
    if (auto gross = explain_gross_mismatch(asset_, fit_, holdout_, options_, progress_)) return std::move(*gross);
    tell("fitting the model as it is", 0.02);
    Result<Baseline> baseline = fit_baseline(asset_, fit_, holdout_, options_, time_);
    if (!baseline) return fail(baseline.error());
    take_up(std::move(*baseline));
    if (const Status status = look_for_what_is_missing(); !status) return cannot_look(status.error());
    if (at_rest(*baseline_, prepared(fit_))) why_none_ = nothing_moves();
    if (!why_none_ && time_.in_time("whether something changed between the tests")) look_for_a_change();
    if (!why_none_ && own_ && !own_->goes_its_way) say_what_differs();
    if (!why_none_) take_values_found();
    if (!why_none_ && own_) say_what_differs();
    const bool asked = why_none_ || beside_ || !result_.asset_values.empty();
    if (!asked && time_.in_time("the values that the asset file fixes")) ask_the_datasheet();
    time_.allow(1.0);
    if (why_none_) take_no_law();
    if (!best_.effects.empty()) {
      tell("proving on held-out recordings", 0.75);
      prove();
    }
    if (beside_ && best_.effects.empty()) fall_back_on_the_value();
    if (!lacks_a_pressure() && !why_none_ && time_.not_asked().empty()) look_again();
    if (const Status status = finish(); !status) return fail(status.error());
    time_.allow(1.0);
    if (time_.in_time("a picture of what is missing"))
      draw_missing_terms(*baseline_, tried_.effects.empty() ? best_ : tried_, prepared(fit_), !windowed(), result_);
    tell("done", 1.0);
    return std::move(result_);
  }

  void take_no_law() { best_ = {.effects = {}, .model = with_another_value_ ? with_another_value_ : baseline_}; }

  void take_up(Baseline baseline) {
    baseline_ = std::move(baseline.model);
    window_s_ = baseline.window_s;
    input_swings_ = baseline.input_swings;
    result_.notes = std::move(baseline.notes);
  }

  // In tests of different days first beside a seal of its own in each, then in common from what was found there, unless
  // a seal that wears leaves nothing. What else differs from test to test is asked beside the laws.
  Status look_for_what_is_missing() {
    tell("looking for what is missing", 0.15);
    ExplainOptions options = options_;
    if (lacks_a_pressure()) options.maximum_laws = 0;
    if (!windowed()) fit_.may_differ = may_differ(asset_, fit_);
    if (!windowed()) fit_.fixed = known_values(asset_, plant());
    const ScreeningOptions screening{.seed = options.seed, .threads = options.threads};
    Result<Screening> first = screen(*baseline_, prepared(fit_), screening);
    if (!first) return fail(first.error());
    say_how_likely_by_noise(*first);
    if (!windowed() && may_age(asset_, fit_) && result_.statistically_significant) {
      own_ = each_its_own(what_wears(asset_), fit_, *baseline_, options.threads);
      if (own_ && !look_beside_own(*own_, {}, options)) own_.reset();
      if (own_ && !own_->naming.differs_in.empty()) {
        const Naming beside = own_->naming;
        if (look_beside_what_differs(beside, options)) return {};
        fit_.may_differ.clear();
        if (!time_.deadline().passed()) own_.reset();
      }
      if (own_ && explains_everything(*own_, options)) {
        take_over(*own_);
        return {};
      }
      if (own_ && own_->fit.known.size() > fit_.known.size()) {
        first = look_with_inexact_sensors(own_->fit.known, screening);
        if (!first) return fail(first.error());
      }
    }
    if (own_) fit_.may_differ.clear();  // nothing else was found to differ beside it
    std::optional<Trial> from;
    if (own_ && !own_->naming.best.effects.empty()) from = found_in_common(*own_);
    if (own_) tell("looking again, with one seal for all tests", 0.5);
    Result<Naming> naming = look_in_common(from.value_or(Trial{{}, baseline_}), options, &*first);
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

  // Sensors that were off beside what differs are so in common; also where the time to search is over.
  Result<Screening> look_with_inexact_sensors(const std::vector<KnownValue>& known, const ScreeningOptions& options) {
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

  // Also where the time to search is over: it is what is told then.
  std::optional<Trial> found_in_common(const OwnValues& own) {
    time_.allow(1.0);
    std::optional<Trial> laws = in_common(own, options_.threads);
    time_.allow(kSearchShare);
    return laws;
  }

  // Laws that all recordings have in common, beginning with `from`, beside sensors that are exact or not. `known`: the
  // baseline's screening.
  Result<Naming> look_in_common(const Trial& from, const ExplainOptions& options, const Screening* known) {
    Data data = prepared(fit_);
    data.sensors = unknown_sensors();
    Result<Naming> naming = name_effects(baseline_, data, options, progress_, from, known);
    if (!naming || !naming->sensors_are_inexact) return naming;
    Result<Naming> again = beside_inexact_sensors(*naming, options);
    // The search asked for a value in place of the sensors before it took them for inexact.
    const bool was_asked = again && naming->with_sensors && same_effects(naming->best.effects, again->best.effects);
    if (again && !was_asked && value_in_place_of_sensors(*again, data.sensors)) {
      tell("looking again, with exact sensors", 0.6);
      again->trials.clear();
      data.sensors.clear();
      again = name_effects(baseline_, data, options, progress_);
    } else if (again) {
      forget_predictions();
      std::ranges::copy(data.sensors, std::back_inserter(fit_.known));
      baseline_ = as_it_began(*again).baseline;
    }
    if (again || !time_.deadline().passed()) return again;
    naming->not_asked.emplace_back(kSensorsAgain);
    return naming;
  }

  // Sensors that are taken for exact so far.
  [[nodiscard]] std::vector<KnownValue> unknown_sensors() const {
    std::vector<KnownValue> sensors = known_sensors(asset_, baseline_->problem);
    std::erase_if(sensors, [&](const KnownValue& one) {
      return std::ranges::find(fit_.known, one.name, &KnownValue::name) != fit_.known.end();
    });
    return sensors;
  }

  // Laws beside a parameter of which each recording has its own; false where one for all does as well.
  bool look_beside_what_differs(const Naming& found, const ExplainOptions& options) {
    tell("looking again, with a " + found.differs_in + " for each test", 0.5);
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

  // Laws beside it, beginning with those found in common, beside sensors that are exact or not.
  bool look_beside_own(OwnValues& own, const Trial& found, const ExplainOptions& options) const {
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

  // The best of a search that was cut: whether it takes all of its laws, and what it leaves, has not been looked at.
  void look_at_what_is_left() {
    const bool was_cut = !naming_.not_asked.empty() && !naming_.best.effects.empty();
    if (was_cut) {
      time_.allow(1.0);
      if (!naming_.settled) settle(naming_, prepared(fit_), options_);
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

  // What was found is asked again beside sensors that are off by no more than they may be.
  [[nodiscard]] Result<Naming> beside_inexact_sensors(const Naming& found, const ExplainOptions& options) const {
    Data inexact = fit_;
    std::ranges::copy(known_sensors(asset_, baseline_->problem), std::back_inserter(inexact.known));
    const Trial& laws = found.best;
    // What the search compared the laws with is one of the two models already.
    const auto fitted = [&](const FittedModel& from) -> Result<std::shared_ptr<const FittedModel>> {
      if (found.with_sensors && &from == laws.model.get()) return found.with_sensors;
      if (found.baseline_with_sensors && &from == baseline_.get()) return found.baseline_with_sensors;
      Result<FittedModel> model = fit_model(from.asset, prepared(inexact), &from, options_.threads);
      if (!model) return fail(model.error());
      return std::make_shared<const FittedModel>(std::move(*model));
    };
    const auto with_sensors = fitted(*baseline_);
    if (!with_sensors) return fail(with_sensors.error());
    const auto with_laws = laws.model == baseline_ ? with_sensors : fitted(*laws.model);
    if (!with_laws) return fail(with_laws.error());
    const Trial from{laws.effects, *with_laws};
    tell("looking again, with sensors within their tolerances", 0.5);
    Result<Naming> beside = name_effects(*with_sensors, prepared(inexact), options, progress_, from);
    if (beside) keep_what_was_replaced(*beside, found);
    return beside;
  }

  // A search that began with values free does not know the laws that they replaced before.
  static void keep_what_was_replaced(Naming& naming, const Naming& before) {
    if (!naming.freed.empty() && naming.replaced.empty()) naming.replaced = before.replaced;
  }

  // With the laws that were found beside inexact sensors, one value of the asset file does what all sensors did.
  [[nodiscard]] bool value_in_place_of_sensors(const Naming& found, const std::vector<KnownValue>& sensors) const {
    const FittedModel& inexact = *found.best.model;
    AssetConfig asset = inexact.asset;
    asset.sensors = baseline_->asset.sensors;
    const Data exact = prepared(fit_);
    const auto model = fit_model(asset, exact, &inexact, options_.threads);
    const double phi = dispersion(inexact);
    const double score = criterion(inexact, phi) + occam_factor(inexact, sensors, phi);
    return model && a_value_explains(*model, score, phi, exact, options_.threads);
  }

  // The model follows the recordings, but nothing can be asked of it: no law, no test, no power.
  Result<Explanation> cannot_look(const Error& why) {
    why_none_ = time_.in_time("what is missing") ? cannot_be_asked(why) : time_was_up();
    time_.allow_what_is_needed();
    result_.statistically_significant = excess(*baseline_) > kGross;  // seen without any law
    if (result_.statistically_significant) result_.p_value = kSmallestP;
    naming_ = {.baseline = baseline_, .best = {{}, baseline_}, .trials = {{{}, baseline_}}, .first = {}, .last = {}};
    best_ = naming_.best;
    if (const Status status = finish(); !status) return fail(status.error());
    tell("done", 1.0);
    return std::move(result_);
  }

  void say_how_likely_by_noise(const Screening& screening) {
    result_.p_value = excess(*baseline_) > kGross ? kSmallestP : std::max(screening.p_value, kSmallestP);
    result_.statistically_significant = differs(screening.p_value, *baseline_, options_.false_alarm_rate);
  }

  // Of other data; what was predicted before is of no use.
  void forget_predictions() { predictions_ = std::make_shared<KeptPredictions>(); }

  void take_over(const OwnValues& own) {
    forget_predictions();
    fit_ = own.fit;
    fit_.sensors.clear();
    baseline_ = own.baseline;
    naming_ = own.naming;
    best_ = naming_.best;
    time_.add_not_asked(naming_.not_asked);
  }

  // Why the recordings differ though no physics is missing: something changed from test to test.
  void look_for_a_change() {
    if (!result_.statistically_significant || windowed() || fit_.samples.size() < 2) return;
    if (leaves_nothing()) return;
    if (const auto change = change_between_tests(asset_, fit_, *best_.model)) why_none_ = something_changed(*change);
  }

  // Why no law is named beside what differs from test to test, where that is so.
  void say_what_differs() {
    const std::string course = course_in_words(*best_.model, fit_);
    const bool no_more = best_.effects.empty() && leaves_nothing();
    if (!own_->goes_its_way)
      why_none_ = seal_changed_but_not_by_wear(course);
    else if (no_more)
      why_none_ = is_wear(*own_) ? seal_aged_and_no_more(course) : differed_and_no_more(course);
  }

  // What looks like another value in each test, and not by wear, may be a wrong value of another parameter in all of them.
  void ask_values_in_place_of_own() {
    const DatasheetQuestion question{asset_, *baseline_, own_->naming.best, fit_, options_.threads};
    const auto wrong = values_alone(question, fit_.samples.size());
    if (!wrong || wrong->behind > 0.0) return;
    const std::string other = is_wear(*own_) ? "seal" : own_->fit.own_parameter;
    std::vector<RecordingComparison> compared;
    if (bears_out(*wrong, *own_->naming.best.model, compared))
      blame_the_asset_file(*wrong, "another " + other + " in each test", compared);
  }

  [[nodiscard]] bool leaves_nothing() const {
    return !differs(naming_.last.p_value, *best_.model, options_.false_alarm_rate);
  }

  // What is fixed in the asset file may be wrong: laws and sensors' faults are then bent to it, or none is found. (In a
  // gross misfit without a law a value takes up some of whatever is missing.)
  void ask_the_datasheet() {
    const std::size_t laws = best_.effects.size();
    const bool asks = laws > 0 || (result_.statistically_significant && excess(*baseline_) <= kGross);
    if (!asks || (windowed() && !by_measurements(asset_, fit_))) return;
    tell("asking the values that the asset file fixes", 0.7);
    const Data data = prepared(fit_);
    const DatasheetQuestion question{asset_, *baseline_, best_, data, options_.threads};
    std::vector<std::string> instead_of;
    for (const Effect& effect : best_.effects) instead_of.push_back(law_in_words(law_at(effect)));
    const auto wrong = laws > 0 ? values_in_place_of_laws(question) : values_alone(question, 1);
    if (!wrong) return;
    asked_values_.push_back(asked(*wrong, naming_));
    // Laws that stand in both explanations are claimed with the better one.
    const double better_by = laws == 0 ? kWorthAnother : wrong->with.effects.empty() ? kCannotTell : 0.0;
    if (wrong->behind < -better_by) {
      std::vector<RecordingComparison> compared;
      time_.allow(1.0);  // a proof, whatever is searched further
      const bool borne_out = bears_out(*wrong, *best_.model, compared),
                 beside = borne_out && take_beside_values(*wrong, instead_of, compared);
      if (borne_out && !beside && wrong->behind < -kCannotTell)
        blame_the_asset_file(*wrong, joined(instead_of, " and "), compared);
      time_.allow(kSearchShare);
    }
    if (why_none_ || beside_ || laws == 0) return;
    result_.asset_values = wrong->values;
    instead_of_ = laws;
  }

  // Values that took the place of laws while these were searched are off, where the held-out recordings bear them out and
  // laws are beside them. Else the laws again: what values do alone is asked in the end, all that do it alike.
  void take_values_found() {
    if (naming_.freed.empty()) return;
    const Naming laws = *naming_.with_laws;
    WrongDatasheet wrong{.values = {values_off(*best_.model, asset_)}, .behind = naming_.behind_laws, .with = best_};
    std::vector<RecordingComparison> compared;
    time_.allow(1.0);  // a proof, whatever is searched further
    const bool beside =
        !best_.effects.empty() && !wrong.values.front().empty() && bears_out(wrong, *laws.best.model, compared);
    time_.allow(kSearchShare);
    if (!beside && best_.effects.empty()) ask_what_values_do_alone(laws);
    if (!beside && !why_none_ && !beside_) look_on_from(laws);
    if (!beside) return;
    if (time_.in_time("other values in place of the one that is off")) add_values_that_do_as_well(wrong);
    std::vector<std::string> replaced;
    for (const Effect& effect : naming_.replaced)
      if (!is_among(effect, best_.effects)) replaced.push_back(law_in_words(law_at(effect)));
    asked_values_ = trace_of(laws);
    asked_values_.push_back(asked(wrong, laws));
    beside_ = Beside{wrong, joined(replaced, " and "), joined(replaced, " and "), compared, laws};
  }

  void add_values_that_do_as_well(WrongDatasheet& wrong) const {
    if (wrong.values.front().size() != 1) return;
    std::vector<KnownValue> off = fit_.fixed;
    std::erase_if(off, [&](const KnownValue& value) { return value.name != wrong.values.front().front().name; });
    const std::vector<std::vector<std::size_t>> no_law(1);
    for (const ValueSwap& swap :
         values_in_place_of({wrong.with, no_law, fit_.fixed, prepared(fit_), options_.threads, kCannotTell, off}))
      wrong.values.push_back(values_off(*swap.with.model, asset_));
  }

  // All values that do it alike, and several of them.
  void ask_what_values_do_alone(const Naming& laws) {
    naming_ = laws;
    look_at_what_is_left();
    time_.allow(1.0);
    ask_the_datasheet();
    time_.allow(kSearchShare);
  }

  // The search for laws goes on where it was left, without values.
  void look_on_from(const Naming& laws) {
    result_.asset_values.clear();  // beside the laws so far
    instead_of_ = 0;
    fit_.fixed.clear();
    fit_.may_differ.clear();
    Result<Naming> further = look_in_common(laws.best, options_, &laws.first);
    naming_ = further ? std::move(*further) : laws;
    if (further && naming_.baseline == laws.baseline)
      naming_.trials.insert(naming_.trials.begin(), laws.trials.begin(), laws.trials.end());
    look_at_what_is_left();
  }

  static bool is_among(const Effect& effect, const std::vector<Effect>& effects) {
    return std::ranges::any_of(effects, [&](const Effect& other) { return same_place(law_at(effect), law_at(other)); });
  }

  // A value in place of one law, and others needed beside it: these are in both explanations, and are claimed. The search
  // goes on from them with that value free; false where it does not come to them, or to less than the laws did.
  bool take_beside_values(const WrongDatasheet& wrong, const std::vector<std::string>& laws,
                          const std::vector<RecordingComparison>& compared) {
    if (wrong.with.effects.empty()) return false;
    AssetConfig asset = baseline_->asset;
    for (const AssetValue& value : wrong.values.front()) asset = with_free_value(std::move(asset), value.name);
    Result<FittedModel> alone = fit_model(asset, prepared(fit_), wrong.with.model.get(), options_.threads);
    if (!alone) return false;
    tell("looking again, beside a value of the asset file", 0.7);
    const ScreeningOptions screening{.seed = options_.seed, .threads = options_.threads};
    const Result<Screening> first = screen(*alone, prepared(fit_), screening);
    if (!first) return false;
    time_.allow(kSearchShare);
    auto naming = name_effects(std::make_shared<const FittedModel>(std::move(*alone)), prepared(fit_), options_,
                               progress_, wrong.with, &*first);
    if (!naming || !naming->differs_in.empty() || naming->best.effects.empty()) return false;
    const auto known = [&](const Effect& effect) { return is_among(effect, best_.effects); };
    const double phi = std::min(dispersion(*naming->best.model), dispersion(*best_.model));
    if (!std::ranges::all_of(naming->best.effects, known) ||
        criterion(*naming->best.model, phi) > criterion(*best_.model, phi) ||
        values_off(*naming->best.model, asset_).empty())
      return false;
    std::vector<std::string> instead;
    for (std::size_t k = 0; k < laws.size(); ++k)
      if (!is_among(best_.effects[k], naming->best.effects)) instead.push_back(laws[k]);
    if (instead.empty()) return false;
    const std::vector<Asked> asked_before = trace_of(naming_);
    asked_values_.insert(asked_values_.begin(), asked_before.begin(), asked_before.end());
    beside_ = Beside{wrong, joined(instead, " and "), joined(laws, " and "), compared, std::move(naming_)};
    naming_ = std::move(*naming);
    look_at_what_is_left();
    return true;
  }

  // The laws beside it were taken back: what is left is the value.
  void fall_back_on_the_value() {
    const Beside beside = std::move(*beside_);
    beside_.reset();
    naming_ = beside.before;
    asked_values_.erase(asked_values_.begin(), std::prev(asked_values_.end()));  // the rest is in the trace again
    if (beside.wrong.behind < -kCannotTell) blame_the_asset_file(beside.wrong, beside.laws, beside.compared);
    take_no_law();
  }

  // Not where the value does not help on held-out recordings. Near the noise, whose own size is not known well enough to
  // tell shares of what exceeds it, it has to explain no more than what it replaces.
  [[nodiscard]] bool bears_out(const WrongDatasheet& wrong, const FittedModel& replaced,
                               std::vector<RecordingComparison>& compared) const {
    const auto blocks = held_out().gains({{}, baseline_}, wrong.with, &compared);
    if (!blocks) return false;
    if (blocks->gain.empty() && !blocks->not_compared.empty()) return false;
    if (!blocks->gain.empty() && gain_interval(*blocks, dispersion(*wrong.with.model), options_.seed).low <= 0.0)
      return false;
    return share_explained_by(*wrong.with.model) >= std::min(kExplainedAtLeast, share_explained_by(replaced));
  }

  void blame_the_asset_file(const WrongDatasheet& wrong, const std::string& instead_of,
                            const std::vector<RecordingComparison>& compared) {
    std::vector<std::string> beside;
    for (const Effect& effect : wrong.with.effects) {
      beside.push_back(law_in_words(law_at(effect)));
      result_.beside_asset_values.push_back(law_at(effect));
    }
    result_.asset_values = wrong.values;
    why_none_ =
        value_of_the_asset_file(values_in_words(wrong.values), wrong.values.front().size() > 1, joined(beside, " and "),
                                instead_of, compared.empty() ? PooledFit{} : pool(compared, true));
    with_another_value_ = wrong.with.model;
  }

  void tell(std::string_view step, double share) const {
    if (progress_) progress_(step, share);
  }

  // Where everything found still misses grossly, what is left is a slow course, to which slow laws bend best. Weighed
  // by its own colour, corners and episodes count for what they are. Where that fails, what was found before stays.
  void look_again() {
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

  Status weigh_by_colour() {
    const NoiseColour colour = residual_colour(*baseline_);
    forget_predictions();
    fit_.colour.assign(fit_.samples.size(), colour);
    holdout_.colour.assign(holdout_.samples.size(), colour);
    Result<FittedModel> model = fit_model(baseline_->asset, prepared(fit_), nullptr, options_.threads);
    if (!model) return fail(model.error());
    baseline_ = std::make_shared<const FittedModel>(std::move(*model));
    tell("looking again, weighed by the colour of what is left", 0.5);
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

  // Driven by the flow, the circuit takes chamber B's pressure as the reservoir's where it is not recorded. If that
  // shows, no law is asked for what an unrecorded pressure did.
  [[nodiscard]] bool lacks_a_pressure() const {
    return windowed() && by_measurements(asset_, fit_) && !recorded(ChannelRole::pressure_down) &&
           excess(*baseline_) > kGross;
  }

  [[nodiscard]] bool recorded(ChannelRole role) const {
    return find_series(fit_.samples.front(), plant_or_default(asset_.model), role) != nullptr;
  }

  [[nodiscard]] const PlantDescription& plant() const {
    return baseline_->problem.recordings.front().simulation->plant();
  }
  [[nodiscard]] bool windowed() const { return window_s_ > 0.0; }
  [[nodiscard]] HeldOut held_out() const { return {fit_, holdout_, window_s_, options_, predictions_}; }
  [[nodiscard]] Data prepared(const Data& data) const { return in_windows(data, window_s_); }

  [[nodiscard]] ToProve to_prove() const { return {held_out(), naming_, baseline_}; }

  void prove() {
    ProvenLaws laws = mismatch::prove(to_prove(), best_, time_);
    time_.allow(1.0);
    best_ = std::move(laws.best);
    proven_ = laws.proven;
    std::ranges::move(laws.notes, std::back_inserter(result_.notes));
    note_not_compared({.gain = {}, .not_compared = std::move(laws.not_compared)});
  }

  void note_not_compared(const BlockGains& blocks) {
    all_compared_ = all_compared_ && blocks.not_compared.empty();
    for (const std::string& one : blocks.not_compared)
      if (const std::string note = "Not compared, as a model cannot be simulated there: " + one + ".";
          std::ranges::find(result_.notes, note) == result_.notes.end())
        result_.notes.push_back(note);
  }

  // What is left beside a law says that something is left, not what, where it could as well sit in three other elements
  // or is no more than the law's own form may be off by; nor is a law claimed whose strength may be nothing.
  void describe_what_was_found() {
    const bool gross = excess(*best_.model) > kGross;
    const std::optional<CarryOver> carry_over =
        gross && !best_.effects.empty() ? std::optional(carry_over_of(to_prove(), held_out())) : std::nullopt;
    while (!gross && !best_.effects.empty()) {
      const std::optional<NotTold> law = not_told_from_zero(best_, resolution_of(prepared(fit_), plant()));
      if (!law) break;
      result_.notes.push_back(law->sentence);
      take_out(law->slot);
    }
    while (!best_.effects.empty()) {
      result_.effects = describe_effects(naming_, best_, prepared(fit_), options_, carry_over ? &*carry_over : nullptr);
      if (best_.effects.size() == 1 || gross) break;
      const std::optional<Remainder> remainder = remainder_among(result_.effects, law_at(best_.effects.back()));
      if (!remainder) break;
      result_.notes.push_back(remainder->sentence);
      const auto slot = std::ranges::find_if(
          best_.effects, [&](const Effect& effect) { return same_place(law_at(effect), remainder->law); });
      take_out(static_cast<std::size_t>(slot - best_.effects.begin()));
    }
    if (best_.effects.empty()) result_.effects.clear();
  }

  void take_out(std::size_t slot) {
    time_.allow_what_is_needed();
    best_ = without(best_, slot, to_prove());
    time_.allow(1.0);
  }

  Status finish() {
    tell("writing down what was found", 0.9);
    describe_what_was_found();
    if (beside_ && !best_.effects.empty()) {
      result_.asset_values = beside_->wrong.values;
      result_.asset_values.front() = values_off(*best_.model, asset_);
    }
    if (beside_ && (best_.effects.empty() || result_.asset_values.front().empty())) {
      result_.effects.clear();
      fall_back_on_the_value();
    }
    if (!best_.effects.empty()) static_cast<void>(time_.in_time("every alternative to the laws found"));
    time_.allow_what_is_needed();
    const Trial before{{}, baseline_};
    for (std::size_t k = 0; k < fit_.samples.size(); ++k) {
      if (!windowed()) {
        result_.recordings.push_back(compare(*baseline_, *best_.model, fit_, k));
        add_gain(result_.recordings.back(), block_gains(*baseline_, *best_.model, k), *best_.model, options_.seed);
        continue;
      }
      const auto old_model = free_run(baseline_->asset, fit_, k), new_model = free_run(best_.model->asset, fit_, k);
      if (!old_model || !new_model) {
        const Error& why = old_model ? new_model.error() : old_model.error();
        note_not_compared({.gain = {}, .not_compared = {fit_.names[k] + " as a whole (" + reason_in_words(why) + ")"}});
        continue;
      }
      result_.recordings.push_back(compare(*old_model, *new_model, only(fit_, k), 0));
      add_gain(result_.recordings.back(), block_gains(*old_model, *new_model, 0), *best_.model, options_.seed);
    }
    const auto blocks = held_out().gains(before, best_, &result_.recordings);
    if (!blocks) return fail(blocks.error());
    note_not_compared(*blocks);
    result_.fit = pool(result_.recordings, false);
    result_.holdout = pool(result_.recordings, true);
    if (takes_back_what_comes_nowhere_near() || takes_back_what_does_not_carry_over() ||
        takes_back_what_does_not_explain())
      return finish();
    result_.explained_share = explained_share();
    result_.power = power_of(best_.effects.empty() ? naming_.first : naming_.last, plant());
    if (!best_.effects.empty()) {
      result_.location = locate(result_.effects);
    } else if (result_.statistically_significant && asks_within(plant())) {
      const bool laws_ask = naming_.first.p_value <= options_.false_alarm_rate;
      result_.location = laws_ask ? locate_without_law(naming_.first) : locate_at_a_sensor(result_.fit);
    }
    for (const std::string& remark : naming_.remarks) result_.notes.push_back(remark);
    note_laws_not_asked();
    for (const Forbidden& forbidden : naming_.forbidden) result_.rejected.push_back(describe(forbidden));
    result_.parameters = parameter_shifts(asset_, *baseline_, *best_.model);
    result_.prognosis = prognosis_shift(asset_, result_.parameters);
    result_.explained = best_.model->asset;
    for (const std::vector<AssetValue>& entry : result_.asset_values)  // fixed again, at what fits
      for (const AssetValue& value : entry) {
        ParameterSetting& setting = result_.explained.parameters.at(value.name);
        const ParameterSetting& given = asset_.parameters.at(value.name);
        setting = {.value = setting.value,
                   .min = given.min,
                   .max = given.max,
                   .estimate = false,
                   .tolerance = given.tolerance};
      }
    if (!naming_.trials.empty() && !beside_) result_.trace = trace_of(naming_);
    std::ranges::copy(asked_values_, std::back_inserter(result_.trace));
    if (result_.statistically_significant && !naming_.last.variants.empty())
      result_.candidates =
          candidate_causes(best_.effects.empty() ? naming_.first : naming_.last, *best_.model, *baseline_);
    compare_with_what_was_kept_aside();
    decide();
    for (FoundEffect& effect : result_.effects)
      effect.evidence = evidence_of(effect, result_.effects.size(), without_laws().misfit / without_laws().residuals,
                                    best_.model->misfit / best_.model->residuals);
    result_.next_test = next_test_of(result_);
    if (lacks_a_pressure())
      result_.next_test =
          "Record the pressures of both chambers, or the motor's voltage: with the flow and the differential pressure "
          "alone, the pressure of chamber B cannot be separated from missing physics.";
    result_.summary = summary_of(result_);
    say_what_else_is_known();
    if (const std::string moved = values_at_their_end(*best_.model, asset_); !moved.empty()) {
      result_.notes.push_back(moved);
      if (result_.verdict == Verdict::undetermined && !why_none_) result_.summary += " " + moved;
    }
    if (!asks_within(plant())) remark_nothing_asked_within(plant(), why_none_.has_value(), result_);
    return {};
  }

  // A law that has no value where the plant goes may be what is missing.
  void note_laws_not_asked() {
    for (const Candidate& candidate : naming_.first.not_asked) {
      const LawAt law = law_at({candidate.law, candidate.element});
      result_.notes.push_back(gives_no_number(law));
      all_compared_ = false;
    }
  }

  static void say_what_was_cut(Explanation& result) {
    if (result.not_asked.empty()) result.not_asked.emplace_back("further steps of what was being fitted");
    result.summary += " The time limit cut the search: not everything was asked.";
    result.notes.push_back("Not asked, as time was up: " + joined(result.not_asked, "; and ") + ".");
  }

  void take_all_laws_back() {
    best_ = {.effects = {}, .model = baseline_};
    proven_ = false;
    result_.effects.clear();
    result_.asset_values.clear();
    result_.recordings.clear();
    if (beside_) fall_back_on_the_value();
  }

  // Laws that leave less than half of a channel's course reproduced, far above its noise, bend to something else: a
  // wrong unit, a sign, a channel of another sensor.
  bool takes_back_what_comes_nowhere_near() {
    if (windowed() || best_.effects.empty()) return false;
    const ChannelComparison* far = farthest_off(result_.fit);
    // Where the seal ages, R_CL of the held-out ones is predicted, and what they miss by is that prediction's error.
    if (far == nullptr && fit_.own_parameter.empty()) far = farthest_off(result_.holdout);
    if (far == nullptr) return false;
    why_none_ = nowhere_near(*far, fit_, result_.fit);
    take_all_laws_back();
    return true;
  }

  // Nor where a channel of held-out recordings comes out worse: other loads and speeds do not bear it out.
  bool takes_back_what_does_not_carry_over() {
    const ChannelComparison* worse = best_.effects.empty() ? nullptr : made_worse(result_.holdout);
    if (worse == nullptr) return false;
    result_.notes.push_back(does_not_carry_over(*worse));
    tried_ = best_;
    take_all_laws_back();
    return true;
  }

  /// The model that the laws are beside: with the values that are off, where they were found beside such.
  [[nodiscard]] const FittedModel& without_laws() const { return beside_ ? *naming_.baseline : *baseline_; }
  [[nodiscard]] double share_explained_by(const FittedModel& model) const {
    return share_explained(without_laws().misfit / without_laws().residuals, model.misfit / model.residuals);
  }
  [[nodiscard]] double explained_share() const { return share_explained_by(*best_.model); }

  [[nodiscard]] bool explains() const {
    return mismatch::explains({.any = !best_.effects.empty(),
                               .proven = proven_,
                               .leave_nothing = leaves_nothing(),
                               .share = explained_share(),
                               .as_searched = naming_.best.effects.size() == best_.effects.size(),
                               .p_before = beside_ ? naming_.first.p_value : result_.p_value,
                               .p_after = naming_.last.p_value});
  }

  // Laws that fit better and explain too little say where to look; a name for it they are not.
  bool takes_back_what_does_not_explain() {
    if (best_.effects.empty() || explains()) return false;
    std::vector<std::string> laws;
    for (const Effect& effect : best_.effects) laws.push_back(law_in_words(law_at(effect)));
    result_.notes.push_back("Not enough to be named: with " + joined(laws, " and ") +
                            " the mean squared residual of the fit recordings falls from " +
                            number(without_laws().misfit / without_laws().residuals) + " to " +
                            number(best_.model->misfit / best_.model->residuals) + " times the noise variance.");
    tried_ = best_;
    take_all_laws_back();
    return true;
  }

  // The fitted recordings agree, and those kept aside do not: what came in between, or acts under their conditions
  // alone, has no part in the fit that could tell it.
  void compare_with_what_was_kept_aside() {
    if (windowed() || why_none_ || result_.statistically_significant) return;
    if (const ChannelComparison* worst = missed_in(result_.holdout)) why_none_ = those_kept_aside_differ(*worst);
  }

  // The channel that is furthest off, where that is more than its noise; null where none is.
  static const ChannelComparison* missed_in(const PooledFit& fit) {
    const auto worst = std::ranges::max_element(fit.channels, {}, &ChannelComparison::weighed_rms_after);
    return worst == fit.channels.end() || worst->weighed_rms_after < kHeldOutAgrees ? nullptr : &*worst;
  }

  [[nodiscard]] std::string what_happened() const {
    return is_wear(*own_) ? what_aged(asset_) + " aged between these tests. "
                          : "Something changed between these tests. ";
  }

  // Beside the verdict and the laws.
  void say_what_else_is_known() {
    const std::string course = own_ ? what_happened() + course_in_words(*best_.model, fit_) : "";
    remark_leak_in_two_parts(result_);
    if (why_none_) {
      if (with_another_value_ && !course.empty()) why_none_->summary += " " + course;
      const ChannelComparison* missed = own_ && is_wear(*own_) ? missed_in(result_.holdout) : nullptr;
      if (missed != nullptr) why_none_->summary += missed_by_trend(*missed);
      return remark_why_none(*why_none_, result_);
    }
    if (own_) is_wear(*own_) ? remark_ageing(course, result_) : remark_difference(course, result_);
    const bool beside = beside_ && !result_.effects.empty();
    // Taken back since: what stood for laws has nothing to stand for.
    if (!beside && result_.effects.size() != instead_of_) result_.asset_values.clear();
    if (beside)
      remark_values_beside(beside_->instead, beside_->wrong.behind > -kCannotTell, result_);
    else if (!result_.asset_values.empty())
      remark_asset_values(result_);
    if (best_.effects.size() == 1 && same_effects(best_.effects, naming_.best.effects) && !leaves_nothing() &&
        leaves_its_form(naming_))
      result_.notes.push_back(left_beside(law_at(best_.effects.front()), share_left_by_best(naming_)));
    const bool undetermined = result_.verdict == Verdict::undetermined;
    if (input_swings_ && undetermined) remark_faster_sampling(result_);
    const bool nothing_asks = naming_.first.p_value > options_.false_alarm_rate;
    if (result_.statistically_significant && nothing_asks && !result_.location.empty())
      remark_disturbed_signal(result_);
  }

  void decide() {
    const std::vector<const Power*> blind = could_not_show(result_.power);
    const Findings findings{.no_law_for_a_reason = why_none_.has_value(),
                            .differs = result_.statistically_significant,
                            .something_hides = !blind.empty(),
                            .all_compared = all_compared_,
                            .explained = explains()};
    result_.verdict = verdict_of(findings);
    if (result_.verdict == Verdict::mismatch && naming_.last.p_value <= options_.false_alarm_rate)
      result_.notes.emplace_back("A remainder beyond the noise stays unexplained.");
    if (why_none_ || findings.differs) return;
    for (const Power* one : blind)
      result_.notes.push_back("These recordings would show " + law_in_words(one->what) + " only from " +
                              number(one->minimum_detectable) + " " + one->unit + "; an engineer would care from " +
                              number(one->significant) + " " + one->unit + ".");
  }

  const AssetConfig& asset_;
  Data fit_, holdout_;
  const ExplainOptions& options_;
  const Progress& progress_;
  TimeBudget time_;
  std::shared_ptr<const FittedModel> baseline_;
  std::optional<OwnValues> own_;  ///< each test has its own of a parameter, and nothing in common is preferred
  Naming naming_;
  Trial best_;
  Trial tried_;  ///< what was taken back, as it explains too little
  bool proven_ = false;
  bool all_compared_ = true;                               ///< the models can be simulated on every recording
  bool input_swings_ = false;                              ///< between its samples, through much of the tests
  std::optional<WhyNone> why_none_;                        ///< set: no law is named
  std::shared_ptr<const FittedModel> with_another_value_;  ///< of the asset file, where that explains it
  std::vector<Asked> asked_values_;                        ///< of the asset file, the best only
  /// Values that are off beside the laws that are claimed.
  struct Beside {
    WrongDatasheet wrong;
    std::string instead;  ///< of them: the laws that they replace, in words
    std::string laws;     ///< all that were found without them
    std::vector<RecordingComparison> compared;
    Naming before;  ///< without them
  };
  std::optional<Beside> beside_;
  std::size_t instead_of_ = 0;  ///< laws, for which a value would do as well
  double window_s_ = 0.0;
  std::shared_ptr<KeptPredictions> predictions_ = std::make_shared<KeptPredictions>();  ///< of fit_ and holdout_
  Explanation result_;
};

// One recording alone, in two where it is long; nothing otherwise.
std::vector<Recording> halves_of_one(const AssetConfig& asset, std::span<const Recording> fit,
                                     std::span<const Recording> holdout) {
  if (fit.size() != 1 || !holdout.empty()) return {};
  const auto simulation = PlantSimulation::create(asset, fit.front().samples);
  return simulation ? in_halves(fit.front(), (*simulation)->channels()) : std::vector<Recording>{};
}

}  // namespace

Status ExplainOptions::validate() const {
  if (!(false_alarm_rate > 0.0 && false_alarm_rate < 0.5))
    return fail("false_alarm_rate must be between 0 and 0.5, is " + number(false_alarm_rate));
  if (maximum_laws < 1 || maximum_laws > 3)
    return fail("maximum_laws must be 1 to 3, is " + std::to_string(maximum_laws));
  if (!(time_limit_s > 0.0)) return fail("time_limit_s must be positive, is " + number(time_limit_s));
  if (threads < 1) return fail("threads must be at least 1, is " + std::to_string(threads));
  return {};
}

Result<Explanation> explain(const AssetConfig& asset, std::span<const Recording> fit,
                            std::span<const Recording> holdout, const ExplainOptions& options,
                            const Progress& progress) {
  if (const Status status = options.validate(); !status) return fail(status.error());
  if (const Status status = check(asset, fit, holdout); !status) return fail(status.error());
  std::vector<std::string> notes;
  const std::vector<Recording> kept_aside = thinned(holdout, notes);
  std::vector<Recording> fitted = thinned(fit, notes);
  std::vector<Recording> halves = halves_of_one(asset, fitted, kept_aside);
  if (!halves.empty()) fitted = halves;
  Result<Explanation> found =
      Analysis(asset, data_of(fitted, kept_aside), data_of(kept_aside, fitted), options, progress).run();
  if (!found) return found;
  std::ranges::move(notes, std::back_inserter(found->notes));
  if (!halves.empty())
    found->notes.push_back(
        "The one recording is long enough to be two, a correlation time apart: each half is left out "
        "in turn.");
  for (const auto& list : {fit, holdout})
    for (const Recording& recording : list)
      if (!recording.left_aside.empty())
        found->notes.push_back(recording.file + ": columns that the plant does not know were left aside: " +
                               joined(recording.left_aside, " and ") + ".");
  return found;
}

}  // namespace sealwatch::mismatch
