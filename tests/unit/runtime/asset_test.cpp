// Asset files (docs/asset-file.md): defaults from the plant table, every fault named, write and read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AssetConfig load(const std::string& yaml) {
  const YamlPlace place;
  auto asset = load_asset(place.write("a.yaml", yaml));
  EXPECT_TRUE(asset.has_value()) << asset.error().describe();
  return asset ? *asset : AssetConfig();
}

struct BadCase {
  const char* name;
  const char* yaml;
  const char* message;
};

class BadAsset : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadAsset, IsNamed) {
  const YamlPlace place;
  const auto asset = check_asset(place.write("a.yaml", GetParam().yaml));
  ASSERT_FALSE(asset.has_value());
  std::vector<std::string> found;
  for (const Error& error : asset.error()) found.push_back(place.bare(error.describe()));
  EXPECT_THAT(found, ElementsAre(GetParam().message));
}

const BadCase kBadCases[] = {
    {"no_id", "site: x\n", "a.yaml: key asset_id: must be given"},
    {"empty_id", "asset_id: \"\"\n", "a.yaml: line 1, key asset_id: must not be empty"},
    {"control_characters", "asset_id: \"A\\nB\"\n",
     "a.yaml: line 1, key asset_id: 'A\\x0AB': must not have line breaks, other control characters or invisible ones"},
    {"invisible", "asset_id: A\u200b\n",
     "a.yaml: line 1, key asset_id: 'A\\xE2\\x80\\x8B': must be UTF-8 without control characters or invisible ones; "
     "save the file as UTF-8"},
    {"blank_behind_the_id", "asset_id: \"XT03 \"\n",
     "a.yaml: line 1, key asset_id: 'XT03 ': must not begin or end with a blank, which nobody sees"},
    {"id_like_an_option", "asset_id: --help\n",
     "a.yaml: line 1, key asset_id: '--help': must not begin with '-': commands would take it for an option"},
    {"id_like_no_asset", "asset_id: \"-\"\n",
     "a.yaml: line 1, key asset_id: '-': must not begin with '-': commands would take it for an option"},
    {"id_beyond_all_bounds",
     "asset_id: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaabbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbc\n",
     "a.yaml: line 1, key asset_id: "
     "'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaabbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbc': "
     "must not be longer than 80 bytes"},
    {"id_that_is_no_text", "asset_id: [A]\n", "a.yaml: line 1, key asset_id: must be a text"},
    {"latin_1", "asset_id: A\nsegment: s\xE4te\n",
     "a.yaml: line 2, key segment: 's\\xE4te': must be UTF-8 without control characters or invisible ones; save the "
     "file as UTF-8"},
    {"for_a_terminal", "asset_id: A\nsegment: \"\\e[2Jgate\"\n",
     "a.yaml: line 2, key segment: '\\x1B[2Jgate': must be UTF-8 without control characters or invisible ones; save "
     "the "
     "file as UTF-8"},
    {"model", "asset_id: A\nmodel: eah\n", "a.yaml: line 2, key model: 'eah': is not known; did you mean 'eha'?"},
    {"unknown_key", "asset_id: A\nsegmnet: x\n",
     "a.yaml: line 2, key segmnet: 'segmnet': is not a known key; did you mean 'segment'?"},
    {"a_plant", "name: shaft\nmeaning: a shaft\noutputs: {w: {value: w, unit: rad/s}}\n",
     "a.yaml: line 3, key outputs: stands in the file of a plant, not in that of an asset; keep plants in a folder of "
     "their own and name one from the asset, as model: ../plants/FILE.yaml"},
    {"unknown_parameter", "asset_id: A\nparameters:\n  R_CL: 2.0e13\n  betta: 1\n",
     "a.yaml: line 4, key parameters.betta: 'betta': is not a known key; did you mean 'beta'?"},
    {"unknown_key_of_parameter", "asset_id: A\nparameters: {R_CL: {value: 2.0e13, mim: 1}}\n",
     "a.yaml: line 2, key parameters.R_CL.mim: 'mim': is not a known key; did you mean 'min'?"},
    {"text_in_number", "asset_id: A\nparameters: {R_CL: 2.6e13x}\n",
     "a.yaml: line 2, key parameters.R_CL: '2.6e13x': must be a number above 0"},
    {"infinite", "asset_id: A\nparameters: {p_ambient: .inf}\n",
     "a.yaml: line 2, key parameters.p_ambient: '.inf': must be a number"},
    {"below_min", "asset_id: A\nparameters: {R_CL: {value: 1.0e12, min: 2.0e12, max: 3.0e13}}\n",
     "a.yaml: line 2, key parameters.R_CL.value: '1e+12': must lie between min and max, 2e+12 and 3e+13"},
    {"tolerance_as_a_share", "asset_id: A\nparameters: {alpha_P: {value: 4.0e-8, tolerance: 5.0e-4}}\n",
     "a.yaml: line 2, key parameters.alpha_P.tolerance: '0.0005': must not be above the value, 4e-08 m3/rad, in whose "
     "unit it is one standard deviation; a share of 0.0005 is written 2e-11"},
    {"min_above_max", "asset_id: A\nparameters: {R_CL: {min: 3.0e13, max: 2.0e13}}\n",
     "a.yaml: line 2, key parameters.R_CL.min: '3e+13': min must not be above max, which are 3e+13 and 2e+13"},
    {"unknown_channel", "asset_id: A\nsensors: {presure_a: {noise_std: 1}}\n",
     "a.yaml: line 2, key sensors.presure_a: 'presure_a': is not a known key; did you mean 'pressure_a'?"},
    {"unknown_channel_by_key", "asset_id: A\nsensors: {noise_std: {presure_a: 1}}\n",
     "a.yaml: line 2, key sensors.noise_std.presure_a: 'presure_a': is not a known key; did you mean 'pressure_a'?"},
    {"negative_noise", "asset_id: A\nsensors: {flow: {noise_std: -1}}\n",
     "a.yaml: line 2, key sensors.flow.noise_std: '-1': must be a number above 0, from 1e-100 to 1e100"},
    {"huge_noise", "asset_id: A\nsensors: {flow: {noise_std: 1e308}}\n",
     "a.yaml: line 2, key sensors.flow.noise_std: '1e308': must be a number above 0, from 1e-100 to 1e100"},
    {"no_noise_to_speak_of", "asset_id: A\nsensors: {motor_voltage: {noise_std: 1e-320}}\n",
     "a.yaml: line 2, key sensors.motor_voltage.noise_std: '1e-320': must be 0 or a number from 1e-100 to 1e100"},
    {"no_noise", "asset_id: A\nsensors:\n  noise_std: {flow: 0}\n",
     "a.yaml: line 3, key sensors.noise_std.flow: '0': must be a number above 0, from 1e-100 to 1e100"},
    {"gain", "asset_id: A\nsensors: {flow: {gain_error: -1}}\n",
     "a.yaml: line 2, key sensors.flow.gain_error: '-1': must be a number above -1"},
    {"range", "asset_id: A\nsensors: {flow: {range: [2, 1]}}\n",
     "a.yaml: line 2, key sensors.flow.range: must be two numbers, the lower one first: [min, max]"},
    {"seal", "asset_id: A\nseal: {resistance_100: 1.0e12}\n",
     "a.yaml: line 2, key seal.resistance_60: '4.64e+12': must be below resistance_100, 1e+12: a worn seal leaks more"},
    {"threshold", "asset_id: A\nseal: {threshold: 60}\n",
     "a.yaml: line 2, key seal.threshold: '60': must be a number between 0 and 1"},
    {"no_stroke", "asset_id: A\npst: {stroke: 0}\n",
     "a.yaml: line 2, key pst.stroke: '0': must not be 0: a test has to move the stem"},
    {"beyond_stroke", "asset_id: A\npst: {start: 0.07, stroke: 0.02}\n",
     "a.yaml: line 2, key pst.stroke: '0.02': start + stroke is 0.09 m: must stay within the actuator's stroke, 0 to "
     "0.08 m"},
    {"speed", "asset_id: A\npst: {speed: 100}\n",
     "a.yaml: line 2, key pst.speed: '100': must be a speed from 1e-6 to 2 m/s"},
    {"no_speed", "asset_id: A\npst: {speed: 0}\n",
     "a.yaml: line 2, key pst.speed: '0': must be a speed from 1e-6 to 2 m/s"},
    {"stroke_in_millimetres", "asset_id: A\nmodel: emps\npst: {stroke: -16}\n",
     "a.yaml: line 3, key pst.stroke: '-16': must be a way from -2 to 2 m"},
    {"start_in_millimetres", "asset_id: A\nmodel: emps\npst: {start: 60}\n",
     "a.yaml: line 3, key pst.start: '60': must be a position from 0 to 2 m"},
    {"hold", "asset_id: A\npst: {hold: 1.0e4}\n",
     "a.yaml: line 2, key pst.hold: '1.0e4': must be a time from 0 to 3600 s"},
    {"interval", "asset_id: A\npst: {interval_months: 0.01}\n",
     "a.yaml: line 2, key pst.interval_months: '0.01': must be a number of months from 0.1 to 120"},
    {"physics_element",
     "asset_id: A\nphysics:\n  - {id: coulomb_friction, element: pisten, parameters: {F_c: 1, v_s: 1.0e-4}}\n",
     "a.yaml: line 3, key physics[0].element: 'pisten': is not known; did you mean 'piston'?"},
    {"physics_law", "asset_id: A\nphysics:\n  - {id: coulomb_fricton, element: piston, parameters: {F_c: 1}}\n",
     "a.yaml: line 3, key physics[0].id: 'coulomb_fricton': is not a law of the catalogue; did you mean "
     "'coulomb_friction'?"},
    {"physics_parameters", "asset_id: A\nphysics:\n  - {id: coulomb_friction, element: piston, parameters: {F: 1}}\n",
     "a.yaml: line 3, key physics[0].id: 'coulomb_friction': needs exactly the parameters F_c, v_s or F_c, v_s, m"},
    {"physics_without_parameters", "asset_id: A\nphysics:\n  - {id: hose_compliance, element: chamber_a}\n",
     "a.yaml: line 3, key physics[0].id: 'hose_compliance': needs exactly the parameters C_h or C_p, b_h or C_s, p_h"},
    {"physics_sign",
     "asset_id: A\nphysics:\n  - {id: external_leakage, element: chamber_a, parameters: {G: -4.0e-14}}\n",
     "a.yaml: line 3, key physics[0].parameters.G: '-4e-14': must stay within the law's bounds, 0 to 1e-10 m3/(s Pa)"},
    {"physics_bound",
     "asset_id: A\nphysics:\n  - {id: external_leakage, element: chamber_a,\n     parameters: {G: {value: 4.0e-14, "
     "min: "
     "0, max: 1}}}\n",
     "a.yaml: line 4, key physics[0].parameters.G: '1': must stay within the law's bounds, 0 to 1e-10 m3/(s Pa)"},
    {"physics_without_value",
     "asset_id: A\nphysics:\n  - {id: external_leakage, element: chamber_a, parameters: {G: {max: 1.0e-12}}}\n",
     "a.yaml: line 3, key physics[0].parameters.G: needs a value; write {value: ..., min: ..., max: ..., estimate: "
     "true}"},
    {"limits", "asset_id: A\nalert_limits: {hold_decay_rate: {advisory: 1, warning: 5, alarm: 3}}\n",
     "a.yaml: line 2, key alert_limits.hold_decay_rate.warning: '5': must lie between advisory and alarm, 1 and 3"},
    {"limit_missing", "asset_id: A\nalert_limits: {hold_decay_rate: {advisory: 1, warning: 5}}\n",
     "a.yaml: line 2, key alert_limits.hold_decay_rate.alarm: must be given"},
    {"limit_of_nothing", "asset_id: A\nalert_limits: {closing_tim: {advisory: 50, warning: 55, alarm: 60}}\n",
     "a.yaml: line 2, key alert_limits.closing_tim: 'closing_tim': is not a quantity that is judged; did you mean "
     "'closing_time'?"},
    {"limit_of_no_channel", "asset_id: A\nalert_limits: {channel.presure_a: {advisory: 1, warning: 1, alarm: 2}}\n",
     "a.yaml: line 2, key alert_limits.channel.presure_a: 'channel.presure_a': is not a quantity that is judged; did "
     "you mean 'channel.pressure_a'?"},
};

INSTANTIATE_TEST_SUITE_P(All, BadAsset, ::testing::ValuesIn(kBadCases),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(AssetTest, UnsetValuesTakeThePlantTablesDefaults) {
  const AssetConfig asset = load("asset_id: A\n");
  const PlantDescription& plant = **find_plant("eha");
  ASSERT_EQ(asset.parameters.size(), plant.parameters.size());
  for (const ParameterDescription& row : plant.parameters) {
    const ParameterSetting& setting = asset.parameters.at(row.name);
    EXPECT_EQ(setting.value, row.value) << row.name;
    EXPECT_EQ(setting.min, row.min) << row.name;
    EXPECT_EQ(setting.max, row.max) << row.name;
    EXPECT_EQ(setting.estimate, row.estimate) << row.name;
  }
  ASSERT_EQ(asset.sensors.size(), plant.channels.size());
  EXPECT_EQ(asset.sensors.at("pressure_a").noise_std, 1.0e4);
  EXPECT_EQ(asset.sensors.at("pressure_a").time_constant_s, 5e-3);
  ASSERT_TRUE(asset.condition.has_value());
  EXPECT_EQ(asset.condition->at_100, 2.6e13);
  EXPECT_EQ(asset.pst.stroke_m, -0.016);
}

TEST(AssetTest, GivenValuesAreReadInEitherForm) {
  const AssetConfig asset = load(R"(asset_id: A
segment: wing valve
parameters:
  R_CL: {value: 2.0e13, min: 1.0e12, max: 7.8e13, estimate: false}
  f_C: 1.5e6
  beta: {estimate: false}
sensors:
  noise_std: {flow: 1.0e-8}
  pressure_a: {noise_std: 5, time_constant: 0.001, quantisation: 2, range: [-1, 1.0e7]}
seal: {resistance_100: 3.0e13, resistance_60: 5.0e12, threshold: 0.55}
pst: {start: 0.05, stroke: 0.01, speed: 0.002, hold: 4, interval_months: 3}
alert_limits: {leakage_resistance: {advisory: 8.0e12, warning: 7.0e12, alarm: 6.0e12}}
physics:
  - {id: coulomb_friction, element: piston, parameters: {F_c: 4000, v_s: {value: 0.001, estimate: true}}}
  - {id: sensor_bias, element: "sensor:flow", parameters: {b: 1.0e-8}}
)");
  EXPECT_EQ(asset.segment, "wing valve");
  EXPECT_EQ(asset.parameters.at("R_CL").value, 2.0e13);
  EXPECT_EQ(asset.parameters.at("R_CL").min, 1.0e12);
  EXPECT_FALSE(asset.parameters.at("R_CL").estimate);
  EXPECT_EQ(asset.parameters.at("f_C").value, 1.5e6);
  EXPECT_EQ(asset.parameters.at("beta").value, 1.2e9);
  EXPECT_FALSE(asset.parameters.at("beta").estimate);
  EXPECT_EQ(asset.sensors.at("flow").noise_std, 1.0e-8);
  EXPECT_EQ(asset.sensors.at("pressure_a").noise_std, 5.0);
  EXPECT_EQ(asset.sensors.at("pressure_a").time_constant_s, 0.001);
  EXPECT_EQ(asset.sensors.at("pressure_a").quantisation, 2.0);
  EXPECT_EQ(asset.sensors.at("pressure_a").range_max, 1.0e7);
  EXPECT_EQ(asset.condition->threshold, 0.55);
  EXPECT_EQ(asset.pst.interval_months, 3.0);
  EXPECT_EQ(asset.alert_limits.at("leakage_resistance").alarm, 6.0e12);
  ASSERT_EQ(asset.physics.size(), 2U);
  EXPECT_EQ(asset.physics[0].parameters.at("F_c").value, 4000.0);
  EXPECT_FALSE(asset.physics[0].parameters.at("F_c").estimate);
  EXPECT_TRUE(asset.physics[0].parameters.at("v_s").estimate);
  EXPECT_EQ(asset.physics[1].element, "sensor:flow");
}

TEST(AssetTest, ACommandMayBeWithoutNoise) {
  EXPECT_EQ(load("asset_id: A\nsensors: {motor_voltage: {noise_std: 0}}\n").sensors.at("motor_voltage").noise_std, 0.0);
  for (const PlantDescription& plant : all_plants()) {
    const AssetConfig asset = load("asset_id: A\nmodel: " + plant.name + "\n");
    EXPECT_EQ(asset_to_yaml(load(asset_to_yaml(asset))), asset_to_yaml(asset)) << plant.name;
  }
}

TEST(AssetTest, AValueOutsideTheTablesBoundsBringsItsOwn) {
  const AssetConfig asset = load("asset_id: A\nparameters: {A_C: 0.5, p_ambient: 2.0e8}\n");
  EXPECT_EQ(asset.parameters.at("A_C").min, 0.05);
  EXPECT_EQ(asset.parameters.at("A_C").max, 5.0);
  EXPECT_EQ(asset.parameters.at("p_ambient").max, 2.0e8);
}

TEST(AssetTest, TheSealIsUndefinedWhereTheFileSaysSoOrThePlantHasNone) {
  EXPECT_FALSE(load("asset_id: A\nseal: null\n").condition.has_value());
  EXPECT_FALSE(load("asset_id: A\nmodel: eha_switched\n").condition.has_value());
  EXPECT_TRUE(load("asset_id: A\nmodel: eha_switched\nseal: {}\n").condition.has_value());
}

TEST(AssetTest, SeveralFaultsAsOneErrorNameThemAll) {
  const YamlPlace place;
  const auto asset = load_asset(place.write("a.yaml", "asset_id: A\nmodell: eha\nseall: {}\n"));
  ASSERT_FALSE(asset.has_value());
  EXPECT_THAT(asset.error().describe(), HasSubstr("modell"));
  EXPECT_THAT(asset.error().describe(), HasSubstr("seall"));
}

TEST(AssetTest, WhatIsWrittenReadsBackToTheBit) {
  AssetConfig asset = load("asset_id: 'yes: \"odd\" id'\nsegment: \"# no comment\"\n");
  double odd = 1.0 / 3.0;
  for (auto& [name, setting] : asset.parameters) setting.value *= 1.0 + 1e-3 * (odd = odd * 0.7 + 0.01);
  asset.sensors.at("flow") = {1.0 / 3.0, 1e-300, 0.1, -0.1, 1e300, 1.0 / 7.0, 1e-9 / 3.0, -1.0 / 9.0, -1e-8 / 3.0};
  asset.condition->threshold = 0.1 + 0.2;
  asset.pst.hold_s = 1.0 / 7.0;
  asset.physics = {
      {"coulomb_friction", "piston", {{"F_c", {1.0 / 3.0, 0.0, 1e5, true}}, {"v_s", {1e-4, 1e-5, 1e-3, false}}}}};
  asset.alert_limits["hold_decay_rate"] = {1.0 / 3.0, 2.0 / 3.0, 1.0};
  const AssetConfig back = load(asset_to_yaml(asset));
  EXPECT_EQ(asset_to_yaml(back), asset_to_yaml(asset));
  EXPECT_EQ(back.asset_id, asset.asset_id);
  EXPECT_EQ(back.segment, asset.segment);
  for (const auto& [name, setting] : asset.parameters) EXPECT_EQ(back.parameters.at(name).value, setting.value) << name;
  EXPECT_EQ(back.sensors, asset.sensors);
  EXPECT_EQ(back.condition->threshold, asset.condition->threshold);
  EXPECT_EQ(back.pst.hold_s, asset.pst.hold_s);
  EXPECT_EQ(back.physics.at(0).parameters, asset.physics.at(0).parameters);
  EXPECT_EQ(back.alert_limits.at("hold_decay_rate").advisory, 1.0 / 3.0);
  AssetConfig without = asset;
  without.condition.reset();
  EXPECT_FALSE(load(asset_to_yaml(without)).condition.has_value());
}

TEST(AssetTest, IsSavedWhereItMayBeWritten) {
  const YamlPlace place;
  AssetConfig asset = load("asset_id: A\n");
  ASSERT_TRUE(save_asset(asset, place.directory() + "/saved.yaml"));
  EXPECT_EQ(load_asset(place.directory() + "/saved.yaml")->asset_id, "A");
  EXPECT_THAT(save_asset(asset, "/nowhere/at/all.yaml").error().describe(),
              HasSubstr("/nowhere/at/all.yaml: cannot be"));
}

}  // namespace
}  // namespace sealwatch::testing
