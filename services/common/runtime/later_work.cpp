#include "services/common/runtime/later_work.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace sealwatch {
namespace {

/// Receiving comes first, also where processors are few: this thread alone is made nicer (Linux has it by thread).
void give_way() {
  constexpr int kNicer = 5;
  const auto thread = static_cast<id_t>(::gettid());
  ::setpriority(PRIO_PROCESS, thread, ::getpriority(PRIO_PROCESS, thread) + kNicer);
}

}  // namespace

LaterWork::~LaterWork() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LaterWork::add(Work work) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  ++open_;
  changed_.notify_all();
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
}

std::vector<Conclusion> LaterWork::take_done() {
  if (open_ == 0) return {};
  const std::lock_guard lock(mutex_);
  if (raised_) std::rethrow_exception(raised_);
  open_ -= done_.size();
  return std::exchange(done_, {});
}

void LaterWork::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return !done_.empty() || raised_; });
}

void LaterWork::run() {
  give_way();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (stopping_) return;
    const Work work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    Conclusion conclusion;
    std::exception_ptr raised;
    try {
      conclusion = work();
    } catch (...) {
      raised = std::current_exception();
    }
    lock.lock();
    if (raised)
      raised_ = raised;
    else
      done_.push_back(std::move(conclusion));
    changed_.notify_all();
    on_done_();
    if (raised_) return;
  }
}

}  // namespace sealwatch
