// What the compiler cannot compare between idl/ and the C++ structs: names and order of enumerators, and extensibility.
#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <string>

#include "sealwatch/message/topics.hpp"

namespace sealwatch::test {
namespace {

/// All IDL files, each run of white space as one space.
std::string idl_text() {
  std::string text;
  for (const char* file : {"common", "data_acquisition", "data_manipulation", "state_detection", "health_assessment",
                           "prognostic_assessment", "advisory_generation", "service"}) {
    std::ifstream stream(std::string(SEALWATCH_SOURCE_DIR "/idl/") + file + ".idl");
    EXPECT_TRUE(stream) << file;
    for (std::string word; stream >> word;) text += word + ' ';
  }
  return text;
}

/// "BlockBoundary" -> "BLOCK_BOUNDARY", "own_baseline" -> "OWN_BASELINE"
std::string shouted(std::string_view name) {
  std::string result;
  bool after_lower_case = false;
  for (const char c : name) {
    if (std::isupper(c) != 0 && after_lower_case) result += '_';
    after_lower_case = std::islower(c) != 0;
    result += static_cast<char>(std::toupper(c));
  }
  return result;
}

template <DescribedEnum Enum>
void expect_in_idl(const std::string& text, const std::string& name) {
  std::string expected = "@appendable enum " + name + " {";
  std::string separator = " ";
  for (const std::string_view value : EnumNames<Enum>::kNames) {
    expected += separator + shouted(name) + '_' + shouted(value);
    separator = ", ";
  }
  expected += " };";
  EXPECT_NE(text.find(expected), std::string::npos) << "idl/ must have: " << expected;
}

// Without its key a topic keeps the last message of one asset for all.
TEST(Idl, EveryTopicIsKeyedByItsAsset) {
  const std::string text = idl_text();
  std::size_t topics = 0;
  for (std::size_t at = text.find("// Topic "); at != std::string::npos; at = text.find("// Topic ", at + 1)) {
    const std::size_t structure = text.find("@appendable struct ", at);
    const std::size_t member = text.find("{ ", structure) + 2;
    EXPECT_EQ(text.compare(member, 5, "@key "), 0) << text.substr(structure, member - structure);
    ++topics;
  }
  EXPECT_GE(topics, EnumNames<Topic>::kNames.size())
      << "each topic's structure is announced by a comment \"Topic <name>\"";
}

TEST(Idl, EnumsHaveTheNamesAndTheOrderOfTheirCppOnes) {
  const std::string text = idl_text();
  expect_in_idl<ChannelState>(text, "ChannelState");
  expect_in_idl<BlockBoundary>(text, "BlockBoundary");
  expect_in_idl<PhaseKind>(text, "PhaseKind");
  expect_in_idl<AlertRegion>(text, "AlertRegion");
  expect_in_idl<PstVerdict>(text, "PstVerdict");
  expect_in_idl<Reference>(text, "Reference");
  expect_in_idl<FaultKind>(text, "FaultKind");
  expect_in_idl<ForecastState>(text, "ForecastState");
  expect_in_idl<AdvisoryPriority>(text, "AdvisoryPriority");
  expect_in_idl<AdvisoryAction>(text, "AdvisoryAction");
  expect_in_idl<AdvisoryState>(text, "AdvisoryState");
}

TEST(Idl, EverythingIsAppendableSoThatItMayGrow) {
  const std::string text = idl_text();
  const std::string appendable = "@appendable ";
  for (const std::string keyword : {"struct ", "enum "}) {
    int count = 0;
    for (auto found = text.find(keyword); found != std::string::npos; found = text.find(keyword, found + 1)) {
      const std::string declaration = text.substr(found, 60);
      if (declaration.find('{') == std::string::npos) continue;  // the word in a comment
      ++count;
      EXPECT_TRUE(text.substr(0, found).ends_with(appendable)) << declaration;
    }
    EXPECT_GT(count, 10) << keyword;
  }
}

}  // namespace
}  // namespace sealwatch::test
