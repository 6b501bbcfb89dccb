#include "services/verification/lives/life_record.hpp"

#include <gtest/gtest.h>

namespace sealwatch::verification {
namespace {

LifeRecord some_life() {
  LifeRecord record;
  record.life = 7;
  record.end_of_life_months = 101.25;
  record.censored = true;
  record.tests = {{1.0, 0.99, true, 0.991, 0.001}, {2.0, 0.98, false, 0.0, 0.0}};
  const RecordedAnswer answer{ForecastState::ok, 30.5F, 20.0F, 44.0F, 24.0F, 38.0F, 0.6F, 2.5F, 0.7F};
  record.answers = {{answer, {}}, {{.state = ForecastState::past_threshold, .pit = 1.0F}, answer}};
  return record;
}

TEST(LifeRecord, GoesThroughBytes) {
  const LifeRecord record = some_life();
  const auto back = life_from_bytes(to_bytes(record));
  ASSERT_TRUE(back) << back.error().describe();
  EXPECT_EQ(*back, record);
  EXPECT_EQ(to_bytes(*back), to_bytes(record));
  EXPECT_DOUBLE_EQ(record.true_rul_months(1), 99.25);
}

TEST(LifeRecord, EveryDamagedByteIsSeen) {
  const std::string bytes = to_bytes(some_life());
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    std::string damaged = bytes;
    damaged[k] = static_cast<char>(damaged[k] ^ 0x10);
    EXPECT_FALSE(life_from_bytes(damaged)) << k;
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(life_from_bytes(bytes.substr(0, size))) << size;
  EXPECT_FALSE(life_from_bytes(bytes + "x"));
}

}  // namespace
}  // namespace sealwatch::verification
