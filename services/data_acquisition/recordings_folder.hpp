// The folder where recordings are dropped (ServiceConfig::recordings_directory).
//
// A file is read when it and its sidecar have not changed for ten looks, one a second: a copy in progress is left
// alone, and one that changes while it is read is read again. When its test is concluded it moves to done/, when it
// cannot be read to rejected/ with the reason beside it as NAME.error.txt (NAME.2 where that name is taken: nothing is
// overwritten); its sidecar, which must be there when the recording is read, moves along. Where it cannot be moved,
// that is told once and tried again with each look. Until then it stays, and a change of file or sidecar or a restart
// reads it again: nothing is lost, and what comes twice is taken once, by its message id.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/data_acquisition/folder_alarms.hpp"
#include "services/data_acquisition/old_recordings.hpp"

namespace sealwatch {

class RecordingsFolder {
 public:
  /// Whether the test that begins with this block is concluded, and that conclusion stored.
  using IsConcluded = std::function<bool(const RawSamples&)>;
  using Report = std::function<void(const Error&)>;
  RecordingsFolder(std::filesystem::path directory, std::vector<AssetConfig> assets, IsConcluded is_concluded,
                   Report report, int looks_until_settled = 10, const RetentionConfig& kept = {});

  /// One look, about once a second: puts away what is done, and notes what may be read.
  void look();
  /// Reads one recording of those that the last look found: its blocks, or none where it was rejected or has changed
  /// since. Nothing where all are read.
  [[nodiscard]] std::optional<std::vector<RawSamples>> read_next();
  /// Whether the last look found none that is still to be read.
  [[nodiscard]] bool all_taken() const;
  /// The first blocks of the recordings that were read and are still there.
  [[nodiscard]] std::vector<RawSamples> awaiting() const;
  /// What is not taken: a rejected recording, one that cannot be moved away, all while the folder cannot be read.
  [[nodiscard]] std::vector<ServiceAlarm> alarms() const;

 private:
  /// What changes when a recording or its sidecar does; its number, where another of the same size and time takes its
  /// name.
  struct Stamp {
    std::uintmax_t size = 0;
    std::uintmax_t number = 0, sidecar_number = 0;
    std::filesystem::file_time_type changed, sidecar_changed;
    bool leads_nowhere = false;  ///< a link, which is refused in its turn
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    std::optional<Stamp> stamp;
    int unchanged_looks = 0;
    bool taken = false;
    std::optional<Error> rejected;  ///< why it was not taken
    std::string stuck;              ///< why it could not be moved away when that was last tried; empty: it was not
    std::int64_t stuck_ns = 0;
    RawSamples first_block;  ///< without samples it would not be known again: content_hash is always set
  };
  [[nodiscard]] std::vector<std::filesystem::path> recordings();
  void put_away_finished();
  /// Concluded and stored, or rejected.
  [[nodiscard]] bool is_finished(const File& file) const;
  [[nodiscard]] bool is_settled(const std::filesystem::path& path);
  [[nodiscard]] static std::optional<Stamp> stamp_of(const std::filesystem::path& path);
  [[nodiscard]] std::vector<RawSamples> take(const std::filesystem::path& path);
  [[nodiscard]] Result<std::vector<RawSamples>> blocks(const std::filesystem::path& path) const;
  [[nodiscard]] Result<Recording> read(const std::filesystem::path& path) const;
  /// Whether it is gone; what hinders it is reported once.
  bool move_away(const std::filesystem::path& path, File& file);
  void reject(const std::filesystem::path& path, const Error& error);

  std::filesystem::path directory_;
  std::vector<AssetConfig> assets_;
  IsConcluded is_concluded_;
  Report report_;
  int looks_until_settled_;
  std::map<std::filesystem::path, File> files_;
  std::deque<std::filesystem::path> to_read_;
  bool is_readable_ = true;         ///< at the last look
  std::int64_t unreadable_ns_ = 0;  ///< since when not
  std::string unreadable_;          ///< why not
  RejectedRecordings rejected_;
  OldRecordings old_;
};

}  // namespace sealwatch
