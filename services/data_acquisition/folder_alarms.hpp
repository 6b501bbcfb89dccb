// What of the folder of recordings was not taken, as alarms: they stand, over restarts too, for as long as the folder
// shows it. Who has seen to a rejected recording takes it, or the reason beside it, out of rejected/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sealwatch/message/service.hpp"

namespace sealwatch {

/// What stands beside a rejected recording with the reason.
inline constexpr const char* kReasonSuffix = ".error.txt";

/// The reasons in rejected/, the oldest first.
class RejectedRecordings {
 public:
  /// Looks where something changed since the last look.
  void look(const std::filesystem::path& directory);
  /// The first few by name, the rest by their number.
  [[nodiscard]] std::vector<ServiceAlarm> alarms() const;

 private:
  struct Reason {
    std::int64_t since_ns = 0;
    std::filesystem::path file;
    std::string text;  ///< of the first few
    bool operator<(const Reason& other) const {
      return since_ns != other.since_ns ? since_ns < other.since_ns : file < other.file;
    }
  };
  std::int64_t changed_ns_ = -1;
  bool is_settled_ = false;
  std::vector<Reason> reasons_;
};

/// About a recording of that name, or about the folder itself.
[[nodiscard]] ServiceAlarm recording_alarm(const std::string& subject, const std::string& text, std::int64_t since_ns);

}  // namespace sealwatch
