// What is concluded from the blocks of one whole test: a pure function.
#pragma once

#include <vector>

#include "sealwatch/message/data_acquisition.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "services/data_manipulation/asset_view.hpp"
#include "services/data_manipulation/options.hpp"

namespace sealwatch {

struct TestConclusion {
  TestWindow window;
  TestFeatures features;
};

/// `blocks` of one test in the order of receipt, the one that ends it last; at least one.
[[nodiscard]] TestConclusion conclude_test(const std::vector<SampleBlock>& blocks, const AssetView& asset,
                                           const DataManipulationOptions& options);

}  // namespace sealwatch
