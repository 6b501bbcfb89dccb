// Every field of every topic through the codec and through Cyclone's own serialisation, over UDP.
#include <gtest/gtest.h>

#include "tests/unit/transport/filled.hpp"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPatience{5000};

template <class T>
class RoundTrip : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(publisher_ && subscriber_);
    if constexpr (std::is_constructible_v<Message, T>) {
      const Topic topic = topic_of(Message(T{}));
      ASSERT_TRUE(subscriber_->subscribe(std::span(&topic, 1)));
    } else {
      ASSERT_TRUE(subscriber_->subscribe_service_topics());
      connect();
    }
  }

  /// A volatile topic reaches only those who are known.
  void connect() {
    bool arrived = false;
    for (int attempt = 0; !arrived && attempt < 100; ++attempt) {
      ASSERT_TRUE(publisher_->publish(T{}));
      arrived = !subscriber_->receive(milliseconds(50)).empty();
    }
    ASSERT_TRUE(arrived);
    while (!subscriber_->receive(milliseconds(100)).empty()) {
    }
  }

  [[nodiscard]] T through_dds(const T& message) {
    std::vector<BusItem> items;
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (items.empty() && std::chrono::steady_clock::now() < deadline) {
      // On a busy machine the large message before this one may not be acknowledged yet: DDS then takes no other within
      // the time that a publisher may be blocked, and the publisher is told to try again.
      Status published;
      if constexpr (std::is_constructible_v<Message, T>)
        published = publisher_->publish(Message(message));
      else
        published = publisher_->publish(message);
      if (!published) {
        EXPECT_EQ(published.error().rule, "DDS says: Timeout") << published.error().describe();
      }
      items = subscriber_->receive(published ? kPatience : milliseconds(10));
    }
    EXPECT_EQ(items.size(), 1U);
    if (items.empty()) return T{};
    if constexpr (std::is_constructible_v<Message, T>)
      return std::get<T>(std::get<Message>(items.front()));
    else
      return std::get<T>(items.front());
  }

 private:
  std::unique_ptr<Kit> kit_ = network_kit();
  std::unique_ptr<Bus> publisher_ = kit_->open();
  std::unique_ptr<Bus> subscriber_ = kit_->open();
};

using AllTypes = testing::Types<RawSamples, SampleBlock, TestWindow, TestFeatures, StateReport, HealthReport,
                                LeakageEstimate, RemainingLife, PstRequest, Advisory, Acknowledgement, MaintenanceEvent,
                                ModelDiscrepancy, ModelAcceptance, ActRecord, ServiceStatus, ResendRequest>;
TYPED_TEST_SUITE(RoundTrip, AllTypes);

TYPED_TEST(RoundTrip, KeepsEveryFieldOfSequencesThatGrowAndShrink) {
  for (const std::size_t length : {3, 0, 40, 2}) {
    SCOPED_TRACE(length);
    const auto message = filled<TypeParam>(length);
    EXPECT_EQ(this->through_dds(message), message);
  }
}

/// Each value of every enum must exist in the IDL: DDS refuses to write one that does not.
template <DescribedEnum Enum, class T>
void expect_all_values(Enum T::*field, auto&& through_dds) {
  for (std::size_t value = 0; value < EnumNames<Enum>::kNames.size(); ++value) {
    T message;
    message.*field = static_cast<Enum>(value);
    EXPECT_EQ(through_dds(message).*field, message.*field) << name_of(message.*field);
  }
}

using RoundTripOfAdvisory = RoundTrip<Advisory>;
TEST_F(RoundTripOfAdvisory, KeepsEveryValueOfItsEnums) {
  const auto through = [this](const Advisory& advisory) { return through_dds(advisory); };
  expect_all_values(&Advisory::priority, through);
  expect_all_values(&Advisory::action, through);
  expect_all_values(&Advisory::state, through);
}

}  // namespace
}  // namespace sealwatch::test
