#include "services/data_manipulation/data_manipulation.hpp"

#include <algorithm>
#include <cassert>

#include "sealwatch/core/test_limits.hpp"
#include "services/common/text/numbers.hpp"
#include "services/data_manipulation/conclude_test.hpp"

namespace sealwatch {
namespace {

constexpr Topic kInputs[] = {Topic::sample_block};
constexpr Topic kOutputs[] = {Topic::test_window, Topic::test_features};

/// Of one asset, played-back ones that were broken off among them.
constexpr std::size_t kMostTests = 256;
/// A block counts as so many at least.
constexpr std::size_t kLeastNumbers = 16;

bool ends(const SampleBlock& block) {
  return block.boundary == BlockBoundary::end || block.boundary == BlockBoundary::whole;
}

}  // namespace

Status DataManipulationOptions::validate() const {
  const auto check = [](bool good, const char* option, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = option, .value = text::general(value), .rule = rule, .advice = {}});
  };
  if (Status s = check(longest_gap_s > 0.0, "longest_gap_s", longest_gap_s, "must be positive"); !s) return s;
  if (Status s = check(least_samples >= 16, "least_samples", static_cast<double>(least_samples), "must be 16 or more");
      !s)
    return s;
  if (Status s = check(largest_offset_s > 0.0, "largest_offset_s", largest_offset_s, "must be positive"); !s) return s;
  if (Status s = check(significance > 0.0, "significance", significance, "must be positive"); !s) return s;
  if (Status s = check(least_correlation > 0.0 && least_correlation < 1.0, "least_correlation", least_correlation,
                       "must be between 0 and 1");
      !s)
    return s;
  return check(complete_share > 0.0 && complete_share <= 1.0, "complete_share", complete_share, "must be 0 to 1");
}

DataManipulation::DataManipulation(std::vector<AssetConfig> assets, DataManipulationOptions options)
    : assets_(std::move(assets)), options_(options) {
  assert(options_.validate());
}

std::span<const Topic> DataManipulation::inputs() const { return kInputs; }
std::span<const Topic> DataManipulation::outputs() const { return kOutputs; }

void DataManipulation::restore(const Message& own_output) { concluded_.insert(header_of(own_output).pst_id); }

Conclusion DataManipulation::receive(const Message& input) {
  const auto* block = std::get_if<SampleBlock>(&input);
  const std::string& pst_id = header_of(input).pst_id;
  Conclusion conclusion;
  if (!block || concluded_.contains(pst_id)) {
    conclusion.consumed.push_back(header_of(input).message_id);
    return conclusion;
  }
  std::deque<Waiting>& of_asset = waiting_[block->asset_id];
  Waiting test = take(pst_id, of_asset);
  test.numbers += std::max(block->samples.time_s.size() * (1 + block->samples.channels.size()), kLeastNumbers);
  test.blocks.push_back(*block);
  if (!ends(*block)) {
    of_asset.push_back(std::move(test));
    forget_some(of_asset, conclusion);
    return conclusion;
  }
  conclusion.later = [blocks = std::move(test.blocks), asset = view(block->asset_id),
                      options = options_](const std::stop_token& /*bounded by the test's rows*/) {
    Conclusion of_test;
    for (const SampleBlock& one : blocks) of_test.consumed.push_back(one.header.message_id);
    TestConclusion concluded = conclude_test(blocks, asset, options);
    of_test.outputs.emplace_back(std::move(concluded.window));
    of_test.outputs.emplace_back(std::move(concluded.features));
    return of_test;
  };
  concluded_.insert(pst_id);
  return conclusion;
}

DataManipulation::Waiting DataManipulation::take(const std::string& pst_id, std::deque<Waiting>& of_asset) {
  const auto found = std::ranges::find(of_asset, pst_id, &Waiting::pst_id);
  if (found == of_asset.end()) return {.pst_id = pst_id};
  Waiting test = std::move(*found);
  of_asset.erase(found);
  return test;
}

void DataManipulation::forget_some(std::deque<Waiting>& of_asset, Conclusion& conclusion) {
  std::size_t numbers = 0;
  for (const Waiting& test : of_asset) numbers += test.numbers;
  while (numbers > 2 * kTestLimits.most_numbers || of_asset.size() > kMostTests) {
    const Waiting& oldest = of_asset.front();
    for (const SampleBlock& block : oldest.blocks) conclusion.consumed.push_back(block.header.message_id);
    conclusion.refused.push_back({oldest.blocks.back(), "the end of its test did not come, and others began"});
    numbers -= oldest.numbers;
    of_asset.pop_front();
  }
}

AssetView DataManipulation::view(const std::string& asset_id) const {
  for (const AssetConfig& asset : assets_) {
    if (asset.asset_id != asset_id) continue;
    const Result<const PlantDescription*> plant = find_plant(asset.model);
    return {&asset, plant ? *plant : nullptr};
  }
  return {};
}

}  // namespace sealwatch
