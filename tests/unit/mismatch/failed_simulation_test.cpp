// A model that cannot be simulated somewhere costs the law that asks for it, not the analysis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/standard_errors.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

AssetConfig plant() {
  AssetConfig asset = with_fixed_parameters(nominal_asset("eha"));
  asset.parameters.at("f_M").estimate = true;
  return asset;
}

Data one_test(const std::string& name) {
  Data data;
  data.names = {name};
  data.samples = {simulated_test(plant(), 1.0)};
  return data;
}

const double kNoForce = std::numeric_limits<double>::quiet_NaN();

/// Dry friction of a size that no integrator follows.
Trial unusable(FittedModel model) {
  const Law* law = find_law("coulomb_friction", std::vector<std::string>{"F_c", "v_s"}).value();
  model.asset = with_law(model.asset, *law, "piston", std::vector<double>{kNoForce, 1e-4});
  model.optimum.point.shared.assign(model.optimum.point.shared.size(), kNoForce);
  model.optimum.converged = true;
  return {{{law, "piston"}}, std::make_shared<const FittedModel>(std::move(model))};
}

TEST(StandardErrors, OfATrialWhoseDerivativesWereNotKeptAreThoseThatItHad) {
  FittedModel model = fit_model(plant(), one_test("fit"), nullptr, 1).value();
  const std::vector<double> errors = standard_errors(model);
  for (Linearisation& at : model.optimum.at_optimum) at.jacobian.resize(0, 0);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_GT(errors.front(), 0.0);
  EXPECT_NEAR(standard_errors(model).front(), errors.front(), 1e-6 * errors.front());
}

TEST(FailedSimulation, OfAHeldOutRecordingIsAnErrorOfTheLawOrLeavesTheRecordingOut) {
  const Data fit = one_test("fit"), holdout = one_test("holdout");
  const ExplainOptions options;
  const HeldOut held_out{fit, holdout, 0.0, options};
  const auto baseline = std::make_shared<const FittedModel>(fit_model(plant(), fit, nullptr, 1).value());
  const Trial before{{}, baseline}, broken = unusable(fit_model(plant(), fit, nullptr, 1).value());

  const auto same = held_out.gains(before, before);
  ASSERT_TRUE(same) << same.error().describe();
  EXPECT_FALSE(same->gain.empty());
  EXPECT_TRUE(same->not_compared.empty());

  EXPECT_FALSE(held_out.gains(before, broken));
  const auto no_old_model = held_out.gains(broken, before);
  ASSERT_TRUE(no_old_model) << no_old_model.error().describe();
  EXPECT_TRUE(no_old_model->gain.empty());
  EXPECT_THAT(no_old_model->not_compared, ElementsAre(StartsWith("holdout (")));

  std::vector<RecordingComparison> kept;
  const auto told = held_out.gains(before, broken, &kept);
  ASSERT_TRUE(told) << told.error().describe();
  EXPECT_TRUE(kept.empty());
  EXPECT_THAT(told->not_compared, ElementsAre(StartsWith("holdout (")));
}

TEST(FailedSimulation, OfALawThatFitsLeavesTheBestThatWas) {
  const Data fit = one_test("fit");
  const auto baseline = std::make_shared<const FittedModel>(fit_model(plant(), fit, nullptr, 1).value());
  Naming naming{.baseline = baseline, .best = {{}, baseline}, .trials = {{{}, baseline}}, .first = {}, .last = {}};
  naming.last.p_value = 0.25;
  EXPECT_FALSE(take(naming, unusable(fit_model(plant(), fit, nullptr, 1).value()), fit, {}));
  EXPECT_TRUE(naming.best.effects.empty());
  EXPECT_EQ(naming.best.model, baseline);
  EXPECT_EQ(naming.last.p_value, 0.25);
  EXPECT_THAT(naming.remarks, ElementsAre(HasSubstr("Coulomb friction at the piston")));
  EXPECT_TRUE(take(naming, {{}, baseline}, fit, {}));
  EXPECT_EQ(naming.best.model, baseline);
  EXPECT_LT(naming.last.p_value, 1.0);
}

}  // namespace
}  // namespace sealwatch::mismatch
