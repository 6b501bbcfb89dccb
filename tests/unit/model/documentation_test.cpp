// docs/model.md (channels of eha) and docs/reference/plants.md show the plants' tables as the code has them. When this
// fails, paste the rows that it prints.
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

std::vector<std::string> rows_of(const PlantDescription& plant) {
  std::vector<std::string> rows;
  for (const ParameterDescription& p : plant.parameters)
    rows.push_back("| `" + p.name + "` | " + p.unit + " | " + text_of(p.value) + " | " + text_of(p.min) + " to " +
                   text_of(p.max) + " | " + (p.estimate ? "yes" : "") + " | " + p.meaning + " |");
  for (const ChannelDescription& c : plant.channels)
    rows.push_back("| `" + c.name + "` | " + c.unit + " | " + (c.input ? "input" : text_of(c.noise_std)) + " | " +
                   (c.time_constant_s > 0.0 ? text_of(1e3 * c.time_constant_s) + " ms" : "") + " | " + c.meaning +
                   " |");
  return rows;
}

TEST(ModelDocumentation, TablesAgreeWithTheCode) {
  std::ostringstream content;
  for (const char* page : {"/docs/model.md", "/docs/reference/plants.md"})
    content << std::ifstream(std::string(SEALWATCH_SOURCE_DIR) + page).rdbuf();
  for (const PlantDescription& plant : all_plants())
    for (const std::string& row : rows_of(plant))
      EXPECT_NE(content.str().find(row + "\n"), std::string::npos) << plant.name << " lacks the row\n" << row;
}

}  // namespace
}  // namespace sealwatch
