// Which messages a service failed on and which it is working on, in memory that outlives the process: a file mapped into
// it. A process that is killed, aborts or hangs takes nothing along, so that the next one knows what it worked on. Costs
// no system call. After a power cut it may be gone: nothing but a try that is not counted is lost.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <mutex>
#include <string>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// How often work on a message failed, and how often the process died while it went on, for whatever reason.
struct Tries {
  std::uint16_t failures = 0;
  std::uint16_t deaths = 0;
};

class TryRecord {
 public:
  /// For one process alone.
  TryRecord() = default;
  /// A process that worked on a message and did not end in order has died on it. `path` is made where it is missing.
  [[nodiscard]] Status keep_in(const std::string& path);
  /// In order: what is being worked on has not failed.
  ~TryRecord();
  TryRecord(const TryRecord&) = delete;
  TryRecord& operator=(const TryRecord&) = delete;

  [[nodiscard]] Tries tries(const std::string& message_id);
  void begin(const std::string& message_id);
  /// It ended well: nothing of it is remembered.
  void end(const std::string& message_id);
  void fail(const std::string& message_id);
  /// It was given up before it ended, for a reason that is none of its own.
  void leave(const std::string& message_id);
  /// Nothing that is being worked on is counted any more, whatever way the process ends.
  void stop_in_order();

 private:
  /// The file of a former version has 32 bits of failures, then 32 that say whether it is at work. After a return to it
  /// deaths make it take the message for one at work, as which it counts one failure: it is tried, and not set aside.
  struct Entry {
    std::uint64_t message;  ///< hash of its id; 0: free
    std::uint16_t failures;
    std::uint16_t zero;
    std::uint16_t at_work;
    std::uint16_t deaths;
  };
  static_assert(sizeof(Entry) == 16 && std::endian::native == std::endian::little, "as the former version has it");
  static constexpr std::size_t kEntries = 1024;
  using Entries = std::array<Entry, kEntries>;

  [[nodiscard]] static bool is_unsuspected(const Entry& entry) { return entry.failures == 0 && entry.deaths == 0; }
  Entry* find(const std::string& message_id);
  Entry& find_or_make(const std::string& message_id);

  std::mutex mutex_;
  Entries own_{};
  Entries* entries_ = &own_;
  std::size_t next_ = 0;  ///< where the next free entry is looked for
};

}  // namespace sealwatch
