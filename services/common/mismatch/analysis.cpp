#include "services/common/mismatch/analysis.hpp"

#include <algorithm>
#include <iterator>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/drawn_terms.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/gross_mismatch.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/screening.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/verdict.hpp"
#include "services/common/model/runtime_simulation.hpp"

namespace sealwatch::mismatch {
Result<Explanation> Analysis::run() {
  Result<Explanation> result = analyse();
  if (time_.deadline().cancelled()) return fail("the analysis was called off");
  if (result) std::ranges::copy(time_.not_asked(), std::back_inserter(result->not_asked));
  if (result && time_.deadline().was_met() && more_time_helps_) say_what_was_cut(*result);
  return result;
}

Result<Explanation> Analysis::analyse() {
  result_.asset_id = asset_.asset_id;
  result_.model = asset_.model;
  result_.fit_recordings = fit_.names;
  result_.holdout_recordings = holdout_.names;
  time_.allow(1.0);
  if (auto gross = explain_gross_mismatch(asset_, fit_, holdout_, options_, progress_)) return std::move(*gross);
  time_.allow(kSearchShare);
  tell("fitting the model as it is", 0.02);
  Result<Baseline> baseline = fit_baseline(asset_, fit_, holdout_, options_, time_);
  if (!baseline) return fail(baseline.error());
  take_up(std::move(*baseline));
  if (const auto runaway = follows_no_machine())
    return tell_no_law(runs_away(in_words(*runaway), advice_for_runaway()));
  if (const Status status = look_for_what_is_missing(); !status) {
    if (time_.in_time("what is missing")) return tell_no_law(cannot_be_asked(status.error()));
    const std::optional<Error> ever = why_no_law_can_be_asked();
    more_time_helps_ = !ever;
    return tell_no_law(ever ? cannot_be_asked(*ever) : time_was_up(options_.time_limit_s));
  }
  if (at_rest(*baseline_, prepared(fit_))) why_none_ = nothing_moves();
  if (const auto part = driven_unseen(); part && !why_none_ && result_.statistically_significant)
    why_none_ = drives_unseen(*part);
  if (!why_none_ && time_.in_time("whether something changed between the tests")) look_for_a_change();
  if (!why_none_ && own_ && !own_->goes_its_way) say_what_differs();
  if (!why_none_) take_values_found();
  if (!why_none_ && own_) say_what_differs();
  const bool asked = why_none_ || beside_ || !result_.asset_values.empty();
  time_.allow(kSettledBy);
  if (!asked && time_.in_time(kFixedValues)) ask_the_datasheet();
  time_.allow(1.0);
  if (!why_none_) take_no_measurement_for_a_value();
  if (why_none_) take_no_law();
  if (!best_.effects.empty()) {
    tell("proving on held-out recordings", 0.75);
    prove();
    if (best_.effects.empty() && !beside_) ask_the_datasheet_alone();
  }
  if (beside_ && best_.effects.empty()) fall_back_on_the_value();
  if (!why_none_ && time_.not_asked().empty()) look_again();
  if (const Status status = finish(); !status) return fail(status.error());
  time_.allow(1.0);
  if (time_.in_time("a picture of what is missing"))
    draw_missing_terms(*baseline_, tried_.effects.empty() ? best_ : tried_, prepared(fit_), !windowed(), result_);
  tell("done", 1.0);
  return std::move(result_);
}

void Analysis::take_up(Baseline baseline) {
  baseline_ = std::move(baseline.model);
  window_s_ = baseline.window_s;
  input_swings_ = baseline.input_swings;
  result_.notes = std::move(baseline.notes);
}

std::optional<Runaway> Analysis::follows_no_machine() const {
  if (windowed() || excess(*baseline_) <= kGross) return std::nullopt;
  return find_runaway(baseline_->asset, fit_.samples.front());
}

Result<Explanation> Analysis::tell_no_law(WhyNone why) {
  why_none_ = std::move(why);
  time_.allow_what_is_needed();
  result_.statistically_significant = excess(*baseline_) > kGross;  // seen without any law
  if (result_.statistically_significant) result_.p_value = kSmallestP;
  naming_ = {.baseline = baseline_, .best = {{}, baseline_}, .trials = {{{}, baseline_}}, .first = {}, .last = {}};
  best_ = naming_.best;
  if (const Status status = finish(); !status) return fail(status.error());
  tell("done", 1.0);
  return std::move(result_);
}

std::optional<Error> Analysis::why_no_law_can_be_asked() {
  const FittedModel& model = *baseline_;
  if (!may_jump(*model.problem.recordings.front().simulation)) return std::nullopt;
  std::vector<Candidate> one =
      find_candidates(*model.problem.recordings.front().simulation, model.asset.physics, Laws::listed);
  if (one.empty()) return std::nullopt;
  one.erase(one.begin() + 1, one.end());
  time_.allow_what_is_needed();
  const Result<Screening> asked = screen_laws(model, std::move(one), prepared(fit_),
                                              {.draws = 1, .seed = options_.seed, .threads = options_.threads});
  return asked ? std::nullopt : std::optional(asked.error());
}

void Analysis::tell(std::string_view step, double share) const {
  if (progress_) progress_(step, share);
}

std::optional<PlantPart> Analysis::driven_unseen() const {
  PlantPart part = simulated_part(asset_, fit_.samples.front());
  // Little is left where the samples count, and errors of the measured input add up to as much.
  const bool may_be_all = part.unseen_at_reversal_s > 0.0 || excess(*baseline_) > kGross;
  if (part.not_recorded.empty() || !may_be_all) return std::nullopt;
  return part;
}

const PlantDescription& Analysis::plant() const { return baseline_->problem.recordings.front().simulation->plant(); }

}  // namespace sealwatch::mismatch
