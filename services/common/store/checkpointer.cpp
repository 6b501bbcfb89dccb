#include "services/common/store/checkpointer.hpp"

#include <soci/soci.h>

namespace sealwatch {
namespace {

/// Half a second of fifty actuators: little at a time, which the disk takes beside the service's writing.
constexpr std::size_t kRows = 1000;
/// Pages of 1 kB (database.cpp). A log that is begun anew soon is still in memory.
constexpr int kLongLog = 16'000;

}  // namespace

Checkpointer::~Checkpointer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Checkpointer::committed(std::size_t rows) {
  rows_ += rows;
  if (rows_ < kRows) return;
  rows_ = 0;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = true;
  }
  changed_.notify_all();
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
}

void Checkpointer::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || wanted_; });
    if (stopping_) return;
    wanted_ = false;
    lock.unlock();
    try {
      checkpoint();
    } catch (const std::exception&) {
      // The log stays as it is and is tried again later; what really fails, a full disk, fails the writer too.
    }
    lock.lock();
  }
}

void Checkpointer::checkpoint() {
  soci::session sql(connection_);
  int busy = 0;
  int pages = 0;
  int moved = 0;
  const auto move = [&] {
    sql << "PRAGMA wal_checkpoint(PASSIVE)", soci::into(busy), soci::into(pages), soci::into(moved);
  };
  move();
  if (pages < kLongLog) return;
  move();  // what came meanwhile, so that little is left
  nearly_done_ = true;
}

}  // namespace sealwatch
