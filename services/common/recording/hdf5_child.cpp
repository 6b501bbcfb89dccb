#include "services/common/recording/hdf5_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <type_traits>

#include "sealwatch/core/process_copy.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

using Variables = std::vector<MatVariable>;
using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// The numbers of one test take 16 MB and a fraction of a second. A chunk of zeros unpacks to gigabytes, thousands of
// nested groups take minutes, and a data set may lie in a file of its own: a pipe, for whose writer the library waits.
constexpr std::uint64_t kMoreMemory_bytes = 400'000'000;
constexpr rlim_t kProcessorTime_s = 5;
constexpr unsigned kLongest_s = 10;

// The answer on its way: 1 and the variables, or 0 and the error's five texts. Both ends are this program.

template <class T>
void put(std::FILE* to, const T& content) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    std::fwrite(&content, sizeof content, 1, to);
  } else {
    put(to, static_cast<std::uint64_t>(content.size()));
    std::fwrite(content.data(), sizeof(typename T::value_type), content.size(), to);
  }
}

template <class T>
bool get(std::FILE* from, T& content) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    return std::fread(&content, sizeof content, 1, from) == 1;
  } else {
    std::uint64_t size = 0;
    if (!get(from, size) || size > kMostNumbers) return false;  // a child may have lost its wits before it ended
    content.resize(size);
    return std::fread(content.data(), sizeof(typename T::value_type), size, from) == size;
  }
}

void put_answer(std::FILE* to, const Result<Variables>& answer) {
  put(to, static_cast<std::uint64_t>(answer.has_value()));
  if (answer) {
    put(to, static_cast<std::uint64_t>(answer->size()));
    for (const MatVariable& variable : *answer) {
      for (const std::string* text :
           {&variable.name, &variable.unit, &variable.scaling, &variable.rule, &variable.advice})
        put(to, *text);
      put(to, variable.values);
    }
  } else {
    const Error& error = answer.error();
    for (const std::string* text : {&error.file, &error.place, &error.value, &error.rule, &error.advice})
      put(to, *text);
  }
}

std::optional<Result<Variables>> get_answer(std::FILE* from) {
  std::uint64_t good = 0, count = 0;
  if (!get(from, good)) return std::nullopt;
  if (good == 0) {
    Error error;
    for (std::string* text : {&error.file, &error.place, &error.value, &error.rule, &error.advice})
      if (!get(from, *text)) return std::nullopt;
    return fail(std::move(error));
  }
  if (!get(from, count) || count > kMostNumbers) return std::nullopt;
  Variables variables;
  for (std::uint64_t k = 0; k < count; ++k) {
    MatVariable& variable = variables.emplace_back();
    for (std::string* text : {&variable.name, &variable.unit, &variable.scaling, &variable.rule, &variable.advice})
      if (!get(from, *text)) return std::nullopt;
    if (!get(from, variable.values)) return std::nullopt;
  }
  return variables;
}

void set_limit(int resource, rlim_t limit) {
  const rlimit both{limit, limit + 1};  // the first has a signal with a name of its own, the second kills
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

/// Sanitizers reserve terabytes of addresses, which the limit would take for memory.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(SEALWATCH_FUZZING)
  const Stream file(std::fopen("/proc/self/statm", "r"), &std::fclose);
  unsigned long long pages = 0;
  if (!file || std::fscanf(file.get(), "%llu", &pages) != 1) return;
  set_limit(RLIMIT_AS, pages * static_cast<unsigned long long>(sysconf(_SC_PAGESIZE)) + kMoreMemory_bytes);
#endif
}

[[noreturn]] void answer_and_end(int pipe_end, const std::function<Result<Variables>()>& read) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGSEGV, SIGBUS, SIGABRT, SIGPIPE, SIGALRM})
    std::signal(signal, SIG_DFL);
  alarm(kLongest_s);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, kProcessorTime_s);
  limit_memory();
  const Stream to(fdopen(pipe_end, "w"), &std::fclose);
  bool all_there = false;
  try {
    if (to) put_answer(to.get(), read());
    all_there = to && std::fflush(to.get()) == 0;
  } catch (const std::exception&) {  // no memory for what a damaged length says
  }
  _exit(all_there ? 0 : 1);
}

Error no_answer(int status) {
  std::string how = "ended without an answer";
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGXCPU))
    how = "took too long";
  else if (WIFSIGNALED(status))
    how = std::string("was stopped: ") + strsignal(WTERMSIG(status));
  return {
      .file = {},
      .place = {},
      .value = {},
      .rule = "is damaged: the library that reads HDF5 and MATLAB 7.3 files " + how,
      .advice = "record or export it again; save(..., '-v7') writes a format that can be checked before it is read"};
}

}  // namespace

Result<Variables> in_child(const std::function<Result<Variables>()>& read) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return fail(std::string("cannot be read: no pipe, ") + std::strerror(errno));
  const pid_t child = copy_process();
  if (child == 0) {
    close(ends[0]);
    answer_and_end(ends[1], read);
  }
  close(ends[1]);
  const Stream from(fdopen(ends[0], "r"), &std::fclose);
  if (child < 0) return fail(std::string("cannot be read: no process, ") + std::strerror(errno));
  std::optional<Result<Variables>> answer = get_answer(from.get());
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return answer ? std::move(*answer) : Result<Variables>(fail(no_answer(status)));
}

}  // namespace sealwatch
