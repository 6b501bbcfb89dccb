#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/recording/sidecar.hpp"
#include "tests/unit/recording/plant.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  const Result<Sidecar> result = parse_sidecar(text, test_plant());
  EXPECT_FALSE(result) << "accepted:\n" << text;
  return result ? "" : result.error().describe();
}

TEST(SidecarText, ReadsEveryKey) {
  const Result<Sidecar> result = parse_sidecar(
      "recording_id: 2031-04-PST-XT03-MV2\nasset_id: XT03-MV2\ntest: full_stroke\nstart_time: 2031-04-12T03:00:00Z\n"
      "noise_std: {pressure_a: 1.0e4, position: 5e-6}\ninterpolation: hold\nnote: free text\n",
      test_plant());
  ASSERT_TRUE(result) << result.error().describe();
  EXPECT_EQ(result->recording_id, "2031-04-PST-XT03-MV2");
  EXPECT_EQ(result->asset_id, "XT03-MV2");
  EXPECT_EQ(result->test, TestKind::full_stroke);
  ASSERT_TRUE(result->start_time);
  EXPECT_EQ(format_utc(*result->start_time), "2031-04-12T03:00:00Z");
  EXPECT_EQ(result->noise_std.at("pressure_a"), 1.0e4);
  EXPECT_EQ(result->noise_std.at("position"), 5e-6);
  EXPECT_TRUE(result->interpolation_hold);
  EXPECT_EQ(result->note, "free text");
}

TEST(SidecarText, EveryKeyIsOptional) {
  for (const char* text : {"", "# nothing\n", "{}\n", "note:\n", "noise_std:\n"}) {
    const Result<Sidecar> result = parse_sidecar(text, test_plant());
    ASSERT_TRUE(result) << result.error().describe();
    EXPECT_EQ(result->test, TestKind::pst);
    EXPECT_FALSE(result->start_time);
    EXPECT_TRUE(result->noise_std.empty());
  }
}

TEST(SidecarText, ErrorsNameLineAndKey) {
  EXPECT_THAT(error_of("test: pst\nassetid: X\n"),
              HasSubstr("line 2, key assetid: 'X': is not a known key; did you mean 'asset_id'?"));
  EXPECT_THAT(error_of("noise_std:\n  presure_a: 1\n"),
              HasSubstr("line 2, key noise_std.presure_a: '1': is not a known key; did you mean 'pressure_a'?"));
  EXPECT_THAT(error_of("noise_std: {position: fine}\n"),
              HasSubstr("line 1, key noise_std.position: 'fine': must be a positive number"));
  EXPECT_THAT(error_of("noise_std: {position: 0}\n"), HasSubstr("must be a positive number"));
  EXPECT_THAT(error_of("noise_std: {position: 1e308}\n"), HasSubstr("must be a positive number, from 1e-100 to 1e100"));
  EXPECT_THAT(error_of("noise_std: {position: 1e-320}\n"), HasSubstr("must be a positive number"));
  EXPECT_THAT(error_of("noise_std: {position: .inf}\n"), HasSubstr("must be a positive number"));
  EXPECT_THAT(error_of("noise_std: {position: .nan}\n"), HasSubstr("must be a positive number"));
  EXPECT_THAT(error_of("noise_std: [1, 2]\n"), HasSubstr("key noise_std: must be a mapping"));
  EXPECT_THAT(error_of("test: pts\n"), HasSubstr("line 1, key test: 'pts': must be pst, full_stroke or other"));
  EXPECT_THAT(error_of("start_time: yesterday\n"), HasSubstr("line 1, key start_time: 'yesterday'"));
  EXPECT_THAT(error_of("interpolation: cubic\n"),
              HasSubstr("line 1, key interpolation: 'cubic': must be hold or linear"));
  EXPECT_THAT(error_of("note: a\nnote: b\n"), HasSubstr("line 2, key note: 'b': stands there twice"));
  EXPECT_THAT(error_of("note: {a: b}\n"), HasSubstr("line 1, key note: must be plain text"));
  EXPECT_THAT(error_of("note: caf\xE9\n"), HasSubstr("is not UTF-8"));
  EXPECT_THAT(error_of("- pst\n"), HasSubstr("must be a mapping"));
  EXPECT_THAT(error_of("[a, b]: c\n"), HasSubstr("a key must be plain text"));
  EXPECT_THAT(error_of("test: pst\nnote: [open\n"), HasSubstr("is not YAML"));
}

// An asset's file may have the keys of a sidecar as well.
TEST(SidecarText, APlantOrAnAssetWithTheRecordingsNameIsNamed) {
  EXPECT_THAT(error_of("name: tank\ninputs: {}\noutputs: {}\n"),
              HasSubstr("line 3, key outputs: is a key of a plant or asset file; give that file another name"));
  EXPECT_THAT(error_of("asset_id: X\nmodel: tank.yaml\n"),
              HasSubstr("line 2, key model: is a key of a plant or asset"));
  EXPECT_THAT(parse_sidecar_value("asset_id: X\nmodel: tank.yaml\n", "asset_id").error().describe(),
              HasSubstr("give that file another name than the recording's"));
}

TEST(SidecarText, AQuotedTextThatIsNeverClosedIsNamed) {
  EXPECT_THAT(error_of("test: pst\nasset_id: \"XT03\nnote: a\n"),
              HasSubstr("line 2, key asset_id: 'XT03 note: a ': is not YAML: the quoted text has no closing quote"));
  EXPECT_THAT(error_of("note: 'cut off"), HasSubstr("line 1, key note: 'cut off"));
  EXPECT_THAT(error_of("noise_std: {position: \"5\n"), HasSubstr("is not YAML"));
  EXPECT_TRUE(parse_sidecar("note: \"it's closed\"\n", test_plant()));
  EXPECT_TRUE(parse_sidecar("note: |\n  \"a block\n  it's fine\n", test_plant()));
}

TEST(SidecarText, IsOneDocument) {
  EXPECT_THAT(error_of("test: pst\n---\nasset_id: X\n"), HasSubstr("line 2: a second YAML document stands here"));
  EXPECT_TRUE(parse_sidecar("---\ntest: pst\n...\n", test_plant()));
}

TEST(SidecarText, NamesAreNoLongerThanTopicsTakeThem) {
  EXPECT_TRUE(parse_sidecar("recording_id: " + std::string(500, 'r') + "\n", test_plant()));
  const auto result = parse_sidecar("recording_id: " + std::string(501, 'r') + "\n", test_plant());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().describe(), HasSubstr("line 1, key recording_id"));
  EXPECT_THAT(result.error().describe(), HasSubstr("must not be longer than 500 bytes"));
}

TEST(SidecarText, AnAssetIsCalledSoThatItIsToldFromOthers) {
  EXPECT_THAT(error_of("asset_id: \"XT03 \"\n"), HasSubstr("'XT03 ': must not begin or end with a blank"));
  EXPECT_THAT(error_of("asset_id: --asset\n"), HasSubstr("'--asset': must not begin with '-'"));
}

TEST(SidecarText, NamesAreNotEmptyAndOfOneLine) {
  for (const std::string key : {"asset_id", "recording_id"}) {
    const std::string place = "line 2, key " + key + ": ";
    EXPECT_THAT(error_of("test: pst\n" + key + ":\n"), HasSubstr(place + "must not be empty"));
    EXPECT_THAT(error_of("test: pst\n" + key + ": null\n"), HasSubstr(place + "must not be empty"));
    EXPECT_THAT(error_of("test: pst\n" + key + ": \"\"\n"), HasSubstr(place + "must not be empty"));
    EXPECT_THAT(error_of("test: pst\n" + key + ": \"A\\nB\"\n"), HasSubstr(place + "'A?B': must not have line breaks"));
  }
}

}  // namespace
}  // namespace sealwatch
