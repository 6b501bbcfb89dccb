// Numbers as people read them.
#include "sealwatch/forecast/words.hpp"

#include <gtest/gtest.h>

namespace sealwatch::forecast {
namespace {

TEST(Words, OfTimesAreInDigitsThatMeanSomething) {
  EXPECT_EQ(in_months(18.43), "18 months");
  EXPECT_EQ(in_months(2.34), "2.3 months");
  EXPECT_EQ(in_months(2.0), "2 months");
  EXPECT_EQ(in_months(1.0), "1 month");
  EXPECT_EQ(in_days(2.34), "2.3 days");
}

TEST(Words, OfProbabilitiesAreNeverCertain) {
  EXPECT_EQ(in_percent(0.0), "under 0.1 %");
  EXPECT_EQ(in_percent(0.1234), "12 %");
  EXPECT_EQ(in_percent(1.0), "over 99.9 %");
}

TEST(Words, OfTheSealConditionAreInPercent) {
  EXPECT_EQ(condition_in_percent(0.667), "66.7 %");
  EXPECT_EQ(condition_with_std(0.7235, 0.0021), "72.35 +- 0.2 %");
  EXPECT_EQ(condition_with_std(0.66704, 2e-5), "66.70 +- 0.002 %");
  EXPECT_EQ(spread_in_percent(0.00123), "0.12 %");
}

TEST(Words, OfQuantitiesNameNoUnitOfPlainNumbers) {
  EXPECT_EQ(with_unit(5.907e12, "Pa s/m3"), "5.91e+12 Pa s/m3");
  EXPECT_EQ(with_unit(1.2, "1"), "1.2");
  EXPECT_EQ(in_words("not_judged"), "not judged");
}

}  // namespace
}  // namespace sealwatch::forecast
