// From an advisory down to the waveform, out of the ids that messages carry.
#include "services/cli/provenance_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

namespace sealwatch::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Messages as the services keep them: a header names also what stands behind its sources.
class ProvenanceTree : public ::testing::Test {
 protected:
  ProvenanceTree() {
    add<SampleBlock>("sample_block/T2/0", "T2", {"raw_samples/A/T2/0"});
    add<SampleBlock>("sample_block/T2/1", "T2", {"raw_samples/A/T2/1"});
    add<TestWindow>("test_window/T2", "T2", {"sample_block/T2/0", "sample_block/T2/1"}).recording_id = "the_recording";
    add<HealthReport>("health_report/T2", "T2", {"test_window/T2", "sample_block/T2/0", "sample_block/T2/1"});
    add<LeakageEstimate>("leakage_estimate/T2", "T2", {"health_report/T2", "test_window/T2"});
    add<LeakageEstimate>("leakage_estimate/T1", "T1", {"health_report/T1", "test_window/T1"});
    add<RemainingLife>("remaining_life/T2", "T2", {"leakage_estimate/T2", "leakage_estimate/T1"});
    add<Advisory>("advisory/T2", "T2",
                  {"remaining_life/T2", "leakage_estimate/T2", "health_report/T2", "test_window/T2"})
        .reasons = {"the reason"};
  }
  template <class M>
  M& add(const std::string& id, const std::string& pst_id, std::vector<std::string> sources) {
    M message;
    message.asset_id = "A";
    message.header.message_id = id;
    message.header.pst_id = pst_id;
    message.header.source_ids = std::move(sources);
    return std::get<M>(messages_[id] = message);
  }
  [[nodiscard]] SourceNode tree(const std::string& id) {
    Result<SourceNode> made = provenance_tree(id, [this](const std::string& wanted) -> Result<Looked> {
      ++looked_up_[wanted];
      const auto found = messages_.find(wanted);
      if (found == messages_.end()) return Looked{};
      return Looked{std::make_shared<const Message>(found->second), "journal"};
    });
    EXPECT_TRUE(made) << made.error().describe();
    return std::move(*made);
  }

  std::map<std::string, Message> messages_;
  std::map<std::string, int> looked_up_;
};

TEST_F(ProvenanceTree, LeadsFromTheAdvisoryToTheSamples) {
  const SourceNode root = tree("advisory/T2");
  ASSERT_EQ(root.sources.size(), 1U) << "the others stand behind the remaining life";
  const SourceNode& life = root.sources.front();
  EXPECT_EQ(life.message_id, "remaining_life/T2");
  ASSERT_EQ(life.sources.size(), 2U);
  const SourceNode& health = life.sources[0].sources.front();
  EXPECT_EQ(health.message_id, "health_report/T2");
  ASSERT_EQ(life.sources[0].sources.size(), 1U) << "the window stands behind the health report";
  const SourceNode& window = health.sources.front();
  EXPECT_EQ(window.message_id, "test_window/T2");
  ASSERT_EQ(window.sources.size(), 2U);
  EXPECT_EQ(window.sources[1].sources.front().message_id, "raw_samples/A/T2/1");
  EXPECT_EQ(window.sources[1].sources.front().message, nullptr) << "only its id is kept";
  ASSERT_NE(window_of(root), nullptr);
  EXPECT_EQ(window_of(root)->recording_id, "the_recording");
}

TEST_F(ProvenanceTree, NamesTheHistoryAndDoesNotFollowIt) {
  const SourceNode root = tree("remaining_life/T2");
  EXPECT_EQ(root.sources[1].message_id, "leakage_estimate/T1");
  EXPECT_FALSE(root.sources[1].followed);
  EXPECT_TRUE(root.sources[1].sources.empty());
  EXPECT_EQ(looked_up_.count("test_window/T1"), 0U);
  EXPECT_EQ(looked_up_["test_window/T2"], 1) << "each message is read once";
}

TEST_F(ProvenanceTree, ReadsAsText) {
  const std::string text = tree_text(tree("advisory/T2"));
  EXPECT_THAT(text, AllOf(HasSubstr("advisory/T2\n"), HasSubstr("    - the reason\n"),
                          HasSubstr("leakage_estimate/T1\n"), HasSubstr("1 message of other tests"),
                          HasSubstr("sample_block/T2/0 ... /1\n"), HasSubstr("2 blocks, 0 samples of recording"),
                          HasSubstr("raw_samples/A/T2/0 ... /1\n"), Not(HasSubstr("health_report/T1"))));
}

TEST_F(ProvenanceTree, ReadsAsJson) {
  const auto json = nlohmann::json::parse(tree_json(tree("advisory/T2")));
  EXPECT_EQ(json["schema"], "sealwatch.message/1");
  EXPECT_EQ(json["message"]["reasons"][0], "the reason");
  EXPECT_EQ(json["journal"], "journal");
  const auto& life = json["sources"][0];
  EXPECT_EQ(life["topic"], "remaining_life");
  EXPECT_FALSE(life["sources"][1].contains("sources")) << "not followed";
  EXPECT_EQ(life["sources"][0]["sources"][0]["sources"][0]["sources"][0]["sources"][0]["message_id"],
            "raw_samples/A/T2/0");
}

TEST_F(ProvenanceTree, EndsWhereMessagesNameEachOther) {
  add<HealthReport>("health_report/T3", "T3", {"state_report/T3"});
  add<StateReport>("state_report/T3", "T3", {"health_report/T3"});
  EXPECT_EQ(tree("health_report/T3").message_id, "health_report/T3");
}

}  // namespace
}  // namespace sealwatch::cli
