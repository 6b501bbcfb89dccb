// One test while its blocks come in: which blocks were seen, what was noticed on the time axis and on each channel.
//
// Everything here is rebuilt by absorbing the sample blocks that were made of the test, in the same order: that is how
// the layer comes back after a restart.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/message/data_acquisition.hpp"
#include "services/data_acquisition/channel_watch.hpp"

namespace sealwatch {

class OpenTest {
 public:
  /// `asset` and `plant` are null for an asset that is not configured; all must outlive the test.
  OpenTest(std::string asset_id, const AssetConfig* asset, const PlantDescription* plant,
           const DataAcquisitionOptions& options);

  /// Cleans the samples of a raw block: SI units, only the plant's channels, rows whose time increases. Fills the
  /// block's samples, counts and status, and absorbs it.
  void complete(const RawSamples& raw, SampleBlock& block);
  /// What forbids to take this block: with it the test would be more than one test may be (core/test_limits.hpp).
  [[nodiscard]] std::optional<std::string> beyond_limits(const RawSamples& raw) const;
  /// Takes in a block that was made before.
  void absorb(const SampleBlock& block);
  [[nodiscard]] bool begun() const { return last_.has_value(); }
  [[nodiscard]] bool seen(std::uint64_t block_number) const { return seen_.contains(block_number); }
  /// The block that closes a test whose end never came.
  [[nodiscard]] SampleBlock closing_block(const std::string& reason) const;

 private:
  [[nodiscard]] bool is_time(double time_s) const;
  [[nodiscard]] TimeSeries clean(const RawSamples& raw);
  [[nodiscard]] std::vector<std::size_t> increasing_rows(const RawSamples& raw);
  [[nodiscard]] std::optional<Series> accept(const Series& channel, const std::vector<std::size_t>& rows);
  void count_gap(double interval_s);
  void take_rows(const SampleBlock& block);
  void count_rows(const SampleBlock& block, bool in_order);
  [[nodiscard]] std::vector<ChannelStatus> status() const;
  [[nodiscard]] bool latest(std::uint64_t block_number) const {
    return seen_.empty() || block_number > *seen_.rbegin();
  }

  std::string asset_id_;
  const PlantDescription* plant_;
  const DataAcquisitionOptions* options_;
  std::set<std::uint64_t> seen_;
  std::optional<SampleBlock> last_;  ///< without samples: what a closing block repeats
  std::vector<std::pair<std::string, ChannelWatch>> watches_;
  std::map<std::string, std::string> left_out_;  ///< channel and why
  std::optional<double> first_time_s_;
  std::optional<double> last_time_s_;
  std::vector<double> first_intervals_s_;  ///< until the usual interval is known
  double usual_interval_s_ = 0.0;
  std::uint64_t rows_ = 0;
  double numbers_ = 0.0;  ///< rows times channels so far, times among them
  std::uint64_t missing_rows_ = 0;
  std::uint64_t clock_steps_back_ = 0;
  Travel travel_;
};

}  // namespace sealwatch
