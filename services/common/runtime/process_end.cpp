#include "services/common/runtime/process_end.hpp"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

namespace sealwatch {
namespace {

timer_t timer;
pid_t owner = 0;              ///< the process that has made the timer: a fork does not inherit it
std::atomic<int> status = 0;  ///< set by one thread, read by whichever takes the signal
static_assert(std::atomic<int>::is_always_lock_free);

void set_timer(std::chrono::milliseconds time) {
  if (owner == 0) return;
  const int saved = errno;  // a signal handler must leave it alone
  itimerspec in{};
  in.it_value.tv_sec = static_cast<time_t>(time.count() / 1000);
  in.it_value.tv_nsec = static_cast<long>(time.count() % 1000) * 1'000'000;
  timer_settime(timer, 0, &in, nullptr);
  errno = saved;
}

}  // namespace

void prepare_process_end() {
  if (owner == getpid()) return;
  struct sigaction action {};
  action.sa_handler = [](int) { _exit(status); };
  sigaction(SIGALRM, &action, nullptr);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  if (timer_create(CLOCK_MONOTONIC, &event, &timer) == 0) owner = getpid();
}

void end_process_in(std::chrono::milliseconds time, int exit_status) {
  status = exit_status;
  set_timer(time);
}

void keep_process() { set_timer({}); }

}  // namespace sealwatch
