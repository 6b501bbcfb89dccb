// A retraction has a topic of its own, so that DDS Security can grant the right to it by itself; where there are rights, it
// is taken from no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <thread>

#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/common/transport/channel.hpp"
#include "services/common/transport/participant.hpp"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using transport::Channel;
using transport::DdsSample;
using transport::Rights;

constexpr auto kEvents = static_cast<std::size_t>(Topic::maintenance_event);
constexpr std::size_t kRetractions = transport::kRetractionIndex;

MaintenanceEvent event(std::string_view kind, const std::string& id) {
  MaintenanceEvent made;
  made.asset_id = "A";
  made.kind = kind;
  made.header.message_id = id;
  return made;
}

/// Ids of what a service takes when all kinds of events are written to both topics.
std::vector<std::string> taken(const Configuration& configuration, Rights rights) {
  transport::Inbox inbox;  // outlives the participants, as the channels do
  std::deque<Channel> readers;
  std::deque<Channel> writers;
  const auto reading = transport::Participant::join(configuration);
  const auto writing = transport::Participant::join(configuration);
  const auto add = [](std::deque<Channel>& channels, const transport::Participant& participant, std::size_t index,
                      Rights of_reader) {
    const transport::TopicType& type = transport::topic_types()[index];
    channels.emplace_back(participant.handle(), type, type.qos, SlowReader::asks_again, of_reader);
  };
  for (const std::size_t index : {kEvents, kRetractions}) {
    add(readers, *reading, index, rights);
    EXPECT_TRUE(readers.back().subscribe(inbox));
    add(writers, *writing, index, Rights::none);
  }
  int number = 0;
  const auto id_of = [&number](std::string_view kind) {
    const std::string id = std::to_string(++number);
    return kind == kActConfirmed ? confirmation_id("A", "retraction/A/test/T/" + id, UtcTime{}) : id;
  };
  for (const std::string_view kind : {std::string_view("seal_replaced"), kTestRetracted, kActConfirmed}) {
    for (Channel& writer : writers) {
      while (writer.subscribers().value_or(0) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      EXPECT_TRUE(writer.write(DdsSample(Message(event(kind, id_of(kind))))));
    }
  }
  // What is to be taken, and then what is always taken: the topics' last words.
  EXPECT_TRUE(writers[0].write(DdsSample(Message(event("seal_replaced", "last 0")))));
  EXPECT_TRUE(writers[1].write(DdsSample(Message(event(kTestRetracted, "last 1")))));
  std::vector<std::string> ids;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  for (int last = 0; last < 2 && std::chrono::steady_clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(inbox.mutex);
    for (const BusItem& item : inbox.take(100, std::chrono::steady_clock::now())) {
      const std::string id = header_of(std::get<Message>(item)).message_id;
      ids.push_back(id.substr(id.rfind('/') + 1));
      last += ids.back().starts_with("last") ? 1 : 0;
    }
  }
  std::erase_if(ids, [](const std::string& id) { return id.starts_with("last"); });
  std::ranges::sort(ids);
  return ids;
}

TEST(RightToRetract, IsOfATopicOfItsOwnWhereThereAreRights) {
  const Configuration configuration = isolated_configuration(0);
  (void)refused_by_dds();
  EXPECT_THAT(taken(configuration, Rights::none), ElementsAre("1", "3", "4", "5", "6"))
      << "a replacement is no retraction";
  (void)refused_by_dds();
  EXPECT_THAT(taken(configuration, Rights::enforced), ElementsAre("1", "4", "6"));
  EXPECT_THAT(refused_by_dds().value_or(""), HasSubstr("needs another right"));
}

TEST(RightToRetract, HoldsWhereTheSettingsOfCycloneHaveSecurity) {
  const Configuration configuration;
  const char* const before = std::getenv("CYCLONEDDS_URI");
  const std::string kept = before == nullptr ? "" : before;
  const std::string file = ::testing::TempDir() + "/secured.xml";
  std::ofstream(file) << "<CycloneDDS><Domain><Security/></Domain></CycloneDDS>";
  ::setenv("CYCLONEDDS_URI", ("<CycloneDDS/>,file://" + file + ",<CycloneDDS/>").c_str(), 1);
  EXPECT_TRUE(transport::is_secured(configuration));
  ::setenv("CYCLONEDDS_URI", "<CycloneDDS/>", 1);
  EXPECT_FALSE(transport::is_secured(configuration));
  ::setenv("CYCLONEDDS_URI", ("file://" + ::testing::TempDir()).c_str(), 1);
  EXPECT_FALSE(transport::is_secured(configuration)) << "a directory cannot be read";
  const auto joined = transport::Participant::join(configuration);
  EXPECT_THAT(joined ? "joined" : joined.error().describe(), HasSubstr("is a directory"));
  ::setenv("CYCLONEDDS_URI", kept.c_str(), 1);
}

}  // namespace
}  // namespace sealwatch::test
