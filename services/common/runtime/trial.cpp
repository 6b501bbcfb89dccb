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
#include <utility>

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

/// Of all its threads.
std::chrono::nanoseconds processor_time(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return {};
  return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec);
}

/// Whether it waits for something else than a processor or the disk (proc(5): state S), and not for a child of its own.
bool sleeps_alone(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream stat("/proc/" + id + "/stat"), children("/proc/" + id + "/task/" + id + "/children");
  std::string line, child;
  std::getline(stat, line);
  const std::size_t behind_name = line.rfind(") ");
  return behind_name != std::string::npos && line.compare(behind_name + 2, 1, "S") == 0 && !(children >> child);
}

}  // namespace

std::optional<Trial::Copy> Trial::copy_for(const std::function<void()>& work) {
  std::array<int, 2> words{};
  if (::pipe2(words.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t maker = ::getpid();
  const rlim_t memory = data_now();
  const pid_t process = copy_process();
  if (process == 0) live(work, words[1], maker, memory);
  ::close(words[1]);
  if (process > 0) return Copy{process, words[0]};
  ::close(words[0]);
  return std::nullopt;
}

std::unique_ptr<Trial> Trial::begin(std::function<void()> work, const Limits& limits) {
  const auto copy = copy_for(work);
  return copy ? std::unique_ptr<Trial>(new Trial(std::move(work), limits, *copy)) : nullptr;
}

Trial::Trial(std::function<void()> work, const Limits& limits, Copy copy)
    : work_(std::move(work)), limits_(limits), copy_(copy), begun_(std::chrono::steady_clock::now()), moved_(begun_) {}

Trial::~Trial() { end_copy(); }

void Trial::end_copy() {
  if (copy_.process > 0) {
    ::kill(copy_.process, SIGKILL);
    ::waitpid(copy_.process, nullptr, 0);
  }
  if (copy_.words >= 0) ::close(copy_.words);
  copy_ = {};
}

std::string Trial::told() const {
  std::array<char, 400> text{};
  const ssize_t size = ::read(copy_.words, text.data(), text.size());
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "it ended in an unknown way";
}

bool Trial::is_overdue() const {
  return std::chrono::steady_clock::now() - begun_ > limits_.by_clock ||
         processor_time(copy_.process) > limits_.deadline;
}

bool Trial::stands_still() {
  const auto now = std::chrono::steady_clock::now();
  const auto used = processor_time(copy_.process);
  if (used != used_) moved_ = now;
  used_ = used;
  if (now - moved_ <= limits_.still) return false;
  if (sleeps_alone(copy_.process)) return true;
  moved_ = now;
  return false;
}

std::optional<std::string> Trial::with_another_copy() {
  constexpr int kMostCopies = 3;
  end_copy();
  if (copies_++ == kMostCopies) return "it stood still, each time it was tried";
  const auto copy = copy_for(work_);
  if (!copy) return "no process can be made to try it in";
  copy_ = *copy;
  begun_ = moved_ = std::chrono::steady_clock::now();
  used_ = {};
  return std::nullopt;
}

std::optional<std::string> Trial::result() {
  int status = 0;
  const pid_t ended = ::waitpid(copy_.process, &status, WNOHANG);
  if (ended == 0) {
    if (is_overdue()) return "it did not end within " + in_seconds(limits_.deadline);
    return stands_still() ? with_another_copy() : std::nullopt;
  }
  copy_.process = -1;
  if (ended < 0) return "it ended in an unknown way";
  if (WIFSIGNALED(status))
    return "it ended its process by signal " + std::to_string(WTERMSIG(status)) + " (" +
           ::sigdescr_np(WTERMSIG(status)) + ")";
  return WEXITSTATUS(status) == 0 ? std::string() : told();
}

}  // namespace sealwatch
