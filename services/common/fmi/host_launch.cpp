#include "services/common/fmi/host_launch.hpp"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "services/common/fmi/host_protocol.hpp"

namespace sealwatch::fmi {
namespace {

constexpr const char* kHost = "sealwatch-fmu-host";

/// Beside the running program, where it is installed and built; $SEALWATCH_FMU_HOST for programs that stand elsewhere.
std::string host_program() {
  if (const char* given = std::getenv("SEALWATCH_FMU_HOST")) return given;
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return (self.parent_path() / kHost).string();
}

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

/// Neither the binary nor what it starts leaves the process group, which ends as one: whoever asks for a session or a group
/// of his own is refused, as if he had no right to it. Where the kernel has no filters, nothing is refused.
void stay_in_group() {
  std::array<sock_filter, 5> rules = {sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                                      sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_setsid, 1, 0),
                                      sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_setpgid, 0, 1),
                                      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
                                      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  sock_fprog filter{.len = rules.size(), .filter = rules.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}

/// Between fork and exec: only calls that are allowed there. In a session of its own, what a terminal sends to sealwatch
/// does not end it: it clears up after sealwatch. Sanitizers reserve terabytes of addresses, which the limit on memory
/// would count.
[[noreturn]] void become_host(const char* program, std::array<int, 3> ends, std::uint64_t memory_bytes) {
  setsid();
  stay_in_group();
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGCHLD})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::array<int, 3> safe{};  // away from the numbers that they are to get
  for (std::size_t k = 0; k < ends.size(); ++k) safe[k] = fcntl(ends[k], F_DUPFD, 10);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, 0);
  dup2(safe[2], 1);
  dup2(safe[2], 2);
  dup2(safe[0], kSharedMemoryDescriptor);
  dup2(safe[1], kLifeDescriptor);
  close_range(kLifeDescriptor + 1, ~0U, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 1ULL << 30U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit(RLIMIT_AS, memory_bytes);
#else
  static_cast<void>(memory_bytes);
#endif
  execl(program, kHost, nullptr);
  _exit(127);
}

/// What the process shares with this one; closed here where it has been handed over, or where something failed.
struct Ends {
  int memory = -1, output = -1;
  std::array<int, 2> life{-1, -1};
  void close_all() const {
    for (const int end : {memory, output, life[0], life[1]})
      if (end >= 0) close(end);
  }
};

/// The size is sealed: a binary that cuts the memory would otherwise end this process too.
bool open_ends(Ends& ends, std::size_t bytes) {
  ends.memory = memfd_create("sealwatch_fmu", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  ends.output = memfd_create("sealwatch_fmu_output", MFD_CLOEXEC);
  return ends.memory >= 0 && ends.output >= 0 && ftruncate(ends.memory, static_cast<off_t>(bytes)) == 0 &&
         fcntl(ends.memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0 &&
         socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.life.data()) == 0;
}

tl::unexpected<Error> trouble(const Ends& ends, std::string rule, std::string advice) {
  ends.close_all();
  return fail(std::move(rule), std::move(advice));
}

}  // namespace

Result<LaunchedHost> launch_host(std::size_t shared_bytes, std::uint64_t memory_limit_bytes) {
  const std::string program = host_program();
  if (access(program.c_str(), X_OK) != 0)
    return fail("cannot be run: there is no program " + program,
                "install it beside sealwatch, or set SEALWATCH_FMU_HOST to where it is");
  constexpr const char* kAdvice = "close other programs and try again";
  Ends ends;
  void* memory = open_ends(ends, shared_bytes)
                     ? mmap(nullptr, shared_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, ends.memory, 0)
                     : MAP_FAILED;
  if (memory == MAP_FAILED)
    return trouble(ends, std::string("cannot be run: no shared memory: ") + std::strerror(errno), kAdvice);
  const pid_t child = fork();
  if (child == 0) become_host(program.c_str(), {ends.memory, ends.life[1], ends.output}, memory_limit_bytes);
  if (child < 0) {
    munmap(memory, shared_bytes);
    return trouble(ends, std::string("cannot be run: no process: ") + std::strerror(errno), kAdvice);
  }
  close(ends.memory);
  close(ends.life[1]);
  return LaunchedHost{.process = child, .memory = memory, .life = ends.life[0], .output = ends.output};
}

}  // namespace sealwatch::fmi
