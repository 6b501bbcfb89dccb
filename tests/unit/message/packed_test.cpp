#include "services/common/message/packed.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sealwatch/message/blank.hpp"
#include "services/common/message/base64.hpp"
#include "services/common/message/json.hpp"
#include "tests/unit/message/fill.hpp"

namespace sealwatch {

SEALWATCH_ENUM(Colour, red, green)
SEALWATCH_ENUM(Color, green, red)

namespace {

std::string packed(const std::vector<Message>& messages) {
  std::string bytes;
  LastOfTopics last;
  for (const Message& message : messages) pack(message, last, bytes);
  return bytes;
}

constexpr std::size_t kMost = 100;

/// As many as can be read.
std::vector<Message> unpacked(const std::string& bytes) {
  std::vector<Message> messages;
  messages.reserve(kMost);  // they are pointed at
  LastOfTopics last(std::variant_size_v<MessageAlternatives>);
  for (Unpacker unpacker(bytes); !unpacker.is_at_end() && messages.size() < kMost;) {
    auto message = unpack(unpacker, last);
    if (!message) break;
    messages.push_back(std::move(*message));
    last[messages.back().index()] = &messages.back();
  }
  return messages;
}

std::vector<std::string> exactly(const std::vector<Message>& messages) {
  std::vector<std::string> texts;
  for (const Message& message : messages) texts.push_back(to_json(message, JsonForm::exact));
  return texts;
}

/// Of each topic a few that differ in all, in much, in little and in nothing, mixed.
std::vector<Message> one_of_each_and_more() {
  std::vector<Message> messages;
  for (const std::size_t length : {2U, 3U, 0U, 0U, 1U})
    for (std::size_t topic = 0; topic < std::variant_size_v<MessageAlternatives>; ++topic) {
      Message message = blank_message(static_cast<Topic>(topic));
      std::visit([&](auto& content) { content = testing::filled<std::decay_t<decltype(content)>>(length); }, message);
      messages.push_back(std::move(message));
    }
  return messages;
}

TEST(Packed, EveryTopicComesBack) {
  const std::vector<Message> messages = one_of_each_and_more();
  EXPECT_EQ(exactly(unpacked(packed(messages))), exactly(messages));
}

TEST(Packed, EveryBitOfANumberDoes) {
  std::vector<Message> messages;
  for (const double value : {-0.0, 0.0, std::numeric_limits<double>::quiet_NaN(), 1.0 / 3.0, -1.0 / 3.0,
                             std::numeric_limits<double>::infinity(), std::numeric_limits<double>::denorm_min()})
    for (const std::int64_t time :
         {std::int64_t{0}, std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
      StateReport report;
      report.overdue_days = value;
      report.header.event_time_ns = time;
      report.header.stream_sequence = static_cast<std::uint64_t>(time);
      report.header.schema_version = static_cast<std::int32_t>(time);
      messages.emplace_back(report);
    }
  const std::vector<Message> back = unpacked(packed(messages));
  ASSERT_EQ(back.size(), messages.size());
  for (std::size_t k = 0; k < back.size(); ++k)
    EXPECT_TRUE(is_same_in_bits(std::get<StateReport>(back[k]), std::get<StateReport>(messages[k]))) << k;
}

TEST(Packed, ARowOfLikeReportsTakesLittle) {
  std::vector<Message> reports;
  std::size_t json = 0;
  for (int test = 0; test < 100; ++test) {
    auto report = testing::filled<StateReport>(20);
    for (RegionJudgement& judgement : report.judgements) judgement.value += test;
    reports.emplace_back(std::move(report));
    json += to_json(reports.back(), JsonForm::exact).size();
  }
  EXPECT_LT(packed(reports).size(), json / 10);
}

/// A bit may be turned that no checksum tells of.
TEST(Packed, WhateverBytesComeItEnds) {
  const std::string whole = packed(one_of_each_and_more());
  for (std::size_t size = 0; size < whole.size(); size += 7)
    EXPECT_LT(unpacked(whole.substr(0, size)).size(), unpacked(whole).size());
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 61) {
    std::string turned = whole;
    turned[bit / 8] = static_cast<char>(turned[bit / 8] ^ 1 << bit % 8);
    (void)unpacked(turned);
  }
  EXPECT_TRUE(unpacked(std::string(20, '\xFF')).empty());
}

struct One {
  double x = 0.0;
  std::vector<std::string> names;
  Colour colour = Colour::red;
  SEALWATCH_FIELDS(One, x, names, colour)
};
struct Renamed {
  double y = 0.0;
  std::vector<std::string> names;
  Colour colour = Colour::red;
  SEALWATCH_FIELDS(Renamed, y, names, colour)
};
struct Swapped {
  std::vector<std::string> names;
  double x = 0.0;
  Colour colour = Colour::red;
  SEALWATCH_FIELDS(Swapped, names, x, colour)
};
struct OtherKind {
  float x = 0.0;
  std::vector<std::string> names;
  Colour colour = Colour::red;
  SEALWATCH_FIELDS(OtherKind, x, names, colour)
};
struct OtherValues {
  double x = 0.0;
  std::vector<std::string> names;
  Color colour = Color::red;
  SEALWATCH_FIELDS(OtherValues, x, names, colour)
};
struct Longer {
  double x = 0.0;
  std::vector<std::string> names;
  Colour colour = Colour::red;
  bool more = false;
  SEALWATCH_FIELDS(Longer, x, names, colour, more)
};

template <class T>
std::string layout() {
  std::string text;
  describe_layout<T>(text);
  return text.substr(text.find('{'));  // the name of the type tells them apart as well
}

TEST(Packed, AnotherLayoutHasAnotherName) {
  EXPECT_EQ(packed_layout().size(), 16U);
  EXPECT_NE(layout<One>(), layout<Renamed>());
  EXPECT_NE(layout<One>(), layout<Swapped>());
  EXPECT_NE(layout<One>(), layout<OtherKind>());
  EXPECT_NE(layout<One>(), layout<OtherValues>());
  EXPECT_NE(layout<One>(), layout<Longer>());
}

TEST(Packed, BytesComeBackFromText) {
  for (const std::string& bytes : {std::string(), std::string("\0", 1), std::string("a\xFF"), std::string("abc"),
                                   std::string(256, '\x80') + "\n"}) {
    std::string text, back;
    append_base64(bytes, text);
    EXPECT_TRUE(from_base64(text, back)) << text;
    EXPECT_EQ(back, bytes);
  }
  std::string back;
  EXPECT_FALSE(from_base64("a\nbc", back));
}

}  // namespace
}  // namespace sealwatch
