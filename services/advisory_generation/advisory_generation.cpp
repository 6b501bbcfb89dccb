#include "services/advisory_generation/advisory_generation.hpp"

#include <array>

#include "services/advisory_generation/advisory_revision.hpp"
#include "services/advisory_generation/safety_book.hpp"

namespace sealwatch::advisory_generation {
namespace {

constexpr std::array kInputs{Topic::remaining_life,   Topic::health_report,   Topic::state_report,
                             Topic::leakage_estimate, Topic::acknowledgement, Topic::maintenance_event};
constexpr std::array kOutputs{Topic::advisory};

}  // namespace

Result<std::unique_ptr<AdvisoryGeneration>> AdvisoryGeneration::make(const Configuration& configuration,
                                                                     const Options& options) {
  if (const Status valid = options.validate(); !valid) return fail(valid.error());
  return std::unique_ptr<AdvisoryGeneration>(new AdvisoryGeneration(configuration, options));
}

std::span<const Topic> AdvisoryGeneration::inputs() const { return kInputs; }
std::span<const Topic> AdvisoryGeneration::outputs() const { return kOutputs; }

void AdvisoryGeneration::restore(const Message& own_output) {
  if (const auto* record = std::get_if<ActRecord>(&own_output))
    for (const MaintenanceEvent& event : record->events)
      if (event.tests_known && assets_[event.asset_id].retracted.name(event.header.message_id, event.test_ids))
        judge_anew(assets_[event.asset_id]);
  const auto* advisory = std::get_if<Advisory>(&own_output);
  if (!advisory) return;
  Asset& asset = assets_[advisory->asset_id];
  asset.concluded.insert(advisory->header.message_id);
  if (advisory->state == AdvisoryState::superseded) return;
  stand(*advisory, asset);
  const Header& header = advisory->header;
  if (asset.retracted.meet(header.pst_id)) judge_anew(asset);
  if (is_answer_to_replacement(*advisory)) {
    note_replacement(header.source_ids.front(), UtcTime{header.event_time_ns}, asset);
  } else if (const auto renewed = retraction_of_renewed(*advisory)) {
    learn(*renewed, asset);
    const auto record = advisory->reasons.empty() ? std::nullopt : from_words(advisory->reasons.back());
    if (Judged* const last = record ? last_counted(asset) : nullptr) last->verdict = record->verdict;
    judge_anew(asset);
  } else if (const auto retraction = answered_retraction(*advisory)) {
    learn(*retraction, asset);
  } else if (header.message_id == "advisory/" + header.pst_id && !advisory->reasons.empty()) {
    std::optional<UtcTime> time;
    if (header.event_time_known) time = UtcTime{header.event_time_ns};
    if (const auto record = from_words(advisory->reasons.back())) {
      asset.memory.restore(record->verdict, record->in_force);
      remember({header.pst_id, time, record->verdict}, asset);
      remember_words(*advisory, asset);
    }
    if (time) asset.last_test = time;
  }
}

Conclusion AdvisoryGeneration::receive(const Message& input) {
  if (const auto* life = std::get_if<RemainingLife>(&input)) return join(*life, &Pending::life, &Answers::life);
  if (const auto* health = std::get_if<HealthReport>(&input)) return join(*health, &Pending::health, &Answers::health);
  if (const auto* leakage = std::get_if<LeakageEstimate>(&input))
    return join(*leakage, &Pending::leakage, &Answers::leakage);
  if (const auto* state = std::get_if<StateReport>(&input))
    return state->header.pst_id.empty() && !retraction_answered(state->header)
               ? overdue(*state)
               : join(*state, &Pending::state, &Answers::state);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input))
    return is_replacement(*event) ? replaced(*event) : retracted(*event);
  if (const auto* seen = std::get_if<Acknowledgement>(&input)) return acknowledged(*seen);
  return {.outputs = {}, .consumed = {header_of(input).message_id}};
}

template <class Input>
Conclusion AdvisoryGeneration::join(const Input& input, Halves<Input> Pending::*halves,
                                    std::optional<Input> Answers::*slot) {
  if (retraction_answered(input.header)) return take_answer(input, slot);
  const std::string& pst_id = input.header.pst_id;
  Asset& asset = assets_[input.asset_id];
  if (pst_id.empty() || asset.concluded.contains("advisory/" + pst_id))
    return {.outputs = {}, .consumed = {input.header.message_id}};
  Conclusion conclusion;
  Pending& all = asset.pending;
  (all.*halves).add(input, conclusion);
  if (!all.life.has(pst_id) || !all.health.has(pst_id) || !all.state.has(pst_id) || !all.leakage.has(pst_id) ||
      !all.life.is_here(pst_id, conclusion) || !all.health.is_here(pst_id, conclusion) ||
      !all.state.is_here(pst_id, conclusion) || !all.leakage.is_here(pst_id, conclusion))
    return conclusion;
  const Evidence evidence{all.life.take(pst_id, conclusion), all.health.take(pst_id, conclusion),
                          all.state.take(pst_id, conclusion), all.leakage.take(pst_id, conclusion)};
  for (const Header* of :
       {&evidence.life.header, &evidence.health.header, &evidence.state.header, &evidence.leakage.header})
    conclusion.consumed.push_back(of->message_id);
  advise(evidence, conclusion);
  return conclusion;
}

std::size_t AdvisoryGeneration::held() const {
  std::size_t held = 0;
  for (const auto& [asset_id, asset] : assets_)
    held += asset.pending.life.overtaken() + asset.pending.health.overtaken() + asset.pending.state.overtaken() +
            asset.pending.leakage.overtaken();
  return held;
}

void AdvisoryGeneration::advise(const Evidence& evidence, Conclusion& conclusion) {
  const std::string& asset_id = evidence.life.asset_id;
  Asset& asset = assets_[asset_id];
  const Header& cause = evidence.life.header;
  if (asset.retracted.meet(cause.pst_id)) judge_anew(asset);
  if (!asset.retracted.counts(cause.pst_id)) return;
  std::optional<UtcTime> now;
  if (cause.event_time_known) now = UtcTime{cause.event_time_ns};
  if (now && asset.last_test && *now < *asset.last_test) {
    // One that was played back may be of any time. One that was made just now is the latest, or a date is wrong.
    if (!cause.replay)
      conclusion.refused.push_back(
          {evidence.life, "the test is of " + format_utc(*now) + ", and one of " + format_utc(*asset.last_test) +
                              " is known: its advice stands; if that date is wrong, retract it"});
    return;
  }
  if (now && asset.replaced && *now < *asset.replaced) return;
  // One that cannot be placed: what the others advise stands, unless the actuator does not do its stroke.
  if (!now && asset.last_test && evidence.state.verdict != PstVerdict::failed) return;
  if (now) asset.last_test = now;

  const SiteConfig* site = site_of(asset_id);
  const Assessment assessment = assess(evidence, site, options_);
  const InForce& in_force = asset.memory.judge(assessment.verdict, now, options_);
  remember({cause.pst_id, now, assessment.verdict}, asset);
  put_out(evidence, cause, assessment, in_force, conclusion);
  remember_words(*asset.current, asset);
}

void AdvisoryGeneration::put_out(const Evidence& evidence, const Header& cause, const Assessment& assessment,
                                 const InForce& in_force, Conclusion& conclusion) {
  const std::string& asset_id = evidence.life.asset_id;
  const SiteConfig* site = site_of(asset_id);
  const Recommendation recommendation = recommend(evidence, assessment, in_force, site, part_of(asset_id));
  Advisory advisory = revision_of(assets_[asset_id].current, asset_id, recommendation, cause);
  advisory.header.source_ids = source_ids(evidence);
  advisory.reasons = assessment.reasons;
  advisory.reasons.insert(advisory.reasons.end(), recommendation.also.begin(), recommendation.also.end());
  for (std::string& reason : reasons_of_dates(recommendation, assessment.verdict, in_force, site, options_))
    advisory.reasons.push_back(std::move(reason));
  const AssetConfig* config = configuration_.find_asset(asset_id);
  advisory.decision = evidence.life.decision;
  advisory.safety = {
      safety_book(evidence, config, configuration_.decision_of(config ? config->site : std::string()).safety)};
  for (std::string& reason : in_words(advisory.decision, advisory.safety.front()))
    advisory.reasons.push_back(std::move(reason));
  advisory.reasons.push_back(in_words(assessment.verdict, in_force));
  if (is_replacement(advisory.action)) advisory.request_for_work = {work_order(advisory, recommendation)};
  put_out(std::move(advisory), conclusion);
}

Conclusion AdvisoryGeneration::overdue(const StateReport& report) {
  Conclusion conclusion{.outputs = {}, .consumed = {report.header.message_id}};
  Asset& asset = assets_[report.asset_id];
  const bool already_tested =
      asset.last_test && report.header.event_time_known && UtcTime{report.header.event_time_ns} < *asset.last_test;
  const bool answered = asset.concluded.contains("advisory/" + report.header.message_id);
  if (!report.pst_overdue || already_tested || answered) return conclusion;
  put_out(with_overdue_test(asset.current, report), conclusion);
  return conclusion;
}

Conclusion AdvisoryGeneration::replaced(const MaintenanceEvent& event) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  Asset& asset = assets_[event.asset_id];
  const UtcTime time{event.header.event_time_ns};
  const bool newer_known = asset.replaced && *asset.replaced >= time;
  const bool withdrawn = !asset.retracted.holds(event.header.message_id);
  if (!event.header.event_time_known || newer_known || withdrawn) return conclusion;
  note_replacement(event.header.message_id, time, asset);
  const bool tested_since = asset.current && asset.last_test && *asset.last_test > time;
  put_out(tested_since ? after_late_replacement(*asset.current, event) : after_replacement(asset.current, event),
          conclusion);
  return conclusion;
}

Conclusion AdvisoryGeneration::acknowledged(const Acknowledgement& acknowledgement) {
  Conclusion conclusion{.outputs = {}, .consumed = {acknowledgement.header.message_id}};
  Asset& asset = assets_[acknowledgement.asset_id];
  if (!asset.current) return conclusion;
  std::optional<Advisory> answer = with_acknowledgement(*asset.current, asset.current_id, acknowledgement);
  if (answer && !asset.concluded.contains(answer->header.message_id)) put_out(std::move(*answer), conclusion);
  return conclusion;
}

void AdvisoryGeneration::put_out(Advisory advisory, Conclusion& conclusion) {
  Asset& asset = assets_[advisory.asset_id];
  if (asset.current && asset.current->advisory_id == advisory.supersedes_id && advisory.revision == 1) {
    Advisory old = superseded(*asset.current, advisory);
    asset.concluded.insert(old.header.message_id);
    conclusion.outputs.emplace_back(std::move(old));
  }
  asset.concluded.insert(advisory.header.message_id);
  stand(advisory, asset);
  conclusion.outputs.emplace_back(std::move(advisory));
}

void AdvisoryGeneration::stand(const Advisory& advisory, Asset& asset) {
  asset.current_id = id_without_acknowledgements(advisory, asset.current_id);
  asset.current = advisory;
}

const SiteConfig* AdvisoryGeneration::site_of(const std::string& asset_id) const {
  const AssetConfig* asset = configuration_.find_asset(asset_id);
  return asset ? configuration_.find_site(asset->site) : nullptr;
}

std::string AdvisoryGeneration::part_of(const std::string& asset_id) const {
  const AssetConfig* asset = configuration_.find_asset(asset_id);
  if (asset == nullptr) return kPistonSeal;  // its file is gone since: of the built-in plants, as most are
  return asset->condition ? asset->condition->part : "";
}

RequestForWork AdvisoryGeneration::work_order(const Advisory& advisory, const Recommendation& recommendation) const {
  const AssetConfig* asset = configuration_.find_asset(advisory.asset_id);
  const std::optional<UtcTime>& replaced = assets_.at(advisory.asset_id).replaced;
  RequestForWork work;
  const std::string part = part_of(advisory.asset_id);
  const std::string replaceable = part == kPistonSeal ? "seal" : part.empty() ? "actuator" : part;
  work.work_id = "work/" + advisory.asset_id + "/" +
                 (replaced ? replaceable + " of " + format_date(*replaced) : "first " + replaceable);
  work.work_type = "replace actuator";
  work.segment = asset ? asset->site + (asset->segment.empty() ? "" : "/" + asset->segment) : "";
  work.solution_package = "spare actuator" + (asset ? " (model " + asset->model + ")" : std::string()) +
                          (part.empty() ? "" : " with new " + part) + ", vessel with remotely operated vehicle";
  if (recommendation.work_before) {
    work.start_before_known = true;
    work.start_before_ns = recommendation.work_before->nanoseconds;
  }
  work.remarks = advisory.recommendation;
  return work;
}

}  // namespace sealwatch::advisory_generation
