#include "services/cli/replay_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace sealwatch::cli {
namespace {

TEST(ReplaySource, NeedsAtLeastOneFileThatIsThere) {
  ReplayOptions options;
  options.recordings = {"/nowhere/a.csv", "/nowhere/b.csv"};
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(ReplaySource::open(options, {}));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::AllOf(::testing::HasSubstr("/nowhere/a.csv"), ::testing::HasSubstr("/nowhere/b.csv")));
}

/// What a replay of that recording says where it is refused; "" where it is not.
std::string refusal_of(const std::string& sidecar) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "replay_source";
  std::filesystem::create_directories(folder);
  const std::string file = (folder / "test.csv").string();
  std::ofstream(file) << "time[s],pressure_a[Pa],pressure_b[Pa],flow[m3/s],position[m],velocity[m/s]\n"
                         "0.0,1e6,1e6,0,0.01,0\n0.1,1e6,1e6,0,0.02,0\n0.2,1e6,1e6,0,0.03,0\n";
  std::ofstream((folder / "test.yaml").string()) << "asset_id: A\n" << sidecar;
  Configuration configuration;
  configuration.assets.emplace_back().asset_id = "A";
  configuration.commissioned["A"] = parse_utc("2009-01-01").value();
  ReplayOptions options;
  options.recordings = {file};
  auto source = ReplaySource::open(options, configuration);
  ::testing::internal::CaptureStderr();
  const bool refused = !source || source->next().empty();
  const std::string said = ::testing::internal::GetCapturedStderr();
  return refused ? said : "";
}

TEST(ReplaySource, WhatTheServicesWouldRefuseIsRefused) {
  EXPECT_EQ(refusal_of("start_time: 2009-06-01T00:00:00Z\n"), "");
  EXPECT_THAT(refusal_of("start_time: 1969-06-01T00:00:00Z\n"), ::testing::HasSubstr("is not between 1970 and 2260"));
  EXPECT_THAT(refusal_of("start_time: 2008-06-01T00:00:00Z\n"),
              ::testing::HasSubstr("lies before the asset was commissioned"));
  EXPECT_THAT(refusal_of("start_time: 2009-06-01T00:00:00Z\nrecording_id: \"" + std::string(5000, 'x') + "\"\n"),
              ::testing::HasSubstr("line 3, key recording_id"));
}

}  // namespace
}  // namespace sealwatch::cli
