// docs/model.md shows the channels of eha as the code has them. When this fails, paste the rows that it prints. All else
// is shown by `sealwatch plant show` (tests/unit/cli/plant_show_test.cpp).
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

std::string text_of(double value) {
  std::array<char, 32> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.6g", value);
  return buffer.data();
}

std::string row_of(const ChannelDescription& c) {
  return "| `" + c.name + "` | " + c.unit + " | " + (c.input ? "input" : text_of(c.noise_std)) + " | " +
         (c.time_constant_s > 0.0 ? text_of(1e3 * c.time_constant_s) + " ms" : "") + " | " + c.meaning + " |";
}

TEST(ModelDocumentation, ChannelsOfEhaAgreeWithTheCode) {
  std::ostringstream content;
  content << std::ifstream(SEALWATCH_SOURCE_DIR "/docs/model.md").rdbuf();
  for (const ChannelDescription& channel : (*find_plant("eha"))->channels)
    EXPECT_NE(content.str().find(row_of(channel) + "\n"), std::string::npos) << "docs/model.md lacks the row\n"
                                                                             << row_of(channel);
}

}  // namespace
}  // namespace sealwatch
