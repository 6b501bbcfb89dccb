// An imported FMU with laws in it, handed back as an FMU: imported again, it simulates what the explained asset does.
#include <dlfcn.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/export/export_model.hpp"
#include "services/common/fmi/export/fmu_writer.hpp"
#include "services/common/fmi/fmu_archive.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kSpring = R"yaml(
meaning: valve positioner with a return spring
fmu:
  file: model.fmu
  inputs: {u: INPUT}
  parameters: {M: M, F_v: F_v, k_s: STIFFNESS, k_F: k_F}
  variables: {push: {variable: der(v), unit: Pa}}
inputs:
  drive_voltage: {unit: V}
outputs:
  position: {value: x, unit: m}
  height: {value: 2 * x, unit: m}
parameters:
  M: {value: 20.0, unit: kg}
  F_v: {value: 2.0e3, unit: N s/m}
  k_s: {value: 1.0e4, unit: N/m}
  k_F: {value: 100.0, unit: N/V}
states:
  v: {unit: m/s, start: "0[m/s]", own: false, size: 0.1}
  x: {unit: m, start: "0[m]", own: false, size: 0.02}
elements:
  driver:
    sites:
      - {kind: voltage_command, symbol: u_lost, signals: {command: drive_voltage, command_rate: rate(drive_voltage)}}
  piston:
    sites:
      - {kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x, pressure_a: push}}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3, V: 1.0, A: 1.0, s: 1.0,
            Pa: 1.0e-6, m2: 1.0e-3, 1: 1.0}
)yaml";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

PhysicsTerm term(const std::string& id, const std::string& element,
                 const std::vector<std::pair<std::string, double>>& values) {
  PhysicsTerm result{.id = id, .element = element, .parameters = {}};
  for (const auto& [name, value] : values) result.parameters[name] = {value, 0.0, 1e6, false};
  return result;
}

std::string between(const std::string& text, const std::string& before, const std::string& behind) {
  const std::size_t begin = text.find(before) + before.size();
  return text.substr(begin, text.find(behind, begin) - begin);
}

/// A plant around a unit, the unit with an asset's laws in it that was exported of them, and the plant around that.
class Exported {
 public:
  Exported(const TestUnit& unit, const std::string& plant, const std::function<void(AssetConfig&)>& explain) {
    static int count = 0;
    name_ = "exported_" + std::to_string(++count);
    static_cast<void>(folder_.build(unit));
    const std::string file = (folder_ / "plant.yaml").string();
    std::ofstream(file) << "name: " << name_ << plant;
    asset_ = nominal_asset(loaded(file));
    explain(asset_);
    if (const auto read = read_plant_file(file)) export_and_import(read->built.plant);
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] std::string file() const { return (folder_ / "explained.fmu").string(); }
  /// What both simulate of a channel, where `course` is each recorded input's.
  [[nodiscard]] RowMatrix simulated(const std::string& channel, double (*course)(double)) const {
    return run(asset_, channel, course);
  }
  /// A state that an output shows begins where the recording does, at `first`.
  [[nodiscard]] RowMatrix simulated_again(const std::string& channel, double (*course)(double),
                                          double first = 0.0) const {
    return run(again_, channel, course, first);
  }

 private:
  void export_and_import(const RuntimePlant& plant) {
    const auto model = export_model(plant, asset_);
    if (!model) {
      refusal_ = model.error().describe();
      return;
    }
    const std::string file = (folder_ / "explained.fmu").string();
    const auto written = write_fmu(file, *model);
    EXPECT_TRUE(written && written->binary) << (written ? written->without_binary : written.error().describe());
    const auto fmu = FmuFile::open(file);
    ASSERT_TRUE(fmu) << fmu.error().describe();
    const auto text = plant_file_of(**fmu, "explained.fmu");
    ASSERT_TRUE(text) << text.error().describe();
    text_ = replaced(*text, "name: test_explained", "name: again_" + name_);
    std::ofstream(folder_ / "again.yaml") << text_;
    again_ = nominal_asset(loaded((folder_ / "again.yaml").string()));
  }
  static std::string loaded(const std::string& file) {
    const auto plant = load_plant(file);
    if (!plant) ADD_FAILURE() << plant.error().front().describe();
    return plant ? (*plant)->name : "";
  }
  static RowMatrix run(const AssetConfig& asset, const std::string& channel, double (*course)(double),
                       double first = 0.0) {
    TimeSeries recorded;
    for (int row = 0; row <= 300; ++row) recorded.time_s.push_back(0.01 * row);
    for (const ChannelDescription& row : (*find_plant(asset.model))->channels) {
      if (!row.input && row.name != channel) continue;
      Series& series = recorded.channels.emplace_back(Series{row.name, row.unit, 0.0, {}});
      for (const double t : recorded.time_s) series.values.push_back(row.input ? course(t) : first);
      const bool slope = row.name.ends_with("_rate");
      for (std::size_t k = 0; slope && k < recorded.time_s.size(); ++k)
        series.values[k] = (course(recorded.time_s[k] + 1e-6) - course(recorded.time_s[k] - 1e-6)) / 2e-6;
    }
    const auto simulation = PlantSimulation::create(asset, recorded);
    EXPECT_TRUE(simulation) << simulation.error().describe();
    if (!simulation) return {};
    const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-8});
    EXPECT_TRUE(outputs) << outputs.error().describe();
    return outputs ? outputs->values : RowMatrix();
  }

  TestFolder folder_;
  AssetConfig asset_, again_;
  std::string name_, text_, refusal_;
};

/// Whole ramps between samples, so that a held rate between samples is no other course.
double ramps(double t) { return t < 1.0 ? 4.0 * t : t < 2.0 ? 4.0 : 12.0 - 4.0 * t; }

void expect_same(const Exported& exported, const std::string& channel, const std::string& again, double close) {
  const RowMatrix one = exported.simulated(channel, &ramps);
  ASSERT_EQ(one.rows(), 301);
  const RowMatrix other = exported.simulated_again(again, &ramps, one(0, 0));
  ASSERT_EQ(other.rows(), 301);
  for (int row = 0; row <= 300; ++row) ASSERT_NEAR(one(row, 0), other(row, 0), close) << channel << " " << row;
}

std::string spring(const std::string& input, const std::string& stiffness) {
  return replaced(replaced(kSpring, "INPUT", input), "STIFFNESS", stiffness);
}

TEST(ExplainedFmu, HasTheLawsAtDerivativesAndInputs) {
  const Exported exported(spring_return("fmu_spring_return2"), spring("drive_voltage - u_lost", "k_s"),
                          [](AssetConfig& asset) {
                            asset.parameters["M"].value = 23.0;
                            asset.physics = {term("coulomb_friction", "piston", {{"F_c", 60.0}, {"v_s", 1e-3}}),
                                             term("driver_dead_time", "driver", {{"V_z", 0.4}, {"u_s", 0.3}})};
                          });
  EXPECT_THAT(exported.text(), AllOf(HasSubstr("\"u\": u"), HasSubstr("\"M\": M"), HasSubstr("value: 23.0"),
                                     HasSubstr("piston.coulomb_friction.F_c"), HasSubstr("value: 60.0")));
  expect_same(exported, "position", "position", 1e-8);
  expect_same(exported, "height", "height", 2e-8);
  const Exported plain(spring_return("fmu_spring_return2"), spring("drive_voltage - u_lost", "k_s"),
                       [](AssetConfig& asset) { asset.parameters["M"].value = 23.0; });
  EXPECT_GT(
      std::abs(exported.simulated_again("position", &ramps)(100, 0) - plain.simulated("position", &ramps)(100, 0)),
      1e-3)
      << "the laws do something";
}

TEST(ExplainedFmu, HasHiddenStatesAndLawsThatSeeTheUnitsVariables) {
  const Exported exported(
      spring_return("fmu_spring_directional2"), spring("drive_voltage - u_lost", "k_s"), [](AssetConfig& asset) {
        asset.physics = {term("presliding_friction", "piston", {{"F_c", 40.0}, {"delta", 1e-4}}),
                         term("pressure_dependent_friction", "piston", {{"k_d", 5.0}, {"v_s", 1e-2}})};
      });
  EXPECT_THAT(exported.text(), AllOf(HasSubstr("piston.presliding_friction.bristle"),
                                     HasSubstr("unit: \"1\", start: \"0.0[1]\", size: 1.0, own: true, meaning: "
                                               "\"hidden state of a law")));
  expect_same(exported, "position", "position", 1e-7);
}

TEST(ExplainedFmu, HasThePlantsInputsAndParametersWhereTheUnitsFollowFromThem) {
  const Exported exported(spring_return("fmu_spring_return2"), spring("2 * drive_voltage - u_lost", "k_s / 2"),
                          [](AssetConfig& asset) {
                            asset.parameters["k_s"].value = 3e4;
                            asset.physics = {term("driver_dead_time", "driver", {{"tau_d", 0.05}})};
                          });
  EXPECT_THAT(exported.text(), AllOf(HasSubstr("\"drive_voltage\": drive_voltage"),
                                     HasSubstr("\"drive_voltage_rate\": drive_voltage_rate"),
                                     HasSubstr("\"k_s_\": k_s\n"), testing::Not(HasSubstr("\"u\":"))));
  expect_same(exported, "position", "position", 1e-4);  // the recorded rate is linear between samples where it jumps
}

// A law at the input is behind the table, so that the input is another one without the law.
TEST(ExplainedFmu, HasThePlantsTablesWithALawBehindThem) {
  const Exported exported(spring_return("fmu_spring_return2"),
                          spring("pull(drive_voltage - u_lost)", "k_s") +
                              "tables: {pull: {x: [-6, 0, 1, 6], x_unit: V, y: [-9, 0, 2, 5], y_unit: V}}\n",
                          [](AssetConfig& asset) {
                            asset.physics = {term("driver_dead_time", "driver", {{"V_z", 0.4}, {"u_s", 0.3}})};
                          });
  ASSERT_EQ(exported.refusal(), "");
  expect_same(exported, "position", "position", 1e-8);
}

TEST(ExplainedFmu, PassesEventsOn) {
  for (const char* binary : {"fmu_bouncing2", "fmu_bouncing3"}) {
    const Exported exported(bouncing(binary), R"yaml(
meaning: a ball
fmu:
  file: model.fmu
  parameters: {g: g}
inputs: {}
outputs:
  height: {value: h, unit: m}
parameters:
  g: {value: 9.81, unit: m/s2}
states:
  h: {unit: m, start: "1[m]", own: false, size: 1.0}
  v: {unit: m/s, start: "0[m/s]", own: false, size: 1.0}
elements:
  air:
    sites:
      - {kind: piston_force, adds_to: {v: "-1[1/kg]"}, signals: {speed: v, position: h}}
law_sizes: {N: 1.0, m: 1.0, m/s: 1.0, N/m: 1.0, N/m2: 1.0, N s/m: 1.0, N s2/m2: 1.0}
)yaml",
                            [](AssetConfig& asset) {
                              asset.physics = {term("quadratic_drag", "air", {{"k", 0.1}})};
                            });
    expect_same(exported, "height", "height", 1e-6);
  }
}

const std::string& typed_plant() {
  static const std::string plant = R"yaml(
meaning: a unit of all types
fmu:
  file: model.fmu
  settings: {text: "seven\"7", last: 500}
  inputs: {u_real: u_real, u_discrete: u_discrete, u_integer: u_integer, u_boolean: u_boolean}
  parameters: {k: k, x0: x0}
  variables: {y_integer: {variable: y_integer, unit: "1"}, length: {variable: length, unit: "1"}}
inputs:
  u_real: {unit: "1", course: held}
  u_discrete: {unit: "1", course: held}
  u_integer: {unit: "1", course: held}
  u_boolean: {unit: "1", course: held}
outputs:
  x: {value: x, unit: "1"}
  y_integer: {value: y_integer, unit: "1"}
  length: {value: length, unit: "1"}
parameters:
  k: {value: 1.0, unit: 1/s}
  x0: {value: 2.0, unit: "1"}
states:
  x: {unit: "1", start: fmu, size: 1.0}
elements: {}
law_sizes: {}
)yaml";
  return plant;
}

TEST(ExplainedFmu, PassesTypedInputsAndSettingsOn) {
  for (const char* binary : {"fmu_mixed2", "fmu_mixed3"}) {
    const Exported exported(mixed(binary), typed_plant(),
                            [](AssetConfig& asset) { asset.parameters["x0"].value = 3.0; });
    ASSERT_EQ(exported.refusal(), "");
    const auto whole = [](double t) { return std::floor(3.0 * t); };
    const RowMatrix x = exported.simulated_again("x", whole);
    ASSERT_EQ(x.rows(), 301);
    EXPECT_NEAR(x(100, 0), 3.0 * std::exp(-1.0), 1e-7);
    EXPECT_EQ(exported.simulated_again("y_integer", whole), exported.simulated("y_integer", whole));
    EXPECT_EQ(exported.simulated_again("length", whole)(5, 0), 7.0);
  }
}

// sealwatch has no use for variables of type Binary; whoever runs the exported unit may have.
TEST(ExplainedFmu, PassesBinaryVariablesOn) {
  const Exported exported(mixed("fmu_mixed3"), typed_plant(), [](AssetConfig&) {});
  ASSERT_EQ(exported.refusal(), "");
  const auto unpacked = unpack_fmu(exported.file());
  ASSERT_TRUE(unpacked) << unpacked.error().describe();
  std::string text, member;
  std::getline(std::ifstream(unpacked->path_of(kDescriptionName)), text, '\0');
  EXPECT_THAT(text, HasSubstr("<Binary name=\"bytes\" valueReference=\"24\""));
  for (const std::string& name : unpacked->members)
    if (name.starts_with("binaries/") && name.ends_with(".so")) member = unpacked->path_of(name).string();
  void* const library = dlopen(member.c_str(), RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(library, nullptr) << dlerror();
  const auto function = [&](const char* name, auto* type) {
    return reinterpret_cast<decltype(type)>(dlsym(library, name));  // as POSIX has it
  };
  using New = void*(const char*, const char*, const char*, bool, bool, void*, void*);
  using Free = void(void*);
  using Get = int(void*, const unsigned*, std::size_t, std::size_t*, const std::uint8_t**, std::size_t);
  using Set = int(void*, const unsigned*, std::size_t, const std::size_t*, const std::uint8_t* const*, std::size_t);
  const std::string token = between(text, "instantiationToken=\"", "\"");
  void* const unit = function("fmi3InstantiateModelExchange", static_cast<New*>(nullptr))(
      "one", token.c_str(), (unpacked->path_of("resources").string() + "/").c_str(), false, false, nullptr, nullptr);
  ASSERT_NE(unit, nullptr);
  const unsigned reference = 24;
  const std::array<std::uint8_t, 3> bytes = {7, 0, 9};
  const std::uint8_t* place = bytes.data();
  std::size_t size = bytes.size();
  EXPECT_EQ(function("fmi3SetBinary", static_cast<Set*>(nullptr))(unit, &reference, 1, &size, &place, 1), 0);
  size = 0, place = nullptr;
  EXPECT_EQ(function("fmi3GetBinary", static_cast<Get*>(nullptr))(unit, &reference, 1, &size, &place, 1), 0);
  ASSERT_EQ(size, bytes.size());
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), place));
  function("fmi3FreeInstance", static_cast<Free*>(nullptr))(unit);
  dlclose(library);
}

// The same laws, inputs, parameters and events within a unit of FMI 3.0, which is handed back as one of FMI 3.0.
TEST(ExplainedFmu, OfFmi3IsHandedBackAsFmi3) {
  const auto explain = [](AssetConfig& asset) {
    asset.parameters["M"].value = 23.0;
    asset.physics = {term("presliding_friction", "piston", {{"F_c", 40.0}, {"delta", 1e-4}}),
                     term("driver_dead_time", "driver", {{"V_z", 0.4}, {"u_s", 0.3}})};
  };
  const Exported third(spring_return("fmu_spring_return3"), spring("2 * drive_voltage - u_lost", "k_s / 2"), explain);
  ASSERT_EQ(third.refusal(), "");
  EXPECT_THAT(third.text(),
              AllOf(HasSubstr("(FMI 3.0, Model Exchange"), HasSubstr("piston.presliding_friction.bristle"),
                    HasSubstr("\"drive_voltage\": drive_voltage"), HasSubstr("value: 23.0")));
  expect_same(third, "position", "position", 1e-7);
  const Exported second(spring_return("fmu_spring_return2"), spring("2 * drive_voltage - u_lost", "k_s / 2"), explain);
  EXPECT_NEAR(third.simulated_again("position", &ramps)(200, 0), second.simulated_again("position", &ramps)(200, 0),
              1e-7);
}

// An alias may have the name of the plant's output, and there is one variable of a name.
TEST(ExplainedFmu, AnOutputTakesTheNameOfItsAlias) {
  TestUnit unit = spring_return("fmu_spring_return3");
  const std::string state = "<Float64 name=\"x\" valueReference=\"1000\"";
  const std::size_t begin = unit.variables.find(state), end = unit.variables.find("/>", begin);
  ASSERT_NE(begin, std::string::npos) << unit.variables;
  unit.variables.replace(end, 2, "><Alias name=\"stroke\"/><Alias name=\"height\"/></Float64>");
  const Exported exported(unit, replaced(spring("drive_voltage - u_lost", "k_s"), "  position: {", "  stroke: {"),
                          [](AssetConfig& asset) {
                            asset.physics = {term("coulomb_friction", "piston", {{"F_c", 60.0}, {"v_s", 1e-3}})};
                          });
  ASSERT_EQ(exported.refusal(), "");
  EXPECT_THAT(exported.text(), AllOf(HasSubstr("  stroke: {unit: \"m\", value: "), HasSubstr("variable: \"height_\"")));
  expect_same(exported, "stroke", "stroke", 1e-8);
  expect_same(exported, "height", "height", 2e-8);
}

/// Imported again, each state is integrated as exactly as before: its size went along as the nominal value.
void expect_same_sizes(const RuntimePlant& before, const std::string& file) {
  const auto again = read_plant_file(file);
  ASSERT_TRUE(again) << again.error().front().describe();
  const std::vector<RuntimeState>& states = again->built.plant.states;
  ASSERT_GE(states.size(), before.states.size());  // those of laws are behind the plant's
  for (std::size_t k = 0; k < before.states.size(); ++k)
    EXPECT_NEAR(states[k].scale / before.states[k].scale, 1.0, 1e-9) << before.description.states[k].name;
}

/// A recording of a compiled actuator: its inputs in a few steps, its outputs at their start.
TimeSeries stroke_of(const PlantDescription& plant) {
  TimeSeries samples;
  for (const ChannelDescription& channel : plant.channels)
    samples.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (int row = 0; row <= 200; ++row) {
    samples.time_s.push_back(5e-3 * row);
    const double t = samples.time_s.back();
    for (Series& series : samples.channels)
      series.values.push_back(series.name == "motor_voltage" ? 10.0 * t
                              : series.name == "motor_duty"  ? 0.4 * t
                              : series.name == "valve_state" ? (row < 60 ? 0.0 : 1.0)
                              : series.name == "pressure_b"  ? 1.0e6
                              : series.unit == "Pa"          ? (plant.name.ends_with("switched_text") ? 1.9e6 : 1.1e7)
                              : series.unit == "m"           ? 0.03
                                                             : 0.0);
  }
  return samples;
}

// A built-in plant is exported as its text (config/plants), which has its equations. States settle in both, and so does
// the hidden state of a law.
TEST(ExportedBuiltInPlant, SimulatesAgainWhatItsTextDoes) {
  for (const std::string name : {"eha", "eha_switched"}) {
    const TestFolder folder;
    std::string text;
    std::getline(std::ifstream(SEALWATCH_SOURCE_DIR "/config/plants/" + name + ".yaml"), text, '\0');
    EXPECT_THAT(text, HasSubstr("settles: true"));
    std::ofstream(folder / "text.yaml") << replaced(text, "name: ", "name: exported_");
    const auto read = read_plant_file((folder / "text.yaml").string());
    const auto plant = load_plant((folder / "text.yaml").string());
    ASSERT_TRUE(read && plant) << (read ? plant.error() : read.error()).front().describe();
    AssetConfig asset = nominal_asset((*plant)->name);
    asset.parameters["f_C"].value *= 1.5;
    asset.physics = {term("external_leakage", "chamber_a", {{"G", 1e-13}})};
    if (name == "eha") asset.physics.push_back(term("valve_hysteresis", "valve_1", {{"dp_f", 2e4}, {"tau_f", 0.5}}));
    const auto model = export_model(read->built.plant, asset);
    ASSERT_TRUE(model) << model.error().describe();
    const std::string file = (folder / "built_in.fmu").string();
    const auto written = write_fmu(file, *model);
    ASSERT_TRUE(written && written->binary) << (written ? written->without_binary : written.error().describe());
    const auto fmu = FmuFile::open(file);
    ASSERT_TRUE(fmu) << fmu.error().describe();
    const auto imported = plant_file_of(**fmu, "built_in.fmu");
    ASSERT_TRUE(imported) << imported.error().describe();
    std::string around = replaced(*imported, "name: ", "name: again_");
    if (name == "eha_switched") around = replaced(around, "valve_state: {", "valve_state: {course: held, ");
    std::ofstream(folder / "again.yaml") << around;
    const auto again = load_plant((folder / "again.yaml").string());
    ASSERT_TRUE(again) << again.error().front().describe();
    expect_same_sizes(read->built.plant, (folder / "again.yaml").string());
    const TimeSeries samples = stroke_of(**plant);
    const auto by_text = PlantSimulation::create(asset, samples);
    const auto unit = PlantSimulation::create(nominal_asset((*again)->name), samples);
    ASSERT_TRUE(by_text) << by_text.error().describe();
    ASSERT_TRUE(unit) << unit.error().describe();
    ModelValues values = (*unit)->start();
    values.initial_state = (*by_text)->start().initial_state;
    const auto expected = (*by_text)->run((*by_text)->start(), {}, {.relative_tolerance = 1e-8});
    const auto found = (*unit)->run(values, {}, {.relative_tolerance = 1e-7});
    ASSERT_TRUE(expected) << expected.error().describe();
    ASSERT_TRUE(found) << found.error().describe();
    const auto channels = (*unit)->channels();
    for (std::size_t c = 0; c < (*by_text)->channels().size(); ++c) {
      const std::string& channel = (*by_text)->channels()[c];
      const auto same = std::ranges::find(channels, channel) - channels.begin();
      ASSERT_LT(same, std::ssize(channels)) << channel;
      const auto one = expected->values.col(static_cast<Eigen::Index>(c)), other = found->values.col(same);
      EXPECT_GT(one.cwiseAbs().maxCoeff(), 0.0) << channel;
      EXPECT_LT((one - other).cwiseAbs().maxCoeff(), 1e-3 * one.cwiseAbs().maxCoeff()) << name << " " << channel;
    }
  }
}

// Whoever loads it compares what it says with differences, and refuses it where they differ.
TEST(ExportedBuiltInPlant, GivesItsDerivativesWhereNoLawIsInIt) {
  for (const std::string name : {"eha", "spring_return", "cascaded_tanks", "two_actuators"})
    for (const Version version : {Version::fmi2, Version::fmi3}) {
      const TestFolder folder;
      std::string text;
      std::getline(std::ifstream(SEALWATCH_SOURCE_DIR "/config/plants/" + name + ".yaml"), text, '\0');
      const std::string unique = std::string("gives_") + (version == Version::fmi3 ? "three_" : "two_");
      std::ofstream(folder / "text.yaml") << replaced(text, "name: ", "name: " + unique);
      const auto read = read_plant_file((folder / "text.yaml").string());
      const auto plant = load_plant((folder / "text.yaml").string());
      ASSERT_TRUE(read && plant) << (read ? plant.error() : read.error()).front().describe();
      const auto given = [&](const AssetConfig& asset) {
        const auto model = export_model(read->built.plant, asset, version);
        EXPECT_TRUE(model) << model.error().describe();
        const std::string file = (folder / (asset.physics.empty() ? "unit.fmu" : "explained.fmu")).string();
        const auto written = write_fmu(file, *model);
        EXPECT_TRUE(written && written->binary) << (written ? written->without_binary : written.error().describe());
        const auto fmu = FmuFile::open(file);
        EXPECT_TRUE(fmu) << fmu.error().describe();
        const auto imported = plant_file_of(**fmu, file);
        EXPECT_TRUE(imported) << imported.error().describe();
        std::ofstream(folder / "again.yaml") << replaced(*imported, "name: ", "name: again_");
        const auto again = read_plant_file((folder / "again.yaml").string());
        EXPECT_TRUE(again) << name << ": " << again.error().front().describe();
        return (*fmu)->interface().directional_derivatives;
      };
      AssetConfig asset = nominal_asset((*plant)->name);
      EXPECT_TRUE(given(asset)) << name;
      if (name != "spring_return") continue;
      asset.physics = {term("coulomb_friction", "piston", {{"F_c", 60.0}, {"v_s", 1e-3}})};
      EXPECT_FALSE(given(asset));
    }
}

TEST(ExplainedFmu, AMissingFolderIsNamed) {
  const ExportedModel model{
      .version = Version::fmi2, .identifier = "m", .source = {}, .description = {}, .left_out = {}, .carried = {}};
  EXPECT_THAT(write_fmu("/nowhere/at/all/m.fmu", model).error().describe(),
              AllOf(HasSubstr("no folder /nowhere/at/all"), HasSubstr("create it")));
}

// The site of the driver has the rate of its command among its signals, which only some laws see.
TEST(ExplainedFmu, AsksForARateOnlyWhereALawNeedsIt) {
  const Exported without(spring_return("fmu_spring_return2"), spring("drive_voltage - u_lost", "k_s"),
                         [](AssetConfig& asset) {
                           asset.physics = {term("coulomb_friction", "piston", {{"F_c", 60.0}, {"v_s", 1e-3}})};
                         });
  EXPECT_THAT(without.text(), testing::Not(HasSubstr("_rate")));
  expect_same(without, "position", "position", 1e-8);
}

TEST(ExplainedFmu, WhatTheUnitWroteInAnotherEncodingIsReadAgain) {
  TestUnit unit = spring_return("fmu_spring_return2");
  unit.encoding = "ISO-8859-1";
  unit.variables.insert(unit.variables.find("start=\"20\""), "quantity=\"Masse\" ");
  unit.variables.replace(unit.variables.find("name=\"M\""), 8, "name=\"M\" description=\"K\xf6rper\"");
  const Exported exported(unit, spring("drive_voltage - u_lost", "k_s"), [](AssetConfig&) {});
  ASSERT_EQ(exported.refusal(), "");
  EXPECT_THAT(exported.text(), HasSubstr("meaning: \"K\u00f6rper\""));
}

TEST(ExplainedFmu, AUnitThatCannotBeWrappedIsRefusedByName) {
  const auto refusal = [](const TestUnit& unit, const std::string& plant) {
    return Exported(unit, plant, [](AssetConfig&) {}).refusal();
  };
  EXPECT_THAT(refusal(gain(), R"yaml(
meaning: a gain
fmu:
  file: model.fmu
  inputs: {u: u}
  parameters: {k: k}
  variables: {x: {variable: x, unit: "1"}}
inputs:
  u: {unit: "1"}
outputs:
  x: {value: x, unit: "1"}
parameters:
  k: {value: 2.0, unit: "1"}
)yaml"),
              AllOf(HasSubstr("model.fmu"), HasSubstr("Co-Simulation"), HasSubstr("no law can be added")));
}

// With more elements than the description has, whose starts the binary alone knows.
TEST(ExplainedFmu, OfFmi3sOtherTypesAndAStructureThatIsSetIsHandedBack) {
  const Exported exported(types(), R"yaml(
meaning: all types of numbers
fmu:
  file: model.fmu
  settings: {n: 3, flags: "true false"}
  inputs: {u: 2 * u - lost, s: s, e: e, "counts[1]": first, "counts[2]": second}
  parameters: {divisor: divisor, "w[1]": w_1, "w[2]": 2, "w[3]": 3}
  variables: {y: {variable: y, unit: "1"}, low: {variable: low, unit: "1"}, byte: {variable: y_byte, unit: "1"},
              item: {variable: y_item, unit: "1"}}
inputs:
  u: {unit: "1"}
  s: {unit: "1", course: held}
  e: {unit: "1", course: held}
  first: {unit: "1", course: held}
  second: {unit: "1", course: held}
outputs:
  y: {value: y, unit: "1"}
  low: {value: low, unit: "1"}
  byte: {value: byte, unit: "1"}
  item: {value: item, unit: "1"}
parameters:
  divisor: {value: 1.0, unit: "1"}
  w_1: {value: 1.0, unit: "1"}
states:
  x_1: {variable: "x[1]", unit: "1", start: "0", own: false, size: 1.0}
  x_2: {variable: "x[2]", unit: "1", start: "0", own: false, size: 1.0}
  x_3: {variable: "x[3]", unit: "1", start: "0", own: false, size: 1.0}
elements:
  inlet:
    sites:
      - {kind: own, symbol: lost, unit: "1", signals: {a: {value: u, unit: "1", size: 1.0}}, size: 1.0}
law_sizes: {1: 1.0}
)yaml",
                          [](AssetConfig& asset) {
                            asset.parameters["divisor"].value = 2.0;
                            asset.parameters["w_1"].value = 1.5;
                          });
  ASSERT_EQ(exported.refusal(), "");
  EXPECT_THAT(exported.text(), AllOf(HasSubstr("\"x[3]\""), testing::Not(HasSubstr("\"n\""))));
  for (const char* channel : {"y", "low"}) expect_same(exported, channel, channel, 1e-5);
  expect_same(exported, "byte", "y_byte", 0.0);
  expect_same(exported, "item", "y_item", 0.0);
  EXPECT_NEAR(exported.simulated_again("y", [](double) { return 1.0; })(300, 0),
              1111.0 + 2.0 * 6.5 * 2.0 * (1.0 - std::exp(-1.5)), 1e-4);
}

std::string masses_with(const std::string& inputs, const std::string& parameters) {
  return R"yaml(
meaning: two masses
fmu:
  file: model.fmu
  inputs: )yaml" +
         inputs + "\n  parameters: " + parameters + R"yaml(
  variables: {place: {variable: "y[2]", unit: m}}
inputs:
  pull: {unit: N}
  push: {unit: N}
outputs:
  position: {value: place, unit: m}
  first: {value: s_1, unit: m}
parameters:
  m_1: {value: 12.0, unit: kg}
  m_2: {value: 8.0, unit: kg}
states:
  s_1: {variable: "x[1]", unit: m, start: "0[m]", own: false, size: 0.01}
  v_1: {variable: "x[2]", unit: m/s, start: "0[m/s]", own: false, size: 0.1}
  s_2: {variable: "x[3]", unit: m, start: "0[m]", own: false, size: 0.01}
  v_2: {variable: "x[4]", unit: m/s, start: "0[m/s]", own: false, size: 0.1}
elements:
  bearing:
    sites:
      - {kind: piston_force, adds_to: {v_1: -1/m_1}, signals: {speed: v_1, position: s_1}}
  guide:
    sites:
      - {kind: piston_force, symbol: lost, signals: {speed: v_2, position: s_2}}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3}
)yaml";
}

TEST(ExplainedFmu, OfArraysIsHandedBackWithThem) {
  const auto explain = [](AssetConfig& asset) {
    asset.parameters["m_1"].value = 15.0;
    asset.parameters["m_2"].value = 9.0;
    asset.physics = {term("coulomb_friction", "bearing", {{"F_c", 20.0}, {"v_s", 1e-3}}),
                     term("coulomb_friction", "guide", {{"F_c", 10.0}, {"v_s", 1e-3}})};
  };
  // Elements that bring the plant's values; some of an array that follow from them, so that the others do as well.
  const Exported kept(
      masses(), masses_with("{\"f[1]\": 50*pull, \"f[2]\": push - lost}", "{\"m[1]\": m_1, \"m[2]\": m_2}"), explain);
  ASSERT_EQ(kept.refusal(), "");
  EXPECT_THAT(kept.text(),
              AllOf(HasSubstr("\"m[1]\": m_1"), HasSubstr("\"m[2]\": m_2"), HasSubstr("value: 15.0"),
                    HasSubstr("value: 9.0"), HasSubstr("\"pull\": pull"), testing::Not(HasSubstr("f[1]"))));
  expect_same(kept, "position", "position", 1e-8);
  const Exported following(
      masses(),
      masses_with("{\"f[1]\": 50*pull, \"f[2]\": push - lost}", "{\"m[1]\": m_1, \"m[2]\": \"2*m_2 - 9[kg]\"}"),
      explain);
  ASSERT_EQ(following.refusal(), "");
  expect_same(following, "position", "position", 1e-8);
  EXPECT_NEAR(following.simulated_again("position", &ramps)(200, 0), kept.simulated_again("position", &ramps)(200, 0),
              1e-8);
  const Exported alone(masses(), masses_with("{\"f[1]\": pull, \"f[2]\": push - lost}", "{\"m[2]\": m_1 + m_2}"),
                       explain);
  ASSERT_EQ(alone.refusal(), "");
  EXPECT_THAT(alone.text(),
              AllOf(HasSubstr("\"f[1]\": f_1"), HasSubstr("\"f[2]\": f_2"), testing::Not(HasSubstr("pull"))));
  expect_same(alone, "position", "position", 1e-8);
}

TEST(ExplainedFmu, OfAnArrayOfAStructuralSizeIsHandedBack) {
  const Exported exported(arrays(), R"yaml(
meaning: an array of states
fmu:
  file: model.fmu
  parameters: {"x0[1]": a, "x0[2]": b}
  variables: {y: {variable: y, unit: "1"}}
outputs:
  y: {value: y, unit: "1"}
parameters:
  a: {value: 1.0, unit: "1"}
  b: {value: 2.0, unit: "1"}
states:
  x_1: {variable: "x[1]", unit: "1", start: fmu, size: 1.0}
  x_2: {variable: "x[2]", unit: "1", start: fmu, size: 1.0}
)yaml",
                          [](AssetConfig& asset) { asset.parameters["b"].value = 5.0; });
  ASSERT_EQ(exported.refusal(), "");
  EXPECT_NEAR(exported.simulated_again("y", &ramps)(100, 0), 6.0 * std::exp(-1.0), 1e-6);
}

}  // namespace
}  // namespace sealwatch::fmi
