// Layouts that loggers and instruments write: where units and names stand, times and words for no value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "services/common/recording/cells.hpp"
#include "services/common/recording/recording_file.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class LoggerLayouts : public ScratchFolder {
 protected:
  static ChannelMap map_of(const std::string& time, const std::string& time_unit) {
    return {.columns = {{"time", {.column = time, .unit = time_unit}},
                        {"motor_voltage", {.column = "U", .unit = {}}},
                        {"position", {.column = "x", .unit = {}}}},
            .log = {}};
  }
  Recording read(const std::string& text, const ChannelMap& map = map_of("t", "")) {
    Result<Recording> result = read_recording(write("log.csv", text), test_plant(), map);
    EXPECT_TRUE(result) << text << result.error().describe();
    return result ? *result : Recording{};
  }
  std::string error_of(const std::string& text, const ChannelMap& map = map_of("t", "")) {
    const Result<Recording> result = read_recording(write("log.csv", text), test_plant(), map);
    EXPECT_FALSE(result) << "accepted " << text;
    return result ? "" : result.error().describe();
  }
};

/// Three rows: 1, 2, 4 mV; 60, 59, 57 mm; half a second apart.
void expect_three_rows(const Recording& recording) {
  ASSERT_TRUE(recording.samples.has("motor_voltage") && recording.samples.has("position"));
  EXPECT_THAT(recording.samples.time_s, ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(recording.samples.find("motor_voltage")->values,
              ElementsAre(DoubleEq(0.001), DoubleEq(0.002), DoubleEq(0.004)));
  EXPECT_THAT(recording.samples.find("position")->values,
              ElementsAre(DoubleEq(0.060), DoubleEq(0.059), DoubleEq(0.057)));
}

const std::string kRows = "0;1;60\n500;2;59\n1000;4;57\n";

TEST_F(LoggerLayouts, UnitsStandOverTheNamesOrUnderThem) {
  for (const char* head :
       {"ms;mV;mm\nt;U;x\n", "[ms];[mV];[mm]\nt;U;x\n", "Rig 3\noperator;Miller\n\n[ms];[mV];[mm]\nt;U;x\n",
        "t;U;x\nms;mV;mm\n", "t;U;x\n(msec);(mV);(millimeters)\n\n", "t;U;x\nms;mV;mm\nraw;raw;mean\n"})
    expect_three_rows(read(head + kRows));
}

TEST_F(LoggerLayouts, UnitsStandFarAboveTheNamesWhereTheirRowSaysSo) {
  for (const char* head : {"Model;DPO\nUnits;mV;mm\nSource;CH1;CH2\nt;U;x\n", "Unit:;mV;mm\nt;U;x\n",
                           "t;U;x\nUnit;mV;mm\nWhat;drive;stem\n", "Einheit;mV;mm\n\nt;U;x\n"})
    expect_three_rows(read(head + kRows, map_of("t", "ms")));
}

TEST_F(LoggerLayouts, UnitsInBracketsOfAnyKindAndBeforeWords) {
  for (const char* head : {"t [ms seit Start];U [mV DC];x [mm, von oben]\n", "t [ms since start];U [mV];x [mm]\n",
                           "t {ms};U {mV};x {mm}\n", "\"t {ms}\" ; \"U {mV}\" ; \"x {mm}\"\n"})
    expect_three_rows(read(head + kRows));
}

TEST_F(LoggerLayouts, WhatSimulinkSaysOfItsColumns) {
  for (const char* head : {"t;U;x\nUnit: ms;Unit: mV;Unit: mm\nType: double;Type: double;Type: single\n",
                           "t;U;x\nType: double;Type: double;Type: double\nUnit: ms;Unit: mV;Unit: mm\nInterp: linear;"
                           "Interp: linear;Interp: zoh\n"})
    expect_three_rows(read(head + kRows));
}

/// Each column of values has one of times before it, or several share one, in milliseconds of the first sample.
TEST_F(LoggerLayouts, WhatTwinCatScopeWritesAboveItsColumns) {
  const std::string own =
      "Name\tRig 3\nFile\tC:\\rig.svdx\nStarttime of export\t133500000000000000\tMontag, 4. Mai 2026\n\n"
      "Name\tU\tName\tx\nSymbolComment\t\tSymbolComment\t\nData-Type\tREAL64\tData-Type\tREAL64\n"
      "SampleTime[ms]\t500\tSampleTime[ms]\t500\nVariableSize\t8\tVariableSize\t8\nUnit\tmV\tUnit\tmm\n"
      "Unit Offset\t0\tUnit Offset\t0\n\n0\t1\t0\t60\n500\t2\t500\t59\n1000\t4\t1000\t57\n";
  expect_three_rows(read(own, map_of("column 1", "")));
  const std::string shared =
      "Name\tRig 3\n\nName\tU\tx\nSampleTime[ms]\t500\t500\nUnit\tmV\tmm\n\n0\t1\t60\n500\t2\t59\n1000\t4\t57\n";
  expect_three_rows(read(shared, map_of("Time", "")));
}

TEST_F(LoggerLayouts, AMachineCalledByAUnitIsNone) {
  const Recording recording = read("Unit;A\nShift;2\nt [ms];U [mV];x [mm]\n" + kRows);
  expect_three_rows(recording);
}

std::string labview_file(const std::string& x_columns, const std::string& names, const std::string& rows) {
  return "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t" + x_columns +
         "\nTime_Pref\tRelative\nDate\t2031/04/12\nTime\t03:00:00.25\n***End_of_Header***\n\nChannels\t2\n"
         "Samples\t3\t3\nDate\t2031/04/12\t2031/04/12\nTime\t03:00:00.25\t03:00:00.25\nY_Unit_Label\tmV\tmm\n"
         "X_Dimension\tTime\tTime\nX0\t0.0E+0\t0.0E+0\nDelta_X\t0.5\t0.5\n***End_of_Header***\n" +
         names + rows;
}

TEST_F(LoggerLayouts, APreambleWithNumbersIsNoTable) {
  const std::string names = "X_Value\tU\tx\tComment\n";
  expect_three_rows(read(labview_file("One", names, "0\t1\t60\n0.5\t2\t59\n1\t4\t57\n"), map_of("X_Value", "s")));
  EXPECT_THAT(
      error_of(labview_file("No", names, "\t1\t60\n\t2\t59\n\t4\t57\n"), map_of("X_Value", "s")),
      AllOf(HasSubstr("row 21, column 1 (X_Value, channel time)"),
            HasSubstr("the cell is empty; in the map: time: {column: row, unit: s, scale: SECONDS_BETWEEN_ROWS}")));
  ChannelMap counted = map_of("row", "s");
  EXPECT_THAT(error_of(labview_file("No", names, "\t1\t60\n\t2\t59\n"), counted),
              HasSubstr("channel time: 'row': counts the rows, which needs the time between two"));
  counted.columns["time"].scale = 0.5, counted.columns["time"].is_scaled = true;
  expect_three_rows(read(labview_file("No", names, "\t1\t60\n\t2\t59\n\t4\t57\n"), counted));
  const ChannelMap map = {.columns = {{"time", {.column = "x-axis", .unit = "s"}},
                                      {"motor_voltage", {.column = "1", .unit = {}}},
                                      {"position", {.column = "2", .unit = {}}}},
                          .log = {}};
  expect_three_rows(read("x-axis,1,2\nsecond,mV,mm\n0,1,60\n0.5,2,59\n1,4,57\n", map));
}

// A word in the place of a first time is the table's: its samples would be lost, and nobody would know.
TEST_F(LoggerLayouts, AFirstRowThatBeginsWithAWordIsRefused) {
  EXPECT_THAT(error_of("t [s];U [mV];x [mm]\nstart;1;60\n0.5;2;59\n1;4;57\n"), HasSubstr("row 2, column 1"));
}

TEST_F(LoggerLayouts, ASecondHeaderIsRefused) {
  EXPECT_THAT(error_of("t [s];U [mV];x [mm]\n0;1;60\n0.5;2;59\n\nt [s];U [mV];x [m]\n1;4;57\n1.5;4;57\n"),
              HasSubstr("row 5, column 1"));
}

// Its columns may stand in another order: taking the row out, as of a summary, would swap them unseen.
TEST_F(LoggerLayouts, AHeaderInAnotherOrderNeedsAFileOfItsOwn) {
  EXPECT_THAT(
      error_of("t [s];U [mV];x [mm]\n0;1;60\n0.5;2;59\n\nx [mm];t [s];U [mV]\n57;1;4\n57;1.5;4\n"),
      AllOf(HasSubstr("row 5, column 1"), HasSubstr("is a column's name: another header; make a file of its own")));
}

TEST_F(LoggerLayouts, RowsAreCountedAsAnEditorDoes) {
  EXPECT_THAT(error_of("t [s];U [mV];x [mm];note\n0;1;60;\"two\nlines\"\n0.5;2;\n", map_of("t", "s")),
              HasSubstr("row 4, column 3"));
}

TEST_F(LoggerLayouts, ACountOfSamplesIsATimeWithAScale) {
  ChannelMap map = map_of("n", "s");
  map.columns["time"].scale = 0.5, map.columns["time"].is_scaled = true;
  expect_three_rows(read("n;U [mV];x [mm]\n0;1;60\n1;2;59\n2;4;57\n", map));
  map.columns["time"].offset = 3.0;
  EXPECT_THAT(read("n;U [mV];x [mm]\n0;1;60\n1;2;59\n2;4;57\n", map).samples.time_s, ElementsAre(3.0, 3.5, 4.0));
  map.columns["time"].unit = "iso8601";
  EXPECT_THAT(error_of("n;U [mV];x [mm]\n2031-04-12T03:00:00Z;1;60\n", map),
              HasSubstr("channel time: 'iso8601': is a clock, which takes no scale"));
  EXPECT_THAT(error_of("n;U [mV];x [mm]\n0;1;60\n1;2;59\n", map_of("n", "Sequence")),
              HasSubstr("of a count of samples: {unit: s, scale: SECONDS_BETWEEN_SAMPLES}"));
}

TEST_F(LoggerLayouts, ALeapSecondIsNamed) {
  const std::string rule = "is a leap second, which has no place of its own";
  EXPECT_THAT(error_of("t;U [mV];x [mm]\n2016-12-31T23:59:59.5Z;1;60\n2016-12-31T23:59:60.0Z;2;59\n"
                       "2016-12-31T23:59:60.5Z;4;57\n",
                       map_of("t", "iso8601")),
              AllOf(HasSubstr("row 3, column 1"), HasSubstr(rule), HasSubstr("log the time in s")));
  EXPECT_THAT(error_of("t;U [mV];x [mm]\n31.12.2016 23:59:59.5;1;60\n31.12.2016 23:59:60.0;2;59\n",
                       map_of("t", "%d.%m.%Y %H:%M:%S")),
              AllOf(HasSubstr("row 3, column 1"), HasSubstr(rule)));
}

TEST_F(LoggerLayouts, AClockWithoutADayGoesOnPastMidnight) {
  const Recording recording =
      read("t;U [mV];x [mm]\n23:59:59.5;1;60\n00:00:00.0;2;59\n00:00:00.5;4;57\n", map_of("t", "%H:%M:%S"));
  expect_three_rows(recording);
  EXPECT_FALSE(recording.start_time);
  EXPECT_THAT(error_of("t;U [mV];x [mm]\n23:58:00;1;60\n23:58:10;1;60\n00:00:00;2;59\n", map_of("t", "%H:%M:%S")),
              HasSubstr("time goes back"))
      << "more than a minute is no step: a count from the begin starts anew";
}

// A slow log's step over midnight is as long as its others; a gap over midnight is longer, and may as well be a restart.
TEST_F(LoggerLayouts, ASlowClockPassesMidnightTooDayForDay) {
  std::string text = "t;U [mV];x [mm]\n";
  for (int row = 0; row < 200; ++row) {  // every 20 minutes from 23:50: nearly three days
    const int minutes = (23 * 60 + 50 + 20 * row) % 1440;
    std::array<char, 64> line{};
    std::snprintf(line.data(), line.size(), "%02d:%02d:30;%d;60\n", minutes / 60, minutes % 60, row);
    text += line.data();
  }
  EXPECT_THAT(error_of(text, map_of("t", "%H:%M:%S")), HasSubstr("row 3, column 1"))
      << "no step before tells its length";
  text.erase(text.find("23:50"), text.find("00:10") - text.find("23:50"));
  const Recording recording = read(text, map_of("t", "%H:%M:%S"));
  ASSERT_THAT(recording.samples.time_s, SizeIs(199));
  for (std::size_t row = 0; row < 199; ++row)
    EXPECT_NEAR(recording.samples.time_s[row], 1200.0 * static_cast<double>(row), 1e-6) << row;
}

TEST_F(LoggerLayouts, DaysOfMatlabAndTimesSinceADate) {
  const Recording days =
      read("t;U [mV];x [mm]\n736696.25;1;60\n736696.250005787;2;59\n736696.250011574;4;57\n", map_of("t", "datenum"));
  ASSERT_THAT(days.samples.time_s, SizeIs(3));
  EXPECT_NEAR(days.samples.time_s[2], 1.0, 1e-4);  // a day's 16th digit
  EXPECT_EQ(format_utc(*days.start_time), "2017-01-01T06:00:00Z");
  const Recording since =
      read("t;U [mV];x [mm]\n0;1;60\n0.5;2;59\n1;4;57\n", map_of("t", "seconds since 2031-04-12 03:00:00"));
  expect_three_rows(since);
  EXPECT_EQ(format_utc(*since.start_time), "2031-04-12T03:00:00Z");
  EXPECT_THAT(error_of("t;U;x\n0;1;60\n1;1;60\n", map_of("t", "seconds since yesterday")),
              HasSubstr("must read as 'days since 2031-04-12'"));
}

// A count since long ago has few digits left: the test begins at 0 s, exactly, and is dated.
TEST_F(LoggerLayouts, MillisecondsSince1970DateATest) {
  const std::string text = "t;U [mV];x [mm]\n1930003200125;1;60\n1930003200625;2;59\n1930003201125;4;57\n";
  const Recording dated = read(text, map_of("t", "ms since 1970-01-01"));
  EXPECT_THAT(dated.samples.time_s, ElementsAre(0.0, 0.5, 1.0));
  EXPECT_EQ(format_utc(*dated.start_time), "2031-02-28T00:00:00.125Z");
  EXPECT_THAT(dated.warnings, IsEmpty());
  const Recording counted = read(text, map_of("t", "ms"));
  EXPECT_FALSE(counted.start_time);
  EXPECT_THAT(counted.warnings, ElementsAre(HasSubstr("`unit: ms since 1970-01-01` begins the test at 0 s")));
  EXPECT_THAT(error_of("t;U;x\n1e300;1;60\n", map_of("t", "s since 1970-01-01")), HasSubstr("the years 1700 to 2250"));
}

TEST(TimeFormat, WhatCountsSince1970IsOfOurTime) {
  EXPECT_EQ(since_1970("s", 1.93e9), "s since 1970-01-01");
  EXPECT_EQ(since_1970("us", 1.93e15), "us since 1970-01-01");
  EXPECT_EQ(since_1970("ms", 1.93e9), "") << "of 22 days";
  EXPECT_EQ(since_1970("s", 4.0e9), "") << "since 1904, as LabVIEW counts";
  EXPECT_EQ(since_1970("iso8601", 1.93e9), "");
}

// As loggers of programmable controllers and simulators write switches.
TEST_F(LoggerLayouts, TrueAndFalseAreNumbers) {
  const Recording recording = read("t;U;x [mm]\n0;FALSE;60\n0,5;True;59\n1;true;57\n", map_of("t", "s"));
  EXPECT_THAT(recording.samples.find("motor_voltage")->values, ElementsAre(0.0, 1.0, 1.0));
  EXPECT_THAT(error_of("t;U;x\n0;falsch;60\n", map_of("t", "s")), HasSubstr("must be a number"));
}

// "Unicode text" of Windows' tools.
TEST_F(LoggerLayouts, TextInUtf16IsRead) {
  const std::u16string text = u"t [ms];U [mV];x [mm];Größe \U0001F600\r\n0;1;60;1\r\n500;2;59;1\r\n1000;4;57;1\r\n";
  for (const bool little : {true, false}) {
    std::string bytes = little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char16_t unit : text) {
      const char low = static_cast<char>(unit & 0xFFU), high = static_cast<char>(unit >> 8U);
      bytes += little ? low : high;
      bytes += little ? high : low;
    }
    const Recording recording = read(bytes);
    expect_three_rows(recording);
    EXPECT_THAT(recording.left_aside, ElementsAre("Größe \U0001F600"));
    EXPECT_THAT(error_of(bytes + "7"), HasSubstr("byte 135: is no UTF-16"));
    EXPECT_THAT(error_of(bytes + (little ? "\x3D\xD8" : "\xD8\x3D")), HasSubstr("is no UTF-16"));
  }
}

TEST_F(LoggerLayouts, FortransDoublePrecision) {
  expect_three_rows(
      read("# t[s] U[mV] x[mm]\n0.0D+00 1.0D+00 6.0D+01\n5.0D-01 2.0D+00 5.9D+01\n1.0D+00 4.0d+00 5.7d+01\n"));
}

TEST_F(LoggerLayouts, AMinusAsItIsPrinted) {
  const Recording recording = read("t [s];U [mV];x [mm]\n0;−1;60\n0,5;−2,5;59\n");
  EXPECT_THAT(recording.samples.find("motor_voltage")->values, ElementsAre(DoubleEq(-0.001), DoubleEq(-0.0025)));
}

TEST_F(LoggerLayouts, ASummaryBelowTheTableIsRefusedWithItsRemedy) {
  EXPECT_THAT(error_of("t [s];U [mV];x [mm]\n0;1;60\n0.5;2;59\nMin;1;59\n"),
              AllOf(HasSubstr("row 4, column 1 (t [s], channel time): 'Min': must be a number"),
                    HasSubstr("take the row out where it is no sample")));
}

TEST_F(LoggerLayouts, WordsForNoValueHaveDigitsToo) {
  for (const char* word : {"1.#INF", "1.#QNAN", "-1.#IND", "#DIV/0!", "OL"}) {
    const std::string text = std::string("t [s];U [mV];x [mm]\n0;1;60\n0.25;1;") + word + "\n0.5;2;59\n1;4;57\n";
    EXPECT_THAT(error_of(text), AllOf(HasSubstr(std::string("row 3, column 3 (x [mm], channel position): '") + word),
                                      HasSubstr("log: {incomplete_rows: skip} leaves such rows out")));
    ChannelMap map = map_of("t", "");
    map.log.incomplete_rows = "skip";
    expect_three_rows(read(text, map));
  }
}

/// 1234.5, 2345.25 and 3456.75 mV; 0, 1500 and 3000 ms.
void expect_thousands(const Recording& recording) {
  EXPECT_THAT(recording.samples.time_s, ElementsAre(0.0, 1.5, 3.0));
  ASSERT_TRUE(recording.samples.has("motor_voltage"));
  EXPECT_THAT(recording.samples.find("motor_voltage")->values,
              ElementsAre(DoubleEq(1.2345), DoubleEq(-2.34525), DoubleEq(3.45675)));
}

TEST_F(LoggerLayouts, ThousandsMayBeSeparated) {
  const std::string head = "t [ms];U [mV];x [mm]\n";
  for (const char* rows : {"0;1,234.5;60\n1,500.0;-2,345.25;59\n3,000.0;3,456.75;57\n",
                           "0,0;1.234,5;60,0\n1.500,0;-2.345,25;59,0\n3.000,0;3.456,75;57,0\n",
                           "0;1'234.5;60\n1'500;\xE2\x88\x92"
                           "2'345.25;59\n3'000;3'456.75;57\n",
                           "0;1 234,5;60\n1 500;-2 345,25;59\n3 000;3 456,75;57\n",
                           "0;1\xE2\x80\xAF"
                           "234,5;60\n1\xC2\xA0"
                           "500;-2\xA0"
                           "345,25;59\n3\xE2\x80\x89"
                           "000;3\xE2\x80\x99"
                           "456,75;57\n"})
    expect_thousands(read(head + rows));
  expect_thousands(
      read("\"t [ms]\",\"U [mV]\",\"x "
           "[mm]\"\n\"0\",\"1,234.5\",\"60\"\n\"1,500\",\"-2,345.25\",\"59\"\n\"3,000\",\"3,456.75\",\"57\"\n"));
}

TEST_F(LoggerLayouts, ARowThatIsLeftOutIsCounted) {
  ChannelMap map = map_of("row", "ms");
  map.columns["time"].scale = 250.0, map.columns["time"].is_scaled = true;
  map.log.incomplete_rows = "skip";
  expect_three_rows(read("U [mV];x [mm]\n1;60\nNaN;60\n2;59\n2;---\n4;57\n", map));
}

TEST_F(LoggerLayouts, ATimeOfMorePartsThanItHasIsRefused) {
  const std::string text =
      "Date;Hour;Time;ms;U [mV];x [mm]\n12.04.2031;3;03:00:00;0;1;60\n12.04.2031;3;03:00:00;500;2;59\n";
  EXPECT_THAT(error_of(text, map_of("Date + Hour + Time + ms", "%d.%m.%Y %H:%M:%S")),
              HasSubstr("is more than a day, a time and its fraction"));
  EXPECT_THAT(error_of(text, map_of("Date + Time + us", "%d.%m.%Y %H:%M:%S")),
              HasSubstr("is not a column of this log"));
  EXPECT_THAT(error_of("Date;Time;ms;U [mV];x [mm]\n12.04.2031;03:00:00;x;1;60\n12.04.2031;03:00:00;500;2;59\n",
                       map_of("Date + Time + ms", "%d.%m.%Y %H:%M:%S")),
              HasSubstr("its fraction, in column 3, must be a number"));
}

TEST_F(LoggerLayouts, AMapThatContradictsTheFileIsToldWhatTheFileIs) {
  const std::string text = "t [s];U [mV];x [mm]\n0,0;1,5;60,1\n0,5;2,5;59,2\n1,0;4,5;57,3\n";
  ChannelMap map = map_of("t", "");
  map.log = {.delimiter = "semicolon", .decimal = "point"};
  EXPECT_THAT(
      error_of(text, map),
      HasSubstr(
          "log: says delimiter: semicolon, decimal: point; the file reads with delimiter: semicolon, decimal: comma"));
  map.log = {.delimiter = "tab", .decimal = {}};
  EXPECT_THAT(error_of(text, map), HasSubstr("log: says delimiter: tab; the file reads with delimiter: semicolon"));
}

// "1,234" is one thousand or one: only the other cells, or the map, tell.
TEST_F(LoggerLayouts, ACommaThatMayBeEitherIsRefusedUnlessTheDecimalSignIsKnown) {
  const std::string text = "t [ms];U [mV];x [mm]\n0;1;60\n500;2;59\n1,000;4;57\n";
  EXPECT_THAT(
      error_of("t [ms];U [mV];x [mm]\n0;1;60\n500;1,234;59\n1000;4;57\n"),
      AllOf(HasSubstr("row 3, column 2 (U [mV], channel motor_voltage): '1,234'"),
            HasSubstr("may be a number with thousands or with decimals; log: {decimal: point} or {decimal: comma}")));
  EXPECT_THAT(error_of(text), HasSubstr("row 4, column 1 (t [ms], channel time): '1,000': may be a number"));
  ChannelMap map = map_of("t", "");
  map.log.decimal = "point";
  expect_three_rows(read(text, map));
  expect_three_rows(read("t [ms];U [mV];x [mm]\n0;1;60.0\n500;2;59.0\n1,000;4;57.0\n"));
  const Recording decimals = read("t [ms];U [mV];x [mm]\n0;1,234;60,000\n500;2,345;59,000\n1000;4,567;57,000\n");
  EXPECT_THAT(decimals.samples.find("motor_voltage")->values,
              ElementsAre(DoubleEq(0.001234), DoubleEq(0.002345), DoubleEq(0.004567)));
}

}  // namespace
}  // namespace sealwatch
