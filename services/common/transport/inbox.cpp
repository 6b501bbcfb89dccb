#include "services/common/transport/inbox.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sealwatch::transport {
namespace {

std::size_t index_of(const BusItem& item) {
  if (const auto* message = std::get_if<Message>(&item)) return message->index();
  return std::holds_alternative<ServiceStatus>(item) ? kServiceStatusIndex : kResendRequestIndex;
}

bool comes_again(const BusItem& item) {
  const auto* message = std::get_if<Message>(&item);
  if (message == nullptr) return true;
  const Header& header = header_of(*message);
  return !header.writer_id.empty() && header.stream_sequence != 0;
}

}  // namespace

void Inbox::put(BusItem item, std::size_t limit) {
  std::size_t& waiting = waiting_[index_of(item)];
  if (waiting >= limit && comes_again(item)) return;
  ++waiting;
  items_.push_back(std::move(item));
}

std::vector<BusItem> Inbox::take(std::size_t most) {
  const auto end = std::next(items_.begin(), static_cast<std::ptrdiff_t>(std::min(most, items_.size())));
  std::vector<BusItem> taken(std::move_iterator(items_.begin()), std::move_iterator(end));
  items_.erase(items_.begin(), end);
  for (const BusItem& item : taken) --waiting_[index_of(item)];
  return taken;
}

}  // namespace sealwatch::transport
