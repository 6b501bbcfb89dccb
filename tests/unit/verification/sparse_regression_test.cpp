// The control of the field: it finds what is large and recorded, and it is fooled by noise.
#include "services/verification/trial/sparse_regression.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/verification/truth/trials.hpp"

namespace sealwatch::verification {
namespace {

constexpr std::uint64_t kSet = 5;  // white noise, even sampling

/// Two tests of the actuator with what `change` hides in it.
template <class Change>
std::vector<SparseTerm> regressed(const Change& change) {
  bench::TrialPlan plan = bench::plan_trial(TrialStratum::null, kSet);
  plan.fit.resize(2);
  plan.holdout.clear();
  change(plan);
  const auto recorded = bench::record_trial(plan);
  EXPECT_TRUE(recorded);
  mismatch::Data data;
  for (const Recording& recording : recorded->fit) {
    data.names.push_back(recording.recording_id);
    data.samples.push_back(recording.samples);
  }
  const AssetConfig asset = bench::trial_asset();
  const auto simulation = PlantSimulation::create(asset, data.samples.front());
  EXPECT_TRUE(simulation);
  return sparse_regression(asset, data, mismatch::find_candidates(**simulation, {}, mismatch::Laws::listed));
}

void add_dry_friction(bench::TrialPlan& plan, double force_N) {
  const auto forms = bench::piston_effects();
  const auto coulomb = std::ranges::find(forms, "arctangent", &bench::EffectForm::form);
  plan.effects.push_back({.form = &*coulomb, .element = "piston", .size = force_N, .shape = {5e-5, 0.0, 0.0}});
}

bool keeps(const std::vector<SparseTerm>& terms, std::string_view element) {
  return std::ranges::any_of(terms, [&](const SparseTerm& term) { return term.element == element; });
}

TEST(SparseRegression, FindsPlainDryFrictionWhereAllIsRecorded) {
  constexpr double kForce_N = 6000.0;  // a tenth of the load
  const auto terms = regressed([](bench::TrialPlan& plan) { add_dry_friction(plan, kForce_N); });
  ASSERT_FALSE(terms.empty());
  EXPECT_EQ(terms.front().element, "piston");
  EXPECT_TRUE(terms.front().id.find("friction") != std::string::npos) << terms.front().id;
}

TEST(SparseRegression, FindsNothingWhereTheBalancesAreNotRecorded) {
  const auto terms = regressed([](bench::TrialPlan& plan) {
    add_dry_friction(plan, 6000.0);
    plan.channels = {"motor_voltage", "motor_current", "position"};
  });
  EXPECT_FALSE(keeps(terms, "piston"));
}

std::string told(const std::vector<SparseTerm>& terms) {
  std::string text;
  for (const SparseTerm& term : terms)
    text.append(term.id).append(" at ").append(term.element).append(", gain ") += std::to_string(term.gain) + "\n";
  return text;
}

// Nothing is hidden. Smoothed corners, noise in the regressors and samples that say the same are enough for a law.
TEST(SparseRegression, IsFooledWhereNothingIsHidden) {
  constexpr double kWorthALaw = 12.0;  // what the analysis asks of a law's criterion
  const auto noisy = regressed([](bench::TrialPlan&) {});
  ASSERT_FALSE(noisy.empty());
  EXPECT_GT(noisy.front().gain, kWorthALaw) << told(noisy);
  const auto clean = regressed([](bench::TrialPlan& plan) { plan.noise.clear(); });
  ASSERT_FALSE(clean.empty());
  EXPECT_GT(clean.front().gain, kWorthALaw) << told(clean);
}

TEST(SparseRegression, IsFooledByNoiseWhereFrictionIsSmall) {
  constexpr double kForce_N = 50.0;  // five times what such tests begin to show
  const auto terms = regressed([](bench::TrialPlan& plan) { add_dry_friction(plan, kForce_N); });
  ASSERT_FALSE(terms.empty());
  EXPECT_EQ(terms.front().id.find("friction"), std::string::npos) << told(terms);
}

}  // namespace
}  // namespace sealwatch::verification
