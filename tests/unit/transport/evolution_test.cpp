// Older and newer versions of a topic's type understand each other: fields are only ever appended (docs/topics.md).
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "dds/dds.h"
#include "tests/unit/transport/evolution.h"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPatience{20'000};
constexpr std::array kPstRequest = {Topic::pst_request};

/// A program that was built against another version of the IDL, in domain 0 of this process.
class Foreigner {
 public:
  explicit Foreigner(const dds_topic_descriptor_t& descriptor, const char* topic = "sealwatch/pst_request") {
    participant_ = dds_create_participant(0, nullptr, nullptr);
    topic_ = dds_create_topic(participant_, &descriptor, topic, nullptr, nullptr);
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(qos_, DDS_DURABILITY_TRANSIENT_LOCAL);
  }
  ~Foreigner() {
    dds_delete(participant_);
    dds_delete_qos(qos_);
  }
  Foreigner(const Foreigner&) = delete;
  Foreigner& operator=(const Foreigner&) = delete;

  void write(const void* sample) {
    if (writer_ == 0) writer_ = dds_create_writer(participant_, topic_, qos_, nullptr);
    ASSERT_GE(dds_write(writer_, sample), 0);
  }

  /// The first sample that comes, as a loan that lives as long as the foreigner; null when none does.
  [[nodiscard]] const void* read() const {
    const dds_entity_t reader = dds_create_reader(participant_, topic_, qos_, nullptr);
    std::array<void*, 1> sample{};
    dds_sample_info_t info;
    for (auto waited = milliseconds(0); waited < kPatience; waited += milliseconds(10)) {
      if (dds_take(reader, sample.data(), &info, 1, 1) == 1) return info.valid_data ? sample[0] : nullptr;
      dds_sleepfor(DDS_MSECS(10));
    }
    return nullptr;
  }

 private:
  dds_entity_t participant_ = 0;
  dds_entity_t topic_ = 0;
  dds_entity_t writer_ = 0;
  dds_qos_t* qos_ = dds_create_qos();
};

PstRequest request() {
  PstRequest message;
  message.asset_id = "XT03-MV2";
  message.header.message_id = "pst_request/1";
  message.header.writer_id = "w";
  message.due_time_ns = 42;
  message.reason = "monthly test";
  return message;
}

class Evolution : public testing::Test {
 protected:
  [[nodiscard]] PstRequest received() {
    EXPECT_TRUE(bus_->subscribe(kPstRequest));
    const auto items = bus_->receive(kPatience);
    EXPECT_EQ(items.size(), 1U);
    return items.empty() ? PstRequest{} : std::get<PstRequest>(std::get<Message>(items.front()));
  }
  std::unique_ptr<Bus> domain_0_ = same_domain_kit()->open();  // sets the domain up for foreigners
  std::unique_ptr<Bus> bus_ = network_kit()->open();           // meets them over UDP
};

TEST_F(Evolution, AnOlderWritersMessageHasEmptyNewFields) {
  Foreigner older(evolution_older_PstRequest_desc);
  evolution_older_PstRequest sample{};
  sample.asset_id = const_cast<char*>("XT03-MV2");
  sample.header.message_id = const_cast<char*>("pst_request/1");
  sample.due_time_ns = 42;
  older.write(&sample);
  const PstRequest got = received();
  EXPECT_EQ(got.asset_id, "XT03-MV2");
  EXPECT_EQ(got.header.message_id, "pst_request/1");
  EXPECT_EQ(got.due_time_ns, 42);
  EXPECT_EQ(got.reason, "");
  EXPECT_EQ(got.header.writer_id, "");
  EXPECT_EQ(got.header.writer_started_ns, 0);
  EXPECT_EQ(got.header.clock_quality, ClockQuality::unknown);
  EXPECT_FALSE(got.header.clock_error_known);
}

TEST_F(Evolution, ANewerWritersAdditionsAreLeftOut) {
  Foreigner newer(evolution_newer_PstRequest_desc);
  evolution_newer_PstRequest sample{};
  for (char** text : {&sample.header.pst_id, &sample.header.producer, &sample.header.writer_id, &sample.header.site})
    *text = const_cast<char*>("text");
  sample.asset_id = const_cast<char*>("XT03-MV2");
  sample.header.message_id = const_cast<char*>("pst_request/1");
  sample.due_time_ns = 42;
  sample.reason = const_cast<char*>("monthly test");
  sample.header.writer_started_ns = 7;
  sample.header.clock_quality = evolution_newer_CLOCK_QUALITY_STEPPED;
  sample.urgency = evolution_newer_URGENCY_HIGH;
  newer.write(&sample);
  const PstRequest got = received();
  EXPECT_EQ(got.header.message_id, "pst_request/1");
  EXPECT_EQ(got.header.writer_id, "text");
  EXPECT_EQ(got.header.writer_started_ns, 7);
  EXPECT_EQ(got.header.clock_quality, ClockQuality::stepped);
  EXPECT_EQ(got.due_time_ns, 42);
  EXPECT_EQ(got.reason, "monthly test");
}

TEST_F(Evolution, AnOlderReaderGetsWhatItKnows) {
  ASSERT_TRUE(bus_->publish(Message(request())));
  const Foreigner older(evolution_older_PstRequest_desc);
  const auto* const got = static_cast<const evolution_older_PstRequest*>(older.read());
  ASSERT_NE(got, nullptr);
  EXPECT_STREQ(got->asset_id, "XT03-MV2");
  EXPECT_STREQ(got->header.message_id, "pst_request/1");
  EXPECT_EQ(got->due_time_ns, 42);
}

TEST_F(Evolution, ANewerReaderGetsDefaultsForWhatIsNotThere) {
  ASSERT_TRUE(bus_->publish(Message(request())));
  const Foreigner newer(evolution_newer_PstRequest_desc);
  const auto* const got = static_cast<const evolution_newer_PstRequest*>(newer.read());
  ASSERT_NE(got, nullptr);
  EXPECT_STREQ(got->reason, "monthly test");
  EXPECT_STREQ(got->header.writer_id, "w");
  EXPECT_STREQ(got->header.site, "");
  EXPECT_EQ(got->urgency, evolution_newer_URGENCY_LOW);
  EXPECT_EQ(got->limits._length, 0U);
}

// Its stream would stand still, if nobody saw that it is there.
TEST_F(Evolution, OfAMessageWithAnUnknownEnumeratorTheHeaderAloneComesAndSaysSo) {
  Foreigner newer(evolution_newer_Advisory_desc, "sealwatch/advisory");
  evolution_newer_Advisory sample{};
  for (char** text : {&sample.advisory_id, &sample.header.message_id, &sample.header.pst_id, &sample.header.producer,
                      &sample.header.writer_id, &sample.header.site})
    *text = const_cast<char*>("text");
  sample.asset_id = const_cast<char*>("unknown");
  sample.header.stream_sequence = 1;
  sample.state = evolution_newer_ADVISORY_STATE_POSTPONED;
  newer.write(&sample);
  sample.asset_id = const_cast<char*>("known");
  sample.header.stream_sequence = 2;
  sample.state = evolution_newer_ADVISORY_STATE_SUPERSEDED;
  newer.write(&sample);
  constexpr std::array kAdvisory = {Topic::advisory};
  ASSERT_TRUE(bus_->subscribe(kAdvisory));
  std::vector<Advisory> got;
  while (got.size() < 2) {
    const auto items = bus_->receive(kPatience);
    ASSERT_FALSE(items.empty());
    for (const BusItem& item : items) got.push_back(std::get<Advisory>(std::get<Message>(item)));
  }
  EXPECT_EQ(got[0].header.message_id, "unreadable/text");
  EXPECT_EQ(got[0].header.writer_id, "text");
  EXPECT_EQ(got[0].header.stream_sequence, 1U);
  EXPECT_EQ(got[0].header.pst_id, "");
  EXPECT_EQ(got[0].asset_id, "unknown");
  EXPECT_EQ(got[1].asset_id, "known");
  EXPECT_EQ(got[1].state, AdvisoryState::superseded);
}

}  // namespace
}  // namespace sealwatch::test
