#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/rate_unit.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/core/units.hpp"

namespace sealwatch {

SEALWATCH_ENUM(Colour, red, green, blue)

namespace {

TEST(Error, DescribesOnlyThePartsThatAreThere) {
  const Error whole{
      .file = "a.csv", .place = "row 3, column x", .value = "abc", .rule = "must be a number", .advice = "mend it"};
  EXPECT_EQ(whole.describe(), "a.csv: row 3, column x: 'abc': must be a number; mend it");
  const Error bare{.file = {}, .place = {}, .value = {}, .rule = "must be a number", .advice = {}};
  EXPECT_EQ(bare.describe(), "must be a number");
}

TEST(Time, ParsesAndFormatsIso8601) {
  EXPECT_EQ(parse_utc("1970-01-01T00:00:00Z").value().nanoseconds, 0);
  EXPECT_EQ(parse_utc("2031-04-12T03:00:00Z").value().nanoseconds, 1933729200LL * 1'000'000'000LL);
  EXPECT_EQ(parse_utc("2031-04-12").value(), parse_utc("2031-04-12T00:00:00Z").value());
  EXPECT_EQ(parse_utc("2031-04-12T05:00:00+02:00").value(), parse_utc("2031-04-12T03:00:00Z").value());
  EXPECT_EQ(parse_utc("2031-04-12T03:00").value(), parse_utc("2031-04-12T03:00:00Z").value());
  for (const char* text :
       {"2031-04-12T03:00:00Z", "2009-12-31T23:59:59.25Z", "1969-12-31T23:59:59.5Z", "2024-02-29T00:00:00Z"})
    EXPECT_EQ(format_utc(parse_utc(text).value()), text);
  EXPECT_EQ(format_date(parse_utc("2024-02-29T13:00:00Z").value()), "2024-02-29");
}

TEST(RateUnit, IsThatOfTheDerivativeInTime) {
  EXPECT_EQ(rate_unit("K"), "K/s");
  EXPECT_EQ(rate_unit("m/s"), "m/s2");
  EXPECT_EQ(rate_unit("kg/m"), "(kg/m)/s");
  EXPECT_EQ(rate_unit(""), "1/s");
}

TEST(Time, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "yesterday", "2031-13-01", "2023-02-29", "2031-04-12T25:00:00Z", "2031-04-12T03:00:61Z",
        "2031-04-12T03:00:00Q", "2031-04-12T03:00:00.Z", "2031-04-12T", "99999-01-01", "0001-01-01"}) {
    const Result<UtcTime> time = parse_utc(text);
    ASSERT_FALSE(time.has_value()) << text;
    EXPECT_EQ(time.error().value, text);
  }
}

TEST(Time, MonthIsTheMeanGregorianMonth) {
  const UtcTime start = parse_utc("2009-03-01").value();
  EXPECT_NEAR(months_between(start, parse_utc("2018-03-01").value()), 108.0, 0.05);
  EXPECT_NEAR(months_between(start, add_months(start, 36.5)), 36.5, 1e-12);
}

struct UnitCase {
  const char* unit;
  double value;
  double si;
  const char* si_unit;
};

class Units : public ::testing::TestWithParam<UnitCase> {};

TEST_P(Units, ConvertToSi) {
  const UnitConversion conversion = find_unit(GetParam().unit).value();
  EXPECT_DOUBLE_EQ(conversion.to_si(GetParam().value), GetParam().si);
  EXPECT_EQ(conversion.si_unit, GetParam().si_unit);
}

// Reference values: BIPM SI brochure, 9th edition, and the definition of the pound-force per square inch.
INSTANTIATE_TEST_SUITE_P(
    All, Units,
    ::testing::Values(UnitCase{"", 2.0, 2.0, "1"}, UnitCase{"bar", 2.0, 2.0e5, "Pa"}, UnitCase{"MPa", 2.0, 2.0e6, "Pa"},
                      UnitCase{"psi", 1.0, 6894.757293168361, "Pa"}, UnitCase{"mm", 5.0, 5.0e-3, "m"},
                      UnitCase{"mm/s", 5.0, 5.0e-3, "m/s"}, UnitCase{"L/min", 60.0, 1.0e-3, "m3/s"},
                      UnitCase{"rpm", 60.0, 2.0 * std::numbers::pi, "rad/s"}, UnitCase{"degC", 4.0, 277.15, "K"},
                      UnitCase{"mA", 4.0, 4.0e-3, "A"}, UnitCase{"ms", 4.0, 4.0e-3, "s"},
                      UnitCase{"kN", 4.0, 4.0e3, "N"}, UnitCase{"rev", 1.0, 2.0 * std::numbers::pi, "rad"},
                      UnitCase{"deg", 180.0, std::numbers::pi, "rad"}));

TEST(Error, CutsALongValueBetweenLetters) {
  Error error;
  error.value = "x";
  for (int k = 0; k < 5000; ++k) error.value += "ü";
  error.rule = "must be a mapping";
  std::string expected = "'x";
  for (int k = 0; k < 99; ++k) expected += "ü";
  EXPECT_EQ(error.describe(), expected + "…': must be a mapping");
}

TEST(UnitErrors, NameTheNearestUnit) {
  const auto unknown = find_unit("mpa");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().value, "mpa");
  EXPECT_EQ(unknown.error().advice, "did you mean 'MPa'?");
}

TEST(Text, NearestFindsTyposAndRefusesStrangers) {
  const std::vector<std::string> keys = {"R_CL", "R_PL", "pressure_a", "pressure_b", "beta"};
  EXPECT_EQ(nearest("presure_a", keys), "pressure_a");
  EXPECT_EQ(nearest("R_LC", keys), "R_CL");
  EXPECT_EQ(nearest("press", keys), "pressure_a") << "cut short";
  EXPECT_EQ(nearest("temperature_of_the_sea", keys), "");
  EXPECT_EQ(suggest("temperature_of_the_sea", keys), "known are: R_CL, R_PL, pressure_a, pressure_b, beta");
}

TEST(Text, ContentHashIsFnv1a) {
  // Published test vectors of the 64-bit FNV-1a hash (Fowler, Noll, Vo).
  EXPECT_EQ(content_hash(""), "cbf29ce484222325");
  EXPECT_EQ(content_hash("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(content_hash("foobar"), "85944171f73967e8");
}

struct Sample {
  int first = 1;
  double second_Pa = 2.0;
  SEALWATCH_FIELDS(Sample, first, second_Pa)
};

TEST(Fields, VisitNamesEveryFieldInOrder) {
  std::string seen;
  Sample sample;
  Sample::visit(
      [&seen](std::string_view name, auto& value) { seen += std::string(name) + "=" + std::to_string(value) + ";"; },
      sample);
  EXPECT_EQ(seen, "first=1;second_Pa=2.000000;");
  EXPECT_EQ(Sample::kFieldCount, 2U);
  EXPECT_EQ(name_of(Colour::green), "green");
  EXPECT_EQ(value_of<Colour>("blue"), Colour::blue);
  EXPECT_FALSE(value_of<Colour>("black").has_value());
}

}  // namespace
}  // namespace sealwatch
