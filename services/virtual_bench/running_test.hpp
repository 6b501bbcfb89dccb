// A test while it runs: its recording leaves in blocks as time passes, and an abort cuts it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/data_acquisition.hpp"

namespace sealwatch::bench {

class RunningTest {
 public:
  /// `recording` as it will be if nobody interferes; it has a start time. `source_ids`: what asked for it.
  RunningTest(Recording recording, std::vector<std::string> source_ids, double block_s);

  [[nodiscard]] TestKind kind() const { return recording_.test; }
  [[nodiscard]] UtcTime end() const;
  [[nodiscard]] bool finished() const { return sent_ == recording_.samples.time_s.size(); }
  /// The blocks that are complete at `now` and were not taken yet.
  [[nodiscard]] std::vector<RawSamples> take_until(UtcTime now);
  /// Ends the test: the last block, with the samples up to `now` that were not taken yet (at least one).
  [[nodiscard]] RawSamples abort(UtcTime now, const std::string& reason);

 private:
  [[nodiscard]] RawSamples take(std::size_t count);
  [[nodiscard]] UtcTime time_of(std::size_t sample) const;

  Recording recording_;
  std::vector<std::string> source_ids_;
  std::size_t block_samples_ = 1;
  std::size_t sent_ = 0;  ///< samples
  std::uint64_t block_number_ = 0;
};

}  // namespace sealwatch::bench
