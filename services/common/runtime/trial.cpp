#include "services/common/runtime/trial.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <exception>
#include <fstream>

#include "sealwatch/core/process_copy.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/workers.hpp"

namespace sealwatch {
namespace {

/// A test never takes so much; a computation that wants more is told so, before the machine's memory is gone.
constexpr rlim_t kMostMemory = rlim_t{2} << 30;

bool memory_is_shadowed() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

/// Bytes of data that this process has now.
rlim_t data_now() {
  std::ifstream file("/proc/self/statm");
  rlim_t total = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  file >> total >> resident >> shared >> text >> library >> data;
  return data * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

void say(int words, const char* text) { [[maybe_unused]] const auto written = ::write(words, text, std::strlen(text)); }

/// The copy's whole life.
[[noreturn]] void live(const std::function<void()>& work, int words, pid_t maker, rlim_t memory) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != maker) ::_exit(1);
  constexpr int kWords = 3;
  ::dup2(words, kWords);
  ::close_range(kWords + 1, ~0U, 0);
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  const rlimit data{memory + kMostMemory, memory + kMostMemory};
  if (!memory_is_shadowed()) ::setrlimit(RLIMIT_DATA, &data);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTERM, SIGINT}) ::signal(signal, SIG_DFL);
  silence_log();
  try {
    work();
  } catch (const std::bad_alloc&) {
    say(kWords, "it wants more memory than a test may take");
    ::_exit(1);
  } catch (const std::exception& raised) {
    say(kWords, raised.what());
    ::_exit(1);
  } catch (...) {
    say(kWords, "it raised an exception");
    ::_exit(1);
  }
  ::_exit(0);
}

}  // namespace

std::unique_ptr<Trial> Trial::begin(const std::function<void()>& work, std::chrono::milliseconds deadline,
                                    std::chrono::milliseconds by_clock) {
  std::array<int, 2> words{};
  if (::pipe2(words.data(), O_CLOEXEC) != 0) return nullptr;
  const pid_t maker = ::getpid();
  const rlim_t memory = data_now();
  const pid_t process = copy_process();
  if (process == 0) live(work, words[1], maker, memory);
  ::close(words[1]);
  if (process < 0) {
    ::close(words[0]);
    return nullptr;
  }
  return std::unique_ptr<Trial>(new Trial(process, words[0], deadline, by_clock));
}

Trial::Trial(pid_t process, int words, std::chrono::milliseconds deadline, std::chrono::milliseconds by_clock)
    : process_(process),
      words_(words),
      begun_(std::chrono::steady_clock::now()),
      deadline_(deadline),
      by_clock_(by_clock) {}

Trial::~Trial() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(words_);
}

std::string Trial::told() const {
  std::array<char, 400> text{};
  const ssize_t size = ::read(words_, text.data(), text.size());
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "it ended in an unknown way";
}

bool Trial::is_overdue() const {
  if (std::chrono::steady_clock::now() - begun_ > by_clock_) return true;
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process_, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return false;
  return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec) > deadline_;
}

std::optional<std::string> Trial::result() {
  int status = 0;
  const pid_t ended = ::waitpid(process_, &status, WNOHANG);
  if (ended == 0) {
    if (!is_overdue()) return std::nullopt;
    return "it did not end within " + in_seconds(deadline_);
  }
  process_ = -1;
  if (ended < 0) return "it ended in an unknown way";
  if (WIFSIGNALED(status))
    return "it ended its process by signal " + std::to_string(WTERMSIG(status)) + " (" +
           ::sigdescr_np(WTERMSIG(status)) + ")";
  return WEXITSTATUS(status) == 0 ? std::string() : told();
}

}  // namespace sealwatch
