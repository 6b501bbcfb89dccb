// The plants of config/plants against those that are built in: outputs, sensitivities, laws, fits.
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "docs/examples/own_plant/spring_return.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-9, .maximum_steps = 2000000};
constexpr double kWithinIntegration = 1e-4;  // of the largest value of a column; a law's sharp corner needs it

struct Pair {
  std::string native, text;
};

const PlantDescription& text_plant(const std::string& name) {
  const auto plant = load_plant(SEALWATCH_SOURCE_DIR "/config/plants/" + name + ".yaml");
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return **plant;
}

Pair pair_of(const std::string& name) {
  static const bool added = add_plant<example::SpringReturnModel>(example::describe_spring_return()).has_value();
  EXPECT_TRUE(added);
  return {name, text_plant(name).name};
}

TimeSeries driven(const PlantDescription& plant, double amplitude, double mean, double start, double step_s) {
  TimeSeries samples;
  for (const ChannelDescription& channel : plant.channels)
    samples.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (int row = 0; row < 801; ++row) {
    samples.time_s.push_back(step_s * row);
    for (std::size_t c = 0; c < plant.channels.size(); ++c)
      samples.channels[c].values.push_back(
          plant.channels[c].input ? mean + amplitude * std::sin(2.0 * std::numbers::pi * row / 250.0) : start);
  }
  return samples;
}

/// A stroke of an actuator that starts under pressure: the pump turns one way and back, valves follow.
TimeSeries driven_actuator(const PlantDescription& plant) {
  constexpr double kReturn_Pa = 1e6, kStart_m = 0.03, kAmplitude_V = 12.0, kDuty = 0.5, kStep_s = 4e-3;
  constexpr int kRows = 201;
  const double loaded_Pa = plant.find_channel("valve_state") != nullptr ? 1.9e6 : 1.1e7;  // where its load is at rest
  TimeSeries samples;
  for (const ChannelDescription& channel : plant.channels)
    samples.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (int row = 0; row < kRows; ++row) {
    samples.time_s.push_back(kStep_s * row);
    const double wave = std::sin(2.0 * std::numbers::pi * row / (kRows - 1));
    for (Series& series : samples.channels) {
      const double valves = row < 40 ? 0.0 : row < 120 ? 1.0 : -1.0;
      series.values.push_back(series.name == "motor_voltage" ? kAmplitude_V * wave
                              : series.name == "motor_duty"  ? kDuty * wave
                              : series.name == "valve_state" ? valves
                              : series.name == "pressure_b"  ? kReturn_Pa
                              : series.unit == "Pa"          ? loaded_Pa
                              : series.unit == "m"           ? kStart_m
                                                             : 0.0);
    }
  }
  return samples;
}

TimeSeries driven(const std::string& native) {
  const PlantDescription& plant = **find_plant(native);
  if (native.starts_with("eha")) return driven_actuator(plant);
  if (native == "cascaded_tanks") return driven(plant, 1.5, 2.5, 5.0, 4.0);
  return driven(plant, 3.0, 0.0, 0.01, 4e-3);
}

AssetConfig asset_of(const std::string& model, const std::vector<PhysicsTerm>& physics) {
  AssetConfig asset = nominal_asset(model);
  asset.physics = physics;
  for (auto& [channel, sensor] : asset.sensors) sensor.time_constant_s = 0.0;  // of which a text says nothing
  return asset;
}

PhysicsTerm law_at(const std::string& element, const std::string& id, const std::string& plant) {
  const auto law = std::ranges::find_if(all_laws(), [&](const Law& known) { return known.id == id && known.evaluate; });
  PhysicsTerm term{.id = id, .element = element, .parameters = {}};
  for (const LawParameter& parameter : law->parameters) {
    const double value = law_start(**find_plant(plant), parameter);
    term.parameters[std::string(parameter.name)] = {value, value, value, false};
  }
  return term;
}

void expect_equal(const Pair& plants, const std::vector<PhysicsTerm>& physics) {
  const TimeSeries samples = driven(plants.native);
  const auto native = PlantSimulation::create(asset_of(plants.native, physics), samples);
  const auto text = PlantSimulation::create(asset_of(plants.text, physics), samples);
  ASSERT_TRUE(native) << native.error().describe();
  ASSERT_TRUE(text) << text.error().describe();
  std::vector<FreeQuantity> free;
  for (const auto& parameter : (*native)->plant().parameters) free.push_back(*(*native)->find(parameter.name));
  for (const auto& parameter : (*native)->physics_parameters()) free.push_back(*(*native)->find(parameter.name));
  for (const auto& state : (*native)->state_names()) free.push_back(*(*native)->find("initial:" + state));
  const auto expected = (*native)->run((*native)->start(), free, kTight);
  const auto found = (*text)->run((*native)->start(), free, kTight);
  ASSERT_TRUE(expected) << expected.error().describe();
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_LT((expected->values - found->values).cwiseAbs().maxCoeff(),
            kWithinIntegration * expected->values.cwiseAbs().maxCoeff());
  for (Eigen::Index k = 0; k < expected->sensitivities.cols(); ++k)
    EXPECT_LE((expected->sensitivities.col(k) - found->sensitivities.col(k)).cwiseAbs().maxCoeff(),
              kWithinIntegration * expected->sensitivities.col(k).cwiseAbs().maxCoeff())
        << plants.text << ", column " << k;
}

/// Of actuators, whose motor forgets in milliseconds: a slope is as exact as its parameter matters in the channel.
void expect_equal_actuators(const Pair& plants, const std::vector<PhysicsTerm>& physics) {
  constexpr double kOfSlope = 1e-3, kOfValue = 1e-5;
  const TimeSeries samples = driven(plants.native);
  const auto native = PlantSimulation::create(asset_of(plants.native, physics), samples);
  const auto text = PlantSimulation::create(asset_of(plants.text, physics), samples);
  ASSERT_TRUE(native) << native.error().describe();
  ASSERT_TRUE(text) << text.error().describe();
  const ModelValues start = (*native)->start();
  std::vector<FreeQuantity> free;
  for (const auto& parameter : (*native)->plant().parameters) free.push_back(*(*native)->find(parameter.name));
  for (const auto& parameter : (*native)->physics_parameters()) free.push_back(*(*native)->find(parameter.name));
  const auto expected = (*native)->run(start, free, kTight), found = (*text)->run(start, free, kTight);
  ASSERT_TRUE(expected) << expected.error().describe();
  ASSERT_TRUE(found) << found.error().describe();
  const Eigen::Index channels = expected->values.cols();
  for (Eigen::Index c = 0; c < channels; ++c) {
    const std::string& channel = (*native)->channels()[static_cast<std::size_t>(c)];
    ASSERT_EQ(channel, (*text)->channels()[static_cast<std::size_t>(c)]);
    // It has the valves' sign: at the sample at which they switch, that before or after. Its integral is an output, too.
    if (channel == "shaft_speed" && plants.native == "eha_switched") continue;
    const double largest = expected->values.col(c).cwiseAbs().maxCoeff();
    EXPECT_GT(largest, 0.0) << channel;
    EXPECT_LT((expected->values.col(c) - found->values.col(c)).cwiseAbs().maxCoeff(), kWithinIntegration * largest)
        << plants.text << " " << channel;
    const auto rows = Eigen::seqN(c, expected->values.rows(), channels);
    for (Eigen::Index k = 0; k < expected->sensitivities.cols(); ++k) {
      const Eigen::VectorXd one = expected->sensitivities(rows, k), other = found->sensitivities(rows, k);
      const double value = std::abs(free[static_cast<std::size_t>(k)].in(start));
      const double allowed = kOfSlope * one.cwiseAbs().maxCoeff() + (value > 0.0 ? kOfValue * largest / value : 0.0);
      EXPECT_LE((one - other).cwiseAbs().maxCoeff(), allowed) << plants.text << " " << channel << ", column " << k;
    }
  }
}

TEST(TextPlant, SimulatesAsTheBuiltInPlant) {
  for (const char* name : {"spring_return", "emps", "cascaded_tanks"}) expect_equal(pair_of(name), {});
  for (const char* name : {"eha", "eha_switched"}) expect_equal_actuators(pair_of(name), {});
}

// One law at every kind of site, those that see what others add among them.
TEST(TextPlant, CarriesTheLawsOfTheActuators) {
  const Pair eha = pair_of("eha");
  const auto law = [&](const char* element, const char* id) { return law_at(element, id, eha.native); };
  expect_equal_actuators(eha, {law("shaft", "shaft_coulomb_friction"), law("chamber_a", "external_leakage"),
                               law("piston", "stribeck_friction"), law("piston_seal", "turbulent_seal_leakage"),
                               law("fluid", "entrained_air")});
  expect_equal_actuators(eha, {law("valve_1", "valve_hysteresis"), law("fluid", "viscosity_warm_up")});
  const Pair switched = pair_of("eha_switched");
  expect_equal_actuators(switched, {law_at("piston_seal", "turbulent_seal_leakage", switched.native)});
}

TEST(TextPlant, CarriesTheCataloguesLaws) {
  for (const char* name : {"spring_return", "emps"}) {
    const Pair plants = pair_of(name);
    expect_equal(plants, {law_at("piston", "stribeck_friction", plants.native)});
    expect_equal(plants, {law_at("piston", "presliding_friction", plants.native)});
    expect_equal(plants, {law_at("driver", "driver_dead_time", plants.native)});
  }
  const Pair tanks = pair_of("cascaded_tanks");
  expect_equal(tanks, {law_at("upper_outlet", "linear_outflow", tanks.native)});
}

TEST(TextPlant, HasTheTableOfTheBuiltInPlant) {
  for (const char* name : {"spring_return", "emps", "cascaded_tanks", "eha", "eha_switched"}) {
    const Pair plants = pair_of(name);
    const PlantDescription &native = **find_plant(plants.native), &text = **find_plant(plants.text);
    ASSERT_EQ(native.parameters.size(), text.parameters.size());
    for (std::size_t k = 0; k < native.parameters.size(); ++k) {
      EXPECT_EQ(native.parameters[k].name, text.parameters[k].name);
      EXPECT_EQ(native.parameters[k].unit, text.parameters[k].unit);
      EXPECT_EQ(native.parameters[k].value, text.parameters[k].value);
      EXPECT_NEAR(native.parameters[k].min, text.parameters[k].min, 1e-12 * native.parameters[k].max);
      EXPECT_NEAR(native.parameters[k].max, text.parameters[k].max, 1e-12 * native.parameters[k].max);
      EXPECT_EQ(native.parameters[k].positive, text.parameters[k].positive);
      EXPECT_EQ(native.parameters[k].estimate, text.parameters[k].estimate);
    }
    for (const ChannelDescription& channel : native.channels) {
      if (channel.meaning.find("not simulated") != std::string::npos && text.find_channel(channel.name) == nullptr)
        continue;
      ASSERT_NE(text.find_channel(channel.name), nullptr) << channel.name;
      EXPECT_EQ(text.find_channel(channel.name)->hold, channel.hold) << channel.name;
      EXPECT_EQ(text.find_channel(channel.name)->noise_std, channel.noise_std) << channel.name;
    }
    const auto sites = [](const PlantDescription& plant) {
      std::vector<std::pair<std::string_view, SiteKind>> all;
      for (const Site& site : plant.sites)
        if (site.kind != SiteKind::line_drop) all.emplace_back(site.element, site.kind);  // see the texts
      std::ranges::sort(all);
      return all;
    };
    EXPECT_EQ(sites(native), sites(text));
    EXPECT_EQ(native.window_s, text.window_s);
  }
}

/// The same estimates from the recordings of the tanks and of the drive.
TEST(TextPlant, FitsAsTheBuiltInPlant) {
  const std::filesystem::path data = SEALWATCH_SHARED_DATA;
  if (!std::filesystem::exists(data / "emps/train.csv")) GTEST_SKIP() << "no public recordings in " << data;
  for (const char* name : {"emps", "cascaded_tanks"}) {
    const Pair plants = pair_of(name);
    TimeSeries samples = read_recording(data / name / "train.csv");
    if (std::string(name) == "emps") {  // a few seconds say as much
      constexpr std::size_t kRows = 6000;
      samples.time_s.resize(kRows);
      for (Series& series : samples.channels) series.values.resize(kRows);
    }
    const auto native = fit_actuator(nominal_asset(plants.native), std::array{samples}).report;
    const auto text = fit_actuator(nominal_asset(plants.text), std::array{samples}).report;
    ASSERT_EQ(native.parameters.size(), text.parameters.size());
    for (std::size_t k = 0; k < native.parameters.size(); ++k) {
      constexpr double kOfStandardError = 0.02;
      EXPECT_EQ(native.parameters[k].name, text.parameters[k].name);
      EXPECT_NEAR(native.parameters[k].value, text.parameters[k].value,
                  kOfStandardError * native.parameters[k].std_error)
          << plants.text << " " << native.parameters[k].name;
    }
  }
}

/// Nothing but shared parameters, or nothing at all, is free in a plant without states.
TEST(TextPlant, FitsWithoutStates) {
  const std::filesystem::path data = SEALWATCH_SHARED_DATA;
  if (!std::filesystem::exists(data / "seal_friction")) GTEST_SKIP() << "no public recordings in " << data;
  const TimeSeries low = read_recording(data / "seal_friction/run1_1bar.csv"),
                   high = read_recording(data / "seal_friction/run1_5bar.csv");
  AssetConfig asset = nominal_asset(text_plant("seal_friction").name);
  const auto fit = fit_actuator(asset, std::array{low, high}).report;
  ASSERT_EQ(fit.parameters.size(), 1U) << fit.termination;
  EXPECT_NEAR(fit.parameters.front().value, 5.3e-4, 0.1e-4) << "a rod of 26 mm";
  asset.parameters["area"].estimate = false;
  const JointFit fixed = fit_actuator(asset, std::array{low, high});
  ASSERT_EQ(fixed.recordings.size(), 2U) << fixed.report.termination;
  EXPECT_EQ(fixed.recordings.front().simulated.time_s.size(), low.time_s.size());
}

/// The circuit's cubic spring and its offset, given as laws: from 9 mV to the noise of the instrument.
TEST(TextPlant, FollowsTheSilverboxWithItsCubicSpring) {
  const std::filesystem::path data = SEALWATCH_SHARED_DATA;
  if (!std::filesystem::exists(data / "silverbox")) GTEST_SKIP() << "no public recordings in " << data;
  TimeSeries samples = read_recording(data / "silverbox/multisine_1.csv");
  for (Series& series : samples.channels)
    if (series.name == "y") series.noise_std = 2e-4;
  const auto rms_with = [&](const std::vector<PhysicsTerm>& physics) {
    const JointFit fit = fit_actuator(asset_of(text_plant("silverbox").name, physics), std::array{samples});
    if (fit.recordings.empty()) return 1e9;
    double sum = 0.0;
    const std::vector<double>& simulated = fit.recordings.front().simulated.channels.front().values;
    for (std::size_t k = 0; k < simulated.size(); ++k)
      sum += std::pow(simulated[k] - samples.find("y")->values[k], 2) / static_cast<double>(simulated.size());
    return std::sqrt(sum);
  };
  PhysicsTerm offset{.id = "constant_force", .element = "piston", .parameters = {}}, spring = offset;
  offset.parameters["F_0"] = {1e-3, -1.0, 1.0, true};
  spring.id = "spring_load";
  spring.parameters = {{"F_x", {1e-2, -1.0, 1.0, true}}, {"a_x", {3.0, 3.0, 3.0, false}}};
  EXPECT_GT(rms_with({}), 7e-3);
  EXPECT_LT(rms_with({offset, spring}), 0.6e-3);
}

}  // namespace
}  // namespace sealwatch
