// A plant that is known at run time only against the same plant built in: outputs, sensitivities, laws with hidden
// states, injected columns; a plant without states; equations that fail.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/runtime_equations.hpp"
#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-9, .maximum_steps = 2000000};
constexpr double kWithinIntegration = 1e-6;  // relative to the largest value of a column

/// The equations of `emps` by hand: x, v; M, F_v, k_F; sites driver and piston. Broken: dv/dt is no number beyond a
/// speed.
class HandWrittenEmps final : public RuntimeEquations {
 public:
  explicit HandWrittenEmps(double broken_above_m_s = 1e9) : broken_above_m_s_(broken_above_m_s) {}

  class Evaluator final : public RuntimeEvaluator {
   public:
    Evaluator(std::vector<std::size_t> differentiated, double broken_above_m_s)
        : differentiated_(std::move(differentiated)), broken_above_m_s_(broken_above_m_s) {}

    bool evaluate(RuntimeFunction function, const RuntimePoint& at, std::span<double> values) override {
      const auto* all = linearise(function, at, {});
      if (all == nullptr) return false;
      std::ranges::copy(all->values, values.begin());
      return true;
    }
    const RuntimeLinearisation* linearise(RuntimeFunction function, const RuntimePoint& at,
                                          RuntimeDirections) override {
      const double x = at.states[0], v = at.states[1], u = at.inputs[0] - at.added[0];
      const double M = at.parameters[0], F_v = at.parameters[1], k_F = at.parameters[2];
      if (function == RuntimeFunction::derivatives) {
        if (v > broken_above_m_s_) return nullptr;
        const double force = k_F * u - F_v * v - at.added[1];
        shape(2);
        result_.values = {v, force / M};
        result_.by_state.values = {0.0, 1.0, 0.0, -F_v / M};
        result_.by_added.values = {0.0, 0.0, -k_F / M, -1.0 / M};
        const std::array by_parameter = {-force / (M * M), -v / M, u / M};
        for (std::size_t k = 0; k < differentiated_.size(); ++k)
          result_.by_parameter.row(1)[k] = by_parameter[differentiated_[k]];
      } else if (function == RuntimeFunction::signals) {
        shape(2 * kSiteSignals);
        result_.values = {0.0, at.inputs[0], at.input_rates[0], 0.0, v, x, 0.0, 0.0};
        result_.by_state.row(4)[1] = result_.by_state.row(5)[0] = 1.0;
      } else {
        shape(1);
        result_.values = {x};
        result_.by_state.row(0)[0] = 1.0;
      }
      return &result_;
    }
    std::string trouble() const override { return "too fast"; }

   private:
    void shape(std::size_t rows) {
      result_.values.assign(rows, 0.0);
      result_.by_state.resize(rows, 2);
      result_.by_parameter.resize(rows, differentiated_.size());
      result_.by_added.resize(rows, 2);
    }
    std::vector<std::size_t> differentiated_;
    double broken_above_m_s_;
    RuntimeLinearisation result_;
  };

  Result<std::unique_ptr<RuntimeEvaluator>> evaluator(const RuntimePoint&,
                                                      std::span<const std::size_t> differentiated) const override {
    return std::make_unique<Evaluator>(std::vector(differentiated.begin(), differentiated.end()), broken_above_m_s_);
  }
  Result<std::vector<double>> initial_state(std::span<const double>, const TimeSeries& recorded) const override {
    return std::vector{recorded.find("position")->values.front(), 0.0};
  }

 private:
  double broken_above_m_s_;
};

RuntimePlant runtime_emps(const std::string& name, double broken_above_m_s, int output_state) {
  RuntimePlant plant;
  plant.description = *find_plant("emps").value();
  plant.description.name = name;
  plant.states = {{.scale = 1e-11}, {.scale = 1e-9}};
  plant.inputs = {{"motor_voltage", InputCourse::averaged}};
  plant.outputs = {{"position", output_state}};
  plant.equations = std::make_shared<HandWrittenEmps>(broken_above_m_s);
  return plant;
}

AssetConfig asset_of(const std::string& model, std::vector<PhysicsTerm> physics = {}) {
  static const bool added = add_plant(runtime_emps("emps_by_hand", 1e9, 0)).has_value() &&
                            add_plant(runtime_emps("emps_computed_output", 1e9, -1)).has_value() &&
                            add_plant(runtime_emps("emps_broken", 0.01, 0)).has_value();
  EXPECT_TRUE(added);
  AssetConfig asset = nominal_asset("emps");
  asset.model = model;
  asset.physics = std::move(physics);
  return asset;
}

TimeSeries strokes() {
  TimeSeries samples;
  samples.channels = {{"motor_voltage", "V", 0.0, {}}, {"position", "m", 0.0, {}}};
  for (int row = 0; row < 1001; ++row) {
    samples.time_s.push_back(2e-3 * row);
    samples.channels[0].values.push_back(3.0 * std::sin(2.0 * std::numbers::pi * 2e-3 * row));
    samples.channels[1].values.push_back(0.01);
  }
  return samples;
}

std::vector<FreeQuantity> everything(const PlantSimulation& simulation) {
  std::vector<FreeQuantity> free;
  for (const auto& parameter : simulation.plant().parameters) free.push_back(*simulation.find(parameter.name));
  for (const auto& parameter : simulation.physics_parameters()) free.push_back(*simulation.find(parameter.name));
  for (const auto& state : simulation.state_names()) free.push_back(*simulation.find("initial:" + state));
  return free;
}

/// Two columns, one of which is fed at both sites.
class Columns final : public InjectedColumns {
 public:
  std::size_t columns() const override { return 2; }
  std::span<const Entry> entries() const override { return entries_; }
  void weigh(double, Signals signals, std::span<double> weights) override {
    weights[0] = signals[0][1];
    weights[1] = signals[1][0];
    weights[2] = std::tanh(signals[1][0] / 0.01);
  }

 private:
  std::array<Entry, 3> entries_ = {Entry{0, 0}, Entry{0, 1}, Entry{1, 1}};
};

void expect_equal(const std::string& model, const std::vector<PhysicsTerm>& physics, InjectedColumns* injected) {
  const TimeSeries samples = strokes();
  const auto native = PlantSimulation::create(asset_of("emps", physics), samples);
  const auto runtime = PlantSimulation::create(asset_of(model, physics), samples);
  ASSERT_TRUE(native) << native.error().describe();
  ASSERT_TRUE(runtime) << runtime.error().describe();
  const auto free = everything(**native);
  const auto expected = (*native)->run((*native)->start(), free, kTight, injected);
  const auto found = (*runtime)->run((*native)->start(), everything(**runtime), kTight, injected);
  ASSERT_TRUE(expected) << expected.error().describe();
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_LT((expected->values - found->values).cwiseAbs().maxCoeff(),
            kWithinIntegration * expected->values.cwiseAbs().maxCoeff());
  ASSERT_EQ(expected->sensitivities.cols(), found->sensitivities.cols());
  for (Eigen::Index k = 0; k < expected->sensitivities.cols(); ++k) {
    const double size = expected->sensitivities.col(k).cwiseAbs().maxCoeff();
    EXPECT_GT(size, 0.0) << k;
    EXPECT_LT((expected->sensitivities.col(k) - found->sensitivities.col(k)).cwiseAbs().maxCoeff(),
              kWithinIntegration * size)
        << model << ", column " << k;
  }
}

PhysicsTerm law(const std::string& id, const std::map<std::string, double>& values) {
  PhysicsTerm term{.id = id, .element = "piston", .parameters = {}};
  for (const auto& [name, value] : values) term.parameters[name] = {value, value, value, false};
  return term;
}

TEST(RuntimePlant, IsTheBuiltInPlant) { expect_equal("emps_by_hand", {}, nullptr); }

TEST(RuntimePlant, CarriesLawsWithAndWithoutHiddenStates) {
  expect_equal("emps_by_hand", {law("coulomb_friction", {{"F_c", 20.0}, {"v_s", 2e-3}})}, nullptr);
  const auto names = [](const Law& known) { return known.hidden && known.id == "presliding_friction"; };
  const auto dahl = std::ranges::find_if(all_laws(), names);
  ASSERT_NE(dahl, all_laws().end());
  std::map<std::string, double> values;
  for (const LawParameter& parameter : dahl->parameters)
    values[std::string(parameter.name)] = law_start(**find_plant("emps"), parameter);
  expect_equal("emps_by_hand", {law("presliding_friction", values)}, nullptr);
}

TEST(RuntimePlant, DifferentiatesByInjectedColumns) {
  Columns columns;
  expect_equal("emps_by_hand", {}, &columns);
  expect_equal("emps_by_hand", {law("coulomb_friction", {{"F_c", 20.0}, {"v_s", 2e-3}})}, &columns);
}

TEST(RuntimePlant, ComputesAnOutputThatIsNoState) {
  Columns columns;
  expect_equal("emps_computed_output", {law("coulomb_friction", {{"F_c", 20.0}, {"v_s", 2e-3}})}, &columns);
}

TEST(RuntimePlant, SaysWhyItsEquationsFail) {
  const auto simulation = PlantSimulation::create(asset_of("emps_broken"), strokes());
  ASSERT_TRUE(simulation);
  const auto failed = (*simulation)->run((*simulation)->start(), {});
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().describe().find("too fast"), std::string::npos) << failed.error().describe();
}

}  // namespace
}  // namespace sealwatch
