// What a plant's file with a fault is told: file, line, value, rule, advice; and plants that need little: no state, a
// law of their own, a table, twenty states.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

const std::string kSound = R"(name: NAME
meaning: a mass on a spring
inputs:
  u: {unit: N, meaning: force}
outputs:
  position: {value: x, unit: m, noise_std: 1e-5, meaning: where it is}
parameters:
  M: {value: 2.0, unit: kg, meaning: mass, estimate: true}
  k: {value: 50.0, unit: N/m, meaning: stiffness}
  c: {value: 4.0, unit: N s/m, meaning: damping}
definitions:
  force: u - k*x - c*v
states:
  x: {der: v, unit: m, start: position}
  v: {der: (force - lost)/M, unit: m/s, start: 0, size: 1.0}
elements:
  mass:
    meaning: forces on the mass
    sites:
      - {kind: piston_force, symbol: lost, signals: {speed: v, position: x}}
law_sizes: {N: 1e-3, m: 1, m/s: 1, N/m: 1e-3, N/m2: 1e-3, N s/m: 1e-3, N s2/m2: 1e-3}
)";

std::string with(std::string text, const std::string& what, const std::string& instead) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), instead);
}

std::string written(const std::string& name, const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / (name + ".yaml");
  std::ofstream(file) << with(text, "NAME", name);
  return file.string();
}

std::string faults_of(const std::string& text) {
  const auto plant = read_plant_file(written("faulty", text));
  if (plant) return {};
  std::string all;
  for (const Error& error : plant.error()) all += error.describe() + "\n";
  return all;
}

TEST(PlantFile, OfTheTestsIsSound) { EXPECT_EQ(faults_of(kSound), ""); }

// A winding and a shaft: N m/A follows from N m and A, and A from ohm and ohm/A2, which follow from V and A.
const std::string kMotor = R"(name: motor
meaning: a motor with an inertia
inputs:
  u: {unit: V, meaning: armature voltage}
outputs:
  current: {value: i, unit: A, noise_std: 0.01, meaning: armature current}
  speed: {value: w, unit: rad/s, noise_std: 0.2, meaning: its speed}
parameters:
  R: {value: 1.2, unit: Ohm, meaning: resistance}
  L: {value: 3.0e-3, unit: H, meaning: inductance}
  c: {value: 0.06, unit: V s, meaning: motor constant}
  J: {value: 2.0e-4, unit: kg m2, meaning: inertia, estimate: true}
states:
  i: {der: (u - R*i - c*w - u_lost)/L, unit: A, start: current}
  w: {der: (c*i - lost)/J, unit: rad/s, start: speed}
elements:
  winding: {meaning: its voltages, sites: [{kind: winding_voltage, symbol: u_lost, signals: {current: i, speed: w}}]}
  shaft: {meaning: its torques, sites: [{kind: shaft_torque, symbol: lost, signals: {speed: w, current: i}}]}
law_sizes: SIZES
)";

TEST(PlantFile, EachSizeOfLawsIsKnownOrMissing) {
  const std::string shaft = "N m: 0.1, N m s/rad: 0.1, rad/s: 3, s: 1";
  for (const char* enough : {", V: 1, A: 1}", ", ohm: 2, ohm/A2: 0.1}"}) {
    const auto plant = read_plant_file(written("motor", "#NAME\n" + with(kMotor, "SIZES", "{" + shaft + enough)));
    ASSERT_TRUE(plant) << enough << plant.error().front().describe();
    for (const char* unit : {"ohm", "ohm/A2", "N m/A", "A"}) EXPECT_TRUE(plant->text.law_sizes.contains(unit)) << unit;
  }
  EXPECT_NE(faults_of("#NAME\n" + with(kMotor, "SIZES", "{" + shaft + ", V: 1}")).find("'A': is missing"),
            std::string::npos);
}

TEST(PlantFile, ABadNumberIsOneFault) {
  for (const char* number : {".nan", "\"20,0\""}) {
    const std::string faults =
        faults_of(with(kSound, "{value: 2.0, unit: kg", std::string("{value: ") + number + ", unit: kg"));
    EXPECT_NE(faults.find("key parameters.M.value"), std::string::npos) << faults;
    EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 1) << faults;
  }
}

TEST(PlantFile, NamesEachFaultWithItsLine) {
  struct Case {
    std::string what, instead;
    std::vector<std::string> told;
  };
  const Case cases[] = {
      {"u - k*x - c*v", "u - k*y - c*v", {"line 12, key definitions.force", "'y'", "is not a known quantity"}},
      {"u - k*x - c*v", "u - k*x - c*x", {"line 12", "joins N", "kg m/s"}},
      {"u - k*x - c*v", "u - k*x - c*(v", {"line 12", "character"}},
      {"u - k*x - c*v", "u - k*x - c*v + force", {"depends on itself: force -> force", "algebraic loop"}},
      {"der: v,", "der: x,", {"line 14, key states.x.der", "has the unit m where m/s is needed"}},
      {"value: x,", "value: v,", {"key outputs.position.value", "has the unit m/s where m is needed"}},
      {"value: x,", "value: position,", {"is an output"}},
      {"u - k*x - c*v", "u - k*x*2^2^2^2^2^2^2 - c*v", {"line 12", "2^2^2^2", "a constant that is not finite"}},
      {"  position: {value", "  u: {value", {"line 6, key outputs.u", "is the name of an input too"}},
      {"unit: N s/m", "unit: N s/mm", {"line 10, key parameters.c", "is not the SI unit"}},
      {"unit: N s/m", "unit: N q/m", {"line 10", "'q'"}},
      {"c*v\n", "k*v*1[s]\n", {"line 10, key parameters.c", "stands in no equation"}},
      {"- lost", "", {"line 20, key elements.mass.sites[0]", "adds to no equation"}},
      {"N s/m: 1e-3, N s2/m2: 1e-3",
       "",
       {"line 21, key law_sizes", "'N s/m'", "is missing",
        "N s/m: about 2000000 N s/m (viscous friction of its piston)"}},
      {"N s2/m2: 1e-3}",
       "N s2/m2: 1e-3, N*m: 2}",
       {"line 21, key law_sizes.N*m", "is not a unit of any law; laws have it as N m"}},
      {"u - k*x - c*v", "u - k*x) - c*v", {"line 12", "closes no bracket"}},
      {"start: position", "start: velocity", {"line 14, key states.x.start", "neither a parameter nor a channel"}},
      {", start: 0, size", ", size", {"key states.v", "has no start"}},
      {", size: 1.0", "", {"key states.v", "has no size"}},
      {"noise_std: 1e-5", "noise_std: 0", {"line 6, key outputs.position.noise_std: '0'", "from 1e-100 to 1e100"}},
      {"noise_std: 1e-5", "noise_std: 1e308", {"key outputs.position.noise_std: '1e308'", "from 1e-100 to 1e100"}},
      {"noise_std: 1e-5", "noise_std: 1e-320", {"key outputs.position.noise_std: '1e-320'", "from 1e-100 to 1e100"}},
      {"kind: piston_force", "kind: piston_forc", {"did you mean 'piston_force'"}},
      {"{speed: v,", "{sped: v,", {"sped", "did you mean 'speed'"}},
      {"symbol: lost", "adds_to: {w: -1/M}", {"'w'", "is not a state"}},
      {"k: {value: 50.0", "x: {value: 50.0", {"is a name already"}},
      {"c: {value: 4.0, unit", "c: {value: four, unit", {"line 10", "must be a number"}},
      {"kind: piston_force", "kind: force", {"'force'", "known are: voltage_command"}},
      {"unit: N s/m", "unit: Ns/m", {"line 10", "write a product with blanks: N s"}},
      {"der: v, unit: m", "der: \"v + 20[degC]*1[m/s/K]\", unit: m", {"'degC'", "write temperatures in K"}},
      {"unit: N s/m", "unit: kg rpm", {"is not the SI unit", "here kg/s"}},
      {"c: {value: 4.0", "c: {value: 0", {"line 10", "give min and max"}},
      {"NAME", "eha #NAME", {"line 1, key name", "is the name of a plant that is built in"}},
      {"N: 1e-3, ", "", {"which is N: about 60000 N (load on its rod)"}},
      {"meaning: a mass", "meening: a mass", {"did you mean 'meaning'"}},
      {"outputs:\n", "output:\n", {"line 5, key output", "did you mean 'outputs'"}},
  };
  for (const Case& one : cases) {
    const std::string told = faults_of(with(kSound, one.what, one.instead));
    for (const std::string& words : one.told)
      EXPECT_NE(told.find(words), std::string::npos) << one.what << " -> " << one.instead << ":\n" << told;
    EXPECT_NE(told.find("faulty.yaml"), std::string::npos) << told;
  }
}

// Stiffnesses follow from forces and ways, drags by the square of the speed from frictions and forces.
TEST(PlantFile, SizesOfLawsThatFollowFromOthersNeedNotBeGiven) {
  const auto plant = read_plant_file(
      written("derived", with(kSound, "{N: 1e-3, m: 1, m/s: 1, N/m: 1e-3, N/m2: 1e-3, ", "{N: 0.1, m: 4, m/s: 20, ")));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const std::map<std::string, double>& sizes = plant->text.law_sizes;
  EXPECT_NEAR(sizes.at("N/m"), 0.1 / 4.0, 1e-12);
  EXPECT_NEAR(sizes.at("N/m2"), 0.1 / 16.0, 1e-12);
  EXPECT_NEAR(sizes.at("N s2/m2"), 1e-3, 1e-12) << "as given";
  const auto tank = read_plant_file(written("tank", with(kSound, "{N: 1e-3,", "{m3/s: 100, m3/(s Pa): 1e5, N: 1e-3,")));
  ASSERT_TRUE(tank) << tank.error().front().describe();
  EXPECT_NEAR(tank->text.law_sizes.at("Pa"), 1e-3, 1e-15) << "over which turbulent leaks are rounded";
  const auto hydraulic = faults_of(
      with(with(kSound, "signals: {speed: v,", "signals: {pressure_a: \"k*x/1[m2]\", pressure_b: \"0[Pa]\", speed: v,"),
           "N/m: 1e-3, N/m2: 1e-3, ", ""));
  EXPECT_NE(hydraulic.find("'m2'"), std::string::npos) << "nothing says what a pressure is: " << hydraulic;
}

std::size_t count_of_faults(const std::string& text) {
  const auto plant = read_plant_file(written("faulty", text));
  return plant ? 0 : plant.error().size();
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int k = 0; k < times; ++k) all += text;
  return all;
}

TEST(PlantFile, ThatWouldTakeAllOfTheStackIsRefused) {
  EXPECT_EQ(faults_of(with(kSound, "u - k*x", "u" + repeated(" + u", 3000) + " - k*x")), "");
  EXPECT_NE(faults_of(with(kSound, "u - k*x", "u" + repeated(" + u", 80000) + " - k*x")).find("is too long"),
            std::string::npos);
  EXPECT_NE(faults_of(with(kSound, "u - k*x", repeated("-", 100000) + "u - k*x")).find("nested too deeply"),
            std::string::npos);
  EXPECT_NE(faults_of(with(kSound, "u - k*x", repeated("(", 100000) + "u - k*x")).find("nested too deeply"),
            std::string::npos);
  std::string chain;
  for (int k = 0; k < 2000; ++k) chain += "  d" + std::to_string(k) + ": d" + std::to_string(k + 1) + " + 1\n";
  EXPECT_NE(faults_of(with(kSound, "definitions:\n", "definitions:\n" + chain + "  d2000: 1.5\n")).find("within more"),
            std::string::npos);
  EXPECT_NE(faults_of(with(kSound, "unit: kg,", "unit: " + repeated("m", 200) + "x,")).find("is not a unit"),
            std::string::npos);
}

TEST(PlantFile, TellsOneFaultOnce) {
  EXPECT_EQ(count_of_faults(with(kSound, "u - k*x", "u - k*y")), 1U) << "not at each equation that uses it too";
  EXPECT_EQ(count_of_faults(with(kSound, "u - k*x", "force - k*x")), 1U);
  EXPECT_EQ(count_of_faults(with(kSound, "unit: kg,", "unit: kgs,")), 1U) << "a mass of no known unit fits any";
  EXPECT_EQ(count_of_faults(with(kSound, "kind: piston_force", "kind: piston")), 1U);
  EXPECT_EQ(count_of_faults(with(kSound, "value: 2.0", "value: 0")), 1U);
}

// A noisy tachometer beside a fine encoder: what the integration may miss of the speed adds up in the angle.
TEST(PlantFile, AStateIsIntegratedAsFinelyAsItsIntegralIsSeen) {
  const std::string speed =
      with(with(kSound, ", size: 1.0", ""), "outputs:\n", "outputs:\n  speed: {value: v, unit: m/s, noise_std: 0.1}\n");
  const auto plant = read_plant_file(written("tachometer", speed));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const std::vector<RuntimeState>& states = plant->built.plant.states;
  EXPECT_LE(states[1].scale, states[0].scale);
  EXPECT_GT(states[1].scale, 0.0);
}

TEST(PlantFile, ThatIsLoadedTwiceIsOnePlantAndAnotherOfItsNameIsRefused) {
  const auto first = load_plant(written("loaded", kSound)), again = load_plant(written("loaded", kSound));
  ASSERT_TRUE(first && again);
  EXPECT_EQ(*first, *again);
  const auto other = load_plant(written("loaded", with(kSound, "value: 2.0", "value: 3.0")));
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().front().describe().find("give this plant another name"), std::string::npos);
  EXPECT_FALSE(load_plant(written("taken", with(kSound, "NAME", "emps #NAME"))));
}

TimeSeries samples_of(const std::vector<std::pair<std::string, double (*)(double)>>& channels, int rows,
                      double step_s) {
  TimeSeries samples;
  for (const auto& [name, course] : channels) {
    samples.channels.push_back({name, "", 0.0, {}});
    for (int row = 0; row < rows; ++row) samples.channels.back().values.push_back(course(step_s * row));
  }
  for (int row = 0; row < rows; ++row) samples.time_s.push_back(step_s * row);
  return samples;
}

/// Sensitivities of parameters and of laws' parameters against differences of whole simulations.
void expect_exact_sensitivities(const PlantSimulation& simulation) {
  constexpr SimulationOptions kTight = {.relative_tolerance = 1e-10, .maximum_steps = 2000000};
  std::vector<FreeQuantity> free;
  for (const auto& parameter : simulation.plant().parameters) free.push_back(*simulation.find(parameter.name));
  for (const auto& parameter : simulation.physics_parameters()) free.push_back(*simulation.find(parameter.name));
  const ModelValues values = simulation.start();
  const auto outputs = simulation.run(values, free, kTight);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  for (std::size_t k = 0; k < free.size(); ++k) {
    ModelValues up = values, down = values;
    const double step = 1e-4 * std::abs(free[k].in(values));
    free[k].in(up) += step;
    free[k].in(down) -= step;
    const auto after = simulation.run(up, {}, kTight), before = simulation.run(down, {}, kTight);
    ASSERT_TRUE(after && before);
    const RowMatrix difference = (after->values - before->values) / (2.0 * step);
    const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
    EXPECT_GT(flat.norm(), 0.0) << k;
    EXPECT_LT((flat - outputs->sensitivities.col(static_cast<Eigen::Index>(k))).norm(), 1e-4 * flat.norm()) << k;
  }
}

const std::string kWithoutStates = R"(name: NAME
meaning: friction without inertia
inputs:
  position: {unit: m}
  pressure: {unit: Pa}
outputs:
  force: {value: area*pressure*gain(pressure) + lost, unit: N, noise_std: 0.1}
parameters:
  area: {value: 5e-4, unit: m2, estimate: true}
tables:
  gain: {x: [0, 1e5, 3e5], x_unit: Pa, y: [1.0, 1.02, 1.05]}
elements:
  seal:
    sites: [{kind: piston_force, symbol: lost, signals: {speed: rate(position), position: position, pressure_a: pressure}}]
laws:
  - id: gripping_seal
    element: seal
    equation: (F_0 + c*pressure_a) * sign(speed, v_s) + k*grip
    meaning: an O-ring that grips
    parameters:
      F_0: {unit: N, usual: 5.0, matters: 0.5, max: 100, min: 0, strength: true}
      c: {unit: m2, usual: 1e-5, matters: 1e-6, max: 1e-3, min: 0, strength: true}
      v_s: {unit: m/s, usual: 1e-3, grid: [1e-4], min: 1e-5, max: 1e-1}
      k: {unit: N/m, usual: 1e3, matters: 100, min: 0, max: 1e6, strength: true}
    hidden: {name: grip, unit: m, der: "speed - abs(speed, 1e-6[m/s])*grip/1e-4[m]", size: 1e-4}
law_sizes: {N: 1e-2, m: 1, m/s: 1, N/m: 2e-2, N/m2: 2e-2, N s/m: 1e-3, N s2/m2: 1e-4, m2: 1e-2}
)";

TEST(PlantFile, MayHaveNoStateATableAndALawOfItsOwn) {
  const auto plant = load_plant(written("without_states", kWithoutStates));
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  const TimeSeries samples = samples_of({{"position", [](double t) { return 0.02 * std::sin(2.0 * t); }},
                                         {"pressure", [](double t) { return 2e5 + 1e4 * std::cos(t); }},
                                         {"force", [](double) { return 100.0; }}},
                                        501, 0.01);
  AssetConfig asset = nominal_asset("without_states");
  const auto plain = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(plain) << plain.error().describe();
  const auto outputs = (*plain)->run((*plain)->start(), {});
  ASSERT_TRUE(outputs) << outputs.error().describe();
  EXPECT_NEAR(outputs->values(0, 0), 5e-4 * 2.1e5 * (1.035 + 0.0018), 0.2);
  expect_exact_sensitivities(**plain);
  PhysicsTerm law{.id = "gripping_seal", .element = "seal", .parameters = {}};
  for (const auto& [name, value] : {std::pair{"F_0", 5.0}, {"c", 1e-5}, {"v_s", 5e-3}, {"k", 1e3}})
    law.parameters[name] = {value, 0.0, 1e6, true};
  asset.physics = {law};
  const auto gripping = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(gripping) << gripping.error().describe();
  expect_exact_sensitivities(**gripping);
  asset.model = "emps";
  EXPECT_FALSE(PlantSimulation::create(asset, samples)) << "a plant's own law is its own";
}

TEST(PlantFile, NamesTheFaultsOfALawOfItsOwn) {
  const std::array<std::string, 3> cases[] = {{"k*grip", "k*grip + 1[N]", "is not proportional to its strengths"},
                                              {"der: \"speed -", "der: \"grip -", "joins m"},
                                              {"c*pressure_a", "c*pressure_b", "neither a signal"}};
  for (const auto& [what, instead, told] : cases) {
    const std::string all = faults_of(with(kWithoutStates, what, instead));
    EXPECT_NE(all.find(told), std::string::npos) << instead << ":\n" << all;
    EXPECT_NE(all.find("laws[0]"), std::string::npos) << all;
  }
}

TEST(PlantFile, ThatExplodesIsAnErrorOfTheIntegrator) {
  const std::string text = with(kSound, "u - k*x - c*v", "u - k*x - c*v + 1e6[N/m3]*x^3");
  const auto plant = load_plant(written("exploding", text));
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  const auto simulation = PlantSimulation::create(
      nominal_asset("exploding"),
      samples_of({{"u", [](double t) { return 100.0 * t; }}, {"position", [](double) { return 0.0; }}}, 501, 0.02));
  ASSERT_TRUE(simulation);
  const auto outputs = (*simulation)->run((*simulation)->start(), {});
  ASSERT_FALSE(outputs);
  const std::string told = outputs.error().describe();
  EXPECT_NE(told.find("was given up after"), std::string::npos) << told;
  EXPECT_NE(told.find("moves fastest"), std::string::npos) << told;
}

Result<SimulatedOutputs> simulated(const std::string& name, const std::string& text, const SimulationOptions& options) {
  const auto plant = load_plant(written(name, text));
  if (!plant) return fail(combine(plant.error()));
  const auto simulation = PlantSimulation::create(
      nominal_asset(name),
      samples_of({{"u", [](double t) { return 100.0 * t; }}, {"position", [](double) { return 0.0; }}}, 501, 0.02));
  if (!simulation) return fail(simulation.error());
  return (*simulation)->run((*simulation)->start(), {}, options);
}

TEST(PlantFile, WhoseSimulationDoesNotEndOrStartIsToldWhy) {
  const auto slow = simulated("slow", kSound, {.maximum_steps = 10});
  ASSERT_FALSE(slow);
  EXPECT_NE(slow.error().describe().find("given up after 10 steps"), std::string::npos) << slow.error().describe();
  const std::string never =
      with(with(kSound, "u - k*x - c*v", "1[N] + c*v^2/1[m/s] + k*x^2/1[m]"), "size: 1.0", "size: 1.0, settles: true");
  const auto restless = simulated("restless", never, {});
  ASSERT_FALSE(restless) << "a force that nothing balances";
  EXPECT_NE(restless.error().describe().find("no rest"), std::string::npos) << restless.error().describe();
}

/// A chain of ten masses between springs, pushed at its first: 20 states, 5 sites.
std::string chain_of_masses() {
  std::string states, elements, sites;
  for (int k = 0; k < 10; ++k) {
    const std::string i = std::to_string(k), before = std::to_string(k - 1), after = std::to_string(k + 1);
    const std::string pushed = k == 0 ? "u - k*x0" : "k*(x" + before + " - x" + i + ")";
    const std::string held = k == 9 ? "0" : "k*(x" + i + " - x" + after + ")";
    const std::string lost = k % 2 == 0 ? " - lost" + i : "";
    states += "  x" + i + ": {der: v" + i + ", unit: m, start: 0, size: 0.1, own: false}\n";
    states += "  v" + i + ": {der: (" + pushed + " - " + held + " - c*v" + i + lost +
              ")/M, unit: m/s, start: 0, size: 1, own: false}\n";
    if (k % 2 == 0)
      elements += "  mass" + i + ": {sites: [{kind: piston_force, symbol: lost" + i + ", signals: {speed: v" + i +
                  ", position: x" + i + "}}]}\n";
  }
  return "name: NAME\nmeaning: chain\ninputs: {u: {unit: N}}\n"
         "outputs: {first: {value: x0, unit: m, noise_std: 1e-5}, last: {value: x9, unit: m, noise_std: 1e-5}}\n"
         "parameters:\n  M: {value: 2.0, unit: kg, estimate: true}\n  k: {value: 500.0, unit: N/m, estimate: true}\n"
         "  c: {value: 4.0, unit: N s/m, estimate: true}\nstates:\n" +
         states + "elements:\n" + elements +
         "law_sizes: {N: 1e-3, m: 1, m/s: 1, N/m: 1e-3, N/m2: 1e-3, N s/m: 1e-3, N s2/m2: 1e-3}\n";
}

TEST(PlantFile, MayHaveTwentyStatesAndFiveSites) {
  const auto plant = load_plant(written("chain", chain_of_masses()));
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  EXPECT_EQ((*plant)->states.size(), 20U);
  EXPECT_EQ((*plant)->sites.size(), 5U);
  AssetConfig asset = nominal_asset("chain");
  PhysicsTerm friction{.id = "coulomb_friction", .element = "mass4", .parameters = {}};
  friction.parameters = {{"F_c", {1.0, 0.0, 100.0, true}}, {"v_s", {0.05, 1e-3, 1.0, true}}};
  asset.physics = {friction};
  const auto simulation =
      PlantSimulation::create(asset, samples_of({{"u", [](double t) { return 50.0 * std::sin(3.0 * t); }},
                                                 {"first", [](double) { return 0.0; }},
                                                 {"last", [](double) { return 0.0; }}},
                                                501, 0.01));
  ASSERT_TRUE(simulation) << simulation.error().describe();
  expect_exact_sensitivities(**simulation);
}

// Two sites of the plant's own kind, one signal of which has the same name.
const std::string kOwnSites =
    with(with(kSound, "(force - lost)", "(force - lost - drag - grip)"), "law_sizes:", R"(  rail:
    meaning: the rail
    sites:
      - {kind: own, unit: N, size: 2, symbol: drag, signals: {pace: {value: v, unit: m/s, size: 0.5}}}
  clamp:
    meaning: a clamp
    sites:
      - kind: own
        unit: N
        size: 3
        symbol: grip
        signals: {pace: {value: v, unit: m/s, size: 0.5}, place: {value: x, unit: m, size: 0.1}}
law_sizes:)");

TEST(OwnSites, AreAskedForCurvesOfTheirSignals) {
  const auto plant = read_plant_file(written("own_sites", kOwnSites));
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  std::map<std::string, const Law*> forms;
  std::map<std::string, int> names;
  for (const Law& law : plant->built.laws) {
    EXPECT_EQ(law.id, "unlisted");
    EXPECT_TRUE(law.closed_form);
    forms[std::string(law.form)] = &law;
    ++names[std::string(law.parameters[0].name) + std::string(law.parameters[1].name)];
  }
  EXPECT_EQ(plant->built.laws.size(), 3U + 2U * 4U) << "three of each signal, and either by the other";
  EXPECT_EQ(names.size(), plant->built.laws.size()) << "parameters tell laws of one id apart";
  ASSERT_TRUE(forms.contains("clamp_pace_by_place"));
  const Law& product = *forms.at("clamp_pace_by_place");
  EXPECT_EQ(product.equation, "k_clamp_pace (pace / 0.5 m/s) abs(place / 0.1 m)^b_place");
  const LawOutput at = product.evaluate(law_input(std::array{0.25, -0.2}, 0.0, std::array{6.0, 2.0}, {}));
  EXPECT_NEAR(at.contribution.value, 6.0 * 0.5 * 4.0, 0.01);
  const Law& power = *forms.at("rail_pace_power");
  const LawOutput against = power.evaluate(law_input(std::array{-1.0}, 0.0, std::array{2.0, 3.0}, {}));
  EXPECT_NEAR(against.contribution.value, -2.0 * 8.0, 0.01);
}

TEST(OwnSites, AreAskedForNoneWhereASizeIsMissing) {
  const auto plant = read_plant_file(written("own_sites_without", with(kOwnSites, ", size: 0.1}", "}")));
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  EXPECT_EQ(plant->built.laws.size(), 3U) << "of the other site";
}

TEST(OwnSites, HaveSizesAboveZero) {
  EXPECT_NE(faults_of(with(kOwnSites, "size: 0.1}", "size: 0}")).find("size: '0'"), std::string::npos)
      << faults_of(with(kOwnSites, "size: 0.1}", "size: 0}"));
}

}  // namespace
}  // namespace sealwatch
