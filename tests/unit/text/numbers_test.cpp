// Numbers as people read them.
#include "services/common/text/numbers.hpp"
#include "services/common/text/estimates.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "services/common/text/format.hpp"

namespace sealwatch::text {
namespace {

TEST(Numbers, OfTimesAreInDigitsThatMeanSomething) {
  EXPECT_EQ(in_months(18.43), "18 months");
  EXPECT_EQ(in_months(2.34), "2.3 months");
  EXPECT_EQ(in_months(2.0), "2 months");
  EXPECT_EQ(in_months(1.0), "1 month");
  EXPECT_EQ(range_in_months(34.6, 39.1), "35 to 39 months");
  EXPECT_EQ(range_in_months(0.75, 1.0), "0.8 to 1 month");
  EXPECT_EQ(in_days(2.34), "2.3 days");
}

TEST(Numbers, OfProbabilitiesAreNeverCertain) {
  EXPECT_EQ(in_percent(0.0), "under 0.1 %");
  EXPECT_EQ(in_percent(0.1234), "12 %");
  EXPECT_EQ(in_percent(1.0), "over 99.9 %");
}

TEST(Numbers, OfTheSealConditionAreInPercent) {
  EXPECT_EQ(condition_in_percent(0.667), "66.7 %");
  EXPECT_EQ(condition_with_std(0.7235, 0.0021), "72.4 ± 0.2 %");
  EXPECT_EQ(condition_with_std(0.66704, 2e-5), "66.704 ± 0.002 %");
  EXPECT_EQ(spread_in_percent(0.00123), "0.12 %");
}

TEST(Numbers, HaveTheirDigits) {
  EXPECT_EQ(significant(0.02134), "0.0213");
  EXPECT_EQ(significant(2.611e13), "2.61e+13");
  EXPECT_EQ(general(0.0859436924), "0.0859437");
  EXPECT_EQ(general(1e-5), "1e-05");
  EXPECT_EQ(general(-1013250.0), "-1013250");
  EXPECT_EQ(general(2e6), "2000000");
  EXPECT_EQ(general(2e7), "2e+07");
  EXPECT_EQ(exact(0.1), "0.1");
  EXPECT_EQ(exact(1e-7), "1e-07");
  EXPECT_EQ(with_zeros(1.23), "1.230");
  EXPECT_EQ(with_zeros(1.234e6, 3), "1.23e+06");
  EXPECT_EQ(with_zeros(0.0), "0");
}

TEST(Numbers, OfEstimatesEndWhereTheRecordingsTellNoMore) {
  EXPECT_EQ(rounded_to_error(25955123187728.89, 2.2e10), 2.595512e13);
  EXPECT_EQ(rounded_to_error(-3.997945281597366e-14, 8.5e-17), -3.997945e-14);
  EXPECT_EQ(rounded_to_error(0.005889201872894887, 0.0), 0.005889202);
  EXPECT_EQ(rounded_to_error(1e-5, 1.0), 1e-5);
  EXPECT_EQ(rounded_to_error(0.0, 1.0), 0.0);
}

TEST(Numbers, ArePlainWhereAnEngineerReadsThem) {
  EXPECT_EQ(number(64447.0), "64400");
  EXPECT_EQ(number(1.02), "1.02");
  EXPECT_EQ(number(7.98e12), "7.98e+12");
  EXPECT_EQ(number(-2.05e-12), "-2.05e-12");
}

/// Reports of earlier versions were written by the C library: what has been archived must not differ in a digit.
TEST(Numbers, AreThoseOfTheCLibrary) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-14.0, 15.0);
  std::vector<double> values = {0.0,
                                -0.0,
                                0.5,
                                1.5,
                                2.5,
                                0.125,
                                9.995,
                                99.95,
                                1e22,
                                std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::denorm_min()};
  for (int k = 0; k < 20000; ++k) values.push_back((k % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(random)));
  for (int k = 0; k < 2000; ++k) values.push_back(static_cast<double>(k) / 8.0);  // ties of rounding
  const auto by_c = [](const char* form, int digits, double value) {
    std::array<char, 400> text{};
    std::snprintf(text.data(), text.size(), form, digits, value);
    return std::string(text.data());
  };
  for (const double value : values)
    for (int digits = 0; digits <= 6; ++digits) {
      ASSERT_EQ(format("{:.{}f}", value, digits), by_c("%.*f", digits, value)) << digits;
      ASSERT_EQ(format("{:.{}e}", value, digits), by_c("%.*e", digits, value)) << digits;
      ASSERT_EQ(significant(value, digits + 1), by_c("%.*g", digits + 1, value)) << digits;
    }
}

}  // namespace
}  // namespace sealwatch::text
