#include "services/common/runtime/workers.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

/// What is received comes first, also where processors are few: these threads alone are made nicer (Linux has it by
/// thread). Not those of short work: a batch waits for them, and they would wait for whoever else keeps processors busy.
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

std::string in_seconds(std::chrono::milliseconds time) {
  return text::general(std::chrono::duration<double>(time).count()) + " s";
}

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    ask_all_to_stop();
  }
  for (Worker& worker : workers_) worker.thread.join();
}

void Workers::ask_all_to_stop() {
  stopping_ = true;
  for (Worker& worker : workers_)
    if (worker.work) worker.work->stop.request_stop();
  short_.changed.notify_all();
  long_.changed.notify_all();
}

void Workers::add(Work work) {
  const std::lock_guard lock(mutex_);
  Crew& crew = work.is_long ? long_ : short_;
  crew.waiting.push_back(std::move(work));
  if (crew.idle < crew.waiting.size() && crew.made < crew.most) {
    Worker& worker = workers_.emplace_back();
    ++crew.made;
    ++crew.idle;
    worker.thread = std::thread([this, &worker, &crew] { run(worker, crew); });
  }
  crew.changed.notify_one();
}

void Workers::run(Worker& worker, Crew& crew) {
  if (&crew == &long_) give_way();
  std::unique_lock lock(mutex_);
  for (;;) {
    crew.changed.wait(lock, [&] { return stopping_ || !crew.waiting.empty(); });
    if (stopping_) return;
    --crew.idle;
    worker.work = std::move(crew.waiting.front());
    crew.waiting.pop_front();
    worker.begun = Clock::now();
    worker.processor_s_at_begin = processor_seconds(::pthread_self());
    worker.asked_to_stop.reset();
    worker.told_of = false;
    lock.unlock();
    worker.work->run(worker.work->stop.get_token());
    lock.lock();
    worker.work.reset();
    ++crew.idle;
    if (stopping_) ended_.notify_all();
  }
}

bool Workers::is_overdue(const Worker& worker, Clock::time_point now) const {
  if (now - worker.begun > limits_.by_clock) return true;
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
  ask_all_to_stop();
  return ended_.wait_for(lock, patience, [this] {
    return std::ranges::none_of(workers_, [](const Worker& worker) { return worker.work.has_value(); });
  });
}

}  // namespace sealwatch
