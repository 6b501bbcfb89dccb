#include "services/common/runtime/try_record.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <limits>

#include "sealwatch/core/text.hpp"

namespace sealwatch {
namespace {

std::uint64_t hash_of(const std::string& message_id) {
  return std::max<std::uint64_t>(std::stoull(content_hash(message_id), nullptr, 16), 1);
}

void count(std::uint16_t& times) {
  if (times < std::numeric_limits<std::uint16_t>::max()) ++times;
}

}  // namespace

Status TryRecord::keep_in(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0640);
  // With its place on the disk: where there is none, what is written to the map ends the process.
  int reason =
      file < 0 || ::ftruncate(file, sizeof(Entries)) != 0 ? errno : ::posix_fallocate(file, 0, sizeof(Entries));
  void* const memory =
      reason == 0 ? ::mmap(nullptr, sizeof(Entries), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
  if (reason == 0) reason = errno;
  if (file >= 0) ::close(file);
  if (memory == MAP_FAILED)
    return sealwatch::fail(Error{
        .file = path,
        .place = {},
        .value = {},
        .rule = std::string("cannot be kept: ") + std::strerror(reason),
        .advice = reason == ENOSPC || reason == EFBIG ? "free some space on the disk" : "let this user write there"});
  entries_ = static_cast<Entries*>(memory);
  for (Entry& entry : *entries_) {
    entry.zero = 0;
    if (entry.message == 0 || entry.at_work == 0) continue;
    count(entry.deaths);
    entry.at_work = 0;
  }
  return {};
}

TryRecord::~TryRecord() {
  stop_in_order();
  if (entries_ != &own_) ::munmap(entries_, sizeof(Entries));
}

void TryRecord::stop_in_order() {
  const std::lock_guard lock(mutex_);
  for (Entry& entry : *entries_) {
    entry.at_work = 0;
    if (is_unsuspected(entry)) entry.message = 0;
  }
}

TryRecord::Entry* TryRecord::find(const std::string& message_id) {
  const std::uint64_t hash = hash_of(message_id);
  const auto found = std::ranges::find(*entries_, hash, &Entry::message);
  return found == entries_->end() ? nullptr : &*found;
}

/// Where all are taken, one that nobody works on makes room: it is counted anew.
TryRecord::Entry& TryRecord::find_or_make(const std::string& message_id) {
  if (Entry* const known = find(message_id)) return *known;
  auto room = std::ranges::find(*entries_, 0U, &Entry::message);
  for (std::size_t k = 0; room == entries_->end() && k < kEntries; ++k) {
    next_ = (next_ + 1) % kEntries;
    if ((*entries_)[next_].at_work == 0) room = entries_->begin() + next_;
  }
  if (room == entries_->end()) room = entries_->begin();
  *room = {};
  room->message = hash_of(message_id);
  return *room;
}

Tries TryRecord::tries(const std::string& message_id) {
  const std::lock_guard lock(mutex_);
  const Entry* const known = find(message_id);
  return known == nullptr ? Tries{} : Tries{known->failures, known->deaths};
}

void TryRecord::begin(const std::string& message_id) {
  const std::lock_guard lock(mutex_);
  find_or_make(message_id).at_work = 1;
}

void TryRecord::end(const std::string& message_id) {
  const std::lock_guard lock(mutex_);
  if (Entry* const known = find(message_id)) *known = {};
}

void TryRecord::fail(const std::string& message_id) {
  const std::lock_guard lock(mutex_);
  Entry& entry = find_or_make(message_id);
  count(entry.failures);
  entry.at_work = 0;
}

void TryRecord::leave(const std::string& message_id) {
  const std::lock_guard lock(mutex_);
  Entry* const known = find(message_id);
  if (known == nullptr) return;
  known->at_work = 0;
  if (is_unsuspected(*known)) known->message = 0;
}

}  // namespace sealwatch
