// The time within which SIGTERM ends any program of sealwatch, as the machine has it now: by a process that sleeps for two
// seconds and is as much delayed by whatever else runs.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <thread>

namespace sealwatch::testing {

/// Whether it happens within that time from now on.
[[nodiscard]] inline bool happens_within_two_seconds(const std::function<bool()>& happens) {
  const pid_t sleeper = ::fork();
  if (sleeper == 0) {
    timespec left{.tv_sec = 2, .tv_nsec = 0};
    while (::nanosleep(&left, &left) != 0) continue;
    ::_exit(0);
  }
  for (;;) {
    const bool happened = happens();
    if (!happened && ::waitpid(sleeper, nullptr, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    if (happened) ::kill(sleeper, SIGKILL), ::waitpid(sleeper, nullptr, 0);
    return happened;
  }
}

}  // namespace sealwatch::testing
