#include "services/advisory_generation/assessment.hpp"

#include <algorithm>
#include <string_view>

#include "sealwatch/config/judged_quantities.hpp"
#include "services/advisory_generation/reasons.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::advisory_generation {
namespace {

// When no later campaign is known, one that is longer before the P10 end of life is not the last before it: campaigns
// come at least every year or two, later ones are just not planned yet.
constexpr double kUnplannedAfter_months = 12.0;
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

const ProposedFault* dominant_fault(const HealthReport& health, const Options& options) {
  if (health.ambiguity_group.empty()) return nullptr;
  const ProposedFault& first = health.ambiguity_group.front();
  return first.likelihood >= options.dominant_likelihood ? &first : nullptr;
}

/// Last date at which the seal may be replaced: the last campaign that keeps the failure probability down, else the end
/// of life that comes true earlier with that probability.
UtcTime replace_by(const Forecast& forecast, UtcTime now, const Options& options) {
  const UtcTime early_end = add_months(now, forecast.rul_p10_months);
  std::optional<UtcTime> campaign;
  bool later_one_known = false;
  for (const FailureProbability& candidate : forecast.failure_probability) {
    later_one_known = candidate.probability > options.largest_failure_probability;
    if (later_one_known) break;
    campaign = UtcTime{candidate.before_ns};
  }
  if (campaign && !later_one_known && months_between(*campaign, early_end) > kUnplannedAfter_months) campaign.reset();
  return start_of_day(campaign.value_or(early_end));
}

WearLevel level_for(double months_to_booking, const Options& options) {
  if (months_to_booking < 0.0) return WearLevel::book_at_once;
  if (months_to_booking <= options.booking_horizon_months) return WearLevel::book;
  return months_to_booking <= options.planning_horizon_months ? WearLevel::plan : WearLevel::none;
}

/// The campaign before `work`, if it is still to come.
std::optional<UtcTime> campaign_before(const Forecast& forecast, UtcTime work) {
  std::optional<UtcTime> before;
  for (const FailureProbability& candidate : forecast.failure_probability)
    if (start_of_day({candidate.before_ns}) < work) before = start_of_day({candidate.before_ns});
  return before;
}

/// How far the logarithmic law puts the end of life behind the primary forecast; 0 where it gives none.
double law_gap_months(const RemainingLife& life) {
  const Forecast& in_charge = life.forecasts.front();
  for (const Forecast& other : life.forecasts)
    if (other.method == "ols_log_time" && other.window_months == in_charge.window_months &&
        other.state == ForecastState::ok)
      return other.rul_p50_months - in_charge.rul_p50_months;
  return 0.0;
}

void judge_wear(TestVerdict& verdict, const Evidence& evidence, const SiteConfig* site, const Options& options) {
  if (!evidence.leakage.used_for_forecast || evidence.life.forecasts.empty()) return;
  const Forecast& forecast = evidence.life.forecasts.front();
  const UtcTime now{evidence.life.header.event_time_ns};
  switch (forecast.state) {
    case ForecastState::insufficient_history:
      return;
    case ForecastState::no_significant_trend:
      verdict.wear = WearLevel::none;
      return;
    case ForecastState::past_threshold:
      verdict.wear = WearLevel::replace;
      verdict.replace_by = start_of_day(now);
      verdict.urgent = true;
      return;
    case ForecastState::ok: {
      const UtcTime work = replace_by(forecast, now, options);
      verdict.urgent = forecast.rul_p10_months <= options.urgent_months;
      verdict.wear = verdict.urgent ? WearLevel::replace
                                    : level_for(months_between(now, work) - booking_lead_time_months(site), options);
      const bool laws_agree = law_gap_months(evidence.life) <= options.largest_law_gap_months;
      const WearLevel most = laws_agree || verdict.urgent ? WearLevel::replace : WearLevel::plan;
      verdict.wear = std::min(*verdict.wear, most);
      if (laws_agree || verdict.urgent) verdict.replace_by = work;
      if (const auto earlier = campaign_before(forecast, work)) {
        const double months_to_booking = months_between(now, *earlier) - booking_lead_time_months(site);
        const WearLevel level = std::min(level_for(months_to_booking, options), most);
        if (level > *verdict.wear) verdict.wear_a_campaign_earlier = level;
      }
      return;
    }
  }
}

/// An alarm whose cause is in the actuator asks for planning whatever the forecast says. State detection has its own
/// hysteresis and delay, so it is taken at once.
std::string actuator_alarm(const Evidence& evidence, const Options& options) {
  const ProposedFault* fault = dominant_fault(evidence.health, options);
  if (evidence.state.region != AlertRegion::alarm || !fault) return {};
  if (fault->kind == FaultKind::sensor || fault->kind == FaultKind::load) return {};
  return describe(*fault);
}

/// Residuals in alarm: the actuator no longer behaves as its model, or as it did. The accepted model's where one is in
/// force: what it explains is known.
std::string model_alarm(const Evidence& evidence) {
  const auto& judgements = evidence.state.judgements;
  const auto is_accepted = [](const RegionJudgement& one) { return one.reference == Reference::accepted_model; };
  const bool accepted = std::ranges::any_of(judgements, is_accepted);
  std::vector<std::string> channels;
  for (const RegionJudgement& one : judgements) {
    if (one.region != AlertRegion::alarm || !one.quantity.starts_with(kResidualQuantity) ||
        is_accepted(one) != accepted)
      continue;
    const std::string channel = one.quantity.substr(kResidualQuantity.size());
    if (std::ranges::find(channels, channel) == channels.end()) channels.push_back(channel);
  }
  return text::joined(channels);
}

/// What became of the channel, as state detection says it.
std::string fate_of(const std::string& channel, const StateReport& state) {
  for (const std::string& reason : state.verdict_reasons)
    if (reason.starts_with("channel " + channel + ",")) return reason;
  return "channel " + channel + " was OK in most earlier tests and is not in this one";
}

std::string doubt_in_instruments(const Evidence& evidence, const Options& options) {
  const ProposedFault* fault = dominant_fault(evidence.health, options);
  if (fault && fault->kind == FaultKind::sensor) return describe(*fault);
  std::vector<std::string> fates;
  for (const std::string& channel : evidence.state.stale_channels) fates.push_back(fate_of(channel, evidence.state));
  return text::joined(fates);
}

std::set<std::string> doubted_channels(const Evidence& evidence, const Options& options) {
  constexpr std::string_view kSensor = "sensor:";
  const ProposedFault* fault = dominant_fault(evidence.health, options);
  if (fault && fault->kind == FaultKind::sensor)
    return {fault->element.starts_with(kSensor) ? fault->element.substr(kSensor.size()) : fault->element};
  return {evidence.state.stale_channels.begin(), evidence.state.stale_channels.end()};
}

std::string reason_to_repeat(const Evidence& evidence) {
  const StateReport& state = evidence.state;
  if (state.verdict == PstVerdict::failed || state.verdict == PstVerdict::aborted)
    return "the test " + std::string(name_of(state.verdict)) +
           (state.verdict_reasons.empty() ? "" : ": " + text::joined(state.verdict_reasons));
  const bool repetition_helps = evidence.life.threshold > 0.0 && evidence.leakage.header.event_time_known;
  if (evidence.leakage.used_for_forecast || !repetition_helps) return {};
  std::string reason = "the test could not be used";
  // Of a test that was not judged, why; that it was not follows from "could not be used".
  const bool not_judged = state.verdict == PstVerdict::not_judged;
  const std::vector<std::string>& why = not_judged ? state.verdict_reasons : evidence.leakage.reasons;
  if (!why.empty()) reason += ": " + why.front();
  const bool fit_failed = !evidence.leakage.fits.empty() && evidence.health.admissible_for_prognosis;
  if (fit_failed)
    reason += "; where a repetition ends alike, the model does not describe this actuator (sealwatch explain)";
  return reason;
}

}  // namespace

UtcTime start_of_day(UtcTime time) {
  const std::int64_t into_day = ((time.nanoseconds % kDay_ns) + kDay_ns) % kDay_ns;
  return {time.nanoseconds - into_day};
}

double booking_lead_time_months(const SiteConfig* site) {
  return site ? site->booking_lead_time_months : SiteConfig{}.booking_lead_time_months;
}

Assessment assess(const Evidence& evidence, const SiteConfig* site, const Options& options) {
  Assessment assessment;
  judge_wear(assessment.verdict, evidence, site, options);
  assessment.alarm_reason = actuator_alarm(evidence, options);
  assessment.model_alarm = model_alarm(evidence);
  assessment.instruments_reason = doubt_in_instruments(evidence, options);
  assessment.verdict.instruments_doubted = !assessment.instruments_reason.empty();
  assessment.verdict.doubted_channels = doubted_channels(evidence, options);
  assessment.verdict.failed = evidence.state.verdict == PstVerdict::failed;
  assessment.repeat_reason = reason_to_repeat(evidence);
  assessment.reasons = reasons_of(evidence);
  return assessment;
}

}  // namespace sealwatch::advisory_generation
