#include "services/advisory_generation/recommendation.hpp"

#include <algorithm>
#include <utility>

#include "services/advisory_generation/reasons.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::advisory_generation {
namespace {

std::string capitalised(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 32);
  return text;
}

/// "Seal condition is 76.0 % (limit 60.0 %); its end of life is expected on 2018-05-02 (80 %: ... to ...)".
std::string outlook(const Evidence& evidence, const std::string& part) {
  const RemainingLife& life = evidence.life;
  std::string text;
  if (life.condition_known) {
    text = (part == kPistonSeal ? "Seal condition" : "Condition of the " + part) + " is " +
           text::condition_in_percent(life.condition) + limit_of(life);
    if (!evidence.leakage.used_for_forecast) text += " by the last test that counts, which this one does not";
  }
  if (life.forecasts.empty()) return text.empty() ? text : text + ".";
  const Forecast& forecast = life.forecasts.front();
  const std::string join = text.empty() ? "" : text + "; ";
  const UtcTime now{life.header.event_time_ns};
  switch (forecast.state) {
    case ForecastState::ok:
      return join + "its end of life is expected on " + format_date({forecast.end_of_life_ns}) +
             " (80 %: " + format_date(add_months(now, forecast.rul_p10_months)) + " to " +
             format_date(add_months(now, forecast.rul_p90_months)) + ").";
    case ForecastState::past_threshold:
      // The condition of the last test that counts may still have been above: the forecast goes on to this test's date.
      return text + (life.condition_known && life.condition > life.threshold
                         ? "; by now the limit is passed, so the forecast: " + forecast.explanation + "."
                         : ": the limit is passed.");
    case ForecastState::no_significant_trend:
      return join + "it shows no significant fall.";
    case ForecastState::insufficient_history:
      return join + "no forecast yet: " + forecast.explanation + ".";
  }
  return text;
}

bool no_forecast_yet(const RemainingLife& life) {
  return !life.forecasts.empty() && life.forecasts.front().state == ForecastState::insufficient_history;
}

std::string campaign_at(const SiteConfig* site, UtcTime day) {
  if (site)
    for (const Campaign& campaign : site->campaigns)
      if (start_of_day(campaign.start) == day) return "in campaign " + campaign.label + " (" + format_date(day) + ")";
  return "before " + format_date(day);
}

/// Of a test that is in order itself, after others that were not.
std::string earlier_doubt(const InForce& in_force) {
  std::string text = "doubted in the last tests";
  std::string join = ": ";
  for (const std::string& channel : in_force.doubted_channels)
    text.append(std::exchange(join, ", ")).append(text::in_words(channel));
  return text;
}

struct Context {
  const Evidence& evidence;
  const Assessment& assessment;
  const InForce& in_force;
  const SiteConfig* site;
  std::optional<UtcTime> book_by;
  std::string part;  ///< what wears, and is replaced
};

Recommendation by_wear(const Context& c) {
  Recommendation r;
  r.work_before = c.in_force.replace_by;
  r.latest_by = c.book_by;
  const std::string when = r.work_before ? campaign_at(c.site, *r.work_before) : "at the next opportunity";
  const std::string booked_by = c.book_by ? format_date(*c.book_by) : "the next schedule meeting";
  std::string view = " ";
  view += capitalised(outlook(c.evidence, c.part));
  switch (c.in_force.wear) {
    case WearLevel::none:
      r.text = (no_forecast_yet(c.evidence.life) ? "No action follows from this test." : "No action needed.") + view;
      r.work_before = r.latest_by = std::nullopt;
      return r;
    case WearLevel::plan:
      r.priority = AdvisoryPriority::medium;
      r.action = AdvisoryAction::plan_replacement;
      r.text = r.work_before
                   ? "Plan to replace the " + c.part + " " + when + "; the vessel must be booked by " + booked_by + "."
                   : "Prepare the replacement of the " + c.part + "; it is too early for a date to book by.";
      r.text += view;
      return r;
    case WearLevel::book:
      r.priority = AdvisoryPriority::high;
      r.action = AdvisoryAction::book_vessel;
      r.text = "Book a vessel by " + booked_by + " to replace the " + c.part + " " + when + "." + view;
      return r;
    case WearLevel::book_at_once:
      r.priority = AdvisoryPriority::urgent;
      r.action = AdvisoryAction::book_vessel;
      r.text = "Book a vessel at once to replace the " + c.part + " " + when +
               (c.book_by ? "; the regular booking date " + booked_by + " has passed."
                          : "; less time is left than booking usually takes.") +
               view;
      return r;
    case WearLevel::replace:
      r.priority = AdvisoryPriority::urgent;
      r.action = AdvisoryAction::replace_now;
      r.latest_by = r.work_before;
      r.text = "Replace the " + c.part + " now, its function is no longer assured." + view;
      return r;
  }
  return r;
}

/// Everything that calls for something; what comes first is meant where two are of one rank.
std::vector<Recommendation> calls(const Context& c) {
  std::vector<Recommendation> calls{by_wear(c)};
  const auto call = [&](AdvisoryPriority priority, AdvisoryAction action, std::string text) {
    Recommendation r;
    r.priority = priority;
    r.action = action;
    r.text = std::move(text);
    calls.push_back(std::move(r));
  };
  const Assessment& a = c.assessment;
  if (c.in_force.failing && !c.in_force.instruments_doubted) {
    call(AdvisoryPriority::urgent, AdvisoryAction::replace_now,
         "Replace the actuator now: it failed its partial stroke test repeatedly. " +
             capitalised(outlook(c.evidence, c.part)));
    if (const Header& test = c.evidence.life.header; test.event_time_known)
      calls.back().latest_by = calls.back().work_before = start_of_day({test.event_time_ns});
  }
  if (a.verdict.failed)
    call(AdvisoryPriority::high, AdvisoryAction::repeat_test,
         "Repeat the partial stroke test: " + a.repeat_reason + ".");
  if (!a.alarm_reason.empty())
    call(AdvisoryPriority::medium, AdvisoryAction::plan_replacement,
         "Plan to replace the actuator: its measurements are in alarm, most likely " + a.alarm_reason + ".");
  if (a.alarm_reason.empty() && !a.model_alarm.empty())
    call(AdvisoryPriority::medium, AdvisoryAction::examine_actuator,
         "Have the actuator examined: it departs from its model, or from its first tests, in " + a.model_alarm +
             ". The status shows under 'model' what was found; if nothing, run sealwatch explain.");
  if (c.in_force.instruments_doubted)
    call(c.in_force.failing ? AdvisoryPriority::high : AdvisoryPriority::medium,
         AdvisoryAction::inspect_instrumentation,
         "Inspect the instrumentation: " +
             (a.instruments_reason.empty() ? earlier_doubt(c.in_force) : a.instruments_reason) + ".");
  if (!a.repeat_reason.empty())
    call(AdvisoryPriority::low, AdvisoryAction::repeat_test,
         "Repeat the partial stroke test: " + a.repeat_reason + ".");
  return calls;
}

}  // namespace

Recommendation recommend(const Evidence& evidence, const Assessment& assessment, const InForce& remembered,
                         const SiteConfig* site, const std::string& part) {
  InForce in_force = remembered;
  std::optional<UtcTime> book_by;
  if (in_force.replace_by) book_by = start_of_day(add_months(*in_force.replace_by, -booking_lead_time_months(site)));
  // Level and date are remembered apart: a booking date that has passed meanwhile is urgent, whatever the level was.
  const Header& header = evidence.life.header;
  if (book_by && header.event_time_known && book_by->nanoseconds <= header.event_time_ns) {
    if (in_force.wear == WearLevel::book) in_force.wear = WearLevel::book_at_once;
    if (in_force.wear == WearLevel::plan) in_force.replace_by = book_by = std::nullopt;
  }
  const Context context{evidence, assessment, in_force, site, book_by, part.empty() ? "actuator" : part};
  const std::vector<Recommendation> all = calls(context);
  // An actuator that fails its tests is not to wait for the vessel that its seal's wear books.
  const auto rank = [](const Recommendation& r) {
    return std::pair(r.priority, r.action == AdvisoryAction::replace_now);
  };
  const auto first = std::ranges::max_element(all, {}, rank);
  Recommendation chosen = *first;
  for (auto other = all.begin(); other != all.end(); ++other)
    if (other != first && other->action != AdvisoryAction::none && other->action != chosen.action)
      chosen.also.push_back("also: " + other->text);
  return chosen;
}

std::vector<std::string> reasons_of_dates(const Recommendation& recommendation, const TestVerdict& verdict,
                                          const InForce& in_force, const SiteConfig* site, const Options& options) {
  std::vector<std::string> reasons;
  if (!recommendation.work_before) return reasons;
  const UtcTime work = *recommendation.work_before;
  if (recommendation.latest_by && *recommendation.latest_by < work)
    reasons.push_back("latest by " + format_date(*recommendation.latest_by) + ": " +
                      text::in_months(booking_lead_time_months(site)) + " before the work by " + format_date(work) +
                      ", the booking lead time of a vessel");
  if (work == in_force.replace_by && verdict.replace_by && *verdict.replace_by != work)
    reasons.push_back("work by " + format_date(work) + " is held, although this test alone says " +
                      format_date(*verdict.replace_by) + ": the date moves earlier when " +
                      std::to_string(options.confirming_tests) + " of " + std::to_string(options.confirming_window) +
                      " tests ask for it, later when " + std::to_string(options.easing_tests) +
                      " in a row do, and not for small changes");
  return reasons;
}

bool is_replacement(AdvisoryAction action) {
  return action == AdvisoryAction::plan_replacement || action == AdvisoryAction::book_vessel ||
         action == AdvisoryAction::replace_now;
}

}  // namespace sealwatch::advisory_generation
