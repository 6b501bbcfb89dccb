// What a late subscriber must find, who gets what was published last of every asset: the word on the latest event. A
// test that comes late, or a message that is sent again, must not stay the last one published.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class LatestOutputs {
 public:
  using Key = std::pair<Topic, std::string>;  // asset

  /// An own output of that sequence number was concluded. Of two on the same event the one that was concluded later
  /// counts, and one without a time only where none has any; so it does of advisories: what was advised last stands,
  /// whatever it answers to; and what is concluded anew after a retraction, as the test it takes the place of was later.
  void concluded(const Message& output, std::uint64_t sequence);
  /// A stamped output went out.
  void published(const Message& output);
  /// Whether it is the one that late subscribers are to get.
  [[nodiscard]] bool is_latest(Topic topic, const std::string& asset_id, std::uint64_t sequence) const {
    const auto known = latest_.find({topic, asset_id});
    return known != latest_.end() && known->second.sequence == sequence;
  }
  /// Sequence numbers of the latest outputs that were not the last published of their topic and asset.
  [[nodiscard]] std::map<Key, std::uint64_t> to_publish() const;

 private:
  struct Latest {
    bool time_known = false;
    std::int64_t event_time_ns = 0;
    std::uint64_t sequence = 0;
  };
  std::map<Key, Latest> latest_;
  std::set<Key> hidden_;  ///< the last one published is another
};

}  // namespace sealwatch
