// The runner's part in keeping the disk bounded: samples that nobody needs any more go, a few each second in which
// nothing else is to be done; and what comes of them from others is counted and not concluded from.
#include <algorithm>

#include "sealwatch/message/outside.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

/// A row is read and written whole, and a window of a test has a megabyte.
constexpr std::size_t kAtOnce = 16;

}  // namespace

bool LayerRunner::is_set_aside_anywhere(const std::string& asset_id, const std::string& pst_id) const {
  const bool here = std::ranges::any_of(
      set_aside_, [&](const SetAside& one) { return one.asset_id == asset_id && one.pst_id == pst_id; });
  return here || std::ranges::any_of(set_aside_elsewhere_, [&](const auto& of_service) {
           return of_service.second.contains({asset_id, pst_id});
         });
}

Status LayerRunner::drop_old_samples() {
  const auto now = std::chrono::steady_clock::now();
  // Which samples are the newest of their asset is not known before.
  const bool is_idle = forgotten_.empty() && !full_since_ && resends_.empty() && outbox_.empty();
  if (!retention_.is_bounded() || !is_idle || now < next_retention_) return {};
  next_retention_ = now + options_.retention_pause;
  for (const Retention::Sample& sample : Retention::samples()) {
    if (!journal_.written().contains(sample.topic)) continue;
    const auto dropped = drop_old_samples(sample);
    if (!dropped) return fail(dropped.error());
    if (*dropped) next_retention_ = now;  // there may be more
  }
  return {};
}

Result<bool> LayerRunner::drop_old_samples(const Retention::Sample& sample) {
  const auto bytes = journal_.used_bytes();
  if (!bytes) return fail(bytes.error());
  KeptSamples& kept = kept_samples_[sample.topic];
  std::vector<Journal::Kept> over;
  for (const Journal::Kept& one : std::exchange(kept.needed, {}))
    (is_needed(sample, one) ? kept.needed : over).push_back(one);
  const auto dropped_before = journal_.dropped_samples(sample.topic, kept.looked_at);
  if (!dropped_before) return fail(dropped_before.error());
  const bool passes_over = *dropped_before > kept.looked_at;
  kept.looked_at = *dropped_before;
  // To look at one means to read its samples: most of the time none is old enough, and one tells that.
  for (const std::size_t most : {std::size_t{1}, kAtOnce}) {
    const auto next = journal_.kept_samples(sample.topic, kept.looked_at, most);
    if (!next) return fail(next.error());
    for (const Journal::Kept& one : *next) {
      const bool is_over = retention_.is_over(one.concluded, clock_.now(), *bytes);
      if (!is_over || one.sequence > retention_.read_by_all(sample)) break;  // nor is anything behind it
      kept.looked_at = one.sequence;
      (is_needed(sample, one) ? kept.needed : over).push_back(one);
    }
    if (next->empty() || kept.looked_at < next->back().sequence) break;
  }
  if (over.empty()) return passes_over;
  log_event(LogLevel::info, "samples dropped",
            {{"topic", std::string(name_of(sample.topic))}, {"messages", std::to_string(over.size())}});
  const Status dropped = in_batch([&] {
    for (const Journal::Kept& one : over)
      if (Status expired = journal_.expire(sample.topic, one.sequence); !expired) return expired;
    return Status();
  });
  if (!dropped) return fail(dropped.error());
  return true;
}

bool LayerRunner::is_needed(const Retention::Sample& sample, const Journal::Kept& one) const {
  return latest_.is_latest(sample.topic, one.asset_id, one.sequence) || is_set_aside_anywhere(one.asset_id, one.pst_id);
}

/// Of a message whose samples its writer keeps no more nothing is concluded: what was is in this service's journal, where
/// that was not lost.
bool LayerRunner::has_no_samples_any_more(const Message& message) {
  if (!is_expired(header_of(message).producer)) return false;
  const std::string text = header_of(message).message_id + " came without its samples, which its writer keeps no more";
  log_message(LogLevel::warn, "not concluded from", message, {{"reason", text}});
  note_error(text);
  return true;
}

}  // namespace sealwatch
