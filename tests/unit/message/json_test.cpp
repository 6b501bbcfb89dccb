#include "services/common/message/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "sealwatch/core/json_depth.hpp"
#include "services/common/message/own_json.hpp"
#include "tests/unit/message/fill.hpp"

namespace sealwatch {
namespace {

template <class T>
class EveryTopic : public ::testing::Test {};

using Topics = ::testing::Types<RawSamples, SampleBlock, TestWindow, TestFeatures, StateReport, HealthReport,
                                LeakageEstimate, RemainingLife, PstRequest, Advisory, Acknowledgement, MaintenanceEvent,
                                ModelDiscrepancy, ModelAcceptance>;
TYPED_TEST_SUITE(EveryTopic, Topics);

TYPED_TEST(EveryTopic, ComesBackFieldByFieldInBothForms) {
  for (const std::size_t length : {0U, 1U, 2U, 5U}) {
    const Message message = testing::filled<TypeParam>(length);
    for (const JsonForm form : {JsonForm::readable, JsonForm::exact}) {
      const Result<Message> back = message_from_json(topic_of(message), to_json(message, form));
      ASSERT_TRUE(back.has_value()) << back.error().describe();
      EXPECT_EQ(*back, message) << to_json(message);
    }
  }
}

/// Blanks and members in another order are read by way of a document tree, which what we wrote is not.
TYPED_TEST(EveryTopic, IsReadAlikeWithAndWithoutADocumentTree) {
  for (const std::size_t length : {0U, 1U, 3U}) {
    const Message message = testing::filled<TypeParam>(length);
    for (const JsonForm form : {JsonForm::readable, JsonForm::exact}) {
      const std::string text = to_json(message, form);
      TypeParam direct;
      ASSERT_TRUE(OwnJson(text).is_read_into(direct)) << text;
      EXPECT_EQ(Message(direct), message);
      EXPECT_FALSE(OwnJson(text + " ").is_read_into(direct));
      EXPECT_EQ(message_from_json(topic_of(message), text + " ").value(), message);
    }
  }
}

TEST(Json, TopicNamesFollowTheAlternatives) {
  EXPECT_EQ(EnumNames<Topic>::kNames.size(), std::variant_size_v<MessageAlternatives>);
  EXPECT_EQ(name_of(topic_of(Message(Advisory{}))), "advisory");
  EXPECT_EQ(name_of(topic_of(Message(MaintenanceEvent{}))), "maintenance_event");
}

TEST(Json, ExactFormKeepsEveryBit) {
  RawSamples block;
  block.samples.time_s = {0.1, -0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(),
                          std::numeric_limits<double>::infinity()};
  const Message back = message_from_json(Topic::raw_samples, to_json(Message(block), JsonForm::exact)).value();
  const std::vector<double>& time = std::get<RawSamples>(back).samples.time_s;
  ASSERT_EQ(time.size(), 5U);
  EXPECT_EQ(std::memcmp(time.data(), block.samples.time_s.data(), 5 * sizeof(double)), 0);
}

TEST(Json, ReadableFormShowsEnumsByNameAndNanAsNull) {
  HealthReport report;
  report.health_grade = std::nan("");
  report.ambiguity_group.push_back({.kind = FaultKind::pump,
                                    .element = "pump",
                                    .likelihood = 0.5,
                                    .iso14224_code = {},
                                    .iso14224_mechanism = {},
                                    .evidence = {}});
  const std::string text = to_json(Message(report));
  EXPECT_NE(text.find("\"health_grade\":null"), std::string::npos) << text;
  EXPECT_NE(text.find("\"kind\":\"pump\""), std::string::npos) << text;
}

TEST(Json, EscapesWhatMustBeAndReplacesWhatIsNoText) {
  Acknowledgement message;
  for (const std::string& text : {std::string("plain"), std::string("say \"no\"\\\n\t"), std::string("\x01\x7f"),
                                  std::string("m\u00b3, \u03b8"), std::string("a\0b", 3)}) {
    message.remark = text;
    const Message back = message_from_json(Topic::acknowledgement, to_json(Message(message))).value();
    EXPECT_EQ(std::get<Acknowledgement>(back).remark, text);
  }
  message.remark = "cut\xc3";
  const Message back = message_from_json(Topic::acknowledgement, to_json(Message(message))).value();
  EXPECT_EQ(std::get<Acknowledgement>(back).remark, "cut\ufffd");
}

TEST(Json, PassesOverUnknownFieldsAndKeepsDefaultsOfAbsentOnes) {
  const Message message =
      message_from_json(Topic::health_report, R"({"asset_id": "A", "a_later_field": [1, 2]})").value();
  EXPECT_EQ(std::get<HealthReport>(message).asset_id, "A");
  EXPECT_EQ(std::get<HealthReport>(message).no_fault_likelihood, HealthReport{}.no_fault_likelihood);
}

TEST(Json, AWholeNumberThatDoesNotFitIsNamedAndNotCutDown) {
  const auto read = [](const std::string& number) {
    return message_from_json(Topic::raw_samples, R"({"start_time_ns": )" + number + "}");
  };
  for (const char* wild : {"1.9e19", "-1e300", "9223372036854775808", "1.5", "1e400", "9007199254740993.0e1"}) {
    const auto message = read(wild);
    EXPECT_FALSE(message.has_value()) << wild;
  }
  EXPECT_FALSE(message_from_json(Topic::raw_samples, R"({"block_number": -1})").has_value());
  EXPECT_FALSE(message_from_json(Topic::model_acceptance, R"({"version": 2147483648})").has_value());
  EXPECT_EQ(std::get<RawSamples>(read("-9223372036854775808").value()).start_time_ns,
            std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(std::get<RawSamples>(read("3.0").value()).start_time_ns, 3);
}

/// A document of a million levels ended the process that read it, or wrote it again.
TEST(Json, WhatIsNestedTooDeeplyIsNotRead) {
  const auto nested = [](std::size_t levels, const std::string& open, const std::string& close) {
    std::string text = R"({"unknown": )";
    for (std::size_t k = 0; k < levels; ++k) text += open;
    text += "1";
    for (std::size_t k = 0; k < levels; ++k) text += close;
    return text + "}";
  };
  for (const auto& [open, close] : {std::pair("[", "]"), std::pair(R"({"a":)", "}")}) {
    EXPECT_TRUE(message_from_json(Topic::raw_samples, nested(kDeepestJson - 1, open, close)));
    for (const std::size_t levels : {kDeepestJson, std::size_t{2'000'000}}) {
      const auto read = message_from_json(Topic::raw_samples, nested(levels, open, close));
      ASSERT_FALSE(read);
      EXPECT_NE(read.error().describe().find("is nested deeper than 64 levels"), std::string::npos);
      EXPECT_FALSE(alarm_from_json(nested(levels, open, close)));
    }
  }
  const std::string brackets(100, '[');
  EXPECT_TRUE(message_from_json(Topic::raw_samples, R"({"asset_id": "\"{)" + brackets + R"(\\"})")) << "in a string";
}

/// Each text is read by way of a document tree too, as a blank stands behind it: to the same, or to none.
TEST(Json, OwnReaderReadsNothingThatIsNoJson) {
  const auto same = [](const std::string& member) {
    const std::string text = "{" + member + "}";
    const auto read = message_from_json(Topic::leakage_estimate, text);
    const auto by_tree = message_from_json(Topic::leakage_estimate, text + " ");
    EXPECT_EQ(read.has_value(), by_tree.has_value()) << text;
    if (read && by_tree) {
      EXPECT_EQ(to_json(*read, JsonForm::exact), to_json(*by_tree, JsonForm::exact)) << text;
    }
  };
  for (const char* number : {"0",
                             "-0",
                             "-0.0",
                             "01",
                             "1.",
                             ".5",
                             "1.e5",
                             "1e5",
                             "1E5",
                             "1e",
                             "1e+5",
                             "1e-400",
                             "1e400",
                             "-",
                             "+1",
                             "0x1",
                             "18446744073709551615",
                             "18446744073709551616",
                             "-9223372036854775809",
                             "0.1000000000000000055511151231257827021181583404541015625",
                             "4.9e-324",
                             "NaN",
                             "inf",
                             "null",
                             "\"nan\"",
                             "\"inf\"",
                             "\"-inf\"",
                             "\"NaN\"",
                             "true",
                             "1 "})
    for (const char* field : {"\"resistance_Pa_s_m3\"", "\"header\":{\"stream_sequence\""})
      same(std::string(field) + ":" + number + (field[1] == 'h' ? "}" : ""));
  for (const char* string : {"\"a", "a\"", "\"\\\"\"", "\"\\", "\"\\u00e9\"", "\"\\u00\"", "\"\xc3\xa9\"", "\"\xc3\"",
                             "\"\x01\"", "\"\x7f\"", "\"\\x\"", "\"\"\"", "1", "null"})
    same(std::string("\"asset_id\":") + string);
  for (const char* object :
       {"", ",", "\"asset_id\":\"a\",", ",\"asset_id\":\"a\"", "\"asset_id\":\"a\",\"asset_id\":\"b\"",
        "\"asset_id\":\"a\",\"header\":{}", "\"unknown\":1", "\"header\":{}}", "\"header\":{",
        "\"header\":{\"source_ids\":[]}", "\"header\":{\"source_ids\":[,]}", "\"header\":{\"source_ids\":[\"a\",]}",
        "\"header\":{\"source_ids\":[\"a\"}", "\"header\":{\"clock_quality\":\"synchronised\"}",
        "\"header\":{\"clock_quality\":\"good\"}", "\"header\":{\"replay\":true}", "\"header\":{\"replay\":tru}"})
    same(object);
}

TEST(Json, OwnReaderReadsTextsOfPeople) {
  Acknowledgement message;
  for (const std::string& text :
       {std::string("say \"no\"\\\n\t"), std::string("m\u00b3, \u03b8"), std::string("a\0b", 3)}) {
    message.remark = text;
    Acknowledgement read;
    ASSERT_TRUE(OwnJson(to_json(Message(message))).is_read_into(read));
    EXPECT_EQ(read.remark, text);
  }
}

TEST(Json, NamesTheFieldThatIsWrong) {
  const auto refusal = [](std::string_view text) {
    return message_from_json(Topic::state_report, text).error().describe();
  };
  EXPECT_EQ(refusal("{"), "message of topic state_report: is not JSON");
  EXPECT_EQ(refusal(R"({"judgements": [{"value": "high"}]})"),
            "message of topic state_report: judgements[0].value: must be a number");
  EXPECT_EQ(refusal(R"({"verdict": "splendid"})"),
            "message of topic state_report: verdict: must be one of the enumeration's names");
  EXPECT_EQ(refusal(R"({"header": {"replay": 3}})"),
            "message of topic state_report: header.replay: has the wrong type");
  EXPECT_EQ(refusal(R"({"residuals": {}})"), "message of topic state_report: residuals: must be an array");
}

}  // namespace
}  // namespace sealwatch
