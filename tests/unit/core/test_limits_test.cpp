#include "sealwatch/core/test_limits.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace sealwatch {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Optional;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<double> times(std::size_t rows, double interval_s) {
  std::vector<double> time_s;
  for (std::size_t k = 0; k < rows; ++k) time_s.push_back(interval_s * static_cast<double>(k));
  return time_s;
}

TEST(Plausible, ANumberThatNoSensorGivesIsNone) {
  const double largest = largest_plausible(-0.005, 0.085);
  EXPECT_THAT(plausible(0.06, largest), Optional(0.06));
  EXPECT_THAT(plausible(-60.0, largest), Optional(-60.0)) << "a slip of unit is not damage";
  EXPECT_THAT(plausible(5e-324, largest), Optional(0.0));
  EXPECT_THAT(plausible(-1e-200, largest), Optional(0.0));
  for (const double wild : {1e308, -1e308, 1e5, kInfinity, -kInfinity, kNaN}) EXPECT_FALSE(plausible(wild, largest));
  for (const double whole : {9223372036854775807.0, 18446744073709551615.0})
    EXPECT_THAT(plausible(whole, largest_plausible(0.0, 0.0)), Optional(whole)) << "the largest of 64 bits";
  EXPECT_EQ(largest_plausible(0.0, 0.0), kLargestOfAnyChannel) << "the range is not known";
  EXPECT_EQ(largest_plausible(-kInfinity, 1e308), kLargestOfAnyChannel);
}

TEST(TestLimits, SayWhatIsTooMuch) {
  EXPECT_FALSE(beyond_limits(times(6000, 0.005), 11));
  EXPECT_FALSE(beyond_limits(times(1, 0.005), 11));
  EXPECT_FALSE(beyond_limits({}, 0));
  EXPECT_THAT(beyond_limits(times(500'001, 0.01), 3), Optional(HasSubstr("2000004 numbers")));
  EXPECT_THAT(beyond_limits(times(100, 86400.0), 3), Optional(HasSubstr("s long, more than the 604800 s")));
}

TEST(TestLimits, ATestThatTakesTooManyStepsIsToldWhatToDo) {
  EXPECT_FALSE(too_long_to_simulate(6.0 * 3600.0, 0.25));
  EXPECT_FALSE(too_long_to_simulate(6.9 * 86400.0, 120.0 / 16.0)) << "rows two minutes apart";
  EXPECT_THAT(too_long_to_simulate(6.9 * 86400.0, 0.25),
              Optional(AllOf(HasSubstr("2380000 steps of 0.25 s, more than the 100000"), HasSubstr("cut the recording"),
                             HasSubstr("sealwatch fit"))));
}

TEST(TestLimits, AMessageIsHeldAgainstAllOfThem) {
  const auto wrong = [](std::vector<double> time_s, std::vector<double> values, bool gaps = false) {
    return malformed({.time_s = std::move(time_s), .channels = {{"position", "m", 0.0, std::move(values)}}}, gaps)
        .value_or("");
  };
  EXPECT_EQ(wrong({0.0, 0.1, 0.2}, {1.0, 2.0, 3.0}), "");
  EXPECT_EQ(wrong({0.0, 0.1, 0.2}, {1.0, kNaN, 3.0}, true), "");
  EXPECT_THAT(wrong({0.0, 0.1, 0.2}, {1.0, kNaN, 3.0}), HasSubstr("no sensor gives"));
  EXPECT_THAT(wrong({0.0, 0.1, 0.2}, {1.0, kInfinity, 3.0}, true), HasSubstr("no sensor gives"));
  EXPECT_THAT(wrong({0.0, 0.1, 0.2}, {1.0, 3.0}), HasSubstr("another number of samples"));
  EXPECT_THAT(wrong({0.0, 0.2, 0.1}, {1.0, 2.0, 3.0}), HasSubstr("do not increase"));
  EXPECT_THAT(wrong({0.0, kNaN, 0.1}, {1.0, 2.0, 3.0}), HasSubstr("an impossible time"));
}

}  // namespace
}  // namespace sealwatch
