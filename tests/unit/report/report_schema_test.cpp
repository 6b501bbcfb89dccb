// docs/reference/report.schema.json describes what the writer writes: every key, its type, none too many. The part of JSON
// Schema that the file uses is checked here: type, const, enum, properties, required, items, anyOf, $ref.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/common/report/explanation_json.hpp"
#include "tests/unit/report/example.hpp"

namespace sealwatch::report {
namespace {

using SchemaJson = nlohmann::json;

class Schema {
 public:
  explicit Schema(SchemaJson root) : root_(std::move(root)) {}

  /// What is wrong with the value, each fault a line; "" nothing.
  std::string faults_of(const SchemaJson& value) const { return faults(root_, value, "report"); }

 private:
  std::string faults(const SchemaJson& given, const SchemaJson& value, const std::string& place) const {
    const SchemaJson& schema =
        given.contains("$ref") ? root_.at(SchemaJson::json_pointer(given["$ref"].get<std::string>().substr(1))) : given;
    if (schema.contains("const")) return value == schema["const"] ? "" : place + " is another constant\n";
    if (schema.contains("enum"))
      return std::ranges::count(schema["enum"], value) > 0 ? "" : place + " is none of its values\n";
    if (schema.contains("anyOf")) {
      const bool fits = std::ranges::any_of(schema["anyOf"],
                                            [&](const SchemaJson& one) { return faults(one, value, place).empty(); });
      return fits ? "" : place + " is none of what it may be\n";
    }
    if (!has_type(schema.at("type"), value)) return place + " is " + value.type_name() + "\n";
    return value.is_object() ? faults_of_keys(schema, value, place) : faults_of_items(schema, value, place);
  }

  static bool has_type(const SchemaJson& type, const SchemaJson& value) {
    if (type.is_array()) return std::ranges::any_of(type, [&](const SchemaJson& one) { return has_type(one, value); });
    return type == value.type_name() || (type == "integer" && value.is_number_integer());
  }

  std::string faults_of_items(const SchemaJson& schema, const SchemaJson& value, const std::string& place) const {
    std::string text;
    for (std::size_t k = 0; value.is_array() && k < value.size(); ++k)
      text += faults(schema.at("items"), value[k], place + "[" + std::to_string(k) + "]");
    return text;
  }

  std::string faults_of_keys(const SchemaJson& schema, const SchemaJson& value, const std::string& place) const {
    std::string text;
    for (const auto& [key, member] : value.items()) {
      const SchemaJson* described = nullptr;
      if (schema.contains("properties") && schema["properties"].contains(key)) described = &schema["properties"][key];
      if (described == nullptr && schema.contains("additionalProperties")) described = &schema["additionalProperties"];
      text += described == nullptr ? place + "." + key + " is not described\n"
                                   : faults(*described, member, place + "." + key);
    }
    for (const SchemaJson& key : schema.value("required", SchemaJson::array()))
      if (!value.contains(key.get<std::string>())) text += place + "." + key.get<std::string>() + " is missing\n";
    return text;
  }

  SchemaJson root_;
};

Schema published() {
  std::ifstream file(SEALWATCH_SOURCE_DIR "/docs/reference/report.schema.json");
  return Schema(SchemaJson::parse(file));
}

mismatch::Explanation with_everything() {
  mismatch::Explanation explanation = example_explanation();
  explanation.asset_values = {
      {{.name = "A_C", .unit = "m2", .in_asset_file = 5.89e-3, .fitted = 6e-3, .std_error = 1e-6}}};
  explanation.beside_asset_values = {{"backlash", "", "piston", "", ""}};
  explanation.candidates = {{.what = {"backlash", "", "piston", "", ""}, .share = 0.2, .probability = 0.5}};
  explanation.trace = {{.laws = {{"backlash", "", "piston", "", ""}}, .values = {"A_C"}, .score = 3.0}};
  return explanation;
}

TEST(ReportSchema, DescribesWhatIsWritten) {
  const Schema schema = published();
  for (const mismatch::Explanation& explanation : {example_explanation(), consistent_example(), with_everything()})
    EXPECT_EQ(schema.faults_of(SchemaJson::parse(explanation_to_json(explanation))), "");
}

TEST(ReportSchema, SeesAKeyTooManyOneTooFewAndAnotherType) {
  const Schema schema = published();
  SchemaJson report = SchemaJson::parse(explanation_to_json(example_explanation()));
  report["physics"][0]["surprise"] = 1;
  report["physics"][0]["parameters"][0]["value"] = "4010";
  report.erase("power");
  EXPECT_EQ(schema.faults_of(report),
            "report.physics[0].parameters[0].value is string\nreport.physics[0].surprise is not described\n"
            "report.power is missing\n");
}

}  // namespace
}  // namespace sealwatch::report
