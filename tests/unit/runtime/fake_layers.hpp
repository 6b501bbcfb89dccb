// Two small layers that keep the contract of port/layer.hpp and whose outputs depend on everything they were given, in
// order: a message lost, doubled or out of order shows in what they conclude.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "sealwatch/core/text.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch::testing {

inline Header header(const std::string& message_id, const std::string& pst_id) {
  Header made;
  made.message_id = message_id;
  made.pst_id = pst_id;
  made.producer = "test";
  return made;
}

/// raw_samples -> at each test's last block: test_features and state_report. Keeps the blocks of the running test.
class CuttingLayer : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "data_acquisition"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& own) override {
    if (const auto* features = std::get_if<TestFeatures>(&own)) chain_[features->asset_id] = features->recording_id;
  }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    const auto& block = std::get<RawSamples>(input);
    if (!block.header.writer_id.empty() || block.header.publishing_time_ns != 0) throw std::logic_error("saw a stamp");
    std::vector<RawSamples>& blocks = running_[block.asset_id];
    blocks.push_back(block);
    if (block.boundary != BlockBoundary::end) return {};
    Conclusion conclusion;
    std::string content = chain_[block.asset_id];
    for (const RawSamples& one : blocks) {
      content += one.header.message_id + ";";
      conclusion.consumed.push_back(one.header.message_id);
    }
    blocks.clear();
    TestFeatures features;
    features.asset_id = block.asset_id;
    features.header = header("test_features/" + block.recording_id, block.recording_id);
    features.recording_id = chain_[block.asset_id] = content_hash(content);
    StateReport report;
    report.asset_id = block.asset_id;
    report.header = header("state_report/" + block.recording_id, block.recording_id);
    features.header.replay = report.header.replay = block.header.replay;
    features.header.event_time_known = report.header.event_time_known = block.header.event_time_known;
    features.header.event_time_ns = report.header.event_time_ns = block.header.event_time_ns;
    conclusion.outputs = {features, report};
    return conclusion;
  }

 private:
  static constexpr std::array kInputs = {Topic::raw_samples};
  static constexpr std::array kOutputs = {Topic::test_features, Topic::state_report};
  std::map<std::string, std::vector<RawSamples>> running_;
  std::map<std::string, std::string> chain_;  ///< hash over all blocks so far
};

/// raw_samples -> test_features, concluded later from the blocks of one test.
class PatientLayer : public Layer {
 public:
  explicit PatientLayer(std::chrono::milliseconds takes = {}) : takes_(takes) {}
  [[nodiscard]] std::string_view name() const override { return "data_acquisition"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& own) override { concluded_.insert(header_of(own).pst_id); }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    const auto& block = std::get<RawSamples>(input);
    if (concluded_.contains(block.recording_id)) return {{}, {block.header.message_id}};
    std::vector<RawSamples>& blocks = running_[block.recording_id];
    blocks.push_back(block);
    if (block.boundary != BlockBoundary::end) return {};
    concluded_.insert(block.recording_id);
    return {{}, {}, [blocks = running_.extract(block.recording_id).mapped(), takes = takes_](const std::stop_token&) {
              std::this_thread::sleep_for(takes);
              Conclusion conclusion;
              TestFeatures features;
              features.asset_id = blocks.back().asset_id;
              features.header = header("test_features/" + blocks.back().recording_id, blocks.back().recording_id);
              for (const RawSamples& one : blocks) conclusion.consumed.push_back(one.header.message_id);
              for (const std::string& id : conclusion.consumed) features.recording_id += id + ";";
              conclusion.outputs = {features};
              return conclusion;
            }};
  }

 private:
  static constexpr std::array kInputs = {Topic::raw_samples};
  static constexpr std::array kOutputs = {Topic::test_features};
  std::chrono::milliseconds takes_;
  std::map<std::string, std::vector<RawSamples>> running_;
  std::set<std::string> concluded_;
};

/// test_features + state_report -> health_report when both of a test are there, with the number of the test.
class JoiningLayer : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "health_assessment"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& own) override { ++tests_[asset_of(own)]; }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    if (const auto* features = std::get_if<TestFeatures>(&input))
      features_[features->header.pst_id] = *features;
    else
      reports_[header_of(input).pst_id] = std::get<StateReport>(input);
    const std::string pst = header_of(input).pst_id;
    if (!features_.contains(pst) || !reports_.contains(pst)) return {};
    const TestFeatures features = features_.extract(pst).mapped();
    const StateReport state = reports_.extract(pst).mapped();
    HealthReport report;
    report.asset_id = features.asset_id;
    report.header = header("health_report/" + pst, pst);
    report.inadmissible_reasons = {features.recording_id, "test " + std::to_string(++tests_[features.asset_id])};
    return {{report}, {features.header.message_id, state.header.message_id}};
  }
  [[nodiscard]] Conclusion tick(UtcTime now) override {
    if (ticks) ticks->push_back(now);
    return {};
  }
  std::vector<UtcTime>* ticks = nullptr;

 private:
  static constexpr std::array kInputs = {Topic::test_features, Topic::state_report};
  static constexpr std::array kOutputs = {Topic::health_report};
  std::map<std::string, TestFeatures> features_;
  std::map<std::string, StateReport> reports_;
  std::map<std::string, int> tests_;
};

/// The blocks of `tests` tests of each asset, two blocks a test, assets in turn.
inline std::vector<RawSamples> blocks_of_tests(int tests, const std::vector<std::string>& assets) {
  std::vector<RawSamples> blocks;
  for (int test = 0; test < tests; ++test) {
    for (std::uint64_t number = 0; number < 2; ++number) {
      for (const std::string& asset : assets) {
        RawSamples block;
        block.asset_id = asset;
        block.recording_id = asset + " test " + std::to_string(test);
        block.block_number = number;
        block.boundary = number == 0 ? BlockBoundary::begin : BlockBoundary::end;
        block.header.message_id = "raw_samples/" + block.recording_id + "/" + std::to_string(number);
        blocks.push_back(block);
      }
    }
  }
  return blocks;
}

}  // namespace sealwatch::testing
