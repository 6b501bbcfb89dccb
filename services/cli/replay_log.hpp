// What a replay shows while it runs and at its end, and the files of results it can write.
#pragma once

#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/concluded_history.hpp"
#include "services/cli/summary.hpp"
#include "services/cli/terminal.hpp"

namespace sealwatch::cli {

class ReplayLog {
 public:
  ReplayLog(const ReplayOptions& options, std::size_t tests);
  /// The topics it wants to see.
  [[nodiscard]] static std::span<const Topic> topics();
  void take(const Message& message);
  /// A conclusion from before this replay: part of the final screen, not of the results.
  void take_earlier(const Message& message);
  /// Why there is no new advice from tests that could be read, in words; "" when each gave some.
  [[nodiscard]] std::string without_advice() const;
  /// A test that data acquisition did not take in, and why.
  void refuse(const std::string& reason);
  [[nodiscard]] bool any_refused() const { return any_refused_; }
  /// What was concluded of each asset's tests in this replay.
  [[nodiscard]] const std::map<std::string, ConcludedHistory>& histories() const { return histories_; }
  /// Something that happened besides, like a service that was started again.
  void remark(const std::string& text);
  /// The final screen: each asset's forecast, interval, reasons, and where to look further. An error when the files of
  /// results are not complete. `all_read`: no recording was refused while it was read, which has been said.
  [[nodiscard]] Status finish(bool all_read);

 private:
  void show_advisory(const Advisory& advisory, const Message& message);
  [[nodiscard]] std::string results_file(Topic topic) const;
  void write(const Message& message);
  [[nodiscard]] Status written();

  ReplayOptions options_;
  Progress progress_;
  bool any_refused_ = false;
  using Test = std::pair<std::string, std::string>;   // asset and PST id
  std::set<Test> concluded_;                          ///< those that reached the last layer
  std::map<Test, bool> taken_in_;                     ///< those judged in this replay: whether a later one was known
  std::map<std::string, std::int64_t> latest_known_;  ///< by asset: event time of the last test or replacement before
  std::map<std::string, std::string> last_advisory_;  ///< advisory id and state shown last, by asset
  std::map<std::string, AssetView> assets_;
  std::map<std::string, ConcludedHistory> histories_;
  std::map<Topic, std::unique_ptr<std::ofstream>> results_;
};

}  // namespace sealwatch::cli
