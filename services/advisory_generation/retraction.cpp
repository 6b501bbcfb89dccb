// What the retraction of tests does to the advice: the next test is judged with those that still count.
#include "services/advisory_generation/advisory_generation.hpp"
#include "services/advisory_generation/advisory_revision.hpp"
#include "services/advisory_generation/reasons.hpp"

namespace sealwatch::advisory_generation {
namespace {

/// Five years of monthly tests: the rules against flapping look back over far fewer.
constexpr std::size_t kMostJudged = 60;
/// Retractions whose answers are on their way.
constexpr std::size_t kMostAnswered = 256;

}  // namespace

void AdvisoryGeneration::remember(Judged judged, Asset& asset) {
  if (judged.replacement_id.empty()) asset.retracted.know(judged.pst_id, judged.time);
  asset.judged.push_back(std::move(judged));
  if (asset.judged.size() > kMostJudged) asset.judged.erase(asset.judged.begin());
}

void AdvisoryGeneration::note_replacement(const std::string& message_id, UtcTime time, Asset& asset) {
  asset.memory = {};
  asset.replaced = time;
  asset.replacements[message_id] = time;
  Judged replacement;
  replacement.time = time;
  replacement.replacement_id = message_id;
  remember(std::move(replacement), asset);
}

void AdvisoryGeneration::apply(const Retraction& retraction, Asset& asset) const {
  asset.retracted.apply(retraction);
  asset.replaced.reset();
  for (const auto& [message_id, time] : asset.replacements)
    if (asset.retracted.holds(message_id)) asset.replaced = std::max(asset.replaced.value_or(time), time);
  judge_anew(asset);
}

bool AdvisoryGeneration::learn(const Retraction& retraction, Asset& asset) const {
  if (!asset.retractions.insert(retraction.id).second) return false;
  apply(retraction, asset);
  return true;
}

void AdvisoryGeneration::judge_anew(Asset& asset) const {
  asset.memory = {};
  asset.last_test.reset();
  for (const Judged& one : asset.judged) {
    if (!one.replacement_id.empty()) {
      if (asset.retracted.holds(one.replacement_id)) asset.memory = {};
      continue;
    }
    if (!asset.retracted.counts(one.pst_id)) continue;
    (void)asset.memory.judge(one.verdict, one.time, options_);
    if (one.time) asset.last_test = one.time;
  }
}

AdvisoryGeneration::Judged* AdvisoryGeneration::last_counted(Asset& asset) {
  for (auto one = asset.judged.rbegin(); one != asset.judged.rend(); ++one) {
    const bool is_test = one->replacement_id.empty();
    if (!is_test && asset.retracted.holds(one->replacement_id)) return nullptr;  // none since counts
    if (is_test && asset.retracted.counts(one->pst_id)) return &*one;
  }
  return nullptr;
}

void AdvisoryGeneration::remember_words(const Advisory& advisory, Asset& asset) {
  if (asset.judged.empty() || asset.judged.back().pst_id != advisory.header.pst_id) return;
  TestWords& said = asset.judged.back().said;
  said.reasons = reasons_of_condition(advisory.header, advisory.reasons);
  if (!advisory.safety.empty()) said.margins = advisory.safety.front();
}

Conclusion AdvisoryGeneration::retracted(const MaintenanceEvent& event) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  const auto retraction = retraction_of(event);
  if (!retraction) return conclusion;
  Asset& asset = assets_[event.asset_id];
  if (learn(*retraction, asset) && asset.current)
    put_out(after_retraction(*asset.current, event, *retraction), conclusion);
  return conclusion;
}

template <class Input>
Conclusion AdvisoryGeneration::take_answer(const Input& input, std::optional<Input> Answers::*slot) {
  const std::string id = *retraction_answered(input.header);
  Asset& asset = assets_[input.asset_id];
  if (asset.concluded.contains("advisory/" + renewed_id(id)) || !asset.current || !retraction_of(input.asset_id, id))
    return {.outputs = {}, .consumed = {input.header.message_id}};
  Conclusion conclusion;
  answers_to(id, asset, conclusion).*slot = input;
  renew(id, asset, conclusion);
  return conclusion;
}

template Conclusion AdvisoryGeneration::take_answer(const RemainingLife&, std::optional<RemainingLife> Answers::*);
template Conclusion AdvisoryGeneration::take_answer(const HealthReport&, std::optional<HealthReport> Answers::*);
template Conclusion AdvisoryGeneration::take_answer(const StateReport&, std::optional<StateReport> Answers::*);
template Conclusion AdvisoryGeneration::take_answer(const LeakageEstimate&, std::optional<LeakageEstimate> Answers::*);

AdvisoryGeneration::Answers& AdvisoryGeneration::answers_to(const std::string& retraction_id, Asset& asset,
                                                            Conclusion& conclusion) {
  const auto found = std::ranges::find(asset.answers, retraction_id, &Answers::retraction_id);
  if (found != asset.answers.end()) return *found;
  if (asset.answers.size() == kMostAnswered) {
    const auto refuse = [&](const auto& answer) {
      if (!answer) return;
      conclusion.consumed.push_back(answer->header.message_id);
      conclusion.refused.push_back({*answer, "other layers did not answer this retraction, and did later ones"});
    };
    const Answers& first = asset.answers.front();
    refuse(first.life), refuse(first.health), refuse(first.state), refuse(first.leakage);
    asset.answers.pop_front();
  }
  return asset.answers.emplace_back(Answers{.retraction_id = retraction_id});
}

void AdvisoryGeneration::renew(const std::string& retraction_id, Asset& asset, Conclusion& conclusion) {
  const auto found = std::ranges::find(asset.answers, retraction_id, &Answers::retraction_id);
  if (found == asset.answers.end() || !found->life || !found->health || !found->state) return;
  const Answers answers = std::move(*found);
  asset.answers.erase(found);
  LeakageEstimate last;  // what is known of it stands in the remaining life
  last.asset_id = answers.life->asset_id;
  last.header.event_time_known = last.used_for_forecast = answers.life->condition_known;
  last.header.event_time_ns = answers.life->header.event_time_ns;
  Evidence evidence{*answers.life, *answers.health, *answers.state, last, TestWords()};
  for (const Header* answer : {&evidence.life.header, &evidence.health.header, &evidence.state.header})
    conclusion.consumed.push_back(answer->message_id);
  const bool was_known = !learn(*retraction_answered_by(evidence.state), asset);
  const Header& answered = evidence.life.header;
  // A later test was judged meanwhile: its advice is newer than these answers.
  if (was_known && answered.event_time_known && asset.last_test && UtcTime{answered.event_time_ns} < *asset.last_test)
    return;
  Judged* const now_last = last_counted(asset);
  if (now_last && now_last->time && now_last->time->nanoseconds == answered.event_time_ns)
    evidence.said = now_last->said;
  const Assessment assessment = assess(evidence, site_of(evidence.life.asset_id), options_);
  if (now_last) now_last->verdict = assessment.verdict;  // by all that is known now
  judge_anew(asset);
  Header cause = evidence.life.header;
  cause.message_id = renewed_id(retraction_id);
  put_out(evidence, cause, assessment, asset.memory.in_force(), conclusion);
}

}  // namespace sealwatch::advisory_generation
