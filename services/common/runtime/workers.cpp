#include "services/common/runtime/workers.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace sealwatch {
namespace {

/// Receiving comes first, also where processors are few: these threads alone are made nicer (Linux has it by thread).
void give_way() {
  constexpr int kNicer = 5;
  const auto thread = static_cast<id_t>(::gettid());
  ::setpriority(PRIO_PROCESS, thread, ::getpriority(PRIO_PROCESS, thread) + kNicer);
}

double processor_seconds(pthread_t thread) {
  clockid_t clock{};
  timespec time{};
  if (::pthread_getcpuclockid(thread, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (Worker& worker : workers_)
      if (worker.work) worker.work->stop.request_stop();
  }
  changed_.notify_all();
  for (Worker& worker : workers_) worker.thread.join();
}

void Workers::add(Work work) {
  const std::lock_guard lock(mutex_);
  (work.is_long ? waiting_long_ : waiting_).push_back(std::move(work));
  if (idle_ < waiting_.size() + waiting_long_.size() && workers_.size() < limits_.threads) {
    Worker& made = workers_.emplace_back();
    ++idle_;
    made.thread = std::thread([this, &made] { run(made); });
  }
  changed_.notify_one();
}

std::optional<Workers::Work> Workers::next() {
  const bool is_long = waiting_.empty() && long_at_work_ < limits_.long_work;
  std::deque<Work>& queue = is_long ? waiting_long_ : waiting_;
  if (queue.empty()) return std::nullopt;
  Work work = std::move(queue.front());
  queue.pop_front();
  if (is_long) ++long_at_work_;
  return work;
}

void Workers::run(Worker& worker) {
  give_way();
  std::unique_lock lock(mutex_);
  for (;;) {
    std::optional<Work> work;
    changed_.wait(lock, [&] { return stopping_ || (work = next()).has_value(); });
    if (!work) return;
    --idle_;
    worker.work = std::move(work);
    worker.begun = Clock::now();
    worker.processor_s_at_begin = processor_seconds(::pthread_self());
    worker.asked_to_stop.reset();
    worker.told_of = false;
    lock.unlock();
    worker.work->run(worker.work->stop.get_token());
    lock.lock();
    if (worker.work->is_long) --long_at_work_;
    worker.work.reset();
    ++idle_;
    if (stopping_) changed_.notify_all();
  }
}

bool Workers::is_overdue(const Worker& worker, Clock::time_point now) const {
  constexpr int kByTheClock = 5;
  if (now - worker.begun > kByTheClock * limits_.deadline) return true;
  if (now - worker.begun < limits_.deadline) return false;  // saves asking for processor time
  const double used_s =
      processor_seconds(const_cast<std::thread&>(worker.thread).native_handle()) - worker.processor_s_at_begin;
  return used_s > std::chrono::duration<double>(limits_.deadline).count();
}

std::optional<std::string> Workers::look_after() {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  for (Worker& worker : workers_) {
    if (!worker.work || !is_overdue(worker, now)) continue;
    if (!worker.asked_to_stop) {
      worker.asked_to_stop = now;
      worker.work->stop.request_stop();
    } else if (!worker.told_of && now - *worker.asked_to_stop > limits_.grace) {
      worker.told_of = true;
      return worker.work->name;
    }
  }
  return std::nullopt;
}

bool Workers::stop(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  for (Worker& worker : workers_)
    if (worker.work) worker.work->stop.request_stop();
  changed_.notify_all();
  return changed_.wait_for(lock, patience, [this] {
    return std::ranges::none_of(workers_, [](const Worker& worker) { return worker.work.has_value(); });
  });
}

}  // namespace sealwatch
