#include "services/common/runtime/latest_outputs.hpp"

#include <algorithm>

#include "sealwatch/message/retraction.hpp"

namespace sealwatch {

namespace {

/// It has the time of the act, and whatever test is concluded later says more.
bool says_that_no_test_counts(const Header& header) {
  return answers_retraction(header) && std::ranges::all_of(header.source_ids, [](const std::string& id) {
           return id.find("retraction/") != std::string::npos;
         });
}

}  // namespace

void LatestOutputs::concluded(const Message& output, std::uint64_t sequence) {
  const Header& header = header_of(output);
  const Key key{topic_of(output), asset_of(output)};
  const auto known = latest_.find(key);
  const bool may_be_late = key.first != Topic::advisory && known != latest_.end() && known->second.time_known;
  const bool late = may_be_late && !answers_retraction(header) &&
                    (!header.event_time_known || header.event_time_ns < known->second.event_time_ns);
  if (late) return;
  const bool time_known = header.event_time_known && !says_that_no_test_counts(header);
  latest_[key] = {time_known, header.event_time_ns, sequence};
  hidden_.insert(key);
}

void LatestOutputs::published(const Message& output) {
  const Key key{topic_of(output), asset_of(output)};
  const auto known = latest_.find(key);
  if (known == latest_.end()) return;
  if (header_of(output).stream_sequence == known->second.sequence)
    hidden_.erase(key);
  else
    hidden_.insert(key);
}

std::map<LatestOutputs::Key, std::uint64_t> LatestOutputs::to_publish() const {
  std::map<Key, std::uint64_t> wanted;
  for (const Key& key : hidden_) wanted[key] = latest_.at(key).sequence;
  return wanted;
}

}  // namespace sealwatch
