// A search that goes on where another ended, on a simulated test with noise.
#include "services/common/mismatch/fitted_model.hpp"

#include <gtest/gtest.h>

#include "services/common/mismatch/ranking.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig far_from_the_truth() {
  AssetConfig asset = nominal_asset("eha");
  for (const char* name : {"R_PL", "f_M"}) {
    ParameterSetting& setting = asset.parameters.at(name);
    setting.value *= 1.5;
    setting.estimate = true;
  }
  return asset;
}

// A real part rests as its last motion left it: where its bristles are when a recording starts is that recording's own.
TEST(FittedModel, BristlesStartAnywhere) {
  constexpr double kBent = -0.8;
  const std::string name = "initial:" + physics_parameter_name("piston", "presliding_friction", "bristle");
  const AssetConfig asset = with_law(nominal_asset("eha"), **find_law("presliding_friction", {"F_c", "delta"}),
                                     "piston", std::vector{2000.0, 5e-5});
  TimeSeries samples = standard_pst(asset, 50.0);
  const auto simulation = PlantSimulation::create(asset, samples).value();
  ModelValues start = simulation->start();
  simulation->find(name)->in(start) = kBent;
  const SimulatedOutputs outputs = simulation->run(start, {}).value();
  for (std::size_t c = 0; c < simulation->channels().size(); ++c)
    for (Series& series : samples.channels)
      for (std::size_t row = 0; series.name == simulation->channels()[c] && row < series.values.size(); ++row)
        series.values[row] = outputs.values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c));
  Data data;
  data.names = {"pst"};
  data.samples = {std::move(samples)};
  const auto fitted = fit_model(asset, data, nullptr, 1);
  ASSERT_TRUE(fitted) << fitted.error().describe();
  const std::vector<Unknown>& own = fitted->problem.recordings.front().own;
  const auto bristle = std::ranges::find(own, name, &Unknown::name);
  ASSERT_NE(bristle, own.end());
  EXPECT_NEAR(bristle->to_value(fitted->optimum.point.own.front()[static_cast<std::size_t>(bristle - own.begin())]),
              kBent, 0.1);
  EXPECT_EQ(bristle->min, -1.0);
  EXPECT_EQ(bristle->max, 1.0);
}

// What is held out is simulated at the values found, however many steps a plant takes that is fast between samples.
TEST(FittedModel, WhereNoValueIsSearchedASimulationMayTakeMoreSteps) {
  Data data;
  data.names = {"pst"};
  data.samples = {simulated_test(nominal_asset("eha"), 1.0)};
  const auto steps = [&](const AssetConfig& asset) {
    return fit_model(asset, data, nullptr, 1, 0).value().problem.simulation_options.maximum_steps;
  };
  EXPECT_GT(steps(with_fixed_parameters(nominal_asset("eha"))), 5 * steps(far_from_the_truth()));
}

TEST(FittedModel, ASearchGoesOnFromWhereItEnded) {
  Data data;
  data.names = {"pst"};
  data.samples = {simulated_test(nominal_asset("eha"), 1.0)};
  Result<FittedModel> early = fit_model(far_from_the_truth(), data, nullptr, 1, 1);
  ASSERT_TRUE(early) << early.error().describe();
  for (Linearisation& at : early->optimum.at_optimum) at.jacobian.resize(0, 0);  // simulated anew
  const Result<FittedModel> same = continue_fit(*early, data, 1, 0);
  ASSERT_TRUE(same) << same.error().describe();
  EXPECT_NEAR(same->misfit / early->misfit, 1.0, 1e-6);
  for (const char* name : {"R_PL", "f_M"})
    EXPECT_NEAR(*estimate_of(*same, name) / *estimate_of(*early, name), 1.0, 1e-12) << name;

  const Result<FittedModel> further = continue_fit(*early, data, 1, 30);
  ASSERT_TRUE(further) << further.error().describe();
  EXPECT_TRUE(further->optimum.converged);
  EXPECT_LE(further->misfit, early->misfit);
  EXPECT_NEAR(further->misfit / further->residuals, 1.0, 0.1);
}

// Its asset reads back: exp(ln x) may lie a digit beyond the bound x.
TEST(FittedModel, ValuesAtABoundLieWithinIt) {
  AssetConfig asset = far_from_the_truth();
  Data data;
  data.names = {"pst"};
  data.samples = {simulated_test(nominal_asset("eha"), 1.0)};
  const double truth = nominal_asset("eha").parameters.at("R_PL").value;
  ParameterSetting& slip = asset.parameters.at("R_PL");
  for (const double times : {0.6, 0.7, 0.8, 0.9, 1.1, 1.2, 1.3, 1.7}) {
    const double bound = times * truth;
    slip.min = times < 1.0 ? bound / 1e3 : bound;
    slip.max = times < 1.0 ? bound : bound * 1e3;
    slip.value = times < 1.0 ? 0.7 * bound : 1.4 * bound;
    const Result<FittedModel> model = fit_model(asset, data, nullptr, 1);
    ASSERT_TRUE(model) << model.error().describe();
    const ParameterSetting& fitted = model->asset.parameters.at("R_PL");
    EXPECT_GE(fitted.value, slip.min);
    EXPECT_LE(fitted.value, slip.max);
  }
}

// To the last digit: recordings are added up in their order, whoever simulated them.
TEST(FittedModel, IsTheSameOnOneThreadAndOnThree) {
  Data data;
  for (const double load : {0.7, 0.9, 1.1, 1.3, 1.5}) {
    AssetConfig loaded = nominal_asset("eha");
    loaded.parameters.at("phi").value *= load;
    data.names.push_back(number(load));
    data.samples.push_back(simulated(loaded, standard_pst(loaded, 20.0), 1.0));
  }
  const Result<FittedModel> one = fit_model(far_from_the_truth(), data, nullptr, 1);
  const Result<FittedModel> three = fit_model(far_from_the_truth(), data, nullptr, 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->misfit, three->misfit);
  EXPECT_EQ(one->optimum.point.shared, three->optimum.point.shared);
  EXPECT_EQ(one->optimum.point.own, three->optimum.point.own);
}

AssetConfig with_free_leakage() {
  AssetConfig asset = nominal_asset("eha");
  for (const char* name : {"R_PL", "f_M", "R_CL"}) asset.parameters.at(name).estimate = true;
  return asset;
}

// Two loads of an actuator whose chamber A leaks outwards, which the model does not know, and values that are known within
// their tolerance.
Data with_leakage(double strength) {
  AssetConfig truth = nominal_asset("eha");
  truth.physics.push_back({.id = "external_leakage",
                           .element = "chamber_a",
                           .parameters = {{"G", {.value = strength, .min = 0.0, .max = 1e-10}}}});
  Data data;
  for (const double load : {0.8, 1.2}) {
    AssetConfig loaded = truth;
    loaded.parameters.at("phi").value *= load;
    data.names.push_back(number(load));
    data.samples.push_back(simulated(loaded, standard_pst(loaded, 50.0), 1.0));
  }
  for (const char* name : {"A_C", "k_V"}) {
    const double value = truth.parameters.at(name).value;
    data.known.push_back({.name = name, .value = value, .standard_deviation = 0.005 * std::abs(value)});
  }
  return data;
}

// The first unknown changes by so much.
PemPoint beside_the_first(const FittedModel& model, double change) {
  PemPoint beside{.shared = std::vector<double>(model.problem.shared.size(), 0.0), .own = model.optimum.point.own};
  beside.shared.front() = change;
  for (std::vector<double>& own : beside.own) std::ranges::fill(own, 0.0);
  return beside;
}

// From where the search of another model ended, whose derivatives by what is known are kept, and from the same values
// without.
TEST(FittedModel, KeptDerivativesEndInTheSamePlace) {
  const Data data = with_leakage(0.0);
  Result<FittedModel> early = fit_model(with_free_leakage(), data, nullptr, 2);
  ASSERT_TRUE(early) << early.error().describe();
  ASSERT_LT(early->misfit, 2.0 * early->residuals) << "derivatives are kept near the noise";
  AssetConfig another = early->asset;
  another.parameters.at("f_M").value *= 1.3;
  another.parameters.at("f_C").estimate = true;
  const PemPoint little = beside_the_first(*early, 0.02);
  const Result<FittedModel> at_start = fit_model_beside(little, another, data, *early, 1, 0, {});
  const Result<FittedModel> kept = fit_model(another, data, &*early, 2);
  for (Linearisation& at : early->optimum.at_optimum) at.jacobian.resize(0, 0);
  const Result<FittedModel> anew = fit_model(another, data, &*early, 2);
  const Result<FittedModel> start_anew = fit_model_beside(little, another, data, *early, 1, 0, {});
  ASSERT_TRUE(kept && anew && at_start && start_anew);
  for (std::size_t r = 0; r < data.samples.size(); ++r) {
    const Linearisation &near = at_start->optimum.at_optimum[r], &here = start_anew->optimum.at_optimum[r];
    EXPECT_TRUE(near.has_kept);
    EXPECT_FALSE(here.has_kept);
    EXPECT_LT((near.jacobian - here.jacobian).norm(), 0.05 * here.jacobian.norm());
    EXPECT_NE(near.jacobian, here.jacobian);
  }
  EXPECT_TRUE(kept->optimum.converged);
  EXPECT_NEAR(kept->misfit, anew->misfit, 2.0) << "what does not count as a change, of a misfit";
  for (const Linearisation& at : kept->optimum.at_optimum) EXPECT_FALSE(at.has_kept) << "the end is of its own";
}

TEST(FittedModel, ASearchEndsWhereItCannotComeToWhatIsKnown) {
  const Data data = with_leakage(0.0);
  const Result<FittedModel> start = fit_model(with_free_leakage(), data, nullptr, 2);
  ASSERT_TRUE(start) << start.error().describe();
  const SearchBound half{.cost = 0.25 * start->misfit};
  const PemPoint little = beside_the_first(*start, 0.01);
  const Result<FittedModel> cut = fit_model_beside(little, start->asset, data, *start, 1, 30, half);
  ASSERT_TRUE(cut) << cut.error().describe();
  EXPECT_FALSE(cut->optimum.converged);
  EXPECT_LE(cut->optimum.iterations, 2) << "the start, and there again with all derivatives";
  const Result<FittedModel> whole = fit_model_beside(little, start->asset, data, *start, 1, 30, {});
  ASSERT_TRUE(whole) << whole.error().describe();
  EXPECT_TRUE(whole->optimum.converged);
}

// Unknowns that had taken on what the law does come on top of it where they do not give that back.
TEST(FittedModel, ALawSetsOutBesideUnknownsThatGiveBackWhatItDoes) {
  const Data data = with_leakage(1e-13);
  const Result<FittedModel> without = fit_model(with_free_leakage(), data, nullptr, 2);
  ASSERT_TRUE(without) << without.error().describe();
  const Result<Screening> screening = screen(*without, data, {});
  ASSERT_TRUE(screening) << screening.error().describe();
  const LawStart law = ranked_laws(*screening, 1).front();
  ASSERT_FALSE(law.beside.own.empty());
  const AssetConfig with = with_law(without->asset, *law.effect.law, law.effect.element, law.parameters);
  const Result<FittedModel> beside = fit_model_beside(law.beside, with, data, *without, 1, 0, {}),
                            on_top = fit_model_beside({}, with, data, *without, 1, 0, {});
  ASSERT_TRUE(beside && on_top);
  EXPECT_LT(beside->misfit, on_top->misfit);
}

}  // namespace
}  // namespace sealwatch::mismatch
