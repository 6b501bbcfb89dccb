// Layer 2 (ISO 13374 DM): the sample blocks of one test become its window, cut once, and its features.
//
// Blocks are kept, unconsumed, until the one that ends the test comes; then everything is concluded, later, so that the
// blocks of other assets do not wait for it, and all of them are consumed. Blocks of a test that is concluded already
// are consumed and change nothing. Of the tests whose end never comes only those are kept of which something came last,
// as many as have no more samples than two tests may have.
//
// A test is complete when its begin and its end were recorded, it was not aborted, and the recording does not stop
// short in the middle of the strokes; abort_reason says what was missing. FAILED channels are left out of the window;
// their status says why.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/data_manipulation/asset_view.hpp"
#include "services/data_manipulation/options.hpp"

namespace sealwatch {

class DataManipulation final : public Layer {
 public:
  explicit DataManipulation(std::vector<AssetConfig> assets, DataManipulationOptions options = {});

  [[nodiscard]] std::string_view name() const override { return "data_manipulation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  /// A test is concluded once, by a window and its features, in one.
  [[nodiscard]] bool tells_all(const Message& /*last_of_test*/) const override { return true; }
  [[nodiscard]] Conclusion receive(const Message& input) override;

 private:
  /// Blocks of a test whose end did not come yet.
  struct Waiting {
    std::string pst_id;
    std::size_t numbers = 0;
    std::vector<SampleBlock> blocks = {};  ///< in the order of receipt
  };
  [[nodiscard]] AssetView view(const std::string& asset_id) const;
  [[nodiscard]] static Waiting take(const std::string& pst_id, std::deque<Waiting>& of_asset);
  static void forget_some(std::deque<Waiting>& of_asset, Conclusion& conclusion);

  std::vector<AssetConfig> assets_;
  DataManipulationOptions options_;
  std::map<std::string, std::deque<Waiting>> waiting_;  ///< by asset, that which got a block last at the end
  std::set<std::string> concluded_;                     ///< PST ids
};

}  // namespace sealwatch
