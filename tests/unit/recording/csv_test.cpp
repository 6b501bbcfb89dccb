// RFC 4180 and every rule of docs/recordings.md about the data file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/csv_reader.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Result<ColumnarSamples> read(const std::string& text) {
  std::istringstream in(text);
  return read_csv(in, test_plant());
}

TimeSeries samples_of(const std::string& text) {
  const Result<ColumnarSamples> result = read(text);
  EXPECT_TRUE(result) << result.error().describe();
  return result ? result->samples : TimeSeries{};
}

std::string error_of(const std::string& text) {
  const Result<ColumnarSamples> result = read(text);
  EXPECT_FALSE(result) << "accepted:\n" << text;
  return result ? "" : result.error().describe();
}

TEST(Csv, ConvertsUnitsToSi) {
  const TimeSeries samples = samples_of(
      "time[ms],pressure_a[bar],pressure_b,flow[L/min],position[mm],shaft_speed[rpm],fluid_temperature[degC],"
      "valve_state[1]\n0,1.5,2e5,6,60,60,4,-1\n10,2.5,2.1e5,12,61,120,5,1\n");
  EXPECT_THAT(samples.time_s, ElementsAre(0.0, 0.01));
  EXPECT_THAT(samples.find("pressure_a")->values, ElementsAre(1.5e5, 2.5e5));
  EXPECT_THAT(samples.find("pressure_b")->values, ElementsAre(2e5, 2.1e5));
  EXPECT_DOUBLE_EQ(samples.find("flow")->values[0], 1e-4);
  EXPECT_THAT(samples.find("position")->values, ElementsAre(0.060, 0.061));
  EXPECT_DOUBLE_EQ(samples.find("shaft_speed")->values[1], 4.0 * 3.14159265358979323846);
  EXPECT_THAT(samples.find("fluid_temperature")->values, ElementsAre(277.15, 278.15));
  EXPECT_THAT(samples.find("valve_state")->values, ElementsAre(-1.0, 1.0));
  EXPECT_EQ(samples.find("flow")->unit, "m3/s");
}

TEST(Csv, KeepsJitteredTimesAndMissingRows) {
  EXPECT_THAT(samples_of("position,time\n1,0.000\n2,0.011\n3,0.0195\n4,0.9\n").time_s,
              ElementsAre(0.0, 0.011, 0.0195, 0.9));
}

TEST(Csv, TakesEveryFormThatRfc4180Allows) {
  const TimeSeries plain = samples_of("time,position\n0,1\n1,2\n");
  EXPECT_EQ(samples_of("time,position\r\n0,1\r\n1,2\r\n"), plain);                   // CRLF
  EXPECT_EQ(samples_of("time,position\n0,1\n1,2"), plain);                           // no last line break
  EXPECT_EQ(samples_of("\xEF\xBB\xBFtime,position\n0,1\n1,2\n"), plain);             // byte order mark
  EXPECT_EQ(samples_of("\"time\",\"position[m]\"\n\"0\",\"1\"\n1,\"2\"\n"), plain);  // quotes
  EXPECT_EQ(samples_of("\"time[s]\",position\r\n\"0\",1\r\n\"1\",\"2\""), plain);    // quotes at the very end
  EXPECT_EQ(samples_of("time, position\n 0, +1\n 1e0,\t0.2e1 \n\n\n"), plain);  // blanks around, blank lines behind
}

TEST(Csv, QuotedTextMayHoldQuotesCommasAndLineBreaks) {
  EXPECT_THAT(error_of("time,\"posi\"\"tion,\nx\"\n0,1\n"), HasSubstr("row 1, column 2: 'posi\"tion,?x'"));
}

TEST(Csv, HeaderErrorsNameRowAndColumn) {
  EXPECT_THAT(error_of("position,pressure_a\n0,1\n"), HasSubstr("row 1, column time: is missing"));
  EXPECT_THAT(error_of("time,position,position[mm]\n0,1,1\n"),
              HasSubstr("row 1, column 3: 'position[mm]': is recorded twice"));
  EXPECT_THAT(error_of("time,time[ms]\n0,1\n"), HasSubstr("row 1, column 2: 'time[ms]': is recorded twice"));
  EXPECT_THAT(error_of("time,presure_a\n0,1\n"), HasSubstr("row 1, column 2: 'presure_a'"));
  EXPECT_THAT(error_of("time,presure_a\n0,1\n"), HasSubstr("did you mean 'pressure_a'?"));
  EXPECT_THAT(error_of("time,pressure_a[baar]\n0,1\n"),
              HasSubstr("unit 'baar' is not a known unit; did you mean 'bar'?"));
  EXPECT_THAT(error_of("time,pressure_a[mm]\n0,1\n"),
              HasSubstr("unit 'mm' cannot be converted to Pa; units of this channel: Pa, bar, MPa, kPa, psi"));
  EXPECT_THAT(error_of("time,pressure_a[bar\n0,1\n"), HasSubstr("channel[unit]"));
  EXPECT_THAT(error_of("time,pressure_a[bar]x\n0,1\n"), HasSubstr("channel[unit]"));
  EXPECT_THAT(error_of("time,position_[1].s\n0,1\n"),
              HasSubstr("did you mean 'position'? Then name it so, or with a map (docs/logs.md); else take it out"));
  EXPECT_THAT(error_of("time;position\n0;1\n"), HasSubstr("separated by commas"));
  EXPECT_THAT(error_of("time,\n0,1\n"), HasSubstr("row 1, column 2"));
}

// As simulators name elements of arrays.
TEST(Csv, AColumnOfAnotherNameMayHoldBrackets) {
  const Result<ColumnarSamples> result = read("time,position,axis[1].torque,axis[2],der(s)\n0,1,2,3,4\n");
  ASSERT_TRUE(result) << result.error().describe();
  EXPECT_THAT(result->left_aside, testing::ElementsAre("axis[1].torque", "axis[2]", "der(s)"));
}

TEST(Csv, ErrorsCanBePrintedWhateverTheFileHolds) {
  const Result<ColumnarSamples> result =
      read(std::string("time,position[\x01\xFF\x7F") + std::string(1000, 'x') + "]\n0,1\n");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().value, "position[???" + std::string(48, 'x') + "...");
}

TEST(Csv, ColumnsThatThePlantDoesNotKnowAreLeftAside) {
  const Result<ColumnarSamples> result =
      read("operator,time,position_reference[furlong],position,mood\nAda,0,?,1,\nBob,1,,2,good\n");
  ASSERT_TRUE(result) << result.error().describe();
  EXPECT_THAT(result->left_aside, testing::ElementsAre("operator", "position_reference[furlong]", "mood"));
  EXPECT_EQ(result->samples, samples_of("time,position\n0,1\n1,2\n"));
  EXPECT_EQ(result->columns.size(), 1U);
  EXPECT_THAT(error_of("time,posision,mood\n0,1,good\n"), HasSubstr("did you mean 'position'?"));
  EXPECT_THAT(error_of("mood,reference\n0,1\n"), HasSubstr("row 1, column time: is missing"));
}

TEST(Text, KnowsUtf8) {
  for (const char* good : {"", "plain", "caf\xC3\xA9", "\xE2\x82\xAC", "\xF0\x9F\x98\x80", "\xEF\xBB\xBF"})
    EXPECT_TRUE(is_utf8(good)) << good;
  // Latin-1, cut short, overlong, surrogate, beyond the last code point, stray continuation.
  for (const char* bad :
       {"caf\xE9", "\xE2\x82", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80"})
    EXPECT_FALSE(is_utf8(bad)) << bad;
}

TEST(Csv, SampleErrorsNameRowAndColumn) {
  EXPECT_THAT(error_of("time,position\n0,1\n1,abc\n"), HasSubstr("row 3, column position: 'abc': must be a number"));
  EXPECT_THAT(error_of("time,position\n0,1\n1,2x\n2,3\n"), HasSubstr("row 3, column position: '2x': must be a number"));
  EXPECT_THAT(error_of("time,position\n0,1\n1,\n"), HasSubstr("row 3, column position: the cell is empty"));
  EXPECT_THAT(error_of("time,position\n0,nan\n"), HasSubstr("row 2, column position: 'nan': must be a finite number"));
  EXPECT_THAT(error_of("time,position\n0,-inf\n"),
              HasSubstr("row 2, column position: '-inf': must be a finite number"));
  EXPECT_THAT(error_of("time,position\n0,1e999\n"), HasSubstr("out of a double's range"));
  EXPECT_THAT(error_of("time,pressure_a[MPa]\n0,1e305\n"), HasSubstr("out of a double's range"));
  EXPECT_THAT(error_of("time,position\n0,1,2\n"),
              HasSubstr("row 2, column 3: '2': the row has 3 cells where the header has 2"));
  EXPECT_THAT(error_of("time,position\n0\n1,2\n"), HasSubstr("row 2, column position: '0': the row has 1 cells"));
  EXPECT_THAT(error_of("time,position\n0,1\n\n1,2\n"),
              HasSubstr("row 4, column 1: follows a blank row; take out row 3"));
}

TEST(Csv, Utf16IsNamed) {
  const std::string says = "row 1, column 1: the file is UTF-16 text; save it as UTF-8";
  for (const bool little_end_first : {true, false}) {
    std::string marked = little_end_first ? "\xFF\xFE" : "\xFE\xFF";
    std::string bare;
    for (const char letter : std::string("time,position\r\n0,1\r\n"))
      bare.append(little_end_first ? std::string{letter, '\0'} : std::string{'\0', letter});
    EXPECT_THAT(error_of(bare), HasSubstr(says));
    EXPECT_THAT(error_of(marked.append(bare)), HasSubstr(says));
  }
}

TEST(Csv, TimeMustIncrease) {
  EXPECT_THAT(error_of("time,position\n0,1\n1,2\n0.5,3\n"),
              HasSubstr("row 4, column time: '0.5': time goes back: the row before is at 1 s; time must increase"));
  EXPECT_THAT(error_of("position,time[ms]\n0,1\n1,2\n0.5,2\n"), HasSubstr("row 4, column time: '2': time repeats"));
}

TEST(Csv, RowsOfOneTimeAreBeforeAndAfterAJumpWhereThatIsSaid) {
  std::istringstream in(
      "time,position,valve_state\n0,9,9\n0,1,0\n0,1,0\n0.5,1,0\n0.5,2,0\n0.5,3,1\n1,4,1\n1,4,1\n1.5,5,1\n1.5,6,1\n");
  const auto read = read_csv(in, test_plant(), true);
  ASSERT_TRUE(read) << read.error().describe();
  const TimeSeries& samples = read->samples;
  ASSERT_EQ(samples.time_s.size(), 6U);
  EXPECT_EQ(samples.find("position")->values, (std::vector{1.0, 1.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_LT(samples.time_s[1], 0.5);
  EXPECT_NEAR(samples.time_s[1], 0.5, 1e-6);
  EXPECT_EQ(samples.time_s[2], 0.5);
  EXPECT_EQ(samples.time_s[3], 1.0);
  EXPECT_LT(samples.time_s[4], 1.5);
  EXPECT_EQ(samples.time_s[5], 1.5);
  const Error error =
      read_csv(*std::make_unique<std::istringstream>("time,position\n0,1\n1e-320,2\n1e-320,3\n"), test_plant(), true)
          .error();
  EXPECT_THAT(error.describe(), HasSubstr("time repeats"));
  EXPECT_THAT(error_of("time,position\n0,1\n0,2\n"), HasSubstr("{repeated_times: jump}"));
}

TEST(Csv, QuotingErrorsNameRowAndColumn) {
  EXPECT_THAT(error_of("time,position\n0,\"1\"x\n"), HasSubstr("row 2, column 2: '1': text follows the closing quote"));
  EXPECT_THAT(error_of("time,position\n0,1\"2\n\"\n"), HasSubstr("row 2, column 2"));
  EXPECT_THAT(error_of("time,position\n0,\"1"), HasSubstr("the quoted cell is cut off"));
}

TEST(Csv, EmptyFiles) {
  EXPECT_THAT(error_of(""), HasSubstr("row 1, column 1: the file is empty"));
  EXPECT_THAT(error_of("\xEF\xBB\xBF"), HasSubstr("the file is empty"));
  EXPECT_THAT(error_of("time,position\n"), HasSubstr("row 2, column time: no samples follow the header"));
  EXPECT_THAT(error_of("time,position"), HasSubstr("row 2, column time: no samples follow the header"));
}

TEST(Csv, CutOffLastLine) {
  EXPECT_THAT(error_of("time,position,pressure_a\n0,1,2\n1,2"),
              HasSubstr("row 3, column pressure_a: '2': the last line is cut off: 2 cells where the header has 3"));
  EXPECT_THAT(error_of("time,position\n0,1\n1,2.5e-"),
              HasSubstr("row 3, column position: '2.5e-': must be a number: the last line is cut off"));
  EXPECT_THAT(error_of("time,position\n0,1.250\n1,1.500\n2,1.7"),
              HasSubstr("row 4, column position: '1.7': the last line is cut off inside this number"));
  EXPECT_THAT(error_of("time,position\n0,1.25e-05\n1,1.50e-05\n2,1.75e-0"), HasSubstr("cut off inside this number"));
  EXPECT_THAT(error_of("time,position\n0,11373266.3\n1,11373262.9\n2,1137"), HasSubstr("cut off inside this number"));
}

TEST(Csv, EveryCutOfAFileIsAnErrorOrAValidShorterRecording) {
  const std::string whole = "time[s],position[m]\n0.00,1.25e-05\n0.01,1.50e-05\n0.02,1.75e-05\n";
  const TimeSeries all = samples_of(whole);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Result<ColumnarSamples> cut = read(whole.substr(0, length));
    if (!cut) continue;
    const std::size_t rows = cut->samples.time_s.size();
    ASSERT_LE(rows, 3U);
    for (std::size_t row = 1; row < rows; ++row)  // the first row has none before it to be judged by
      EXPECT_EQ(cut->samples.channels[0].values[row], all.channels[0].values[row]) << "cut to " << length << " bytes";
  }
}

TEST(Csv, RowsMayStraddleBlocks) {  // more than the reader's block of 64 KiB
  std::string text = "time[s],position[m],\"valve_state\"\r\n";
  for (int row = 0; row < 100000; ++row) text += std::to_string(row) + ",0.0" + std::to_string(row) + ",\"1\"\r\n";
  const Result<ColumnarSamples> result = read(text);
  ASSERT_TRUE(result) << result.error().describe();
  ASSERT_EQ(result->samples.time_s.size(), 100000U);
  for (int row = 0; row < 100000; ++row)
    ASSERT_EQ(result->samples.channels[0].values[row], std::stod("0.0" + std::to_string(row)));
  EXPECT_EQ(result->content_hash, content_hash(text));
}

}  // namespace
}  // namespace sealwatch
