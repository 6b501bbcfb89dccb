#include "services/cli/replay_log.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "services/common/message/json.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::array kTopics = {Topic::test_features,    Topic::state_report,     Topic::health_report,
                                Topic::leakage_estimate, Topic::remaining_life,   Topic::pst_request,
                                Topic::advisory,         Topic::model_discrepancy};

}  // namespace

ReplayLog::ReplayLog(const ReplayOptions& options, std::size_t tests)
    : options_(options), progress_("replay", tests, "tests") {}

std::span<const Topic> ReplayLog::topics() { return kTopics; }

void ReplayLog::take_earlier(const Message& message) {
  assets_[asset_of(message)].take(message);
  const Header& header = header_of(message);
  if (!header.event_time_known || topic_of(message) == Topic::model_discrepancy) return;
  std::int64_t& latest = latest_known_.try_emplace(asset_of(message), header.event_time_ns).first->second;
  latest = std::max(latest, header.event_time_ns);
}

void ReplayLog::take(const Message& message) {
  bool wanted = false;
  for (const Topic topic : kTopics) wanted = wanted || topic == topic_of(message);
  if (!wanted) return;
  write(message);
  assets_[asset_of(message)].take(message);
  if (!options_.page.empty()) histories_[asset_of(message)].take(message);
  if (const auto* life = std::get_if<RemainingLife>(&message); life != nullptr && !life->header.pst_id.empty()) {
    const auto latest = latest_known_.find(life->asset_id);
    taken_in_[{life->asset_id, life->header.pst_id}] =
        life->header.event_time_known && latest != latest_known_.end() && life->header.event_time_ns < latest->second;
  }
  if (const auto* advisory = std::get_if<Advisory>(&message)) show_advisory(*advisory, message);
}

std::string ReplayLog::without_advice() const {
  if (taken_in_.empty() && concluded_.empty() && any_refused_) return {};  // has been told, with its reason
  if (taken_in_.empty() && concluded_.empty())
    return "these tests were known already (same recording_id and content), nothing new was advised";
  std::size_t silent = 0;
  std::size_t earlier = 0;
  for (const auto& [test, later_known] : taken_in_) {
    if (concluded_.contains(test)) continue;
    ++silent;
    if (later_known) ++earlier;
  }
  if (silent == 0) return {};
  const std::string stands = ": taken into the history; the advice stands";
  if (silent == earlier)
    return count_of(silent, "test") + (silent == 1 ? " is" : " are") +
           " earlier than the newest test or replacement that was known" + stands;
  return count_of(silent, "test") + " gave no new advice" + stands;
}

void ReplayLog::show_advisory(const Advisory& advisory, const Message& message) {
  if (!advisory.header.pst_id.empty()) concluded_.insert({advisory.asset_id, advisory.header.pst_id});
  // A test that changes nothing repeats the advisory: shown once, unless its state changes.
  const std::string now = advisory.advisory_id + std::string(name_of(advisory.state));
  std::string& before = last_advisory_[advisory.asset_id];
  if (before != now && advisory.state != AdvisoryState::superseded) {
    before = now;
    progress_.clear();
    if (options_.json) std::printf("{\"topic\":\"advisory\",\"message\":%s}\n", to_json(message).c_str());
    if (!options_.json && !options_.quiet) std::printf("%s\n", wrapped(one_line(message), 120, 12).c_str());
    std::fflush(stdout);
  }
  progress_.show(concluded_.size(),
                 advisory.header.event_time_known ? date(advisory.header.event_time_ns) : advisory.header.pst_id);
}

void ReplayLog::refuse(const std::string& reason) {
  any_refused_ = true;
  remark("sealwatch: refused: " + reason);
}

void ReplayLog::remark(const std::string& text) {
  progress_.clear();
  std::fprintf(stderr, "%s\n", text.c_str());
}

std::string ReplayLog::results_file(Topic topic) const {
  return (std::filesystem::path(options_.results_directory) / (std::string(name_of(topic)) + ".jsonl")).string();
}

void ReplayLog::write(const Message& message) {
  if (options_.results_directory.empty()) return;
  const Topic topic = topic_of(message);
  std::unique_ptr<std::ofstream>& file = results_[topic];
  if (!file) file = std::make_unique<std::ofstream>(results_file(topic));
  // Publishing time, the clock and stream stamps differ from run to run; everything else does not.
  Message plain = message;
  Header& header = header_of(plain);
  header.publishing_time_ns = 0;
  header.writer_id.clear();
  header.stream_sequence = 0;
  header.writer_started_ns = 0;
  stamp_clock(header, {});
  *file << to_json(plain) << "\n";
}

Status ReplayLog::written() {
  for (auto& [topic, file] : results_)
    if (!file->flush())
      return fail(Error{.file = results_file(topic),
                        .place = "--results",
                        .value = {},
                        .rule = "cannot be written to: its content is incomplete",
                        .advice = "make room, and replay again"});
  return {};
}

Status ReplayLog::finish(bool all_read) {
  progress_.finish();
  const bool services_run = !options_.offline && !options_.with_services;
  for (const auto& [asset, view] : assets_) {
    if (options_.json)
      std::printf("%s\n", view.json().c_str());
    else
      std::printf("\n%s", view.screen(services_run).c_str());
  }
  if (assets_.empty()) std::printf("no test has been concluded\n");
  if (!options_.results_directory.empty() && results_.empty() && all_read && !any_refused_)
    std::fprintf(stderr, "sealwatch: nothing was written to %s: %s\n", options_.results_directory.c_str(),
                 options_.offline ? "none of these recordings could be concluded"
                                  : "the services had concluded from all these tests before, and say nothing twice; "
                                    "replay --offline, or with another --state, writes everything");
  return written();
}

}  // namespace sealwatch::cli
