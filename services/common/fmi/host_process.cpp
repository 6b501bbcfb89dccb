#include "services/common/fmi/host_process.hpp"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/fmi/host_launch.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::fmi {
namespace {

std::string place_of(const char* what, double time_s) {
  if (std::isnan(time_s)) return what;
  std::string text = std::to_string(time_s);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return std::string(what) + " at t = " + text + " s";
}

std::string share_of_memory(double bytes, double most) {
  constexpr double kGigabyte = 1024.0 * 1024.0 * 1024.0;
  return "has taken " + text::significant(bytes / kGigabyte, 2) + " of the " + text::significant(most / kGigabyte, 2) +
         " GiB of memory that it may have";
}

}  // namespace

MakeLocalHost& local_hosts() {
  static MakeLocalHost make;
  return make;
}

std::function<void(const std::string&)>& slow_starts() {
  static std::function<void(const std::string&)> tell;
  return tell;
}

HostProcess::HostProcess(std::string file, std::size_t heap_bytes, const ProcessLimits& limits)
    : file_(std::move(file)), limits_(limits), memory_bytes_(sizeof(SharedHeader) + heap_bytes) {}

Status HostProcess::launch() {
  Result<LaunchedHost> host = launch_host(memory_bytes_, limits_.memory_bytes);
  if (!host) {
    Error error = host.error();
    error.file = file_;
    return fail(std::move(error));
  }
  header_ = new (host->memory) SharedHeader;
  header_->heap_bytes = memory_bytes_ - sizeof(SharedHeader);
  owner_ = getpid();
  child_ = host->process, life_ = host->life, output_ = host->output;
  alive_ = true;
  loss_.reset();
  return {};
}

bool HostProcess::alive() const { return alive_ && (local_ || owner_ == getpid()); }

HostProcess::~HostProcess() { end(); }

void HostProcess::end() {
  if (child_ > 0 && owner_ != getpid()) alive_ = false, child_ = -1;  // it is another's
  if (alive_) {
    constexpr double kPatience_s = 2.0;  // a licence is given back, and the like
    static_cast<void>(request(Operation::end, "ending", kPatience_s));
    for (int look = 0; alive_ && look < 200 && !has_ended(); ++look) usleep(1000);
  }
  if (child_ > 0) kill_and_reap();
  if (header_ != nullptr) munmap(header_, memory_bytes_);
  header_ = nullptr;
  for (int* descriptor : {&life_, &output_})
    if (*descriptor >= 0) close(std::exchange(*descriptor, -1));
}

bool HostProcess::has_ended() const {
  siginfo_t about{};
  return waitid(P_PID, static_cast<id_t>(child_), &about, WEXITED | WNOHANG | WNOWAIT) == 0 && about.si_pid == child_;
}

// Where allocations fail, a binary may crash, or wait for ever; the limit is none where sanitizers are at work.
std::string HostProcess::exhausted_memory() const {
  rlimit limit{};
  if (prlimit(child_, RLIMIT_AS, nullptr, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  constexpr double kAll = 15.0 / 16.0;
  std::ifstream status("/proc/" + std::to_string(child_) + "/status");
  double peak_kB = 0.0;
  for (std::string word; status >> word && peak_kB == 0.0;)
    if (word == "VmPeak:") status >> peak_kB;
  const auto most = static_cast<double>(limit.rlim_cur);
  if (1024.0 * peak_kB < kAll * most) return "";
  return share_of_memory(1024.0 * peak_kB, most);
}

// Its group has its number, which nobody else gets until it is reaped.
int HostProcess::kill_and_reap() {
  alive_ = false;
  kill(child_, SIGKILL);
  kill(-child_, SIGKILL);
  int status = 0;
  rusage use{};
  while (wait4(child_, &status, 0, &use) < 0 && errno == EINTR) {
  }
  peak_bytes_ = 1024.0 * static_cast<double>(use.ru_maxrss);
  child_ = -1;
  return status;
}

std::span<std::byte> HostProcess::heap() const {
  if (local_) return {const_cast<std::byte*>(local_heap_.data()), local_heap_.size()};
  return {reinterpret_cast<std::byte*>(header_) + sizeof(SharedHeader), memory_bytes_ - sizeof(SharedHeader)};
}

Status HostProcess::request(Operation operation, const char* what, double seconds, double time_s,
                            const std::function<void()>& look) {
  using Clock = std::chrono::steady_clock;
  if (!alive()) return fail(failure(place_of(what, time_s), "the process that ran the FMU has ended", "start anew"));
  if (local_) return request_here(operation, what, time_s);
  const std::uint32_t number = header_->requests.load() + 1;
  header_->operation = operation;
  store_and_wake(header_->requests, number);
  constexpr double kLook_s = 0.02;              // how soon an end of the process is seen
  constexpr std::chrono::seconds kPatience{3};  // a run is told to stop, which it does between two calls
  std::optional<Clock::time_point> passed_at;
  auto begin = Clock::now();
  std::uint32_t calls = header_->calls.load();
  bool told = !slow_starts();
  for (std::uint32_t last = number - 1; !wait_while(header_->answers, last, kLook_s);) {
    if (look) look();
    if (!passed_at && passed(deadline_)) passed_at = Clock::now();
    const bool unwanted = passed_at && Clock::now() - *passed_at > kPatience;
    if (has_ended()) {
      const int status = kill_and_reap();
      if (header_->answers.load() == number) break;
      loss_ = Loss{.hung = false, .error = ended(place(what, time_s), status)};
      return fail(loss_->error);
    }
    if (const std::uint32_t now = header_->calls.load(); now != calls) calls = now, begin = Clock::now();
    const bool starts =
        header_->inside == Operation::begin || operation == Operation::load || operation == Operation::begin;
    const double most = header_->inside == Operation::begin ? limits_.start_s : seconds;
    const double waited = std::chrono::duration<double>(Clock::now() - begin).count();
    if (unwanted) {
      constexpr double kHangs_s = 2.0;  // no call takes as long, of the thousands that a run makes
      Error error = end_unwanted(place(what, time_s), waited);
      if (waited > kHangs_s && header_->inside != Operation::begin) loss_ = Loss{.hung = true, .error = error};
      return fail(std::move(error));
    }
    if (starts && !told && waited > limits_.told_s) {
      slow_starts()(file_ + ": waiting for the FMU to start, at most " + std::to_string(std::lround(most)) + " s");
      told = true;
    }
    if (waited < most) continue;
    loss_ = Loss{.hung = true, .error = end_silent(place(what, time_s), most)};
    return fail(loss_->error);
  }
  if (header_->status != AnswerStatus::failed) return {};
  std::array<char, kTextBytes> text{};
  std::copy_n(header_->text, kTextBytes - 1, text.begin());
  return fail(failure(place_of(what, time_s), text.data(), advice_of(operation) + printed()));
}

void HostProcess::serve_here(const Setup& setup) {
  local_ = local_hosts()(setup);
  local_heap_.resize(memory_bytes_ - sizeof(SharedHeader));
  alive_ = true;
}

Status HostProcess::request_here(Operation operation, const char* what, double time_s) {
  const auto failed = local_->serve(operation, time_s, local_heap_);
  if (!failed) return {};
  return fail(failure(place_of(what, time_s), *failed, advice_of(operation)));
}

std::string HostProcess::place(const char* what, double time_s) const {
  switch (header_->inside) {
    case Operation::begin:
      return "the start of the model";
    case Operation::evaluate:
      return place_of("the derivatives", header_->at_s);
    case Operation::event:
      return place_of("an event", header_->at_s);
    case Operation::completed_step:
      return place_of("the end of a step", header_->at_s);
    case Operation::do_step:
      return place_of("a step", header_->at_s);
    default:
      return place_of(what, time_s);
  }
}

std::string HostProcess::advice_of(Operation operation) const {
  const bool starts = operation == Operation::begin || operation == Operation::load;
  if (starts && !needed_tool_.empty())
    return "it needs " + needed_tool_ +
           " on this machine to run (needsExecutionTool): install it, or export the model without that need";
  return operation == Operation::begin ? "a licence may be missing, or a parameter outside what the model allows"
                                       : "try the model in the tool that made it";
}

Error HostProcess::failure(const std::string& what, std::string rule, std::string advice) const {
  return {.file = file_, .place = what, .value = {}, .rule = std::move(rule), .advice = std::move(advice)};
}

Error HostProcess::end_silent(const std::string& where, double waited_s) {
  const std::string memory = exhausted_memory();  // of the process while there is one
  kill_and_reap();
  std::string seen = "the FMU ", cause = "its binary hangs: ";
  if (!memory.empty()) {
    seen.append("ran out of memory: it ").append(memory).append(", ");
    cause = "its binary takes memory without end: ";
  }
  seen.append("did not answer within ").append(std::to_string(std::lround(waited_s))).append(" s and was ended");
  return failure(where, std::move(seen), cause + "try it in the tool that made it" + said() + printed());
}

Error HostProcess::end_unwanted(const std::string& where, double waited_s) {
  kill_and_reap();
  return failure(where,
                 "the time limit was over, and the FMU had not answered for " + text::significant(waited_s, 2) +
                     " s: it was ended",
                 "give more time, or try it in the tool that made it" + said() + printed());
}

Error HostProcess::ended(const std::string& what, int status) const {
  constexpr double kMuch = 0.75;  // addresses count to the limit that never were memory
  const auto most = static_cast<double>(limits_.memory_bytes);
  const std::string memory = peak_bytes_ > kMuch * most ? "; it " + share_of_memory(peak_bytes_, most) : "";
  if (WIFSIGNALED(status))
    return failure(what, std::string("the FMU's binary crashed: ") + strsignal(WTERMSIG(status)) + memory,
                   "try it in the tool that made it" + said() + printed());
  return failure(what, "the FMU's binary ended its process with status " + std::to_string(WEXITSTATUS(status)) + memory,
                 "try it in the tool that made it" + said() + printed());
}

namespace {

/// A stranger's text as one line of an error.
std::string in_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return visible(text, false);
}

}  // namespace

/// What the binary last told its logger, for where it cannot answer with it any more.
std::string HostProcess::said() const {
  constexpr std::size_t kMost = 400;
  std::array<char, kSaidBytes> text{};
  std::copy_n(header_->said, kSaidBytes - 1, text.begin());
  const std::string all(text.data());
  const std::string last = in_one_line(all.substr(all.size() - std::min(all.size(), kMost)));
  return last.empty() ? "" : "; it said: " + last;
}

/// The end of what the binary printed.
std::string HostProcess::printed() const {
  if (output_ < 0) return "";
  std::array<char, 400> text{};
  const off_t size = lseek(output_, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t got = size > 0 ? pread(output_, text.data(), text.size(), from) : 0;
  const std::string last = in_one_line({text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got))});
  return last.empty() ? "" : "; it printed: " + last;
}

}  // namespace sealwatch::fmi
