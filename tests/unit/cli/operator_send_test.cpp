// Who has to have received what people report before the command says so.
#include "services/cli/operator_send.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "services/cli/layers.hpp"

namespace sealwatch::cli {
namespace {

TEST(OperatorSend, KnowsEveryLayerThatReadsReports) {
  const Configuration configuration;
  const LayerSet layers = LayerSet::make(configuration).value();
  std::vector<std::string> readers;
  for (const auto& [layer, topics] : layers.inputs_by_layer())
    if (std::ranges::find(topics, "maintenance_event") != topics.end()) readers.push_back(layer);
  EXPECT_THAT(kReadersOfMaintenance, ::testing::UnorderedElementsAreArray(readers));
}

}  // namespace
}  // namespace sealwatch::cli
