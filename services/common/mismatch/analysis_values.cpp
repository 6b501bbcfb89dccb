#include "services/common/mismatch/analysis.hpp"

#include <algorithm>
#include <iterator>

#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/value_swaps.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

// In a gross misfit a value takes up some of whatever is missing.
bool is_in_place_of_what_is_missing(const FittedModel& laws, const FittedModel& with_value) {
  return excess(with_value) > kGross && takes_up_little(laws, with_value);
}

}  // namespace

void Analysis::ask_values_in_place_of_own() {
  const DatasheetQuestion question{asset_, *baseline_, own_->naming.best, fit_, options_.threads};
  const auto wrong = values_alone(question, fit_.samples.size());
  if (!wrong || wrong->behind > 0.0) return;
  const std::string other = is_wear(*own_) ? worn_part(asset_) : own_->fit.own_parameter;
  std::vector<RecordingComparison> compared;
  if (bears_out(*wrong, *own_->naming.best.model, compared))
    blame_the_asset_file(*wrong, "another " + other + " in each test", compared);
}

void Analysis::ask_the_datasheet() {
  const std::size_t laws = best_.effects.size();
  const bool asks = laws > 0 || (result_.statistically_significant && excess(*baseline_) <= kGross);
  if (!asks) return;
  tell("testing the values fixed in the asset file", 0.7);
  const Data data = prepared(fit_);
  const DatasheetQuestion question{asset_, *baseline_, best_, data, options_.threads};
  std::vector<std::string> instead_of;
  for (const Effect& effect : best_.effects) instead_of.push_back(law_in_words(effect));
  const auto wrong = laws > 0 ? values_in_place_of_laws(question) : values_alone(question, 1);
  if (!wrong) {
    static_cast<void>(time_.in_time(kFixedValues));  // or the question was cut
    return;
  }
  asked_values_.push_back(asked(*wrong, naming_));
  // A sensor or a recording is no likelier off than a value: where one does as well as the other, nobody can tell.
  const double instead_by = only_measurements_are_off() ? -kCannotTell : kCannotTell;
  // Laws that stand in both explanations are claimed with the better one.
  const double better_by = laws == 0 ? kWorthAnother : wrong->with.effects.empty() ? instead_by : 0.0;
  if (wrong->behind < -better_by) {
    std::vector<RecordingComparison> compared;
    time_.allow(1.0);  // a proof, whatever is searched further
    const bool borne_out = bears_out(*wrong, *best_.model, compared),
               beside = borne_out && take_beside_values(*wrong, instead_of, compared);
    if (borne_out && !beside && (wrong->with.effects.empty() || wrong->behind < -kCannotTell) &&
        (wrong->with.effects.empty() || !is_in_place_of_what_is_missing(*best_.model, *wrong->with.model)))
      blame_the_asset_file(*wrong, joined(instead_of, " and "), compared);
    time_.allow(kSearchShare);
  }
  if (why_none_ || beside_ || laws == 0) return;
  result_.asset_values = wrong->values;
  instead_of_ = laws;
}

bool Analysis::only_measurements_are_off() const {
  return !best_.effects.empty() &&
         std::ranges::all_of(best_.effects, [](const Effect& effect) { return is_of_measurement(effect.law->kind); });
}

void Analysis::take_no_measurement_for_a_value() {
  const bool was_cut = std::ranges::find(time_.not_asked(), kFixedValues) != time_.not_asked().end();
  if (!was_cut || !only_measurements_are_off() || known_values(asset_, plant()).empty()) return;
  std::vector<std::string> laws;
  for (const Effect& effect : best_.effects) laws.push_back(law_in_words(effect));
  why_none_ = values_not_asked(joined(laws, " and "), options_.time_limit_s);
}

// Laws that held-out recordings do not bear out leave what they explained to a value.
void Analysis::ask_the_datasheet_alone() {
  result_.asset_values.clear();
  if (!time_.in_time("the values that the asset file fixes, without the laws that were not proven")) return;
  ask_the_datasheet();
  time_.allow(1.0);
  if (why_none_) take_no_law();
}

void Analysis::take_values_found() {
  if (naming_.freed.empty()) return;
  const Naming laws = *naming_.with_laws;
  WrongDatasheet wrong{.values = {values_off(*best_.model, asset_)}, .behind = naming_.behind_laws, .with = best_};
  std::vector<RecordingComparison> compared;
  time_.allow(1.0);  // a proof, whatever is searched further
  const bool beside =
      !best_.effects.empty() && !wrong.values.front().empty() && bears_out(wrong, *laws.best.model, compared);
  time_.allow(kSearchShare);
  if (!beside && best_.effects.empty() && laws.best.effects.empty() && !wrong.values.front().empty()) {
    value_alone(wrong, laws);
    return;
  }
  if (!beside && best_.effects.empty()) ask_what_values_do_alone(laws);
  if (!beside && !why_none_ && !beside_) look_on_from(laws);
  if (!beside) return;
  if (time_.in_time("other values in place of the one that is off")) add_values_that_do_as_well(wrong);
  std::vector<std::string> replaced;
  for (const Effect& effect : naming_.replaced)
    if (!is_among(effect, best_.effects)) replaced.push_back(law_in_words(effect));
  asked_values_ = trace_of(laws);
  asked_values_.push_back(asked(wrong, laws));
  beside_ = Beside{wrong, joined(replaced, " and "), joined(replaced, " and "), compared, laws};
}

// Values that were found before any law, and left nothing for one. Where they are not borne out, laws are looked for.
void Analysis::value_alone(WrongDatasheet wrong, const Naming& laws) {
  std::vector<RecordingComparison> compared;
  time_.allow(1.0);  // a proof, whatever is searched further
  const bool borne_out = bears_out(wrong, *baseline_, compared);
  time_.allow(kSearchShare);
  if (!borne_out) return look_on_from(laws);
  if (time_.in_time("other values in place of the one that is off")) add_values_that_do_as_well(wrong);
  asked_values_.push_back(asked(wrong, laws));
  blame_the_asset_file(wrong, "", compared);
  naming_ = laws;
  best_ = naming_.best;
}

void Analysis::add_values_that_do_as_well(WrongDatasheet& wrong) const {
  if (wrong.values.front().size() != 1) return;
  std::vector<KnownValue> off = fit_.fixed;
  std::erase_if(off, [&](const KnownValue& value) { return value.name != wrong.values.front().front().name; });
  const std::vector<std::vector<std::size_t>> no_law(1);
  for (const ValueSwap& swap :
       values_in_place_of({wrong.with, no_law, fit_.fixed, prepared(fit_), options_.threads, kCannotTell, off}))
    wrong.values.push_back(values_off(*swap.with.model, asset_));
}

void Analysis::ask_what_values_do_alone(const Naming& laws) {
  naming_ = laws;
  look_at_what_is_left();
  time_.allow(1.0);
  ask_the_datasheet();
  time_.allow(kSearchShare);
}

void Analysis::look_on_from(const Naming& laws) {
  result_.asset_values.clear();  // beside the laws so far
  instead_of_ = 0;
  fit_.fixed.clear();
  fit_.may_differ.clear();
  const KnownOfBaseline known{laws.first};
  Result<Naming> further = look_in_common(laws.best, options_, &known);
  naming_ = further ? std::move(*further) : laws;
  if (further && naming_.baseline == laws.baseline)
    naming_.trials.insert(naming_.trials.begin(), laws.trials.begin(), laws.trials.end());
  look_at_what_is_left();
}

bool Analysis::is_among(const Effect& effect, const std::vector<Effect>& effects) {
  return std::ranges::any_of(
      effects, [&](const Effect& other) { return effect.law->id == other.law->id && effect.element == other.element; });
}

bool Analysis::take_beside_values(const WrongDatasheet& wrong, const std::vector<std::string>& laws,
                                  const std::vector<RecordingComparison>& compared) {
  if (wrong.with.effects.empty() || is_in_place_of_what_is_missing(*best_.model, *wrong.with.model)) return false;
  AssetConfig asset = baseline_->asset;
  for (const AssetValue& value : wrong.values.front()) asset = with_free_value(std::move(asset), value.name);
  Result<FittedModel> alone = fit_baseline(asset, prepared(fit_), *wrong.with.model, options_.threads);
  if (!alone) return false;
  tell("searching again, beside a value of the asset file", 0.7);
  const ScreeningOptions screening{.seed = options_.seed, .threads = options_.threads};
  Result<Screening> first = screen(*alone, prepared(fit_), screening);
  if (!first) return false;
  const KnownOfBaseline of_values{std::move(*first)};
  time_.allow(kSearchShare);
  auto naming = name_effects(std::make_shared<const FittedModel>(std::move(*alone)), prepared(fit_), options_,
                             progress_, wrong.with, &of_values);
  if (!naming || !naming->differs_in.empty() || naming->best.effects.empty()) return false;
  const auto known = [&](const Effect& effect) { return is_among(effect, best_.effects); };
  // What stands in one of the explanations only is not claimed.
  if (!std::ranges::all_of(naming->best.effects, known)) {
    time_.allow(1.0);  // it is what is told
    Result<Screening> left = screen(*wrong.with.model, prepared(fit_), screening);
    time_.allow(kSearchShare);
    if (!left) return false;
    naming->best = wrong.with;
    naming->last = std::move(*left);
  }
  const double phi = std::min(dispersion(*naming->best.model), dispersion(*best_.model));
  if (criterion(*naming->best.model, phi) > criterion(*best_.model, phi) ||
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

void Analysis::fall_back_on_the_value() {
  const Beside beside = std::move(*beside_);
  beside_.reset();
  naming_ = beside.before;
  asked_values_.erase(asked_values_.begin(), std::prev(asked_values_.end()));  // the rest is in the trace again
  if (beside.wrong.behind < -kCannotTell) blame_the_asset_file(beside.wrong, beside.laws, beside.compared);
  take_no_law();
}

bool Analysis::bears_out(const WrongDatasheet& wrong, const FittedModel& replaced,
                         std::vector<RecordingComparison>& compared) const {
  const auto blocks = held_out().gains({{}, baseline_}, wrong.with, &compared);
  if (!blocks) return false;
  if (blocks->gain.empty() && !blocks->not_compared.empty()) return false;
  if (!blocks->gain.empty() && gain_interval(*blocks, dispersion(*wrong.with.model), options_.seed).low <= 0.0)
    return false;
  return share_explained_by(*wrong.with.model) >= std::min(kExplainedAtLeast, share_explained_by(replaced));
}

void Analysis::blame_the_asset_file(const WrongDatasheet& wrong, const std::string& instead_of,
                                    const std::vector<RecordingComparison>& compared) {
  std::vector<std::string> beside;
  for (const Effect& effect : wrong.with.effects) {
    beside.push_back(law_in_words(effect));
    result_.beside_asset_values.push_back(law_at(effect, plant()));
  }
  result_.asset_values = wrong.values;
  why_none_ =
      value_of_the_asset_file(values_in_words(wrong.values), wrong.values.front().size() > 1, joined(beside, " and "),
                              instead_of, compared.empty() ? PooledFit{} : pool(compared, true));
  with_another_value_ = wrong.with.model;
}

}  // namespace sealwatch::mismatch
