// Dependencies that ModelStructure declares make a large Jacobian cheap, and are not believed where the values differ.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/column_groups.hpp"
#include "services/common/fmi/fmu_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kCells = 12;

TEST(ColumnGroups, NeighboursTakeThreeAndAFullRowAll) {
  const std::vector<std::uint32_t> chain = {2, 0, 1, 3, 0, 1, 2, 3, 1, 2, 3, 2, 2, 3};
  const std::vector<ColumnGroup> groups = column_groups(chain, 4);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_THAT(groups[0].columns, ElementsAre(0, 3));
  ASSERT_EQ(groups[0].places.size(), 4U);
  EXPECT_EQ(groups[0].places[2].row, 2U);
  EXPECT_EQ(groups[0].places[2].column, 3U);
  std::vector<std::uint32_t> with_full_row = chain;
  with_full_row.insert(with_full_row.end(), {4, 0, 1, 2, 3});
  EXPECT_EQ(column_groups(with_full_row, 4).size(), 4U);
  EXPECT_EQ(column_groups({}, 4).size(), 4U);
}

struct Jacobian {
  std::vector<double> numbers;
  double calls = 0.0;  // that it took
};

Jacobian jacobian_of(const TestUnit& unit) {
  const TestFolder folder;
  const std::string path = folder.build(unit);
  const auto file = FmuFile::open(path);
  EXPECT_TRUE(file) << file.error().describe();
  const ModelDescription& description = (*file)->description();
  const auto place = [&](const char* name) {
    return static_cast<std::size_t>(description.find(name) - description.variables.data());
  };
  Selection selection{{place("C"), place("G")}, {place("P")}, {place("first"), place("calls")}};
  auto process = FmuProcess::start(path, *(*file)->setup(selection), 1);
  EXPECT_TRUE(process) << process.error().describe();
  const std::vector<double> steps(kCells, 1e-6), inputs = {1.0}, parameters = {1.0, 50.0};
  EXPECT_TRUE((*process)->begin(
      {.state_steps = steps, .input_steps = std::span(steps).first(1), .inputs = inputs, .parameters = parameters}));
  std::vector<double> states;
  for (std::size_t k = 0; k < kCells; ++k) states.push_back(1.0 / (1.0 + static_cast<double>(k)));
  Jacobian result;
  const double before = (*process)->evaluate(0.0, states, inputs, {})->outputs[1];
  const auto values = (*process)->evaluate(0.0, states, inputs, {.by_state = 1});
  EXPECT_TRUE(values) << values.error().describe();
  for (const auto& part : {values->derivatives_by_state, values->outputs_by_state})
    result.numbers.insert(result.numbers.end(), part.begin(), part.end());
  result.numbers.resize((kCells + 1) * kCells);  // without that of the calls
  result.calls = (*process)->evaluate(0.0, states, inputs, {})->outputs[1] - before;
  return result;
}

TEST(SparseJacobian, TakesFewCallsAndIsTheSame) {
  for (const char* binary : {"fmu_rod2", "fmu_rod_partials2"}) {
    const Jacobian full = jacobian_of(rod(binary, false)), sparse = jacobian_of(rod(binary, true));
    ASSERT_EQ(full.numbers.size(), sparse.numbers.size());
    for (std::size_t k = 0; k < full.numbers.size(); ++k) EXPECT_NEAR(full.numbers[k], sparse.numbers[k], 1e-6) << k;
    EXPECT_LT(2.5 * sparse.calls, full.calls) << binary;  // three groups, not twelve columns
  }
}

std::string rod_file(const TestFolder& folder, const std::string& name) {
  std::string text = "name: " + name + R"yaml(
meaning: a rod
fmu:
  file: model.fmu
  inputs: {P: P}
  parameters: {C: C, G: G}
  variables: {first: {variable: first, unit: K}}
inputs:
  P: {unit: W, meaning: heat}
outputs:
  heated_end: {value: first, unit: K, noise_std: 1.0e-3, meaning: temperature of the heated end}
parameters:
  C: {value: 1.0, unit: J/K, meaning: capacity, estimate: true}
  G: {value: 50.0, unit: W/K, meaning: conductance, estimate: true}
elements: {}
law_sizes: {}
states:
)yaml";
  for (std::size_t k = 1; k <= kCells; ++k) {
    const std::string cell = std::to_string(k);
    text += "  T" + cell + ": {variable: T" + cell + ", unit: K, start: \"0[K]\", own: false, size: 1.0}\n";
  }
  const std::string file = (folder / (name + ".yaml")).string();
  std::ofstream(file) << text;
  return file;
}

SimulatedOutputs heated(const std::string& file) {
  const auto plant = load_plant(file);
  EXPECT_TRUE(plant) << plant.error().front().describe();
  TimeSeries samples;
  samples.channels = {{"P", "W", 0.0, {}}, {"heated_end", "K", 0.0, {}}};
  for (int row = 0; row < 101; ++row) {
    samples.time_s.push_back(0.02 * row);
    samples.channels[0].values.push_back(30.0 * std::sin(0.1 * row));
    samples.channels[1].values.push_back(0.0);
  }
  const auto simulation = PlantSimulation::create(nominal_asset((*plant)->name), samples);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const std::vector<FreeQuantity> free = {*(*simulation)->find("C"), *(*simulation)->find("G")};
  auto outputs =
      (*simulation)->run((*simulation)->start(), free, {.relative_tolerance = 1e-7, .maximum_steps = 2000000});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  return std::move(*outputs);
}

void expect_same(const TestUnit& declared, const TestUnit& open, const std::string& name) {
  const TestFolder one, other;
  static_cast<void>(one.build(declared)), static_cast<void>(other.build(open));
  const SimulatedOutputs found = heated(rod_file(one, name)), expected = heated(rod_file(other, name + "_open"));
  EXPECT_LT((found.values - expected.values).cwiseAbs().maxCoeff(), 1e-5 * expected.values.cwiseAbs().maxCoeff());
  for (Eigen::Index k = 0; k < 2; ++k)
    EXPECT_LT((found.sensitivities.col(k) - expected.sensitivities.col(k)).cwiseAbs().maxCoeff(),
              1e-4 * expected.sensitivities.col(k).cwiseAbs().maxCoeff())
        << name << ", " << k;
}

TEST(SparseJacobian, ARunIsThatOfEveryColumnAlone) {
  expect_same(rod("fmu_rod2", true), rod("fmu_rod2", false), "rod");
  expect_same(rod("fmu_rod_partials2", true), rod("fmu_rod2", false), "rod_partials");
}

TEST(SparseJacobian, ADependencyThatIsNotDeclaredIsToldAndFound) {
  const TestFolder folder;
  const auto remarks = [&](const std::string& binary, const std::string& name) {
    static_cast<void>(folder.build(rod(binary, true)));
    const auto plant = read_plant_file(rod_file(folder, name));
    EXPECT_TRUE(plant) << plant.error().front().describe();
    return plant ? plant->built.remarks : std::vector<std::string>();
  };
  EXPECT_THAT(remarks("fmu_rod2", "honest"), IsEmpty());
  EXPECT_THAT(remarks("fmu_rod_hides2", "hiding"), ElementsAre(HasSubstr("der(T3) depends on T10, which ModelStr")));
  expect_same(rod("fmu_rod_hides2", true), rod("fmu_rod_hides2", false), "rod_hides");
}

TEST(SparseJacobian, ADependencyThatShowsFarFromTheStartIsFoundInTheRun) {
  expect_same(rod("fmu_rod_hides_beyond2", true), rod("fmu_rod_hides_beyond2", false), "rod_hides_beyond");
}

}  // namespace
}  // namespace sealwatch::fmi
