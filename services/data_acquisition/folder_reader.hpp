// The folder of recordings (recordings_folder.hpp) as inputs of data acquisition, looked at and read by a thread of its
// own: a large recording, or one that hides gigabytes, holds up no live test. One recording is in memory at a time; the
// next is read once all blocks of the last were taken. One that was taken in part before a kill, and is not in the folder
// for a minute, ends its test.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sealwatch/port/local_inputs.hpp"
#include "services/data_acquisition/recordings_folder.hpp"

namespace sealwatch {

class FolderReader final : public LocalInputs {
 public:
  /// `report` is called by the reading thread and by whoever looks.
  FolderReader(std::filesystem::path directory, std::vector<AssetConfig> assets, RecordingsFolder::Report report,
               std::chrono::milliseconds between_looks = std::chrono::seconds(1), int looks_until_settled = 10,
               const RetentionConfig& kept = {});
  ~FolderReader() override;
  FolderReader(const FolderReader&) = delete;
  FolderReader& operator=(const FolderReader&) = delete;

  void look(const LayerAtRest& woken, const LayerAtRest& awake) override;
  void on_some(std::function<void()> call) override { on_some_ = std::move(call); }
  [[nodiscard]] bool has_some() override { return has_some_; }
  [[nodiscard]] std::vector<Message> take() override;
  [[nodiscard]] std::vector<ServiceAlarm> alarms() override;
  [[nodiscard]] bool stop(std::chrono::milliseconds patience) override;

 private:
  using Test = std::pair<std::string, std::string>;  // asset and PST id: two assets may give theirs the same ids
  [[nodiscard]] static Test test_of(const RawSamples& first_block);
  void run(const std::stop_token& stop);
  void look_at_folder();
  /// Tests that began, by the blocks that would close them.
  [[nodiscard]] std::vector<SampleBlock> open_tests(const LayerAtRest& awake) const;
  void end_removed(const std::vector<SampleBlock>& open);
  [[nodiscard]] bool is_concluded(const RawSamples& first_block);
  /// Waits until all were taken; false at a stop.
  [[nodiscard]] bool hand_over(std::vector<RawSamples> blocks, const std::stop_token& stop);

  std::vector<std::string> assets_;
  RecordingsFolder::Report report_;
  std::chrono::milliseconds between_looks_;
  int looks_until_removed_;
  std::map<Test, int> missed_;  ///< tests that began: for how many looks their recordings were not there
  std::function<void()> on_some_ = [] {};
  RecordingsFolder folder_;  ///< the reading thread's alone
  std::atomic<bool> has_some_{false};
  std::mutex mutex_;  ///< of all below
  std::condition_variable_any changed_;
  std::deque<RawSamples> blocks_;     ///< of the recording that is being taken
  std::vector<RawSamples> awaiting_;  ///< first blocks of those that were taken and are still in the folder
  std::vector<ServiceAlarm> alarms_;
  bool all_taken_ = false;    ///< nothing in the folder is still to be read
  std::set<Test> concluded_;  ///< those among them that are concluded
  bool ended_ = true;         ///< the thread
  std::jthread thread_;       ///< last: it ends first
};

}  // namespace sealwatch
