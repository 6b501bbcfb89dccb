// What is kept of the recordings that were dropped and are seen to, in done/ and rejected/: none that was put there more
// than so many days ago, and no more than so many megabytes in each of the two, the oldest first. A recording goes with
// its sidecar and the reason beside it. Only plain files right in the two folders are ever removed: no link is followed,
// nothing below them is looked at. While this machine's clock cannot be trusted nothing is old.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "sealwatch/config/configuration.hpp"

namespace sealwatch {

class OldRecordings {
 public:
  using Wall = std::chrono::system_clock::time_point;
  using Steady = std::chrono::steady_clock::time_point;

  explicit OldRecordings(const RetentionConfig& kept) : kept_(kept) {}

  /// Removes what is too old or too much, once a minute at most.
  void look(const std::filesystem::path& directory, Wall now, Steady steady);

 private:
  [[nodiscard]] bool is_trusted(Wall now, Steady steady);

  RetentionConfig kept_;
  std::optional<Steady> last_look_;
  std::optional<std::chrono::nanoseconds> ahead_;  ///< of the wall clock, when it was first looked at
};

}  // namespace sealwatch
