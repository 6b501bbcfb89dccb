// History files: what is read, and that every bad one is refused with its place.
#include "services/common/forecast/history.hpp"

#include <gmock/gmock.h>

namespace sealwatch::forecast {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kHeader = "time[iso8601],theta[1],theta_std[1]\n";

std::string error_of(const std::string& text, const std::optional<ConditionSetting>& seal = {}) {
  const auto history = parse_history(text, "H.csv", seal);
  return history ? "no error" : history.error().describe();
}

TEST(History, ReadsConditions) {
  const auto history =
      parse_history(std::string(kHeader) + "2031-01-05T03:00:00Z,0.91,0.004\r\n2031-02-05,0.90,0.005", "H.csv", {});
  ASSERT_TRUE(history) << history.error().describe();
  ASSERT_EQ(history->size(), 2u);
  EXPECT_EQ((*history)[0], (ConditionSample{parse_utc("2031-01-05T03:00:00Z").value(), 0.91, 0.004}));
  EXPECT_EQ((*history)[1].condition, 0.90);
}

TEST(History, ReadsColumnsByNameAndQuotes) {
  const auto history =
      parse_history("\xEF\xBB\xBFnote,\"theta[1]\",time[iso8601]\n\"a, b\",0.8,2031-01-05\n", "H.csv", {});
  ASSERT_TRUE(history) << history.error().describe();
  EXPECT_EQ((*history)[0].condition, 0.8);
  EXPECT_EQ((*history)[0].condition_std, 0.0);  // column absent as a whole: not known
}

TEST(History, TurnsResistanceIntoCondition) {
  const ConditionSetting seal{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  const std::string text =
      "time[iso8601],R_CL[Pa s/m3],R_CL_std[Pa s/m3]\n2031-01-05,4.64e12,2.136e11\n2031-02-05,2.6e13,0\n";
  const auto history = parse_history(text, "H.csv", seal);
  ASSERT_TRUE(history) << history.error().describe();
  EXPECT_NEAR((*history)[0].condition, 0.60, 1e-12);
  EXPECT_NEAR((*history)[0].condition_std, 0.004, 1e-12);
  EXPECT_NEAR((*history)[1].condition, 1.0, 1e-12);
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("R_CL[Pa s/m3]"), HasSubstr("--asset")));
}

TEST(History, AMisspeltColumnIsNotPassedOver) {
  EXPECT_THAT(error_of("time[iso8601],theta[1],theta_sdt[1]\n2031-01-05,0.9,0.004\n"),
              AllOf(HasSubstr("theta_sdt[1]"), HasSubstr("did you mean 'theta_std[1]'")));
  EXPECT_THAT(error_of("time[iso8601],theta[%],note\n2031-01-05,90,x\n"), HasSubstr("did you mean 'theta[1]'"));
  EXPECT_EQ(error_of("time[iso8601],theta[1],phi[1],operator\n2031-01-05,0.9,0.1,me\n"), "no error");
}

TEST(History, RefusesNegativeResistances) {
  EXPECT_THAT(
      error_of("time[iso8601],R_CL[Pa s/m3]\n2031-01-05,-4.64e12\n",
               ConditionSetting{
                   .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"}),
      AllOf(HasSubstr("R_CL[Pa s/m3]"), HasSubstr("must be positive")));
}

TEST(History, NamesRowAndColumnOfBadCells) {
  const std::string start = std::string(kHeader) + "2031-01-05,0.91,0.004\n";
  EXPECT_THAT(error_of(start + "2031-02-05,abc,0.004\n"),
              AllOf(HasSubstr("H.csv"), HasSubstr("row 3"), HasSubstr("theta[1]"), HasSubstr("'abc'")));
  EXPECT_THAT(error_of(start + "2031-02-05,nan,0.004\n"), HasSubstr("finite"));
  EXPECT_THAT(error_of(start + "2031-02-05,0.9,\n"), AllOf(HasSubstr("theta_std[1]"), HasSubstr("missing")));
  EXPECT_THAT(error_of(start + "2031-02-05,0.9,-0.1\n"), HasSubstr("must not be negative"));
  EXPECT_THAT(error_of(start + "2031-02-05,90,0.4\n"), HasSubstr("0.85 for 85 %"));
  EXPECT_THAT(error_of(start + "2031-02-05,-0.9,0.4\n"), HasSubstr("must be above 0"));
  EXPECT_THAT(error_of(start + "yesterday,0.9,0.4\n"), AllOf(HasSubstr("row 3"), HasSubstr("time[iso8601]")));
  EXPECT_THAT(error_of(start + "2031-02-05,0.9"), AllOf(HasSubstr("row 3"), HasSubstr("cut off")));
}

TEST(History, RefusesRepeatedAndUnorderedMonths) {
  const std::string start = std::string(kHeader) + "2031-02-05,0.91,0.004\n";
  EXPECT_THAT(error_of(start + "2031-02-05,0.91,0.004\n"),
              AllOf(HasSubstr("row 3"), HasSubstr("not after the row before")));
  EXPECT_THAT(error_of(start + "2031-01-05,0.92,0.004\n"), HasSubstr("sort the rows"));
}

TEST(History, RefusesNegativeResistance) {
  EXPECT_THAT(
      error_of("time[iso8601],R_CL[Pa s/m3]\n2031-01-05,-2e13\n",
               ConditionSetting{
                   .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"}),
      AllOf(HasSubstr("row 2"), HasSubstr("R_CL[Pa s/m3]"), HasSubstr("must be positive")));
}

// Unlike theta[1], which a percentage would exceed, a resistance in another unit is off by orders of magnitude.
TEST(History, RefusesResistancesThatAreNoCondition) {
  EXPECT_THAT(
      error_of("time[iso8601],R_CL[Pa s/m3]\n2031-01-05,2e13\n2031-02-05,1e300\n",
               ConditionSetting{
                   .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"}),
      AllOf(HasSubstr("row 3"), HasSubstr("R_CL[Pa s/m3]"), HasSubstr("1e300"), HasSubstr("above 2")));
}

TEST(History, OfAnotherFileSaysWhatAHistoryNeedsAndWhatTheFileHas) {
  for (const std::string header : {"time[s],pressure_a[Pa]", "time[iso8601],pressure_a[Pa]"}) {
    const auto history = parse_history(header + "\n0,1\n", "recording.csv", std::nullopt);
    ASSERT_FALSE(history);
    EXPECT_EQ(history.error().file, "recording.csv");
    EXPECT_EQ(history.error().value, header);
    EXPECT_NE(history.error().advice.find("needs time[iso8601] and theta[1] or R_CL[Pa s/m3]"), std::string::npos)
        << history.error().advice;
    EXPECT_EQ(history.error().advice.find("did you mean"), std::string::npos) << history.error().advice;
  }
}

TEST(History, RefusesFilesWithoutTheColumns) {
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of(kHeader), HasSubstr("no row"));
  EXPECT_THAT(error_of("date,theta[1]\n"), HasSubstr("time[iso8601]"));
  EXPECT_THAT(error_of("time[iso8601],health[1]\n"), HasSubstr("neither column theta[1] nor"));
  EXPECT_THAT(error_of("time[iso8601],theta[1],theta[1]\n"), HasSubstr("twice"));
  const auto absent = read_history("does_not_exist.csv", {});
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().describe(), HasSubstr("does_not_exist.csv"));
}

}  // namespace
}  // namespace sealwatch::forecast
