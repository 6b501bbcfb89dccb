// A process of sealwatch-fmu-host, in which the binary of an FMU runs, with limits on memory and on the time of a call. A
// crash, a hang, an instance that is refused (a licence that is missing), a function that answers an error: each is an
// Error with the FMU's file, what it was asked, and the binary's own last words.
//
// One request takes one way there and back over shared memory (host_protocol.hpp).
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "sealwatch/core/deadline.hpp"
#include "sealwatch/core/result.hpp"
#include "services/common/fmi/host_protocol.hpp"

namespace sealwatch::fmi {

struct ProcessLimits {
  std::uint64_t memory_bytes = 4ULL << 30U;
  double start_s = 120.0;  ///< for loading and for the start of a run: some tools' binaries ask a licence server
  double call_s = 30.0;    ///< for every other call of the binary
  double told_s = 5.0;     ///< after which a start that is still waited for is told
};

/// The work of the process, where this is that process: then a request is a call.
class LocalHost {
 public:
  virtual ~LocalHost() = default;
  /// What failed, with the binary's last words; nothing where all is well.
  [[nodiscard]] virtual std::optional<std::string> serve(Operation operation, double time_s,
                                                         std::span<std::byte> heap) = 0;
};
using MakeLocalHost = std::function<std::unique_ptr<LocalHost>(const Setup& setup)>;
/// Set by sealwatch-fmu-host alone, before it does anything else.
[[nodiscard]] MakeLocalHost& local_hosts();

/// Takes what is to be told of a start that is waited for, once each; set by programs with somebody before the screen.
[[nodiscard]] std::function<void(const std::string&)>& slow_starts();

class HostProcess {
 public:
  HostProcess(const HostProcess&) = delete;
  HostProcess& operator=(const HostProcess&) = delete;
  /// Not in a copy of the process that started it: two who ask at once would get each other's answers.
  [[nodiscard]] bool alive() const;
  /// How it ended in the middle of a request: by itself, or because it did not answer within its limit.
  struct Loss {
    bool hung = false;
    Error error;
  };
  [[nodiscard]] const std::optional<Loss>& loss() const { return loss_; }
  /// Until this is called again a request is not waited for longer than some seconds beyond the deadline; null: it has its
  /// own limit alone.
  void keep(const Deadline* deadline) { deadline_ = deadline; }
  /// For a start that is only tried.
  void limit_start(double seconds) { limits_.start_s = seconds; }

 protected:
  static constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
  HostProcess(std::string file, std::size_t heap_bytes, const ProcessLimits& limits);
  ~HostProcess();
  [[nodiscard]] Status launch();
  /// Ends it, with what it has open; launch() may follow.
  void end();
  /// `what` it is asked, at `time_s` unless that is NaN. `seconds`: how long a call of the binary may take within it.
  /// `look` is called now and then.
  [[nodiscard]] Status request(Operation operation, const char* what, double seconds, double time_s = kNoTime,
                               const std::function<void()>& look = {});
  [[nodiscard]] const ProcessLimits& limits() const { return limits_; }
  [[nodiscard]] std::span<std::byte> heap() const;
  [[nodiscard]] Packer packer() const { return Packer(heap()); }
  [[nodiscard]] Unpacker unpacker() const { return Unpacker(heap()); }
  [[nodiscard]] SharedHeader& header() const { return *header_; }
  /// From now on requests are calls.
  void serve_here(const Setup& setup);
  [[nodiscard]] const std::string& file() const { return file_; }
  std::string needed_tool_;  ///< that must be on this machine; "": none

 private:
  [[nodiscard]] Status request_here(Operation operation, const char* what, double time_s);
  [[nodiscard]] std::string advice_of(Operation operation) const;
  [[nodiscard]] Error failure(const std::string& what, std::string rule, std::string advice) const;
  [[nodiscard]] Error ended(const std::string& what, int status) const;
  /// Ends a process that has not answered for so long.
  [[nodiscard]] Error end_silent(const std::string& where, double waited_s);
  /// Ends a process that nobody waits for any more.
  [[nodiscard]] Error end_unwanted(const std::string& where, double waited_s);
  /// Where a run is, from what the process has written down before it called the binary.
  [[nodiscard]] std::string place(const char* what, double time_s) const;
  [[nodiscard]] std::string printed() const;
  [[nodiscard]] std::string said() const;
  [[nodiscard]] bool has_ended() const;
  /// How much memory it has taken, where that is nearly all that it may have; "" elsewhere.
  [[nodiscard]] std::string exhausted_memory() const;
  /// Its status, which it may have ended with by itself; with it end the processes that the binary has started.
  int kill_and_reap();

  std::string file_;
  ProcessLimits limits_;
  std::size_t memory_bytes_ = 0;
  SharedHeader* header_ = nullptr;
  pid_t owner_ = -1;
  pid_t child_ = -1;
  int life_ = -1, output_ = -1;
  bool alive_ = false;
  const Deadline* deadline_ = nullptr;
  double peak_bytes_ = 0.0;  ///< of memory, of the one that was reaped last
  std::optional<Loss> loss_;
  std::unique_ptr<LocalHost> local_;
  std::vector<std::byte> local_heap_;
};

}  // namespace sealwatch::fmi
