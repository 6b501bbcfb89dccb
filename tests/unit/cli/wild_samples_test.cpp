// Property: whatever doubles a sender puts into time and channels, the whole chain ends, says by name what it left out,
// and a good test beside it is concluded as if it were alone.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "services/cli/layers.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "tests/unit/signal/synthetic_pst.hpp"

namespace sealwatch {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kWild[] = {std::numeric_limits<double>::max(),
                            -std::numeric_limits<double>::max(),
                            1e308,
                            1e155,  // its square is infinite
                            -1e100,
                            1e30,
                            kInfinity,
                            -kInfinity,
                            std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::denorm_min(),
                            -1e-310,
                            std::numeric_limits<double>::min(),
                            0.0};

const Configuration& configuration() {
  static const Configuration loaded = [] {
    auto read = load_configuration(std::string(SEALWATCH_SOURCE_DIR) + "/config");
    if (!read) throw std::runtime_error(read.error().front().describe());
    return *read;
  }();
  return loaded;
}

Recording good_test() {
  Recording test;
  test.recording_id = "good";
  test.asset_id = "XT03-MV2";
  test.start_time = parse_utc("2012-04-12T03:00:00Z").value();
  test.content_hash = "0123456789abcdef";
  test.samples = test::SyntheticPst{.rate_Hz = 50.0, .seed = 7}.record();
  return test;
}

/// Wild numbers in one column or in all, at single rows, along a stretch, or throughout; the asset is another one of
/// the same kind, so that what follows from the good test depends on nothing else.
Recording wild_test(unsigned seed) {
  std::mt19937 generator(seed);
  const auto below = [&generator](std::size_t count) { return generator() % count; };
  Recording test = good_test();
  test.recording_id = "wild " + std::to_string(seed);
  test.content_hash = std::to_string(seed) + "deadbeefdeadbeef";
  test.start_time = add_months(*test.start_time, -1.0);
  std::vector<std::vector<double>*> columns = {&test.samples.time_s};
  for (Series& channel : test.samples.channels) columns.push_back(&channel.values);
  const std::size_t chosen = seed % (columns.size() + 1);
  const std::size_t length = std::vector<std::size_t>{1, 3, 200, 1551}[below(4)];
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (chosen < columns.size() && c != chosen) continue;
    const std::size_t begin = below(1551);
    const double one = kWild[below(std::size(kWild))];
    for (std::size_t row = begin; row < std::min<std::size_t>(1551, begin + length); ++row)
      (*columns[c])[row] = length == 3 ? kWild[below(std::size(kWild))] : one;
  }
  if (below(4) == 0) test.samples.channels[below(test.samples.channels.size())].noise_std = kWild[below(7)];
  return test;
}

struct Concluded {
  std::vector<TestFeatures> features;
  std::set<std::string> advised;  ///< PST ids
};

Concluded conclude(const std::vector<Recording>& tests) {
  Concluded all;
  auto layers = cli::LayerSet::make(configuration()).value();
  InProcessPipeline pipeline(layers.makers(), [&all](const Message& message) {
    if (const auto* features = std::get_if<TestFeatures>(&message)) all.features.push_back(*features);
    if (std::holds_alternative<Advisory>(message)) all.advised.insert(header_of(message).pst_id);
  });
  for (const Recording& test : tests)
    for (const RawSamples& block : blocks_of(test)) pipeline.push(block);
  return all;
}

bool says_why(const TestFeatures& features) {
  const auto remarked = [](const ChannelStatus& channel) { return channel.state != ChannelState::OK; };
  return !features.abort_reason.empty() || std::ranges::any_of(features.channel_status, remarked);
}

TEST(WildSamples, TheWholeChainEndsAndTheGoodTestIsConcluded) {
  const Concluded alone = conclude({good_test()});
  ASSERT_EQ(alone.features.size(), 1U);
  ASSERT_TRUE(alone.features[0].complete) << alone.features[0].abort_reason;
  constexpr unsigned kTests = 40;
  for (unsigned seed = 1; seed <= kTests; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Concluded both = conclude({wild_test(seed), good_test()});
    ASSERT_EQ(both.features.size(), 2U);
    EXPECT_TRUE(says_why(both.features[0]));
    for (const Quantity& feature : both.features[0].features) EXPECT_TRUE(std::isfinite(feature.value)) << feature.name;
    EXPECT_EQ(both.features[1], alone.features[0]);
    for (const TestFeatures& one : both.features) EXPECT_TRUE(both.advised.contains(one.header.pst_id));
  }
}

}  // namespace
}  // namespace sealwatch
