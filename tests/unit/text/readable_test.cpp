#include "services/common/text/readable.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sealwatch::text {
namespace {

TEST(Readable, EverydayUnits) {
  EXPECT_EQ(readable(1.05e7, "Pa"), "105 bar");
  EXPECT_EQ(readable(250.0, "Pa"), "2.50 mbar");
  EXPECT_EQ(readable(1.33e-3, "m/s"), "1.33 mm/s");
  EXPECT_EQ(readable(7.85e-6, "m3/s"), "0.471 L/min");
  EXPECT_EQ(readable(-5.0e-6, "m", 2), "−5.0 µm");
  EXPECT_EQ(readable(4010.0, "N"), "4.01 kN");
  EXPECT_EQ(readable(104.72, "rad/s", 4), "1000 rpm");
}

TEST(Readable, OtherUnitsKeepTheirNameWithAPowerOfTen) {
  EXPECT_EQ(readable(2.6e13, "Pa s/m3"), "2.60·10¹³ Pa·s/m³");
  EXPECT_EQ(readable(0.004, "1"), "0.00400");
  const DisplayUnit unit = display_unit("Pa s/m3", 2.6e13);
  EXPECT_EQ(unit.text, "10¹² Pa·s/m³");
  EXPECT_DOUBLE_EQ(2.6e13 * unit.factor, 26.0);
}

TEST(Readable, DigitsCarryIntoTheNextDecade) {
  EXPECT_EQ(number_text(9.996, 3), "10.0");
  EXPECT_EQ(number_text(999999.9, 3), "1.00·10⁶");
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "–");
}

TEST(Readable, WithItsError) {
  EXPECT_EQ(readable_with_error(2.58e13, 3e11, "Pa s/m3"), "(25.80 ± 0.30)·10¹² Pa·s/m³");
  EXPECT_EQ(readable_with_error(-4010.0, 60.0, "N"), "−4.010 ± 0.060 kN");
  EXPECT_EQ(readable_with_error(0.5, 0.0, "ohm"), "0.5000 ohm");
  EXPECT_EQ(readable_with_error(0.5, 12.0, "1"), "0 ± 12");
  EXPECT_EQ(readable_with_error(1.0, 3e-9, ""), "1.000000 ± 3.0·10⁻⁹");
  EXPECT_EQ(readable_with_error(-1e-7, 2e-3, "1"), "(0.0 ± 2.0)·10⁻³");
}

TEST(Readable, NumbersOfSentencesWriteTheirPowersOfTen) {
  EXPECT_EQ(in_sentence(64400.0), "64400");
  EXPECT_EQ(in_sentence(2.611e13), "2.61·10¹³");
  EXPECT_EQ(in_sentence(-5e-5), "−5·10⁻⁵");
  EXPECT_EQ(in_sentence(0.213), "0.213");
}

TEST(Readable, QuantitiesBesideTheirLimitsKeepTheirUnit) {
  EXPECT_EQ(with_unit(5.907e12, "Pa s/m3"), "5.91·10¹² Pa·s/m³");
  EXPECT_EQ(with_unit(1.2, "1"), "1.2");
}

TEST(Readable, ASharePretendsNoCertainty) {
  EXPECT_EQ(percent_text(0.97), "97 %");
  EXPECT_EQ(percent_text(0.9999999), "over 99.9 %");
  EXPECT_EQ(percent_text(1e-9), "under 0.1 %");
  EXPECT_EQ(percent_text(1.0), "100 %");
  EXPECT_EQ(percent_text(0.004), "0.4 %");
  EXPECT_EQ(percent_text(0.0997), "10 %");
  EXPECT_EQ(percent_text(0.0), "0 %");
  EXPECT_EQ(percent_text(1.25), "125.0 %");
}

TEST(Readable, PValues) {
  EXPECT_EQ(p_value_text(0.234), "0.23");
  EXPECT_EQ(p_value_text(3e-9), "< 10⁻⁸");
  EXPECT_EQ(p_value_text(0.0), "< 10⁻⁹");
}

TEST(Readable, Units) {
  EXPECT_EQ(unit_text("Pa s/m3"), "Pa·s/m³");
  EXPECT_EQ(unit_text("Pa s2/m6"), "Pa·s²/m⁶");
  EXPECT_EQ(unit_text("1"), "");
}

}  // namespace
}  // namespace sealwatch::text
