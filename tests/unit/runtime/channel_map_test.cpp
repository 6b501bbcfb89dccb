// `channels:` and `log:` of an asset file or of a file of their own: read, refused with line and key, written back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::ElementsAre;

constexpr const char* kWhole = R"(channels:
  time: {column: Timestamp, unit: iso8601}
  pressure_a: PT-101 [psig]
  position: {column: LVDT, unit: mm, scale: 0.0122, offset: -25}
log: {delimiter: semicolon, decimal: comma, header_row: 12, units_row: 13, first_row: 15, time_resets: split,
      incomplete_rows: skip}
)";

ChannelMap whole() {
  ChannelMap map;
  map.columns = {{"time", {.column = "Timestamp", .unit = "iso8601"}},
                 {"pressure_a", {.column = "PT-101 [psig]", .unit = {}}},
                 {"position", {.column = "LVDT", .unit = "mm", .scale = 0.0122, .offset = -25.0, .is_scaled = true}}};
  map.log = {"semicolon", "comma", 12, 13, 15, "split", "skip"};
  return map;
}

TEST(ChannelMap, IsReadFromAFileOfItsOwnAndFromAnAssetFileAndWrittenBack) {
  const YamlPlace place;
  const auto alone = check_channel_map(place.write("map.yaml", kWhole), &**find_plant("eha"));
  ASSERT_TRUE(alone) << combine(alone.error()).describe();
  EXPECT_EQ(*alone, whole());
  const auto asset = load_asset(place.write("a.yaml", std::string("asset_id: A\n") + kWhole));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_EQ(asset->channel_map, whole());
  const auto back = load_asset(place.write("b.yaml", asset_to_yaml(*asset)));
  ASSERT_TRUE(back) << back.error().describe();
  EXPECT_EQ(back->channel_map, whole());
}

TEST(ChannelMap, AScaleOfOneIsSaidAndWrittenBack) {
  const YamlPlace place;
  const auto asset = load_asset(place.write(
      "a.yaml",
      "asset_id: A\nmodel: eha\nchannels: {position: {column: LVDT, unit: mm, scale: 1}, flow: {column: Q}}\n"));
  ASSERT_TRUE(asset) << asset.error().describe();
  EXPECT_TRUE(asset->channel_map.columns.at("position").is_scaled);
  EXPECT_FALSE(asset->channel_map.columns.at("flow").is_scaled);
  const auto back = load_asset(place.write("b.yaml", asset_to_yaml(*asset)));
  ASSERT_TRUE(back) << back.error().describe();
  EXPECT_EQ(back->channel_map, asset->channel_map);
}

TEST(ChannelMap, IsTakenFromAnotherAssetFileAsWell) {
  const YamlPlace place;
  const std::string text = "asset_id: A\nmodel: eha\nparameters: {x_C: 0.08}\n";
  const auto map = check_channel_map(place.write("a.yaml", text + kWhole), &**find_plant("eha"));
  ASSERT_TRUE(map) << combine(map.error()).describe();
  EXPECT_EQ(*map, whole());
  const auto none = check_channel_map(place.write("b.yaml", text), &**find_plant("eha"));
  ASSERT_FALSE(none);
  EXPECT_EQ(combine(none.error()).rule, "has no map: neither channels nor log");
}

TEST(ChannelMap, WithoutAPlantAnyChannelMayBeNamed) {
  const YamlPlace place;
  const auto map = check_channel_map(place.write("map.yaml", "channels: {anything: X}\n"), nullptr);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->columns.at("anything").column, "X");
}

TEST(ChannelMap, ANeedlessOneLeavesNoTrace) {
  const YamlPlace place;
  const auto asset = load_asset(place.write("a.yaml", "asset_id: A\n"));
  EXPECT_TRUE(asset->channel_map.empty());
  EXPECT_EQ(asset_to_yaml(*asset).find("channels"), std::string::npos);
}

struct BadMap {
  const char* name;
  const char* yaml;
  const char* message;
};
class ChannelMapFault : public ::testing::TestWithParam<BadMap> {};

TEST_P(ChannelMapFault, IsNamedWithLineAndKey) {
  const YamlPlace place;
  const auto map = check_channel_map(place.write("map.yaml", GetParam().yaml), &**find_plant("eha"));
  ASSERT_FALSE(map);
  std::vector<std::string> found;
  for (const Error& error : map.error()) found.push_back(place.bare(error.describe()));
  EXPECT_THAT(found, ElementsAre(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, ChannelMapFault,
    ::testing::Values(
        BadMap{"channel", "channels:\n  presure_a: P1\n",
               "map.yaml: line 2, key channels.presure_a: 'presure_a': is not a known key; did you mean 'pressure_a'?"},
        BadMap{"no_column", "channels: {flow: {unit: gpm}}\n",
               "map.yaml: line 1, key channels.flow: needs a column; write {column: ..., unit: ...}"},
        BadMap{"no_scale", "channels: {flow: {column: F, scale: 0}}\n",
               "map.yaml: line 1, key channels.flow.scale: '0': must not be 0: every number would be the same"},
        BadMap{
            "decimal_comma", "channels: {flow: {column: F, scale: 10,5}}\n",
            "map.yaml: line 1, key channels.flow.5: '5': is not a known key; numbers have a decimal point here: 10.5, "
            "not 10,5"},
        BadMap{"delimiter", "log: {delimiter: ';'}\n",
               "map.yaml: line 1, key log.delimiter: ';': is not known; known are: comma, semicolon, tab, bar, blank"},
        BadMap{"rows", "log: {header_row: 5, first_row: 5}\n",
               "map.yaml: line 1, key log.first_row: '5': must come after header_row and units_row"},
        BadMap{"row", "log: {header_row: 0}\n",
               "map.yaml: line 1, key log.header_row: '0': must be a row number, 1 for the first"},
        BadMap{"other_key", "channels: {flow: F}\nasset: A\n",
               "map.yaml: line 2, key asset: 'asset': is not a known key; known are: channels, log"}),
    [](const auto& bad) { return std::string(bad.param.name); });

}  // namespace
}  // namespace sealwatch::testing
