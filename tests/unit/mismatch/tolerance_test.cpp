// What a drawing gives is known within a tolerance: within it nothing is missing, beyond it the value is named.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/estimation/model_validation.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using testing::Contains;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Le;
using testing::Not;
using testing::SizeIs;

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

AssetConfig with_area(double share) {
  AssetConfig truth = actuator();
  truth.parameters.at("A_C").value *= 1.0 + share;
  return truth;
}

std::vector<Recording> tests_of(const AssetConfig& truth) {
  return {recording_of(truth, 0.7), recording_of(truth, 1.0), recording_of(truth, 1.3)};
}

TEST(Tolerance, FixedValuesHaveTheAssetsToleranceOrThePlants) {
  AssetConfig asset = actuator();
  asset.parameters.at("A_C").tolerance = 1e-5;
  const PlantDescription& plant = **find_plant("eha");
  for (const KnownValue& known : known_values(asset, plant)) {
    EXPECT_FALSE(asset.parameters.at(known.name).estimate) << known.name;
    EXPECT_NE(known.name, "phi");
    const double usual = plant.find_parameter(known.name)->tolerance * std::abs(known.value);
    EXPECT_DOUBLE_EQ(known.standard_deviation, known.name == "A_C" ? 1e-5 : usual) << known.name;
  }
  EXPECT_THAT(known_values(asset, plant), Contains(Field(&KnownValue::name, "A_C")));
}

TEST(Tolerance, AFitKeepsAValueWhereItIsKnownAndMovesItWithinThat) {
  Data data;
  data.names = {"one"};
  data.samples = {recording_of(with_area(0.004), 1.0).samples};
  const AssetConfig asset = actuator();
  const double area = asset.parameters.at("A_C").value;
  const FittedModel exact = fit_model(asset, data, nullptr, 1).value();
  data.known = {{.name = "A_C", .value = area, .standard_deviation = 0.005 * area}};
  const FittedModel tolerant = fit_model(asset, data, nullptr, 1).value();
  EXPECT_LT(tolerant.misfit, exact.misfit - 20.0);
  EXPECT_EQ(tolerant.free_shared, exact.free_shared) << "what is known costs no parameter";
  EXPECT_NEAR(tolerant.asset.parameters.at("A_C").value, 1.004 * area, 0.002 * area);
  data.known[0].standard_deviation = 1e-6 * area;
  EXPECT_NEAR(fit_model(asset, data, nullptr, 1).value().asset.parameters.at("A_C").value, area, 1e-4 * area);
}

TEST(Tolerance, WithinItNothingIsMissing) {
  const auto found = explain(actuator(), tests_of(with_area(0.004)), {});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_FALSE(found->statistically_significant) << found->summary;
  EXPECT_THAT(found->effects, IsEmpty());
  EXPECT_THAT(found->asset_values, IsEmpty());
}

constexpr double kSameFit = 2e-3;  // each recording's own state is estimated once more, to the search's tolerance

AssetConfig with_inexact_sensors() {
  AssetConfig truth = actuator();
  truth.sensors.at("flow").gain_error = 0.004;
  truth.sensors.at("pressure_a").gain_error = -0.003;
  truth.sensors.at("shaft_speed").gain_error = 0.003;
  truth.sensors.at("position").offset_error = 2e-5;
  return truth;
}

TEST(Tolerance, SensorsHaveTheAssetsToleranceOrTheUsualOne) {
  AssetConfig asset = actuator();
  asset.sensors.at("flow").gain_tolerance = 1e-4;
  const TimeSeries samples = recording_of(asset, 1.0).samples;
  const PemProblem problem = make_pem_problem(asset, {&samples, 1}).value();
  const auto [least, largest] = std::ranges::minmax(samples.find("position")->values);
  std::map<std::string, double> known;
  for (const KnownValue& one : known_sensors(asset, problem)) known[one.name] = one.standard_deviation;
  EXPECT_DOUBLE_EQ(known.at("sensor:flow.gain_error"), 1e-4);
  EXPECT_DOUBLE_EQ(known.at("sensor:pressure_a.gain_error"), kUsualSensorTolerance);
  EXPECT_DOUBLE_EQ(known.at("sensor:position.offset_error"), kUsualSensorTolerance * (largest - least));
}

TEST(Tolerance, SensorsOffByLessThanTheyMayBeAreNoFault) {
  const auto found = explain(actuator(), tests_of(with_inexact_sensors()), {});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_FALSE(found->statistically_significant) << found->summary;
  EXPECT_THAT(found->effects, IsEmpty());
}

// They hide no physics; and what `validate` and `simulate` get of the explained asset is what the report calls "after".
TEST(Tolerance, SensorsOffByLessThanTheyMayBeHideNoPhysicsAndAreWrittenWithTheAsset) {
  AssetConfig truth = with_inexact_sensors();
  truth.physics = {{"external_leakage", "chamber_a", {{"G", {4e-14, 0.0, 1e-10, false}}}}};
  const std::vector<Recording> tests = tests_of(truth);
  const auto found = explain(actuator(), tests, {});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.id, "external_leakage") << found->summary;
  ASSERT_NE(found->explained.sensors.at("flow").gain_error, 0.0);
  const std::string file = ::testing::TempDir() + "sensors.explained.yaml";
  ASSERT_TRUE(save_asset(found->explained, file));
  std::vector<std::string> names;
  for (const Recording& test : tests) names.push_back(test.file);
  const auto again = validate_model(load_asset(file).value(), tests, names, false);
  ASSERT_TRUE(again) << again.error().describe();
  for (std::size_t k = 0; k < tests.size(); ++k)
    for (const ChannelValidation& channel : again->recordings[k].channels) {
      const auto& reported = found->recordings[k].channels;
      const auto after = std::ranges::find(reported, channel.fit.channel, &ChannelComparison::channel);
      ASSERT_NE(after, reported.end());
      EXPECT_NEAR(channel.fit.noise_normalised_rms, after->rms_after, kSameFit * after->rms_after)
          << channel.fit.channel;
    }
}

// The simulation is far off: set out from the recorded states, several laws together would fill the value's place.
TEST(Tolerance, AWrongTorqueConstantIsFoundBesideSensorsOffByLessThanTheyMayBe) {
  AssetConfig truth = with_inexact_sensors();
  truth.parameters.at("T_M").value *= 0.89;
  const auto found = explain(actuator(), tests_of(truth), {});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_THAT(found->effects, IsEmpty()) << found->summary;
  ASSERT_THAT(found->asset_values, SizeIs(1)) << found->summary;
  ASSERT_THAT(found->asset_values.front(), SizeIs(1)) << found->summary;
  EXPECT_EQ(found->asset_values.front().front().name, "T_M");
  EXPECT_NEAR(found->asset_values.front().front().fitted / actuator().parameter("T_M"), 0.89, 0.01);
  EXPECT_THAT(found->location, IsEmpty()) << found->summary;
  EXPECT_THAT(found->trace, Each(Field(&Asked::laws, SizeIs(Le(1U))))) << "several laws were asked together";
}

TEST(Tolerance, ASensorThatIsFurtherOffIsAFault) {
  AssetConfig truth = actuator();
  truth.sensors.at("flow").gain_error = 0.02;
  const auto found = explain(actuator(), tests_of(truth), {});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.id, "sensor_gain");
  EXPECT_EQ(found->effects[0].what.element, "sensor:flow");
}

// Far off: simulations held to what the sensor said would ask laws of the input for it.
TEST(Tolerance, ASensorThatIsFarOffIsAskedBeforeSimulationsAreHeldToIt) {
  AssetConfig truth = actuator();
  truth.sensors.at("shaft_speed").offset_error = 15.0;
  std::set<std::string> steps;
  const auto found = explain(actuator(), tests_of(truth), {}, {},
                             [&](std::string_view step, double /*share*/) { steps.emplace(step); });
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.id, "sensor_bias");
  EXPECT_EQ(found->effects[0].what.element, "sensor:shaft_speed");
  EXPECT_FALSE(steps.contains("starting from the recorded states"));
}

AssetConfig drifting(double towards, double time_s) {
  AssetConfig truth = actuator();
  truth.physics.push_back(
      {.id = "sensor_drift",
       .element = "sensor:shaft_speed",
       .parameters = {{"D", {.value = towards}}, {"T", {.value = time_s, .min = 0.5, .max = 1e4}}}});
  return truth;
}

TEST(Tolerance, ASensorWhoseZeroMovesDuringTheTestIsAFault) {
  for (const auto& [towards, time_s] : {std::pair{-4.0, 6.0}, {-130.0, 1000.0}}) {  // comes to rest; goes on
    const auto found = explain(actuator(), tests_of(drifting(towards, time_s)), {});
    ASSERT_TRUE(found) << found.error().describe();
    ASSERT_EQ(found->effects.size(), 1U) << found->summary;
    EXPECT_EQ(found->effects[0].what.id, "sensor_drift");
    EXPECT_EQ(found->effects[0].what.element, "sensor:shaft_speed");
    const std::vector<FoundParameter>& parameters = found->effects[0].parameters;
    EXPECT_NEAR(parameters[0].value / parameters[1].value, towards / time_s, 0.2 * std::abs(towards / time_s));
    EXPECT_TRUE(time_s > 10.0 || std::abs(parameters[1].value - time_s) < 1.0) << parameters[1].value;
  }
}

void leave_out(TimeSeries& samples, const std::set<std::string>& channels) {
  std::erase_if(samples.channels, [&](const Series& channel) { return channels.contains(channel.name); });
}

// A flow that drives the cylinder circuit is measured itself.
TEST(Tolerance, OfAMeasuredFlowIsNoPhysicsAndNoLeakage) {
  const AssetConfig asset = actuator();
  std::vector<Recording> tests = tests_of(asset);
  for (Recording& test : tests) {
    leave_out(test.samples, {"motor_voltage", "motor_current", "shaft_speed"});
    for (double& flow : std::ranges::find(test.samples.channels, "flow", &Series::name)->values)
      flow = 1.003 * flow - 2e-8;
  }
  const auto found = explain(asset, tests, {}, {.time_limit_s = 15.0});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_THAT(found->effects, IsEmpty()) << found->summary;
  const auto leakage = std::ranges::find(found->parameters, "R_CL", &ParameterShift::name);
  ASSERT_NE(leakage, found->parameters.end());
  const double truth = asset.parameters.at("R_CL").value;
  EXPECT_NEAR(leakage->before, truth, 3.0 * leakage->before_std) << "of " << truth;
}

// The source document's own channels. What the pump moves before its valve opens is in none of them.
TEST(Tolerance, OfADifferencePressureAloneTheLeakageIsToldAndNoPhysics) {
  const AssetConfig asset = actuator();
  std::vector<Recording> tests = tests_of(asset);
  for (Recording& test : tests) {
    Series difference = *test.samples.find("pressure_a");
    const std::vector<double>& other = test.samples.find("pressure_b")->values;
    std::ranges::transform(difference.values, other, difference.values.begin(), std::minus<>());
    difference.name = "pressure_differential";
    difference.noise_std *= std::sqrt(2.0);
    test.samples.channels.push_back(std::move(difference));
    leave_out(test.samples, {"motor_voltage", "motor_current", "shaft_speed", "pressure_a", "pressure_b"});
  }
  const auto found = explain(asset, tests, {}, {.time_limit_s = 30.0});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_THAT(found->effects, IsEmpty()) << found->summary;
  EXPECT_THAT(found->summary, HasSubstr("what the pump moves before its valve opens"));
  EXPECT_EQ(found->next_test, "Record the pressures of both chambers, or the motor's voltage.");
  const auto leakage = std::ranges::find(found->parameters, "R_CL", &ParameterShift::name);
  ASSERT_NE(leakage, found->parameters.end());
  const double truth = asset.parameters.at("R_CL").value;
  EXPECT_NEAR(leakage->before, truth, 0.01 * truth);
}

// The load on the rod is constant in the model: the noise of what drives it makes nothing there.
TEST(Tolerance, AChannelThatNoInputMovesKeepsItsOwnNoise) {
  const AssetConfig asset = actuator();
  std::vector<Recording> tests = tests_of(asset);
  for (Recording& test : tests) {
    const std::size_t rows = test.samples.time_s.size();
    std::vector<double> force(rows, asset.parameters.at("phi").value);
    for (std::size_t row = 0; row < rows; ++row) force[row] += row % 2 == 0 ? 100.0 : -100.0;
    test.samples.channels.push_back({"rod_force", "N", 100.0, std::move(force)});
    leave_out(test.samples, {"motor_voltage", "motor_current", "shaft_speed"});
  }
  const auto found = explain(asset, tests, {}, {.time_limit_s = 10.0});
  ASSERT_TRUE(found) << found.error().describe();
}

}  // namespace
}  // namespace sealwatch::mismatch
