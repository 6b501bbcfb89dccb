// What a heartbeat confirms to those who keep no journal, senders of tests and operators: they forget what is
// confirmed, so it is on the disk before it is said. Who sends samples without a number reads in `written` what became of them: so
// of a service that takes samples that is on the disk, too. Services keep their outputs for ever and need not wait.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/service.hpp"
#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {

class ConfirmedPositions {
 public:
  /// `to_disk` brings to the disk what was committed, and says whether it is there (Journal::to_disk).
  ConfirmedPositions(std::function<bool()> to_disk, bool takes_samples)
      : to_disk_(std::move(to_disk)), takes_samples_(takes_samples) {}

  /// Takes from a status, whose positions are committed, what a power cut may still take back. False where the disk
  /// takes nothing any more: then nothing may be confirmed.
  [[nodiscard]] bool make_sure(ServiceStatus& status) {
    std::map<Key, std::uint64_t> committed;
    for (const StreamPosition& position : status.received)
      if (!is_of_a_service(position.topic)) committed[{position.topic, position.writer_id}] = position.sequence;
    if (committed == on_disk_ && (!takes_samples_ || status.written == written_)) return true;
    if (!to_disk_()) return false;
    on_disk_ = std::move(committed);
    written_ = status.written;
    for (StreamPosition& position : status.received) {
      if (is_of_a_service(position.topic)) continue;
      const auto known = on_disk_.find({position.topic, position.writer_id});
      position.sequence = known == on_disk_.end() ? 0 : std::min(position.sequence, known->second);
    }
    return true;
  }

 private:
  using Key = std::pair<std::string, std::string>;  // topic, writer id
  std::function<bool()> to_disk_;
  const bool takes_samples_;
  std::vector<StreamPosition> written_;
  std::map<Key, std::uint64_t> on_disk_;
};

}  // namespace sealwatch
