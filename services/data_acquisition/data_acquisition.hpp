// Layer 1 (ISO 13374 DA): raw samples become time-stamped sample blocks of one test each, with PST boundaries, a PST id
// and the status of every channel.
//
// One raw block gives one sample block at once. A test begins with a block that says so, or with block 0, or with a
// block of a test that is not open. It ends with a block that says so; when its sender begins a later test of the same
// actuator first, or when nothing comes for time_out_s, it is closed as cut by an empty end block with aborted
// set, and so is one that would be more than one test may be (core/test_limits.hpp). Others cut it not: blocks of
// another source, tests of the past and recordings are tests of their own beside it. A recording that is played back or
// was dropped into the folder comes whole: it is not cut by time either, and goes on when it is given again. What was
// seen before changes nothing: blocks whose number came already and tests that are closed are passed over. Blocks out of
// order go on as they come, under their numbers; data manipulation sorts them.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/data_acquisition/open_test.hpp"

namespace sealwatch {

class DataAcquisition final : public Layer {
 public:
  explicit DataAcquisition(std::vector<AssetConfig> assets, DataAcquisitionOptions options = {});

  [[nodiscard]] std::string_view name() const override { return "data_acquisition"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  /// The block that ends it.
  [[nodiscard]] bool tells_all(const Message& last_of_test) const override;
  [[nodiscard]] Conclusion receive(const Message& input) override;
  [[nodiscard]] Conclusion tick(UtcTime now) override;
  /// Whether the test that begins with this block is closed.
  [[nodiscard]] bool is_closed(const RawSamples& first_block) const;
  /// Of each open test of this source, the block that would close it.
  [[nodiscard]] std::vector<SampleBlock> closing_blocks(const std::string& source_id, const std::string& reason) const;

 private:
  struct Running {
    std::string pst_id;
    OpenTest test;
    std::string asset_id = {};
    std::string source_id = {};
    std::optional<UtcTime> start = {};
    bool comes_whole = false;
    double silent_s = 0.0;  ///< ticked since the last block; decides when, never what
  };
  using Tests = std::map<std::string, Running>;  // by identity: what all blocks of one test share
  void take_raw(const RawSamples& raw, Conclusion& conclusion);
  Running* running_test(const RawSamples& raw, Conclusion& conclusion);
  template <class Block>
  Running& begin(const Block& block, const std::string& pst_id);
  void cut_earlier_tests(const RawSamples& raw, Conclusion& conclusion);
  [[nodiscard]] OpenTest open(const std::string& asset_id) const;
  [[nodiscard]] SampleBlock stamp(const RawSamples& raw, const std::string& pst_id) const;
  void refuse(const RawSamples& raw, const std::string& reason, Conclusion& conclusion);
  void close(const std::string& identity, const std::string& reason, Conclusion& conclusion);
  void finish(const std::string& identity);

  std::vector<AssetConfig> assets_;
  DataAcquisitionOptions options_;
  std::optional<UtcTime> last_tick_;
  Tests running_;
  std::set<std::string> finished_;             ///< PST ids
  std::set<std::string> finished_identities_;  ///< what blocks without a content hash are known by
};

}  // namespace sealwatch
