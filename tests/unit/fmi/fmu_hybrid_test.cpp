// Units of FMI 3.0 as public ones are: strict about modes, with event mode of Co-Simulation, early return, intermediate
// update, a clock of their own, variables of many types. They are simulated right, or refused by name.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::HasSubstr;

/// What the unit does: x falls by exp(-k t) and is halved every second.
double expected(double t, double k = 1.0) { return 2.0 * std::exp(-k * t) * std::pow(0.5, std::floor(t + 1e-9)); }

TestUnit hybrid(const std::string& binary, const std::string& interfaces) {
  TestUnit unit{
      .binary = binary, .token = "{hybrid}", .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  unit.interfaces = interfaces;
  unit.variables = R"xml(
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="x" valueReference="1" causality="output" variability="continuous" initial="exact" start="2" reinit="true" intermediateUpdate="true"/>
<Float64 name="der(x)" valueReference="2" causality="local" variability="continuous" derivative="1"/>
<Float64 name="u" valueReference="3" causality="input" start="0"/>
<Float64 name="k" valueReference="4" causality="parameter" variability="tunable" start="1"/>
<Float64 name="x0" valueReference="5" causality="parameter" variability="fixed" start="2"/>
<Float32 name="y32" valueReference="6" causality="output"/>
<Float32 name="u32" valueReference="7" causality="input" start="0"/>
<Float64 name="held" valueReference="8" causality="output" variability="discrete" clocks="9"/>
<Clock name="tick" valueReference="9" causality="local" intervalVariability="triggered"/>
<Int32 name="ticks" valueReference="10" causality="output" clocks="9"/>
<Int64 name="wide" valueReference="11" causality="input" start="0"/>
<Int64 name="y_wide" valueReference="12" causality="output"/>
<Binary name="bytes" valueReference="13" causality="input"><Start value="00"/></Binary>
)xml";
  unit.structure =
      "<Output valueReference=\"1\"/><ContinuousStateDerivative valueReference=\"2\"/>"
      "<InitialUnknown valueReference=\"1\" dependencies=\"5\"/>\n";
  return unit;
}
constexpr const char* kExchange = "<ModelExchange modelIdentifier=\"model\" canGetAndSetFMUState=\"true\"/>\n";
constexpr const char* kSteps =
    "<CoSimulation modelIdentifier=\"model\" canHandleVariableCommunicationStepSize=\"true\" hasEventMode=\"true\" "
    "providesIntermediateUpdate=\"true\" canReturnEarlyAfterIntermediateUpdate=\"true\" "
    "mightReturnEarlyFromDoStep=\"true\"/>\n";

struct Simulated {
  RowMatrix values;
  std::vector<std::string> channels;
  RowMatrix by_k;
  std::string fault;
  [[nodiscard]] double value(int row, const std::string& channel) const {
    const auto at = std::ranges::find(channels, channel);
    return at == channels.end() ? NAN : values(row, at - channels.begin());
  }
};

/// As `plant import` takes it, with samples every 0.3 s.
Simulated simulated(const TestUnit& unit) {
  static int count = 0;
  const TestFolder folder;
  Simulated result;
  const auto fmu = FmuFile::open(folder.build(unit));
  if (!fmu) return result.fault = fmu.error().describe(), result;
  auto text = plant_file_of(**fmu, "model.fmu");
  if (!text) return result.fault = text.error().describe(), result;
  const std::string name = "hybrid_" + std::to_string(++count);
  text->replace(text->find("name: test"), 10, "name: " + name);
  std::ofstream(folder / "plant.yaml") << *text;
  const auto plant = load_plant((folder / "plant.yaml").string());
  if (!plant) return result.fault = plant.error().front().describe(), result;
  TimeSeries recorded;
  for (int row = 0; row <= 15; ++row) recorded.time_s.push_back(0.3 * row);
  for (const ChannelDescription& channel : (*find_plant(name))->channels)
    recorded.channels.push_back({channel.name, channel.unit, 0.0, std::vector<double>(16, 0.0)});
  for (Series& series : recorded.channels)
    if (series.name == "u32" || series.name == "wide") series.values.assign(16, 3.0);
  const auto simulation = PlantSimulation::create(nominal_asset(name), recorded);
  if (!simulation) return result.fault = simulation.error().describe(), result;
  const std::vector<FreeQuantity> free = {*(*simulation)->find("k")};
  const auto outputs = (*simulation)->run((*simulation)->start(), free, {.relative_tolerance = 1e-8});
  if (!outputs) return result.fault = outputs.error().describe(), result;
  result.values = outputs->values, result.by_k = outputs->sensitivities;
  result.channels.assign((*simulation)->channels().begin(), (*simulation)->channels().end());
  return result;
}

TEST(HybridUnit, IsSimulatedByModelExchangeBetweenItsTicks) {
  const Simulated unit = simulated(hybrid("fmu_hybrid3", kExchange));
  ASSERT_EQ(unit.fault, "");
  for (int row = 0; row <= 15; ++row) EXPECT_NEAR(unit.value(row, "x"), expected(0.3 * row), 1e-6) << row;
  EXPECT_EQ(unit.value(15, "ticks"), 4.0);
  EXPECT_NEAR(unit.value(15, "held"), 2.0 * expected(4.0), 1e-6);
  EXPECT_EQ(unit.value(15, "y32"), 3.0);
  EXPECT_EQ(unit.value(15, "y_wide"), 3.0);
}

TEST(HybridUnit, IsSimulatedByCoSimulationWithoutItsEventMode) {
  for (const char* binary : {"fmu_hybrid3", "fmu_hybrid_early3"}) {
    const Simulated unit = simulated(hybrid(binary, kSteps));
    ASSERT_EQ(unit.fault, "") << binary;
    for (int row = 0; row <= 15; ++row) EXPECT_NEAR(unit.value(row, "x"), expected(0.3 * row), 1e-9) << binary << row;
    EXPECT_EQ(unit.value(15, "ticks"), 4.0) << binary;
  }
}

TEST(HybridUnit, ThatIsScheduledFromOutsideIsRefusedByName) {
  TestUnit unit = hybrid("fmu_hybrid3", "<ScheduledExecution modelIdentifier=\"model\"/>\n");
  EXPECT_THAT(simulated(unit).fault, HasSubstr("offers neither Model Exchange nor Co-Simulation"));
}

}  // namespace
}  // namespace sealwatch::fmi
