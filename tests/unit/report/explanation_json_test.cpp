#include "services/common/report/explanation_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/unit/report/example.hpp"
#include "tests/unit/report/explanation_json_reader.hpp"

namespace sealwatch::report {
namespace {

using Json = nlohmann::ordered_json;

Json written(const mismatch::Explanation& explanation) { return Json::parse(explanation_to_json(explanation)); }

// The keys and kinds of the fixed schema, docs/reference/report.schema.json.
TEST(ReportJson, KeepsTheFixedSchema) {
  const Json json = written(example_explanation());
  EXPECT_EQ(json["schema"], "sealwatch.mismatch/1");
  EXPECT_EQ(json["asset_id"], "XT03-MV2");
  EXPECT_EQ(json["recordings"], (Json{{"fit", {"fit_0", "fit_1"}}, {"holdout", {"holdout_0"}}}));
  EXPECT_EQ(json["verdict"], "mismatch");
  EXPECT_TRUE(json["p_value"].is_number());
  EXPECT_DOUBLE_EQ(json["p_value"], 1e-9);

  const Json& location = json["location"][0];
  EXPECT_EQ(location["element"], "piston");
  EXPECT_DOUBLE_EQ(location["probability"], 0.98);
  EXPECT_TRUE(location["indistinguishable_from"].is_array());
  EXPECT_TRUE(location["evidence"].is_string());
  EXPECT_EQ(json["location"][1]["indistinguishable_from"], Json::array({"chamber_a"}));

  const Json& physics = json["physics"][0];
  EXPECT_EQ(json["physics"].size(), 1U);
  EXPECT_EQ(physics["id"], "stribeck_friction");
  EXPECT_EQ(physics["element"], "piston");
  EXPECT_EQ(physics["law"], "(F_c + F_x exp(-(v / v_st)^2)) tanh(v / v_s)");
  EXPECT_DOUBLE_EQ(physics["probability"], 0.97);
  EXPECT_DOUBLE_EQ(physics["delta_bic"], -812.0);
  EXPECT_EQ(physics["indistinguishable_from"], Json::array({"coulomb_friction"}));
  EXPECT_EQ(physics["parameters"][0]["name"], "F_c");
  EXPECT_DOUBLE_EQ(physics["parameters"][0]["value"], 4010.0);
  EXPECT_DOUBLE_EQ(physics["parameters"][0]["std_error"], 60.0);
  EXPECT_EQ(physics["parameters"][0]["unit"], "N");
  EXPECT_TRUE(physics["parameters"][2]["std_error"].is_null());  // infinite: the data cannot tell

  for (const char* set : {"fit", "holdout"}) {
    EXPECT_DOUBLE_EQ(json["fit"][set]["before"]["noise_normalised_rms"]["pressure_a"], 71.0);
    EXPECT_DOUBLE_EQ(json["fit"][set]["after"]["noise_normalised_rms"]["pressure_a"], 1.02);
    EXPECT_DOUBLE_EQ(json["fit"][set]["before"]["nrmse_percent"]["pressure_a"], 31.4);
    EXPECT_DOUBLE_EQ(json["fit"][set]["after"]["nrmse_percent"]["pressure_a"], 98.2);
  }
  EXPECT_DOUBLE_EQ(json["parameters"]["before"]["R_CL"], 1.9e13);
  EXPECT_DOUBLE_EQ(json["parameters"]["after"]["R_CL"], 2.58e13);

  EXPECT_EQ(json["power"][0]["id"], "coulomb_friction");
  EXPECT_DOUBLE_EQ(json["power"][0]["minimum_detectable"], 55.0);
  EXPECT_EQ(json["power"][0]["unit"], "N");
  EXPECT_DOUBLE_EQ(json["power"][0]["absorbed_share"], 0.61);
  EXPECT_TRUE(json["power"][2]["minimum_detectable"].is_null());
  EXPECT_FALSE(json["next_test"].get<std::string>().empty());
  EXPECT_FALSE(json["summary"].get<std::string>().empty());
}

TEST(ReportJson, ConsistentHasNoPhysics) {
  const Json json = written(consistent_example());
  EXPECT_EQ(json["verdict"], "consistent");
  EXPECT_EQ(json["physics"], Json::array());
  EXPECT_EQ(json["location"], Json::array());
  EXPECT_EQ(json["next_test"], "");
  EXPECT_TRUE(json["prognosis"].is_null());
  EXPECT_EQ(json["fit"]["holdout"]["before"]["nrmse_percent"], Json::object());
}

TEST(ReportJson, OtherElementsWithTheSameLawAreNoOtherId) {
  mismatch::Explanation explanation = consistent_example();
  mismatch::FoundEffect effect;
  effect.what = {.id = "sensor_bias", .form = "", .element = "sensor:pressure_a", .law = "b", .meaning = ""};
  effect.indistinguishable = {{"sensor_bias", "", "sensor:pressure_b", "b", ""},
                              {"coulomb_friction", "", "piston", "", ""},
                              {"coulomb_friction", "", "piston", "", ""}};
  explanation.effects.push_back(effect);
  const Json json = written(explanation);
  EXPECT_EQ(json["physics"][0]["indistinguishable_from"], Json::array({"coulomb_friction"}));
  EXPECT_EQ(json["physics"][0]["indistinguishable_laws"].size(), 3U);
}

TEST(ReportJson, ReadsBackWhatItWrote) {
  mismatch::Explanation blamed = consistent_example();
  blamed.asset_values = {{{.name = "A_C", .unit = "m2", .in_asset_file = 5.89e-3, .fitted = 6e-3, .std_error = 1e-6},
                          {.name = "T_M", .unit = "N m/A", .in_asset_file = 0.2, .fitted = 0.21, .std_error = 1e-3}},
                         {{.name = "V_0", .unit = "m3", .in_asset_file = 5e-5, .fitted = 6e-5, .std_error = 1e-7}}};
  for (const mismatch::Explanation& explanation : {example_explanation(), consistent_example(), blamed}) {
    const std::string text = explanation_to_json(explanation);
    const auto read = explanation_from_json(text);
    ASSERT_TRUE(read) << read.error().describe();
    EXPECT_EQ(explanation_to_json(*read), text);
    EXPECT_EQ(read->missing.size(), explanation.missing.size());
  }
  const auto read = explanation_from_json(explanation_to_json(example_explanation()));
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::isnan(read->effects[0].parameters[2].std_error));
  EXPECT_EQ(read->rejected[0].why, "fits better only with oil flowing from low to high pressure");
}

TEST(ReportJson, ASizeThatIsNotKnownIsNull) {
  mismatch::Explanation explanation = example_explanation();
  explanation.effects[0].engineering_share = std::numeric_limits<double>::quiet_NaN();
  explanation.parameters[0].after_at_bound = true;
  const Json json = written(explanation);
  EXPECT_TRUE(json["physics"][0]["engineering_share"].is_null());
  EXPECT_EQ(json["parameter_details"][0]["after_at_bound"], true);
  EXPECT_EQ(json["parameter_details"][1]["after_at_bound"], false);
}

TEST(ReportJson, LongTermsAreThinned) {
  mismatch::Explanation explanation = consistent_example();
  mismatch::MissingTerm term;
  term.time_s.assign(100000, 1.0);
  term.law.assign(999, 2.0);
  explanation.missing.push_back(term);
  const Json json = written(explanation);
  EXPECT_LE(json["missing"][0]["time_s"].size(), 1000U);
  EXPECT_EQ(json["missing"][0]["law"].size(), 999U);
}

TEST(ReportJson, TextThatIsNotUtf8IsWritten) {
  mismatch::Explanation explanation = consistent_example();
  explanation.asset_id = "caf\xe9";
  EXPECT_EQ(written(explanation)["asset_id"], "caf\uFFFD");
}

}  // namespace
}  // namespace sealwatch::report
