#include "services/common/mismatch/analysis.hpp"

#include <algorithm>
#include <iterator>

#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/form_error.hpp"
#include "services/common/mismatch/power.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/remarks.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/value_swaps.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kHeldOutAgrees = 1.5;  // noise-normalised rms of a channel: the noise's own estimate is off by less

}  // namespace

void Analysis::prove() {
  ProvenLaws laws = mismatch::prove(to_prove(), best_, time_);
  time_.allow(1.0);
  best_ = std::move(laws.best);
  proven_ = laws.proven;
  std::ranges::move(laws.notes, std::back_inserter(result_.notes));
  note_not_compared({.gain = {}, .not_compared = std::move(laws.not_compared)});
}

void Analysis::note_not_compared(const BlockGains& blocks) {
  all_compared_ = all_compared_ && blocks.not_compared.empty();
  for (const std::string& one : blocks.not_compared)
    if (const std::string note = not_compared(one); std::ranges::find(result_.notes, note) == result_.notes.end()) {
      result_.notes.push_back(note);
      not_compared_.push_back(one);
    }
}

void Analysis::describe_what_was_found() {
  const bool gross = excess(*best_.model) > kGross;
  const std::optional<CarryOver> carry_over =
      gross && !best_.effects.empty() ? std::optional(carry_over_of(to_prove(), held_out())) : std::nullopt;
  if (gross) take_out_forms_of_larger_laws();
  while (!gross && !best_.effects.empty()) {
    const std::optional<NotTold> law = not_told_from_zero(best_, resolution_of(prepared(fit_), plant()));
    if (!law) break;
    result_.notes.push_back(law->sentence);
    if (!law->by_size.empty()) too_small_by_size_ = law->by_size;
    take_out(law->slot);
  }
  while (!best_.effects.empty()) {
    result_.effects = describe_effects(naming_, best_, prepared(fit_), options_, carry_over ? &*carry_over : nullptr);
    if (best_.effects.size() == 1 || gross) break;
    const std::optional<Remainder> remainder =
        remainder_among(result_.effects, law_at(best_.effects.back(), plant()),
                        [&](const LawAt& small, const LawAt& large) { return more_than_form(small, large); });
    if (!remainder) break;
    take_out(*remainder);
  }
  if (best_.effects.empty()) result_.effects.clear();
}

void Analysis::take_out_forms_of_larger_laws() {
  const auto elsewhere = [](const LawAt& small, const LawAt& large) { return small.element != large.element; };
  while (best_.effects.size() > 1) {
    time_.allow_what_is_needed();
    std::vector<FoundEffect> helps(best_.effects.size());
    for (std::size_t slot = 0; slot < helps.size(); ++slot) {
      helps[slot].what = law_at(best_.effects[slot], plant());
      const auto blocks = held_out().gains(without(best_, slot, to_prove()), best_);
      if (!blocks || blocks->gain.empty()) return;  // nothing is known of that law alone
      helps[slot].delta_bic = -gain_interval(*blocks, dispersion(*best_.model), options_.seed).gain;
    }
    time_.allow(1.0);
    const std::optional<Remainder> remainder = remainder_among(helps, helps.back().what, elsewhere);
    if (!remainder) return;
    take_out(*remainder);
  }
}

bool Analysis::more_than_form(const LawAt& small, const LawAt& large) {
  const auto slot_of = [&](const LawAt& law) {
    const auto is_it = [&](const Effect& effect) { return same_place(law_at(effect, plant()), law); };
    return static_cast<std::size_t>(std::ranges::find_if(best_.effects, is_it) - best_.effects.begin());
  };
  const std::size_t slot = slot_of(small);
  time_.allow_what_is_needed();
  const Trial fewer = without(best_, slot, to_prove());
  const LawStart one{best_.effects[slot], parameters_in(best_.effects[slot], best_.model->asset)};
  const bool more =
      !mismatch::more_than_form(*fewer.model, {&best_.effects[slot_of(large)], 1}, {one}, prepared(fit_), options_)
           .empty();
  time_.allow(1.0);
  return more;
}

void Analysis::take_out(const Remainder& remainder) {
  result_.notes.push_back(remainder.sentence);
  const auto slot = std::ranges::find_if(
      best_.effects, [&](const Effect& effect) { return same_place(law_at(effect, plant()), remainder.law); });
  take_out(static_cast<std::size_t>(slot - best_.effects.begin()));
}

void Analysis::take_out(std::size_t slot) {
  time_.allow_what_is_needed();
  best_ = without(best_, slot, to_prove());
  time_.allow(1.0);
}

Status Analysis::finish() {
  tell("writing the report", 0.9);
  describe_what_was_found();
  take_values_beside();
  if (!best_.effects.empty()) static_cast<void>(time_.in_time("every alternative to the laws found"));
  time_.allow_what_is_needed();
  if (const Status compared = compare_recordings(); !compared) return compared;
  if (takes_back_what_comes_nowhere_near() || takes_back_what_does_not_carry_over() ||
      takes_back_what_does_not_explain())
    return finish();
  result_.explained_share = explained_share();
  if (excess(*best_.model) > kGross) limit_probabilities(result_);
  result_.power = power_of(best_.effects.empty() ? naming_.first : naming_.last, plant());
  say_where();
  for (const std::string& remark : naming_.remarks) result_.notes.push_back(remark);
  note_laws_not_asked();
  for (const Forbidden& forbidden : naming_.forbidden) result_.rejected.push_back(describe(forbidden, plant()));
  result_.parameters = parameter_shifts(asset_, *baseline_, *best_.model);
  result_.prognosis = prognosis_shift(asset_, result_.parameters);
  result_.explained = best_.model->asset;
  fix_values_again();
  if (!naming_.trials.empty() && !beside_) result_.trace = trace_of(naming_);
  std::ranges::copy(asked_values_, std::back_inserter(result_.trace));
  if (result_.statistically_significant && !naming_.last.variants.empty())
    result_.candidates =
        candidate_causes(best_.effects.empty() ? naming_.first : naming_.last, *best_.model, *baseline_);
  compare_with_what_was_kept_aside();
  decide();
  put_in_words();
  return {};
}

void Analysis::take_values_beside() {
  if (beside_ && !best_.effects.empty()) {
    result_.asset_values = beside_->wrong.values;
    result_.asset_values.front() = values_off(*best_.model, asset_);
  }
  if (beside_ && (best_.effects.empty() || result_.asset_values.front().empty())) {
    result_.effects.clear();
    fall_back_on_the_value();
  }
}

Status Analysis::compare_recordings() {
  for (std::size_t k = 0; k < fit_.samples.size(); ++k) compare_fitted(k);
  const auto blocks = held_out().gains({{}, baseline_}, best_, &result_.recordings);
  if (!blocks) return fail(blocks.error());
  note_not_compared(*blocks);
  none_compared_ = blocks->gain.empty();
  result_.fit = pool(result_.recordings, false);
  result_.holdout = pool(result_.recordings, true);
  return {};
}

void Analysis::compare_fitted(std::size_t recording) {
  const auto add = [&](const FittedModel& before, const FittedModel& after, const Data& data, std::size_t place) {
    result_.recordings.push_back(compare(before, after, data, place));
    add_gain(result_.recordings.back(), block_gains(before, after, place), *best_.model, options_.seed);
  };
  if (!windowed()) return add(*baseline_, *best_.model, fit_, recording);
  const auto before = free_run(*baseline_, fit_, recording), after = free_run(*best_.model, fit_, recording);
  if (before && after) return add(*before, *after, only(fit_, recording), 0);
  const std::string why = reason_in_words(before ? after.error() : before.error());
  note_not_compared({.gain = {}, .not_compared = {fit_.names[recording] + " as a whole (" + why + ")"}});
}

void Analysis::say_where() {
  if (!best_.effects.empty()) {
    result_.location = locate(result_.effects);
  } else if (result_.statistically_significant && asks_within(plant())) {
    const bool laws_ask = naming_.first.p_value <= options_.false_alarm_rate;
    result_.location = laws_ask ? locate_without_law(naming_.first) : locate_at_a_sensor(result_.fit);
  }
}

void Analysis::fix_values_again() {
  for (const std::vector<AssetValue>& entry : result_.asset_values)
    for (const AssetValue& value : entry) {
      ParameterSetting& setting = result_.explained.parameters.at(value.name);
      const ParameterSetting& given = asset_.parameters.at(value.name);
      setting = {
          .value = setting.value, .min = given.min, .max = given.max, .estimate = false, .tolerance = given.tolerance};
    }
}

void Analysis::put_in_words() {
  for (FoundEffect& effect : result_.effects)
    effect.evidence = evidence_of(effect, result_.effects.size(), without_laws().misfit / without_laws().residuals,
                                  best_.model->misfit / best_.model->residuals);
  result_.next_test = next_test_of(result_);
  result_.summary = summary_of(result_);
  if (!not_compared_.empty() && result_.verdict == Verdict::undetermined && !why_none_)
    result_.summary = result_.statistically_significant ? result_.summary + " " + not_compared(joined(not_compared_))
                                                        : "The recordings that could be compared show no difference "
                                                          "beyond the noise. " +
                                                              not_compared(joined(not_compared_));
  say_what_else_is_known();
  if (const std::string moved = values_at_their_end(*best_.model, asset_); !moved.empty()) {
    result_.notes.push_back(moved);
    if (result_.verdict == Verdict::undetermined && !why_none_) result_.summary += " " + moved;
  }
  if (!asks_within(plant())) remark_nothing_asked_within(plant(), why_none_.has_value(), result_);
}

void Analysis::note_laws_not_asked() {
  for (const Candidate& candidate : naming_.first.not_asked) {
    const LawAt law = law_at({candidate.law, candidate.element}, plant());
    result_.notes.push_back(gives_no_number(law));
    all_compared_ = false;
  }
}

void Analysis::limit_probabilities(Explanation& result) {
  for (FoundEffect& effect : result.effects) {
    effect.probability = std::min(effect.probability, result.explained_share);
    effect.element_probability = std::min(effect.element_probability, result.explained_share);
  }
}

void Analysis::say_what_was_cut(Explanation& result) const {
  if (result.not_asked.empty()) result.not_asked.emplace_back("further steps of the fit in progress");
  result.notes.push_back("Not tried, as time was up: " + joined(result.not_asked, "; and ") + ".");
  limit_probabilities(result);
  const std::string more = more_time_than(options_.time_limit_s);
  if (result.next_test.starts_with(more)) return;
  const std::string cut = "The time limit ended the search: not everything was tried.";
  result.summary = result.verdict == Verdict::undetermined ? cut + " " + result.summary : result.summary + " " + cut;
  const bool alone = result.verdict == Verdict::undetermined || result.next_test.empty();
  result.next_test = alone ? more + "." : more + ". Then: " + result.next_test;
}

void Analysis::take_all_laws_back() {
  best_ = {.effects = {}, .model = baseline_};
  proven_ = false;
  result_.effects.clear();
  result_.asset_values.clear();
  result_.recordings.clear();
  if (beside_) fall_back_on_the_value();
}

bool Analysis::takes_back_what_comes_nowhere_near() {
  if (windowed() || best_.effects.empty()) return false;
  const ChannelComparison* far = farthest_off(result_.fit);
  // Where the seal ages, R_CL of the held-out ones is predicted, and what they miss by is that prediction's error.
  if (far == nullptr && fit_.own_parameter.empty()) far = farthest_off(result_.holdout);
  if (far == nullptr) return false;
  why_none_ = nowhere_near(*far, fit_, result_.fit);
  take_all_laws_back();
  return true;
}

bool Analysis::takes_back_what_does_not_carry_over() {
  if (best_.effects.empty()) return false;
  const ChannelComparison* worse = made_worse(result_.holdout);
  if (worse == nullptr && !none_compared_) return false;
  result_.notes.push_back(worse != nullptr ? does_not_carry_over(*worse)
                                           : "What was found cannot be compared with anything on the held-out "
                                             "recordings: it is not claimed.");
  if (const std::optional<Trial> rest = worse != nullptr ? without_what_makes_it_worse() : std::nullopt) {
    take_back_to(*rest);
    return true;
  }
  tried_ = best_;
  take_all_laws_back();
  return true;
}

std::optional<Trial> Analysis::without_what_makes_it_worse() {
  std::optional<Trial> rest;
  double most = 0.0;
  time_.allow_what_is_needed();
  for (std::size_t slot = 0; slot < best_.effects.size() && best_.effects.size() > 1; ++slot) {
    const Trial fewer = without(best_, slot, to_prove());
    std::vector<RecordingComparison> compared;
    const auto blocks = held_out().gains({{}, baseline_}, fewer, &compared);
    if (!blocks || blocks->gain.empty() || made_worse(pool(compared, true)) != nullptr) continue;
    const GainInterval gain = gain_interval(*blocks, dispersion(*fewer.model), options_.seed);
    if (gain.low <= 0.0 || gain.gain * dispersion(*fewer.model) <= most) continue;
    most = gain.gain * dispersion(*fewer.model);
    rest = fewer;
  }
  return rest;
}

void Analysis::take_back_to(const Trial& rest) {
  best_ = rest;
  result_.effects.clear();
  result_.recordings.clear();
}

double Analysis::share_explained_by(const FittedModel& model) const {
  return share_explained(without_laws().misfit / without_laws().residuals, model.misfit / model.residuals);
}

bool Analysis::explains() const {
  return mismatch::explains({.any = !best_.effects.empty(),
                             .proven = proven_,
                             .leave_nothing = leaves_nothing(),
                             .share = explained_share(),
                             .share_held_out = share_held_out(),
                             .leave_what_is_within = !asks_within(plant()) && excess(*best_.model) > kGross,
                             .as_searched = naming_.best.effects.size() == best_.effects.size(),
                             .p_before = beside_ ? naming_.first.p_value : result_.p_value,
                             .p_after = naming_.last.p_value,
                             .leave_gross_misfit = largest_excess(*best_.model) > kGross});
}

double Analysis::share_held_out() const {
  const bool is_measure_of_laws = !windowed() && fit_.weight.empty() && fit_.own_parameter.empty();
  if (!is_measure_of_laws || excess(*best_.model) <= kGross) return 1.0;
  double before = 0.0, after = 0.0, count = 0.0;
  for (const ChannelComparison& channel : result_.holdout.channels) {
    if (!std::isfinite(channel.rms_before) || !std::isfinite(channel.rms_after)) continue;
    before += channel.rms_before * channel.rms_before;
    after += channel.rms_after * channel.rms_after;
    ++count;
  }
  return count == 0.0 ? 1.0 : share_explained(before / count, after / count);
}

bool Analysis::takes_back_what_does_not_explain() {
  if (best_.effects.empty() || explains()) return false;
  std::vector<std::string> laws;
  for (const Effect& effect : best_.effects) laws.push_back(law_in_words(effect));
  result_.notes.push_back("Not enough to be named: with " + joined(laws, " and ") +
                          " the mean squared residual of the fit recordings falls from " +
                          number(without_laws().misfit / without_laws().residuals) + " to " +
                          number(best_.model->misfit / best_.model->residuals) + " times the noise variance.");
  tried_ = best_;
  take_all_laws_back();
  return true;
}

void Analysis::compare_with_what_was_kept_aside() {
  if (windowed() || why_none_ || result_.statistically_significant) return;
  if (const ChannelComparison* worst = missed_in(result_.holdout)) why_none_ = those_kept_aside_differ(*worst);
}

const ChannelComparison* Analysis::missed_in(const PooledFit& fit) {
  const auto worst = std::ranges::max_element(fit.channels, {}, &ChannelComparison::weighed_rms_after);
  return worst == fit.channels.end() || worst->weighed_rms_after < kHeldOutAgrees ? nullptr : &*worst;
}

std::string Analysis::what_happened() const {
  if (is_wear(*own_)) return "The " + worn_part(asset_) + " aged between these tests. ";
  if (leaves_nothing()) return "Something changed between these tests. ";
  return "Something changed between these tests, or some of them show more of what is missing. ";
}

void Analysis::say_what_else_is_known() {
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
    result_.notes.push_back(left_beside(law_at(best_.effects.front(), plant()), share_left_by_best(naming_)));
  const bool undetermined = result_.verdict == Verdict::undetermined;
  if (input_swings_ && undetermined) remark_faster_sampling(result_);
  if (undetermined && !too_small_by_size_.empty()) remark_law_sizes(too_small_by_size_, result_);
  const bool nothing_asks = naming_.first.p_value > options_.false_alarm_rate;
  if (result_.statistically_significant && nothing_asks && !result_.location.empty()) remark_disturbed_signal(result_);
}

void Analysis::decide() {
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
                            text::readable(one->minimum_detectable, one->unit) + "; an engineer would care from " +
                            text::readable(one->significant, one->unit) + ".");
}

}  // namespace sealwatch::mismatch
