#include "services/common/runtime/admission.hpp"

#include <algorithm>
#include <utility>

#include "sealwatch/core/asset_id.hpp"
#include "sealwatch/core/test_limits.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/id_part.hpp"
#include "sealwatch/message/made_up.hpp"
#include "sealwatch/message/outside.hpp"
#include "sealwatch/message/retraction.hpp"
#include "sealwatch/message/texts.hpp"

namespace sealwatch {
namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::int64_t kNoClockIsSetSoFarBack_ns = 56LL * 365 * kDay_ns;  // to the end of 2025: there was no sealwatch
constexpr std::int64_t kYear_ns = 366 * kDay_ns;
/// 1970 to 2260: the difference of any two of these times can be counted in nanoseconds.
constexpr std::int64_t kLatest_ns = 290 * kYear_ns;
/// A test has fewer rows.
constexpr std::uint64_t kMostBlocks = kTestLimits.most_numbers;

/// Of an asset: not yet concluded here, the newest of them, as their ids begin with the date.
constexpr std::size_t kMostOnTheirWay = 256;

/// How the name of a test begins that has none yet.
constexpr const char* kUnnamed = "of ";

constexpr const char* kHasControls = "has control or invisible characters";

bool is_report(const Message& message) {
  return topic_of(message) == Topic::maintenance_event || topic_of(message) == Topic::acknowledgement;
}

bool is_time(std::int64_t time_ns) { return time_ns >= 0 && time_ns <= kLatest_ns; }

/// When the test was made that the message is about.
std::optional<std::int64_t> time_of_test(const Message& message) {
  if (const auto* raw = std::get_if<RawSamples>(&message))
    return raw->start_time_known ? std::optional(raw->start_time_ns) : std::nullopt;
  const Header& header = header_of(message);
  const bool known = !is_report(message) && !header.pst_id.empty() && header.event_time_known;
  return known ? std::optional(header.event_time_ns) : std::nullopt;
}

std::optional<std::string> refusal_of_texts(const Message& message) {
  const std::optional<TextFault> fault = fault_of_texts(message);
  if (!fault) return std::nullopt;
  constexpr std::size_t kShown = 60;
  const bool shown = fault->text.size() <= kShown;
  return "its " + fault->field + (shown ? ", '" + visible(fault->text, false) + "', " : " ") + fault->rule +
         "; send it with a plain name";
}

std::optional<std::string> refusal_of_samples(const Message& message) {
  std::optional<std::string> why;
  if (const auto* block = std::get_if<SampleBlock>(&message)) why = malformed(block->samples, true);
  if (const auto* window = std::get_if<TestWindow>(&message)) {
    why = malformed(window->samples, false);
    if (!why) why = beyond_limits(window->samples.time_s, window->samples.channels.size());
  }
  return why ? "its samples have " + *why : why;
}

/// An event of an unknown kind would be taken for a replacement by nobody, and missed by everybody.
std::optional<std::string> refusal_of_kind(const Message& message) {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  if (event == nullptr || event->kind == "actuator_replaced" || event->kind == "seal_replaced") return std::nullopt;
  if (event->kind == kActConfirmed || event->kind == kActRejected) {
    if (confirmed_act(event->asset_id, event->header.message_id)) return std::nullopt;
    return "its message_id, '" + event->header.message_id + "', does not say what is confirmed; use sealwatch confirm";
  }
  if (is_alarm_act(event->kind)) {
    if (alarm_act_of(*event)) return std::nullopt;
    return "its message_id, '" + event->header.message_id +
           "', does not say which alarm is meant; use sealwatch shelve";
  }
  if (!is_retraction_kind(event->kind))
    return "its kind, '" + event->kind + "', is not one of actuator_replaced, seal_replaced, " +
           std::string(kTestRetracted) + ", " + std::string(kTestsRetracted) + ", " +
           std::string(kRetractionWithdrawn) + ", " + std::string(kActConfirmed) + ", " + std::string(kActRejected) +
           ", " + std::string(kAlarmShelved) + ", " + std::string(kAlarmUnshelved) + ", " +
           std::string(kAssetOutOfService) + ", " + std::string(kAssetInService);
  const auto retraction = retraction_of(event->asset_id, event->header.message_id);
  const bool same = retraction && (event->kind == kTestRetracted    ? !retraction->pst_id.empty()
                                   : event->kind == kTestsRetracted ? retraction->since.has_value()
                                                                    : !retraction->withdrawn_id.empty());
  const bool is_undone = same && is_replacement_id(retraction->withdrawn_id);
  if (is_undone && !time_of_replacement(retraction->withdrawn_id))
    return "the replacement that it takes back, '" + retraction->withdrawn_id + "', has no time at the end of its id";
  if (same) return std::nullopt;
  return "its message_id, '" + event->header.message_id + "', does not say what is retracted; use sealwatch retract";
}

std::string name_of_test(const RawSamples& raw) {
  return (raw.recording_id.empty() ? "a test" : "recording " + raw.recording_id) + " of " + raw.asset_id;
}

bool is_of_made_up_test(const Message& message) {
  const auto* raw = std::get_if<RawSamples>(&message);
  return raw != nullptr ? is_made_up(raw->source_id) : is_made_up_test(header_of(message).pst_id);
}

bool is_live(const Message& message) { return !header_of(message).replay && !is_of_made_up_test(message); }

// A computer without a battery starts in 1970, until the network tells it the time. What lies in the future cannot be told
// then, and what was refused would not come again.
bool is_set(UtcTime now) { return now.nanoseconds > kNoClockIsSetSoFarBack_ns; }

/// "recording april of XT03-MV2: its start time, ..."
std::string with_its_time(const Message& message, UtcTime time) {
  const auto* raw = std::get_if<RawSamples>(&message);
  return (raw != nullptr ? name_of_test(*raw) + ": its start time, "
                         : "test " + header_of(message).pst_id + " of " + asset_of(message) + ": its time, ") +
         format_utc(time);
}

}  // namespace

std::optional<TextFault> fault_of_texts(const Message& message) {
  std::optional<TextFault> fault;
  const std::size_t longest_words = is_of_a_service(name_of(topic_of(message))) ? std::string::npos : kLongestRemark;
  bool is_certain = false;  // of a message's id, which others are part of, they tell more
  std::visit(
      [&](const auto& content) {
        for_each_text("", content, [&](std::string_view field, const std::string& text) {
          if (is_certain) return;
          const bool id = names_something(field);
          const std::size_t longest = id ? kLongestId : longest_words;
          if (!is_valid_utf8(text))
            fault = {std::string(field), text, "is not UTF-8"};
          else if (text.size() > longest)
            fault = {std::string(field), text, "is longer than " + std::to_string(longest) + " bytes"};
          else if (id && !is_visible(text))
            fault = {std::string(field), text, kHasControls};
          else if (const auto wrong = field == "asset_id" ? fault_of_asset_id(text) : std::nullopt)
            fault = {std::string(field), text, *wrong};
          else
            return;
          is_certain = !field.ends_with("message_id");
        });
      },
      message);
  return fault;
}

Admission::Admission(std::map<std::string, UtcTime> commissioned, ConfiguredAssets assets)
    : commissioned_(std::move(commissioned)), assets_(std::move(assets)) {
  for (const std::string& asset_id : assets_.names) note_name(asset_id);
}

bool Admission::note(const Message& message, bool concluded) {
  if (const auto* record = std::get_if<ActRecord>(&message)) {
    for (const MaintenanceEvent& event : record->events) note_named_tests(event);
    return false;
  }
  if (const auto* event = std::get_if<MaintenanceEvent>(&message)) note_named_tests(*event);
  if (const auto* block = std::get_if<SampleBlock>(&message); block && !is_made_up(block->source_id))
    recorded_.insert(block->asset_id);
  const std::string asset_id = asset_of(message);
  note_asset(asset_id);
  const std::optional<std::int64_t> time_ns = time_of_test(message);
  const std::string& pst_id = header_of(message).pst_id;
  const auto known = tests_.find(asset_id);
  const bool was_concluded = known != tests_.end() && known->second.knows(pst_id);
  bool is_news = !pst_id.empty() && (!knows_test(asset_id, pst_id) || (concluded && !was_concluded));
  auto& on_their_way = on_their_way_[asset_id];
  if (concluded)
    on_their_way.erase(pst_id);
  else if (!pst_id.empty() && !is_report(message))
    on_their_way[pst_id] = time_ns ? std::optional(UtcTime{*time_ns}) : std::nullopt;
  if (on_their_way.size() > kMostOnTheirWay) on_their_way.erase(on_their_way.begin());
  if (time_ns) {
    if (concluded || topic_of(message) == Topic::raw_samples)
      note_test(message, {*time_ns});
    else
      heard_[asset_id] = std::max(heard_[asset_id], UtcTime{*time_ns});
    if (is_live(message)) live_.insert(asset_id);
  } else if (concluded && !pst_id.empty()) {
    tests_[asset_id].know(pst_id, std::nullopt);
  }
  // An act is told once; after a restart it stands among the sources of what answered it.
  std::vector<std::string> acts = header_of(message).source_ids;
  acts.push_back(header_of(message).message_id);
  for (const std::string& id : acts) is_news = note_act(asset_id, id) || is_news;
  return is_news;
}

bool Admission::knows_test(const std::string& asset_id, const std::string& pst_id) const {
  const auto tests = tests_.find(asset_id);
  const auto coming = on_their_way_.find(asset_id);
  return (tests != tests_.end() && tests->second.knows(pst_id)) ||
         (coming != on_their_way_.end() && coming->second.contains(pst_id));
}

void Admission::note_asset(const std::string& asset_id) {
  if (asset_id.empty() || assets_.names.contains(asset_id)) return;
  if (unknown_.insert(asset_id).second) note_name(asset_id);
}

/// The likes of them are there already, with a history under these ids.
void Admission::note_name(const std::string& asset_id) {
  const auto [other, is_new] = asset_of_id_part_.emplace(id_part(asset_id), asset_id);
  if (!is_new) alike_.push_back(alike_in_ids(asset_id, other->second));
}

std::vector<std::string> Admission::take_alike() { return std::exchange(alike_, {}); }

/// Before data acquisition a test has no name by which it could be retracted: until then it is one of its date.
void Admission::note_test(const Message& message, UtcTime time) {
  RetractedTests& tests = tests_[asset_of(message)];
  std::set<UtcTime>& named = named_[asset_of(message)];
  const std::string_view end = is_of_made_up_test(message) ? kEndOfMadeUpId : std::string_view();
  const std::string unnamed = kUnnamed + format_utc(time) + std::string(end);
  if (topic_of(message) == Topic::raw_samples) {
    if (!named.contains(time)) tests.know(unnamed, time);
    return;
  }
  tests.know(header_of(message).pst_id, time);
  if (named.insert(time).second) tests.forget(unnamed);
}

void Admission::note_named_tests(const MaintenanceEvent& event) {
  if (event.tests_known) (void)tests_[event.asset_id].name(event.header.message_id, event.test_ids);
}

/// A neighbour that answers it knows what it means, and by the answer it is applied here already.
bool Admission::may_be_given(const std::string& asset_id, const Retraction& retraction) const {
  const auto acts = acts_.find(asset_id);
  const bool is_answered = acts != acts_.end() && acts->second.retractions.contains(retraction.id);
  return is_answered || !means_nothing(asset_id, retraction);
}

bool Admission::knows_all_of(const std::string& asset_id, const Retraction& retraction) const {
  if (!retraction.withdrawn_id.empty()) return may_be_given(asset_id, retraction);
  static const RetractedTests none;
  const auto tests = tests_.find(asset_id);
  const RetractedTests& known = tests == tests_.end() ? none : tests->second;
  return std::ranges::all_of(known.meant_by(retraction), [&](const std::string& test) { return known.knows(test); });
}

std::vector<std::string> Admission::tests_meant(const std::string& asset_id, const Retraction& retraction) const {
  std::set<std::string> meant;
  if (const auto tests = tests_.find(asset_id); tests != tests_.end()) meant = tests->second.meant_by(retraction);
  std::erase_if(meant, [](const std::string& name) { return name.starts_with(kUnnamed); });
  if (const auto coming = on_their_way_.find(asset_id); coming != on_their_way_.end())
    for (const auto& [pst_id, time] : coming->second)
      if (time && time >= retraction.since) meant.insert(pst_id);
  return {meant.begin(), meant.end()};
}

bool Admission::note_act(const std::string& asset_id, const std::string& act_id) {
  if (is_replacement_id(act_id)) return acts_[asset_id].replacements.insert(act_id).second;
  const auto retraction = is_retraction_id(act_id) ? retraction_of(asset_id, act_id) : std::nullopt;
  if (!retraction) return false;
  Acts& acts = acts_[asset_id];
  if (!acts.retractions.insert(act_id).second) return false;  // every answer to it names it
  if (means_nothing(asset_id, *retraction)) acts.idle.insert(act_id);
  tests_[asset_id].apply(*retraction);
  if (retraction->since)
    std::erase_if(on_their_way_[asset_id], [&](const auto& one) { return one.second >= retraction->since; });
  heard_.erase(asset_id);
  return true;
}

bool Admission::means_nothing(const std::string& asset_id, const Retraction& retraction) const {
  const auto tests = tests_.find(asset_id);
  const auto acts = acts_.find(asset_id);
  const RetractedTests none;
  const RetractedTests& known = tests == tests_.end() ? none : tests->second;
  if (!known.changes_nothing(retraction, acts == acts_.end() ? std::set<std::string>() : acts->second.replacements))
    return false;
  const auto coming = on_their_way_.find(asset_id);
  return coming == on_their_way_.end() || std::ranges::none_of(coming->second, [&](const auto& one) {
           const bool is_meant = retraction.since ? one.second >= retraction.since : one.first == retraction.pst_id;
           return is_meant && known.counts(one.first);
         });
}

bool Admission::meant_something(const std::string& asset_id, const std::string& act_id) const {
  const auto acts = acts_.find(asset_id);
  return acts != acts_.end() && acts->second.retractions.contains(act_id) && !acts->second.idle.contains(act_id);
}

std::optional<UtcTime> Admission::newest_test(const std::string& asset_id) const {
  const auto tests = tests_.find(asset_id);
  const auto newest = tests == tests_.end() ? std::nullopt : tests->second.newest();
  const auto heard = heard_.find(asset_id);
  return heard == heard_.end() ? newest : std::max(newest, std::optional(heard->second));
}

std::optional<UtcTime> Admission::future_test_before_live(const std::string& asset_id, UtcTime now) const {
  if (!live_.contains(asset_id) || !is_set(now)) return std::nullopt;
  const auto newest = newest_test(asset_id);
  return newest && newest->nanoseconds > now.nanoseconds + kDay_ns ? newest : std::nullopt;
}

/// What is about no asset (an act upon a service's alarm) is refused for none.
std::optional<std::string> Admission::refusal_of_asset(const Message& message) const {
  const std::string asset_id = asset_of(message);
  if (asset_id.empty() || assets_.names.contains(asset_id)) return std::nullopt;
  const std::string what = "asset '" + visible(asset_id.substr(0, kLongestId), false) + "' is not configured";
  if (assets_.refuses_others) return what + ", and unknown_assets are refused; give it an asset file, if it is yours";
  if (unknown_.contains(asset_id)) return std::nullopt;
  if (unknown_.size() < kMostUnknownAssets) return std::nullopt;
  return what + ", and " + std::to_string(unknown_.size()) +
         " such assets are there already; give it an asset file, if it is yours, or find out who sends it";
}

std::optional<std::string> Admission::refusal(const Message& message, UtcTime now) const {
  if (auto why = refusal_of_texts(message)) return why;
  const Header& header = header_of(message);
  if (header.message_id.starts_with(kDamagedMessage))
    return visible(header.message_id) + ": its writer's journal is damaged there; see the alarms of that service";
  if (header.message_id.starts_with(kUnreadableMessage))
    return visible(header.message_id) + ": it has a value that this service does not know, or ends before it should; " +
           "update this service, or correct who sends it";
  const auto* const raw = std::get_if<RawSamples>(&message);
  if (auto why = raw != nullptr ? refusal_of_test(*raw) : refusal_of_samples(message)) return why;
  if (header.event_time_known && !is_time(header.event_time_ns))
    return "its time, " + format_utc({header.event_time_ns}) + ", is not between 1970 and 2260";
  if (is_report(message)) return refusal_of_report(message, now);
  return time_of_test(message) ? refusal_of_time(message, now) : refusal_of_future_act(message, now);
}

std::optional<std::string> Admission::refusal_of_recorded(const Message& act) const {
  if (auto why = refusal_of_texts(act)) return why;
  const Header& header = header_of(act);
  if (header.event_time_known && !is_time(header.event_time_ns))
    return "its time, " + format_utc({header.event_time_ns}) + ", is not between 1970 and 2260";
  return refusal_of_kind(act);
}

std::optional<std::string> Admission::refusal_of_report(const Message& message, UtcTime now) const {
  const Header& header = header_of(message);
  if (topic_of(message) == Topic::maintenance_event && !header.event_time_known)
    return "its time is not known, so it cannot part a history; report it again, with the time at which it happened";
  if (auto why = refusal_of_kind(message)) return why;
  if (auto why = refusal_of_idle(message)) return why;
  return refusal_of_future_act(message, now);
}

std::optional<Retraction> Admission::idle_retraction(const Message& message) const {
  const std::string asset_id = asset_of(message);
  const auto acts = acts_.find(asset_id);
  if (acts == acts_.end() || acts->second.idle.size() < kMostIdleRetractions) return std::nullopt;
  auto retraction = retraction_of(asset_id, header_of(message).message_id);
  return retraction && means_nothing(asset_id, *retraction) ? retraction : std::nullopt;
}

/// A test may be retracted before it comes, a retraction withdrawn before it is heard. "All since a date" means what is
/// known when it is said, and has nothing to wait for.
bool Admission::is_ahead(const Message& message) const {
  const auto idle = idle_retraction(message);
  return idle && !idle->since;
}

std::optional<std::string> Admission::refusal_of_idle(const Message& message) const {
  const auto idle = idle_retraction(message);
  if (!idle || !idle->since) return std::nullopt;
  return "it means no test that is known, and " + std::to_string(kMostIdleRetractions) +
         " retractions that mean nothing known of asset " + asset_of(message) +
         " are there already; find out who sends them";
}

/// What the layers say after an act (that a test is overdue, that tests were retracted) has the time of now or of a test.
std::optional<std::string> Admission::refusal_of_future_act(const Message& message, UtcTime now) const {
  const Header& header = header_of(message);
  if (!header.event_time_known || answers_retraction(header) || !is_set(now)) return std::nullopt;
  std::int64_t latest = now.nanoseconds;
  if (const auto newest = newest_test(asset_of(message))) latest = std::max(latest, newest->nanoseconds);
  if (header.event_time_ns <= latest + kDay_ns) return std::nullopt;
  return "its time, " + format_utc({header.event_time_ns}) + ", lies in the future: it is now " + format_utc(now) +
         "; report it again, with the time at which it happened";
}

std::optional<std::string> Admission::refusal_of_test(const RawSamples& raw) const {
  if (raw.asset_id.empty())
    return (raw.recording_id.empty() ? "a test" : "recording " + raw.recording_id) +
           ": its asset_id is empty; say of which asset it is";
  if (raw.block_number > kMostBlocks)
    return name_of_test(raw) + ": block " + std::to_string(raw.block_number) +
           " is not possible: the blocks of a test count from 0";
  if (is_made_up(raw.source_id) && recorded_.contains(raw.asset_id))
    return name_of_test(raw) + ": made up by the virtual bench, it does not belong into the history of an asset with " +
           "recorded tests; give the bench a configuration with assets and a state directory of its own";
  return std::nullopt;
}

std::optional<std::string> Admission::refusal_of_time(const Message& message, UtcTime now) const {
  const UtcTime time{*time_of_test(message)};
  if (!is_time(time.nanoseconds)) return with_its_time(message, time) + ", is not between 1970 and 2260; correct it";
  const auto commissioned = commissioned_.find(asset_of(message));
  if (topic_of(message) == Topic::raw_samples && commissioned != commissioned_.end() && time < commissioned->second)
    return with_its_time(message, time) + ", lies before the asset was commissioned, " +
           format_utc(commissioned->second) + "; correct the start time, or 'commissioned' in the configuration";
  if (!is_set(now)) return std::nullopt;
  return time.nanoseconds <= now.nanoseconds + kDay_ns ? std::nullopt : refusal_of_future(message, time, now);
}

std::optional<std::string> Admission::refusal_of_future(const Message& message, UtcTime time, UtcTime now) const {
  const std::string ahead = with_its_time(message, time) + ", lies in the future (it is now " + format_utc(now) + ")";
  if (is_live(message)) return ahead + "; set the sender's clock, or correct the start time, and give it again";
  const std::string give_again = "; correct the start time, and give it again";
  if (live_.contains(asset_of(message))) return ahead + ", and the asset has live tests" + give_again;
  const auto newest = newest_test(asset_of(message));
  if (!newest || time.nanoseconds <= newest->nanoseconds + kYear_ns) return std::nullopt;
  return ahead + " and more than a year after the asset's newest test, " + format_utc(*newest) + give_again;
}

}  // namespace sealwatch
