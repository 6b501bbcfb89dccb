// The runner's part in giving layers their past back. An asset's past is recalled before the first message about it is
// taken, and else in turn, while nothing else is to be done: a start does not wait for the history of a thousand assets.
#include <algorithm>

#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

using std::chrono::steady_clock;

/// Under load an asset is recalled so often, and what was not read is looked at.
constexpr std::chrono::milliseconds kPause{100};
/// So many times as long as it takes, others are served in between.
constexpr int kShare = 9;
/// For how long that is looked at, at once: another asset's samples wait for no longer.
constexpr std::chrono::milliseconds kInPassing{5};

}  // namespace

Status LayerRunner::restore_past() {
  journal_.pack_for(options_.build);
  const auto acts = journal_.acts();
  if (!acts) return fail(acts.error());
  past_acts_ = past_retractions(*acts);
  restore_counts(*acts);
  const auto assets = journal_.assets();
  if (!assets) return fail(assets.error());
  for (const std::string& asset_id : *assets) {
    forgotten_.insert(asset_id);
    to_recall_.push_back(asset_id);
    admission_.note_asset(asset_id);
    lanes_.know(asset_id);
  }
  for (const auto& [asset_id, acts_on_it] : past_acts_)
    if (forgotten_.insert(asset_id).second) to_recall_.push_back(asset_id);
  for (const auto& [asset_id, acts_on_it] : acts_of_last_day_)
    if (forgotten_.insert(asset_id).second) to_recall_.push_back(asset_id);
  if (Status opened = open_desk(); !opened) return opened;
  log_event(LogLevel::info, "started",
            {{"writer", journal_.writer_id()},
             {"assets", std::to_string(assets->size())},
             {"open_inputs", std::to_string(journal_.open_inputs())}});
  return look_back(options_.recalls_at_start);
}

Status LayerRunner::recall(const std::string& asset_id) {
  remembered_[asset_id].used = steady_clock::now();
  if (asleep_.erase(asset_id) > 0) return restore_layer(asset_id);
  if (forgotten_.erase(asset_id) == 0) return {};
  std::vector<PastAct> acts;
  if (auto of_asset = past_acts_.extract(asset_id)) acts = std::move(of_asset.mapped());
  auto act = acts.begin();
  std::optional<StandingAdvice> advice;  // as it stands in the end: the desk knows what became of the rest
  Status outputs = journal_.for_each_output_of(
      asset_id,
      [&](const Message& output, const Journal::Place& place) {
        for (; act != acts.end() && act->at < place.concluded; ++act) admission_.note_act(asset_id, act->id);
        lanes_.restore(output);
        note_remembered(asset_id);
        note_alarms_of(output);
        if (const auto said = options_.advice_of_output ? options_.advice_of_output(output) : std::nullopt)
          advice = *said;
        admission_.note(output);
        note_standing(output);
        latest_.concluded(output, place.sequence);
        replaying_[asset_id] = header_of(output).replay;
        return Status();
      },
      [this](const Message& last_of_test) { return kind_->tells_all(last_of_test); });
  if (!outputs) return outputs;
  if (const auto refused = journal_.take_packed_refused())
    log_event(LogLevel::warn, "the packed past is not used, all outputs are read", {{"reason", *refused}});
  for (; act != acts.end(); ++act) admission_.note_act(asset_id, act->id);
  count_past_acts(asset_id);
  if (desk_ && advice) desk_->stand(*advice, clock_.now());
  if (Status recalled = recall_inputs(asset_id); !recalled) return recalled;
  look_for_future_test(asset_id);
  heard_of_.insert(asset_id);
  return {};
}

Status LayerRunner::restore_layer(const std::string& asset_id) {
  return journal_.for_each_output_of(
      asset_id,
      [&](const Message& output, const Journal::Place&) {
        lanes_.restore(output);
        note_remembered(asset_id);
        return Status();
      },
      [this](const Message& last_of_test) { return kind_->tells_all(last_of_test); });
}

void LayerRunner::note_remembered(const std::string& asset_id) {
  ++remembered_[asset_id].outputs;
  ++outputs_remembered_;
}

/// What waits for anything, be it for an answer, keeps its past: its time passes, and it is told of soon.
Status LayerRunner::forget_some() {
  const auto begin = steady_clock::now();
  if (outputs_remembered_ <= options_.most_recalled || begin < forget_next_) return {};
  std::vector<std::pair<steady_clock::time_point, std::string>> by_use;
  for (const auto& [asset_id, past] : remembered_)
    if (past.outputs > 0 && past.used + options_.least_awake <= begin) by_use.emplace_back(past.used, asset_id);
  std::ranges::sort(by_use);
  // Some more than has to be: the next look is not the next message's.
  const std::size_t enough = options_.most_recalled - options_.most_recalled / 10;
  for (const auto& [used, asset_id] : by_use) {
    if (outputs_remembered_ <= enough) return {};
    if (lanes_.at_rest(asset_id) == nullptr) continue;
    const auto open = journal_.open_inputs_of(asset_id);
    if (!open) return fail(open.error());
    if (!open->empty()) continue;
    lanes_.begin_anew(asset_id);
    outputs_remembered_ -= remembered_.at(asset_id).outputs;
    remembered_.at(asset_id).outputs = 0;
    asleep_[asset_id] = begin;
    fell_asleep_.emplace_back(asset_id, begin);
    holds_memory_ = true;
  }
  const auto end = steady_clock::now();
  forget_next_ = end + kShare * (end - begin);
  return {};
}

Status LayerRunner::wake_longest_asleep() {
  while (!fell_asleep_.empty()) {
    const auto [asset_id, since] = fell_asleep_.front();
    const auto asleep = asleep_.find(asset_id);
    const bool sleeps = asleep != asleep_.end() && asleep->second == since;  // and was not awake in between
    if (sleeps && steady_clock::now() < since + options_.longest_sleep) return {};
    fell_asleep_.pop_front();
    if (sleeps) return recall(asset_id);
  }
  return {};
}

Status LayerRunner::recall_inputs(const std::string& asset_id) {
  const auto open = journal_.open_inputs_of(asset_id);
  if (!open) return fail(open.error());
  for (const std::string& message_id : *open) {
    const auto input = journal_.input(message_id);
    if (!input) return fail(input.error());
    if (!*input) continue;
    replaying_[asset_id] = header_of(**input).replay;
    admission_.note(**input, false);
    lanes_.add(asset_id, message_id, nullptr);
  }
  return {};
}

/// Recalls the next asset or, when all are, looks for damage in what was not read.
Status LayerRunner::look_back() {
  if (to_recall_.empty()) {
    const auto more = journal_.check_some();
    all_checked_ = more && !*more;
    return more ? Status() : fail(more.error());
  }
  const std::string asset_id = to_recall_.front();
  to_recall_.pop_front();
  if (to_recall_.empty()) log_event(LogLevel::info, "the past of all assets is recalled", {});
  return recall(asset_id);
}

Status LayerRunner::look_back(std::chrono::milliseconds at_most) {
  const auto end = steady_clock::now() + at_most;
  while (!all_checked_ && steady_clock::now() < end)
    if (Status looked = look_back(); !looked) return looked;
  return {};
}

/// While nothing comes, one asset after another; else now and then.
Status LayerRunner::look_back_in_passing(bool is_idle) {
  if (Status forgot = forget_some(); !forgot) return forgot;
  const bool recalls = !to_recall_.empty();
  const auto begin = steady_clock::now();
  if (begin < look_back_next_ && !(is_idle && recalls)) return {};
  Status looked = wake_longest_asleep();
  if (looked && !all_checked_) looked = recalls ? look_back() : look_back(kInPassing);
  const auto end = steady_clock::now();
  look_back_next_ = end + std::max<steady_clock::duration>(kPause, kShare * (end - begin));
  return looked;
}

/// How long may be waited for what comes.
std::chrono::milliseconds LayerRunner::until_looking_back(std::chrono::milliseconds timeout) const {
  if (all_checked_) return timeout;
  return to_recall_.empty() ? std::min(timeout, kPause) : std::chrono::milliseconds(0);
}

}  // namespace sealwatch
