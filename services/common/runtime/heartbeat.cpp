#include "services/common/runtime/heartbeat.hpp"

#include <utility>

#include "services/common/runtime/log.hpp"

namespace sealwatch {

Heartbeat::Heartbeat(Bus& bus, const Clock& clock, ServiceStatus status, Options options)
    : bus_(bus), clock_(clock), options_(std::move(options)), status_(std::move(status)) {
  thread_ = std::thread([this] { beat(); });
}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    status_.state = "stopping";
  }
  changed_.notify_all();
  thread_.join();
}

void Heartbeat::update(const std::function<void(ServiceStatus&)>& change) {
  bool changed = false;
  {
    const std::lock_guard lock(mutex_);
    ServiceStatus next = status_;
    change(next);
    changed = next != status_;
    if (changed) status_ = std::move(next);
    dirty_ = dirty_ || changed;
    main_thread_seen_ = std::chrono::steady_clock::now();
  }
  if (changed) changed_.notify_all();
}

void Heartbeat::beat_soon() {
  {
    const std::lock_guard lock(mutex_);
    dirty_ = true;
  }
  changed_.notify_all();
}

void Heartbeat::touch() {
  const std::lock_guard lock(mutex_);
  main_thread_seen_ = std::chrono::steady_clock::now();
}

void Heartbeat::beat() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    publish(lock);
    changed_.wait_for(lock, options_.shortest, [this] { return stopping_; });
    changed_.wait_for(lock, options_.interval - options_.shortest, [this] { return stopping_ || dirty_; });
  }
  publish(lock);
}

void Heartbeat::publish(std::unique_lock<std::mutex>& lock) {
  dirty_ = false;
  ServiceStatus status = status_;
  const auto silent =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - main_thread_seen_);
  lock.unlock();                                               // a slow bus must not hold up the main thread
  if (let_out_ && options_.on_beat) options_.on_beat(silent);  // before the disk, which may be slow
  const bool let_out = !options_.before_beat || options_.before_beat(status);
  if (!let_out && let_out_) log_event(LogLevel::error, "no heartbeat: what it would confirm is not on the disk", {});
  let_out_ = let_out;
  if (!let_out) return lock.lock();
  status.publishing_time_ns = clock_.now().nanoseconds;
  if (const Status published = bus_.publish(status); !published)
    log_event(LogLevel::warn, "heartbeat not published", {{"error", published.error().describe()}});
  lock.lock();
}

}  // namespace sealwatch
