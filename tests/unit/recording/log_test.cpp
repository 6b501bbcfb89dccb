// Somebody's own logs: layouts as loggers write them, read by a channel map to the same samples, and what cannot be
// understood named with row and column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <cmath>

#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/log_layout.hpp"
#include "services/common/recording/recording_file.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double kPsi_Pa = 6894.757293168361;
constexpr double kAtmosphere_Pa = 101325.0;
constexpr double kTolerance = 1e-9;  // relative; times are written with nine digits at most

ChannelMap map_of(std::map<std::string, ColumnMapping> columns, LogLayout log = {}) {
  return {std::move(columns), std::move(log)};
}

LogLayout resets(const char* rule) {
  LogLayout layout;
  layout.time_resets = rule;
  return layout;
}

const ChannelMap kGermanMap = map_of({{"time", {.column = "Zeit", .unit = "iso8601"}},
                                      {"pressure_a", {.column = "Druck A", .unit = "barg"}},
                                      {"position", {.column = "Weg", .unit = {}}}});

class ForeignLog : public ScratchFolder {
 protected:
  Recording read(const std::string& text, const ChannelMap& map, const std::string& name = "log.csv") {
    Result<Recording> result = read_recording(write(name, text), test_plant(), map);
    EXPECT_TRUE(result) << result.error().describe();
    return result ? *result : Recording{};
  }
  std::string error_of(const std::string& text, const ChannelMap& map) {
    const Result<std::vector<Recording>> result = read_recordings(write("log.csv", text), test_plant(), map);
    EXPECT_FALSE(result) << "accepted " << text;
    return result ? "" : result.error().describe();
  }
};

/// Two rows: pressure 1 bar and 1.5 bar above the atmosphere, position 60 and 59 mm, half a second apart.
void expect_two_rows(const Recording& recording) {
  ASSERT_THAT(recording.samples.time_s, SizeIs(2));
  EXPECT_NEAR(recording.samples.time_s[1] - recording.samples.time_s[0], 0.5, kTolerance);
  ASSERT_TRUE(recording.samples.has("pressure_a") && recording.samples.has("position"));
  EXPECT_NEAR(recording.samples.find("pressure_a")->values[0], 1.0e5 + kAtmosphere_Pa, 1e-4);
  EXPECT_NEAR(recording.samples.find("pressure_a")->values[1], 1.5e5 + kAtmosphere_Pa, 1e-4);
  EXPECT_NEAR(recording.samples.find("position")->values[1], 0.059, 1e-12);
  EXPECT_EQ(recording.samples.find("position")->unit, "m");
}

TEST_F(ForeignLog, SemicolonsDecimalCommasAPreambleAndARowOfUnits) {
  const Recording recording = read(
      "\xEF\xBB\xBF"
      "Prüfstand 3\r\nBediener: \"O'Neill\" said \"go\r\n\r\nZeit;Druck A;Weg;Bemerkung\r\n;barg;mm;\r\n"
      "2031-04-12 03:00:00,000;1,0;60,0;Start\r\n2031-04-12 03:00:00,500;1,5;59,0;\r\n",
      kGermanMap);
  expect_two_rows(recording);
  ASSERT_TRUE(recording.start_time);
  EXPECT_EQ(format_utc(*recording.start_time), "2031-04-12T03:00:00Z");
}

TEST_F(ForeignLog, RowsOfOneTimeAreBeforeAndAfterAJumpWhereTheMapSaysSo) {
  LogLayout jumps;
  jumps.repeated_times = "jump";
  const Recording recording =
      read("t\tWeg\n0\t1\n1\t2\n1\t3\n1\t3\n2\t4\n",
           map_of({{"time", {.column = "t", .unit = "s"}}, {"position", {.column = "Weg", .unit = "m"}}}, jumps));
  EXPECT_EQ(recording.samples.find("position")->values, (std::vector{1.0, 2.0, 3.0, 4.0}));
  EXPECT_THAT(recording.samples.time_s, ElementsAre(0.0, ::testing::DoubleNear(1.0, 1e-6), 1.0, 2.0));
}

TEST_F(ForeignLog, TabsAndLatin1AndUnitsInTheHeader) {
  const ChannelMap map = map_of({{"time", {.column = "t", .unit = "ms"}},
                                 {"pressure_a", {.column = "Überdruck", .unit = "barg"}},
                                 {"position", {.column = "Weg", .unit = {}}}});
  expect_two_rows(
      read("t\t\xDC"
           "berdruck\tWeg (mm)\n0\t1.0\t60\n500\t1.5\t59\n",
           map));
}

/// Names of a log stand on terminals, pages and in maps.
TEST_F(ForeignLog, NoTerminalObeysItsNamesAndUnits) {
  const auto layout = find_layout(
      "t,Weg\x1b]0;owned\x07,p [bar\u202e],Wert\xff\x9b"
      "31m\n0,1,2,3\n1,2,3,4\n2,3,4,5\n",
      {});
  ASSERT_TRUE(layout) << layout.error().describe();
  EXPECT_THAT(layout->header,
              ElementsAre("t", "Weg\\x1B]0;owned\\x07", "p [bar\\xE2\\x80\\xAE]", "Wert\u00ff\\xC2\\x9B31m"));
  const auto units = find_layout("t,Weg\ns,mm\x1b[31m\n0,1\n1,2\n2,3\n", {});
  ASSERT_TRUE(units) << units.error().describe();
  for (const std::string& unit : units->units) EXPECT_EQ(unit.find('\x1b'), std::string::npos) << unit;
}

ChannelMap plain_map(const std::string& time, const std::string& pressure, const std::string& position) {
  return map_of({{"time", {.column = "t", .unit = time}},
                 {"pressure_a", {.column = "P1", .unit = pressure}},
                 {"position", {.column = "x", .unit = position}}});
}

TEST_F(ForeignLog, AUnitOfAnotherQuantityThanTheMapsIsRefused) {
  const std::string rows = "0.0;1.0;60.0\n0.5;1.5;59.0\n";
  const ChannelMap map = plain_map("s", "barg", "mm");
  EXPECT_THAT(
      error_of("t;P1;x [psig]\n" + rows, map),
      AllOf(HasSubstr("log.csv: row 1, channel position: 'x [psig]'"), HasSubstr("in psig by the log"),
            HasSubstr("mm by the map"), HasSubstr("another quantity"), HasSubstr("correct the unit in the map")));
  EXPECT_THAT(error_of("t;P1;x\ns;bar;V\n" + rows, map), AllOf(HasSubstr("'x'"), HasSubstr("in V by the log")));
  EXPECT_THAT(error_of("t [N];P1;x\n" + rows, map), AllOf(HasSubstr("channel time"), HasSubstr("N by the log")));
}

TEST_F(ForeignLog, TheMapsUnitIsFollowedWithAWarning) {
  const std::string rows = "0.0;1.0;60.0\n0.5;1.5;59.0\n";
  const ChannelMap map = plain_map("s", "barg", "mm");
  const Recording header = read("t [ms];P1 [barg];x [m]\n" + rows, map);
  expect_two_rows(header);
  EXPECT_THAT(header.warnings, ElementsAre(AllOf(HasSubstr("'x [m]'"), HasSubstr("channel position"),
                                                 HasSubstr("log's unit is m "), HasSubstr("the map's mm")),
                                           HasSubstr("log's unit is ms and the map's s")));
  const Recording row = read("t;P1;x\ns;kPa;mm\n" + rows, map);
  expect_two_rows(row);
  EXPECT_THAT(row.warnings, ElementsAre(HasSubstr("log's unit is kPa and the map's barg")));
  EXPECT_THAT(read("t_ms;P1;x\n" + rows, map_of({{"time", {.column = "t_ms", .unit = "s"}},
                                                 {"pressure_a", {.column = "P1", .unit = "barg"}},
                                                 {"position", {.column = "x", .unit = "mm"}}}))
                  .warnings,
              SizeIs(1));
}

TEST_F(ForeignLog, AUnitThatIsTheMapsOrNoneIsSilent) {
  const std::string rows = "0.0;1.0;60.0\n0.5;1.5;59.0\n";
  const ChannelMap map = plain_map("s", "barg", "mm");
  for (const char* head : {"t [sec];P1 [bar(g)];x [millimeter]", "t;P1;x\ns;bar g;mm", "t [raw];P1 [-];x [1]",
                           "t;P1 (A);x (rod)", "t;P1 (min);x"}) {
    const Recording recording = read(std::string(head) + "\n" + rows, map);
    expect_two_rows(recording);
    EXPECT_THAT(recording.warnings, testing::IsEmpty()) << head;
  }
  // With a scale the map's unit is that of the scaled number, and a clock has none.
  ChannelMap scaled = map;
  scaled.columns["position"].scale = 1000.0;
  EXPECT_THAT(read("t;P1;x [V]\n0.0;1.0;0.06\n0.5;1.5;0.059\n", scaled).warnings, testing::IsEmpty());
  EXPECT_THAT(
      read("t [s];P1;x\n2031-04-01 00:00:00;1;60\n2031-04-01 00:00:01;1;59\n", plain_map("iso8601", "barg", "mm"))
          .warnings,
      testing::IsEmpty());
}

TEST(HeaderCell, AnIndexInBracketsIsNoUnit) {
  for (const char* cell : {"outputs[2]", "A[2,1]", "x(10)"}) {
    EXPECT_EQ(split_header_cell(cell).name, cell);
    EXPECT_EQ(split_header_cell(cell).unit, "");
  }
  EXPECT_EQ(split_header_cell("der(s)").name, "der(s)");
  EXPECT_EQ(split_header_cell("ratio[1]").name, "ratio");
  EXPECT_EQ(split_header_cell("s[m]").unit, "m");
}

// As old instruments write it, and some programs on a Mac.
TEST_F(ForeignLog, RowsMayEndInACarriageReturnAlone) {
  const auto map = map_of({{"time", {.column = "t", .unit = "s"}}, {"position", {.column = "x", .unit = "mm"}}});
  const Recording log = read("made by hand\rt;x\r0;1\r0,5;2\r1;4\r", map);
  EXPECT_THAT(log.samples.time_s, ElementsAre(0.0, 0.5, 1.0));
  const Recording own = read("time[s],position[mm]\r0,1\r1,2\r2,4\r", {}, "own.csv");
  EXPECT_THAT(own.samples.time_s, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_DOUBLE_EQ(own.samples.find("position")->values[1], 0.002);
}

TEST_F(ForeignLog, BlanksOfAnyLength) {
  const ChannelMap map = map_of({{"time", {.column = "t", .unit = "s"}},
                                 {"pressure_a", {.column = "P1", .unit = "barg"}},
                                 {"position", {.column = "x", .unit = "mm"}}});
  expect_two_rows(read("# solver output\n  t     P1    x\n 0.0   1.0   60.0\n 0.5   1.5   59.0\n", map));
}

TEST_F(ForeignLog, CountsHaveScaleAndOffsetBeforeTheirUnit) {
  const ChannelMap map = map_of({{"time", {.column = "t", .unit = "s"}},
                                 {"pressure_a", {.column = "AI1", .unit = "barg", .scale = 0.01, .offset = -5.0}},
                                 {"position", {.column = "AI2", .unit = "m", .scale = 0.001, .offset = 0.0}}});
  expect_two_rows(read("t,AI1,AI2\n0,600,60\n0.5,650,59\n", map));
}

TEST_F(ForeignLog, ExcelDaysAndPatterns) {
  const auto with_time = [](const std::string& unit) {
    ChannelMap map = kGermanMap;
    map.columns["time"].unit = unit;
    return map;
  };
  const Recording excel = read("Zeit,Druck A,Weg [mm]\n45000.25,1,60\n45000.250005787037,1.5,59\n", with_time("excel"));
  ASSERT_THAT(excel.samples.time_s, SizeIs(2));
  EXPECT_NEAR(excel.samples.time_s[1], 0.5, 1e-6);  // a day's 16th digit
  EXPECT_EQ(format_utc(*excel.start_time), "2023-03-15T06:00:00Z");
  const std::string german = "Zeit,Druck A,Weg [mm]\n12.04.2031 03:00:00.25,1,60\n12.04.2031 03:00:00.75,1.5,59\n";
  const Recording pattern = read(german, with_time("%d.%m.%Y %H:%M:%S"));
  expect_two_rows(pattern);
  EXPECT_EQ(format_utc(*pattern.start_time), "2031-04-12T03:00:00.25Z");
  const Recording clock = read("Zeit,Druck A,Weg [mm]\n03:00:00.25,1,60\n03:00:00.75,1.5,59\n", with_time("%H:%M:%S"));
  expect_two_rows(clock);
  EXPECT_FALSE(clock.start_time) << "a time of day does not say which day";
}

TEST_F(ForeignLog, ATimeThatStartsAnewIsRefusedJoinedOrAnotherTest) {
  const std::string text = "t,P,x\n0,1,60\n0.5,1,60\n1,1,60\n0,2,50\n0.5,2,50\n";
  const std::map<std::string, ColumnMapping> columns = {{"time", {.column = "t", .unit = "s"}},
                                                        {"pressure_a", {.column = "P", .unit = "bar"}},
                                                        {"position", {.column = "x", .unit = "mm"}}};
  EXPECT_THAT(
      error_of(text, map_of(columns)),
      HasSubstr("log.csv: row 5, column 1 (t, channel time): '0': time goes back: the row before is at 1 s; log: "
                "{time_resets: join} takes it as one test, split as another test"));
  EXPECT_THAT(read(text, map_of(columns, resets("join"))).samples.time_s, ElementsAre(0, 0.5, 1, 1.5, 2));
  EXPECT_THAT(
      error_of("t,P,x\n1e43,1,60\n0.5,1,60\n", map_of(columns, resets("join"))),
      HasSubstr("log.csv: row 3, column 1 (t, channel time): '0.5': the row before is at 1e+43 s: two times fall "
                "on one, as a number has no more than 16 digits; log the time from the test's begin"));
  const auto split = read_recordings(write("s.csv", text), test_plant(), map_of(columns, resets("split")));
  ASSERT_TRUE(split) << split.error().describe();
  ASSERT_THAT(*split, SizeIs(2));
  EXPECT_EQ((*split)[0].recording_id, "s#1");
  EXPECT_EQ((*split)[1].samples.find("position")->values.front(), 0.05);
  EXPECT_NE((*split)[0].content_hash, (*split)[1].content_hash);
  EXPECT_THAT(read_recording(path("s.csv"), test_plant(), map_of(columns, resets("split"))).error().describe(),
              HasSubstr("s.csv: holds 2 tests where one is wanted"));
}

const std::map<std::string, ColumnMapping> kTimeAndPosition = {{"time", {.column = "t", .unit = "s"}},
                                                               {"position", {.column = "x", .unit = "mm"}}};

/// Reads files of one test, named a.csv, b.csv and so on.
class JoinedLogs : public ScratchFolder {
 protected:
  Result<std::vector<Recording>> read(const std::vector<std::string>& texts, const std::string& time_resets = "refuse",
                                      const std::string& time_unit = "s") {
    ChannelMap map = map_of(kTimeAndPosition, resets(time_resets.c_str()));
    map.columns["time"].unit = time_unit;
    std::string paths;
    for (std::size_t k = 0; k < texts.size(); ++k)
      paths.append(k > 0 ? "+" : "").append(write(std::string(1, static_cast<char>('a' + k)) + ".csv", texts[k]));
    return read_recordings(paths, test_plant(), map);
  }
  std::string error_of(const std::vector<std::string>& texts, const std::string& time_resets = "refuse",
                       const std::string& time_unit = "s") {
    const auto result = read(texts, time_resets, time_unit);
    EXPECT_FALSE(result);
    return result ? "" : result.error().describe();
  }
};

TEST_F(JoinedLogs, TimesOfAFileBehindAnotherStayApart) {
  EXPECT_THAT(error_of({"t,x\n0,60\n1e16,60\n", "t,x\n0,60\n0.5,60\n"}, "join"),
              HasSubstr("b.csv: sample 2, column time: two times fall on one"));
}

TEST_F(JoinedLogs, LaterTimesGoOnWhereTheyAre) {
  const auto both = read({"t,x\n0,60\n0.5,60\n", "t,x\n2,50\n2.5,50\n"});
  ASSERT_TRUE(both) << both.error().describe();
  EXPECT_THAT(both->front().samples.time_s, ElementsAre(0, 0.5, 2, 2.5));
}

TEST_F(JoinedLogs, TheWrongOrderAndOverlapsAreRefused) {
  const std::string first = "t,x\n0,60\n0.5,60\n1,60\n", second = "t,x\n1.5,50\n2,50\n";
  for (const char* time_resets : {"refuse", "join", "split"}) {
    EXPECT_THAT(error_of({second, first}, time_resets),
                ::testing::AllOf(HasSubstr("b.csv: row 2, column time: '0 s': begins before "), HasSubstr("a.csv ends"),
                                 HasSubstr("give the files in the order of their times, and no time twice")));
    EXPECT_THAT(error_of({first, "t,x\n0.75,50\n2,50\n"}, time_resets),
                HasSubstr("b.csv: row 2, column time: '0.75 s': begins before "));
  }
}

TEST_F(JoinedLogs, TheSameContentTwiceIsRefused) {
  const std::string text = "t,x\n0,60\n0.5,60\n", other = "t,x\n0,60\n0.5,61\n";
  EXPECT_THAT(error_of({text, other, text}, "join"),
              ::testing::AllOf(HasSubstr("c.csv: holds the same as "), HasSubstr("a.csv, which goes before it")));
}

TEST_F(JoinedLogs, ATimeThatEachFileBeginsAnewIsRefusedJoinedOrAnotherTest) {
  const std::vector<std::string> texts = {"t,x\n0,60\n0.5,60\n1,60\n", "t,x\n0,50\n0.5,50\n", "t,x\n1,40\n1.5,40\n"};
  EXPECT_THAT(error_of(texts), ::testing::AllOf(HasSubstr("b.csv: row 2, column time: '0 s': time starts anew, as in "),
                                                HasSubstr("log: {time_resets: join} takes both as one test")));
  const auto joined = read(texts, "join");
  ASSERT_TRUE(joined) << joined.error().describe();
  ASSERT_THAT(*joined, SizeIs(1));
  EXPECT_THAT(joined->front().samples.time_s, ElementsAre(0, 0.5, 1, 1.5, 2, 2.5, 3))
      << "the third counts as the second";
  const auto split = read(texts, "split");
  ASSERT_TRUE(split) << split.error().describe();
  ASSERT_THAT(*split, SizeIs(2));
  EXPECT_THAT((*split)[1].samples.time_s, ElementsAre(0, 0.5, 1, 1.5));
}

TEST_F(JoinedLogs, AClockWithoutADayTellsTheOrder) {
  const std::string first = "t,x\n03:00:00,60\n03:00:01,60\n", second = "t,x\n03:00:05,50\n03:00:06,50\n";
  const auto both = read({first, second}, "refuse", "%H:%M:%S");
  ASSERT_TRUE(both) << both.error().describe();
  EXPECT_THAT(both->front().samples.time_s, ElementsAre(0, 1, 5, 6));
  EXPECT_FALSE(both->front().start_time);
  EXPECT_THAT(error_of({second, first}, "refuse", "%H:%M:%S"),
              HasSubstr("b.csv: row 2, column time: '03:00:00Z': begins before "));
}

TEST_F(ForeignLog, SeveralFilesAreOneTest) {
  write("a.csv", "Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n");
  write("b.csv", "Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00.5;1,5;59\n");
  const auto both = read_recordings(path("a.csv") + "+" + path("b.csv"), test_plant(), kGermanMap);
  ASSERT_TRUE(both) << both.error().describe();
  ASSERT_THAT(*both, SizeIs(1));
  expect_two_rows(both->front());
  EXPECT_EQ(both->front().recording_id, "a");
  const auto turned = read_recordings(path("b.csv") + "+" + path("a.csv"), test_plant(), kGermanMap);
  EXPECT_THAT(turned.error().describe(),
              HasSubstr("a.csv: row 2, column time: '2031-04-12T03:00:00Z': begins before "));
  EXPECT_THAT(read_recordings(path("a.csv") + "+missing.csv", test_plant(), kGermanMap).error().describe(),
              HasSubstr("missing.csv: cannot be opened"));
}

TEST_F(ForeignLog, SectionOnesOwnFormatNeedsNoneOfTheMapsColumns) {
  const Recording recording = read("time[s],pressure_a[bar],position[mm]\n0,1,60\n0.5,1,60\n", kGermanMap);
  EXPECT_EQ(recording.samples.find("pressure_a")->values.front(), 1e5);
}

TEST_F(ForeignLog, OfTheOtherColumnsThoseWithAChannelsNameAreTaken) {
  const ChannelMap map = map_of({{"time", {.column = "Clock", .unit = "s"}}});
  const Recording recording = read("Clock,pressure_a[psi],Pressure A,spare\n0,1,7,x\n1,2,8,y\n", map);
  EXPECT_THAT(recording.samples.channels, SizeIs(1));
  EXPECT_NEAR(recording.samples.find("pressure_a")->values[1], 2 * kPsi_Pa, 1e-9);
}

TEST_F(ForeignLog, RowsWithAnEmptyCellAreRefusedOrLeftOutAsTheMapSays) {
  const std::string text =
      "Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.2;;60\n"
      "2031-04-12T03:00:00.5;1,5;59\n";
  EXPECT_THAT(error_of(text, kGermanMap), HasSubstr("row 3, column 2 (Druck A, channel pressure_a): the cell is empty; "
                                                    "log: {incomplete_rows: skip} leaves such rows out"));
  ChannelMap skip = kGermanMap;
  skip.log.incomplete_rows = "skip";
  expect_two_rows(read(text, skip));
}

TEST(HeaderCell, GaugeInBracketsBelongsToTheUnit) {
  for (const auto& [cell, name, unit] : std::vector<std::array<const char*, 3>>{{"PT-1 (bar(g))", "PT-1", "bar(g)"},
                                                                                {"PT-1 [psi(g)]", "PT-1", "psi(g)"},
                                                                                {"PT-1 bar(g)", "PT-1", "bar(g)"},
                                                                                {"Druck P(bar)", "Druck P", "bar"},
                                                                                {"Weg (mm)", "Weg", "mm"}}) {
    const NameAndUnitText split = split_header_cell(cell);
    EXPECT_EQ(split.name, name) << cell;
    EXPECT_EQ(split.unit, unit) << cell;
  }
}

// "NaN", "---", "#N/A", "Bad": a cell without a digit holds no number, as an empty one.
TEST_F(ForeignLog, ACellWithoutADigitIsMissingAsAnEmptyOneIs) {
  for (const char* missing : {"NaN", "---", "#N/A", "Bad"}) {
    const std::string text = std::string("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.2;") +
                             missing + ";60\n2031-04-12T03:00:00.5;1,5;59\n";
    EXPECT_THAT(error_of(text, kGermanMap), HasSubstr("log: {incomplete_rows: skip} leaves such rows out")) << missing;
    ChannelMap skip = kGermanMap;
    skip.log.incomplete_rows = "skip";
    expect_two_rows(read(text, skip));
  }
  ChannelMap skip = kGermanMap;
  skip.log.incomplete_rows = "skip";
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.2;1x;60\n", skip),
              HasSubstr("must be a number"));
}

// Excel and controllers in Europe: each cell in quotes, a comma between cells and in numbers.
TEST_F(ForeignLog, ADecimalCommaInQuotesIsOneBetweenCommas) {
  const ChannelMap map = map_of({{"time", {.column = "Zeit", .unit = "iso8601"}},
                                 {"pressure_a", {.column = "Druck A", .unit = "barg"}},
                                 {"position", {.column = "Weg", .unit = "mm"}}});
  expect_two_rows(read(R"("Zeit","Druck A","Weg"
"2031-04-12T03:00:00","1,0","60,0"
"2031-04-12T03:00:00.5","1,5","59,0"
)",
                       map));
  EXPECT_THAT(error_of("Zeit,Druck A,Weg\n2031-04-12T03:00:00,\"1,013\",60\n2031-04-12T03:00:01,\"1,014\",60\n", map),
              HasSubstr("may be a number with thousands or with decimals"));
}

TEST_F(ForeignLog, OfTwoColumnsWithOneHeaderTheMapNamesThePlace) {
  const std::string text = "time[s],Druck,Druck,Weg\n0,9,1,60\n0.5,9,1.5,59\n";
  ChannelMap map =
      map_of({{"pressure_a", {.column = "column 3", .unit = "barg"}}, {"position", {.column = "Weg", .unit = "mm"}}});
  expect_two_rows(read(text, map));
  map.columns["pressure_a"].column = "Druck";
  EXPECT_THAT(error_of(text, map), HasSubstr("stands over columns 2 and 3; give the whole header cell, or its place: "
                                             "column 2"));
}

TEST_F(ForeignLog, ASignThatMakesACommentOfTheHeaderIsNoColumn) {
  const ChannelMap map = map_of({{"time", {.column = "t", .unit = "s"}},
                                 {"pressure_a", {.column = "p", .unit = "barg"}},
                                 {"position", {.column = "x", .unit = "mm"}}});
  for (const char* sign : {"%", "#"}) expect_two_rows(read(std::string(sign) + " t p x\n0 1 60\n0.5 1.5 59\n", map));
}

// Above the numbers stand the units; that of a date, or one that nobody knows, does not make them the header.
TEST_F(ForeignLog, ARowThatIsMostlyUnitsBelowNamesIsTheRowOfUnits) {
  ChannelMap map = kGermanMap;
  map.columns["position"] = {.column = "Weg", .unit = {}};
  map.columns["pressure_a"] = {.column = "Druck A", .unit = {}};
  expect_two_rows(
      read("Anlage 3;;\nZeit;Druck A;Weg\nExcel;barg;mm\n"
           "2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.5;1,5;59\n",
           map));
}

// A decimal comma in one row of a comma-separated log splits a cell: what follows would be read as another column.
TEST_F(ForeignLog, ARowWithMoreCellsThanTheHeaderIsRefusedUnlessTheRestIsEmpty) {
  const ChannelMap map = map_of({{"time", {.column = "t", .unit = "s"}},
                                 {"pressure_a", {.column = "P", .unit = "barg"}},
                                 {"position", {.column = "x", .unit = "mm"}}});
  EXPECT_THAT(error_of("t,P,x\n0,1,60\n0.25,1.2,59.5\n0.5,1.5,59,0\n", map),
              HasSubstr("log.csv: row 4, column 4: '0': the row has 4 cells where the header has 3; a decimal comma"));
  EXPECT_THAT(error_of("t,P,x,\n0,1,60,\n0.25,1.2,59.5,\n0.5,1.5,59,0,\n", map),
              HasSubstr("row 4, column 4: '0': the row has 4 cells where the header has 3"));
  const ChannelMap numbers =
      map_of({{"time", {.column = "column 1", .unit = "s"}}, {"position", {.column = "column 2", .unit = "mm"}}});
  EXPECT_THAT(error_of("0,60\n0.25,59.5\n0.5,59,0\n", numbers),
              HasSubstr("row 3, column 3: '0': the row has 3 cells where the table has 2"));
  expect_two_rows(read("t,P,x\n0,1,60,\n0.5,1.5,59,\n", map));
  EXPECT_THAT(read("t,P,x\n0,1,60\n0.25,1.2,59.5\n0.5,1.5,59,,\n", map).samples.time_s, SizeIs(3));
  EXPECT_THAT(read("t,P,x,\n0,1,60\n0.25,1.2,59.5\n0.5,1.5,59, \n", map).samples.time_s, SizeIs(3));
}

TEST_F(ForeignLog, TwoChannelsOfOneColumnAreRefused) {
  EXPECT_THAT(error_of("t,P\n0,1\n1,2\n", map_of({{"time", {.column = "t", .unit = "s"}},
                                                  {"pressure_a", {.column = "P", .unit = "bar"}},
                                                  {"pressure_b", {.column = "p", .unit = "bar"}}})),
              HasSubstr("row 1, channel pressure_b: 'p': is the column of channel pressure_a too; give each channel"));
}

// What `asset new` understands a map understands, too.
TEST_F(ForeignLog, AUnitAtTheEndOfANameIsOne) {
  const ChannelMap map = map_of({{"time", {.column = "t_ms", .unit = {}}},
                                 {"pressure_a", {.column = "P barg", .unit = {}}},
                                 {"position", {.column = "Weg_mm", .unit = {}}}});
  expect_two_rows(read("t_ms,P barg,Weg_mm\n0,1,60\n500,1.5,59\n", map));
  EXPECT_EQ(unit_at_the_end("pressure_a", "A"), "") << "a chamber";
  EXPECT_EQ(unit_at_the_end("Weg_bar", "m"), "") << "another quantity";
  EXPECT_EQ(unit_at_the_end("opening %", "1"), "%");
}

TEST_F(ForeignLog, ATestOfOneSampleIsNamed) {
  const ChannelMap map =
      map_of({{"time", {.column = "t", .unit = "s"}}, {"position", {.column = "x", .unit = "mm"}}}, resets("split"));
  EXPECT_THAT(
      error_of("t,x\n0,60\n1,60\n0,60\n", map),
      HasSubstr("log.csv: row 4, column time: the test that begins here has one sample alone; take the row out"));
}

// A remark on each column, as loggers write how it was averaged, is not the header.
TEST_F(ForeignLog, ARowOfRemarksBelowTheUnitsIsNoHeader) {
  ChannelMap map = kGermanMap;
  map.columns["pressure_a"].unit = {};
  expect_two_rows(read(
      "Zeit;Druck A;Weg\n-;barg;mm\nroh;roh;Mittel\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.5;1,5;59\n", map));
}

// Its first sample would be lost, and nobody would know.
TEST_F(ForeignLog, AFirstRowWithAQuoteThatDoesNotCloseIsRefused) {
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;\"60\n2031-04-12T03:00:00.5;1,5;59\n", kGermanMap),
              AllOf(HasSubstr("row 2, column 3"), HasSubstr("no closing quote")));
}

TEST_F(ForeignLog, ALogThatIsMostlyTextsIsATableAllTheSame) {
  ChannelMap map = kGermanMap;
  map.columns["pressure_a"].unit = "barg";
  expect_two_rows(
      read("Zeit;A1;A2;A3;A4;Druck A;Weg [mm]\n2031-04-12T03:00:00;ok;ok;auf;zu;1;60\n"
           "2031-04-12T03:00:00.5;ok;ok;auf;zu;1,5;59\n",
           map));
}

TEST_F(ForeignLog, ALastLineThatIsCutInsideANumberIsRefused) {
  const std::string whole = "Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60,00\n2031-04-12T03:00:00.5;1,5;59,";
  expect_two_rows(read(whole + "00", kGermanMap));
  EXPECT_THAT(error_of(whole, kGermanMap), HasSubstr("row 3, column 3 (Weg [mm], channel position): '59,'"));
  EXPECT_THAT(error_of(whole + "0", kGermanMap), HasSubstr("the last line is cut off inside this number"));
}

// Text that was written as text on Windows has a carriage return too many.
TEST_F(ForeignLog, LinesMayEndInTwoCarriageReturns) {
  expect_two_rows(
      read("Zeit;Druck A;Weg [mm]\r\r\n2031-04-12T03:00:00;1;60\r\r\n2031-04-12T03:00:00.5;1,5;59\r\r\n", kGermanMap));
}

TEST_F(ForeignLog, AFirstRowWithoutAnEndIsNamed) {
  EXPECT_THAT(error_of("Zeit;Druck A;" + std::string(500'000, 'x') + "\n1;2;3\n", kGermanMap),
              HasSubstr("row 1, column 1: the row is longer than"));
}

// One count that is one micrometre: said, if only as 1, the scale makes the unit that of the scaled number.
TEST_F(ForeignLog, AScaleOfOneIsAScale) {
  ChannelMap map = kGermanMap;
  map.columns["position"] = {.column = "Weg [counts]", .unit = "mm", .is_scaled = true};
  expect_two_rows(read("Zeit;Druck A;Weg [counts]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:00.5;1,5;59\n", map));
}

TEST_F(ForeignLog, WhatCannotBeUnderstoodIsNamedWithRowAndColumn) {
  EXPECT_THAT(error_of("Zeit;Druck B;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:01;1;60\n", kGermanMap),
              HasSubstr("row 1, channel pressure_a: 'Druck A': is not a column of this log; did you mean 'Druck B'?"));
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [furlong/x]\n2031-04-12T03:00:00;1;60\n", kGermanMap),
              HasSubstr("channel position: 'furlong/x': is not a known unit"));
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [bar]\n2031-04-12T03:00:00;1;60\n", kGermanMap),
              HasSubstr("channel position: 'bar': cannot be converted to m; units of this channel: m, mm"));
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:01;ok;60\n", kGermanMap),
              HasSubstr("row 3, column 2 (Druck A, channel pressure_a): 'ok': must be a number"));
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\nEnde;1;60\n", kGermanMap),
              HasSubstr("row 3, column 1 (Zeit, channel time): 'Ende': must be a UTC time in ISO 8601"));
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n2031-04-12T03:00:00;1;60\n2031-04-12T03:00:01;1\n", kGermanMap),
              HasSubstr("row 3, column 3 (Weg [mm], channel position): the row has 2 cells"));
  EXPECT_THAT(error_of("Druck A;Druck A;Weg\n1;2;3\n", kGermanMap), HasSubstr("stands over columns 1 and 2"));
  EXPECT_THAT(error_of("nothing but words\nand more\n", kGermanMap), HasSubstr("row 1, column 1"));
  EXPECT_THAT(error_of("", kGermanMap), HasSubstr("the file is empty"));
  ChannelMap in_seconds = kGermanMap;
  in_seconds.columns["time"].unit = "s";
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n12. Okt 2031 03:00:00;1;60\n", in_seconds),
              HasSubstr("must be a number; a clock or a date needs its form as unit in the map"));
  ChannelMap bad = kGermanMap;
  bad.columns["time"].unit = "fortnights per bar";
  EXPECT_THAT(error_of("Zeit;Druck A;Weg [mm]\n1;1;60\n2;1;60\n", bad), HasSubstr("time is iso8601, excel"));
}

TEST_F(ForeignLog, FilesOfOtherKindsAreRefusedByName) {
  EXPECT_THAT(read_recording(write("a.parquet", "PAR1"), test_plant()).error().describe(),
              HasSubstr("a.parquet: .parquet files are not read; export it as CSV, HDF5 or MATLAB"));
}

void put_vector(hid_t file, const char* path, const std::vector<double>& values, const char* unit) {
  const hsize_t size = values.size();
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t create = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(create, 1);
  const hid_t data = H5Dcreate2(file, path, H5T_NATIVE_DOUBLE, space, create, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  if (unit != nullptr) {
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, std::char_traits<char>::length(unit) + 1);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(data, "unit", text, scalar, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, text, unit);
    H5Aclose(attribute), H5Sclose(scalar), H5Tclose(text);
  }
  H5Dclose(data), H5Pclose(create), H5Sclose(space);
}

TEST_F(ForeignLog, Hdf5DataSetsAreColumnsByTheirPathOrItsLastPart) {
  const hid_t file = H5Fcreate(path("a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  put_vector(file, "run/time", {0.0, 0.5}, nullptr);
  put_vector(file, "run/P1", {1.0, 1.5}, "barg");
  put_vector(file, "run/position", {60.0, 59.0}, "mm");
  put_vector(file, "setup/gains", {1.0, 2.0, 3.0}, nullptr);
  H5Fclose(file);
  const ChannelMap map = map_of({{"pressure_a", {.column = "run/P1", .unit = {}}}});
  const Result<Recording> recording = read_recording(path("a.h5"), test_plant(), map);
  ASSERT_TRUE(recording) << recording.error().describe();
  expect_two_rows(*recording);
  EXPECT_THAT(read_recording(write("b.h5", "no HDF5"), test_plant(), map).error().describe(),
              HasSubstr("b.h5: is not an HDF5 file, or it is damaged"));
}

TEST(HeaderCell, IsANameAndAUnitWhereTheTextBehindIsOne) {
  const auto split = [](const char* cell) {
    const NameAndUnitText parts = split_header_cell(cell);
    return parts.name + "|" + parts.unit;
  };
  EXPECT_EQ(split("PT-101 [psig]"), "PT-101|psig");
  EXPECT_EQ(split("Pressure A (bar)"), "Pressure A|bar");
  EXPECT_EQ(split("Pressure (supply)"), "Pressure (supply)|");
  EXPECT_EQ(split("Pressure A / bar"), "Pressure A|bar");
  EXPECT_EQ(split("Weg in mm"), "Weg|mm");
  EXPECT_EQ(split("time"), "time|");
}

TEST(TimeFormatOf, IsRecognisedByTheCells) {
  EXPECT_EQ(time_format_of({"2031-04-12 03:00:00", "2031-04-12T03:00:01Z"}), "iso8601");
  EXPECT_EQ(time_format_of({"25.04.2031 03:00:00,5"}), "%d.%m.%Y %H:%M:%S");
  EXPECT_EQ(time_format_of({"4/25/2031 3:00:00 PM"}), "%m/%d/%Y %I:%M:%S %p");
  EXPECT_EQ(time_format_of({"4/25/2031 13:00:00"}), "%m/%d/%Y %H:%M:%S");
  EXPECT_EQ(time_format_of({"11:59:59.5 AM", "12:00:00 PM"}), "%I:%M:%S %p");
  EXPECT_EQ(time_format_of({"25.04.31 03:00:00,5"}), "%d.%m.%y %H:%M:%S");
  EXPECT_EQ(time_format_of({"04 Mar 2031 11:59:58.25"}), "%d %b %Y %H:%M:%S");
  EXPECT_EQ(time_format_of({"2031-04-12 03:00:00.5 UTC"}), "iso8601");
  EXPECT_EQ(time_format_of({"20310412 030000.5"}), "%Y%m%d %H%M%S");
  EXPECT_EQ(time_format_of({"2031-04-12 03:00:00.5 -0730"}), "iso8601");
  EXPECT_EQ(time_format_of({"12:30"}), "") << "hours and minutes, or minutes and seconds";
  EXPECT_EQ(time_format_of({"20310412030000.5", "20310412030001"}), "%Y%m%d%H%M%S");
  for (const char* count : {"1772614800000", "1772614800000000", "20319912030000", "0.5"})
    EXPECT_EQ(time_format_of({count}), "") << count;
}

}  // namespace
}  // namespace sealwatch
