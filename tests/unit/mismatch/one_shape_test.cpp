// Two laws that the data want together and cannot size are one shape.
#include "services/common/mismatch/one_shape.hpp"

#include <gtest/gtest.h>

#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

const Law& law(const char* id, const std::vector<std::string>& parameters) { return **find_law(id, parameters); }

AssetConfig actuator() {
  AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  for (const char* name : {"R_M", "f_M", "R_PL", "f_C"}) asset.parameters.at(name).estimate = false;
  return asset;
}

Trial fitted(const AssetConfig& asset, const Data& data, const std::vector<LawStart>& laws) {
  Trial trial;
  AssetConfig with = asset;
  for (const LawStart& one : laws) {
    with = with_law(with, *one.effect.law, one.effect.element, one.parameters);
    trial.effects.push_back(one.effect);
  }
  trial.model = std::make_shared<const FittedModel>(fit_model(with, data, nullptr, 2).value());
  return trial;
}

// At one speed dry friction and drag by the square of the speed can hardly be told apart: each is known to a half.
Naming naming_of(double friction_N, double drag_N) {
  constexpr double kSpeed_m_s = 1.33e-3;
  const Law &dry = law("coulomb_friction", {"F_c", "v_s"}), &drag = law("quadratic_drag", {"k"});
  const double k = 1.0 / (kSpeed_m_s * kSpeed_m_s);
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, dry, "piston", std::vector{friction_N, 1e-4});
  truth = with_law(truth, drag, "piston", std::vector{drag_N * k});
  const Data data{.names = {"pst"}, .samples = {simulated(truth, standard_pst(truth, 20.0), 1.0)}, .colour = {}};
  const Trial none = fitted(asset, data, {});
  const Trial form = fitted(asset, data, {{{&law("unlisted", {"k_v", "a_v"}), "piston"}, {friction_N + drag_N, 1.0}}});
  Naming naming{
      .baseline = none.model,
      .best = fitted(asset, data, {{{&dry, "piston"}, {friction_N, 1e-4}}, {{&drag, "piston"}, {drag_N * k}}}),
      .trials = {none, form},
      .first = {},
      .last = {}};
  naming.trials.push_back(naming.best);
  one_shape_for_several(naming, data, {.threads = 2});
  return naming;
}

TEST(OneShape, TwoLawsThatAreEachUncertainGiveWayToAClosedForm) {
  const Naming naming = naming_of(95.0, 10.0);
  ASSERT_EQ(naming.best.effects.size(), 1U);
  EXPECT_TRUE(naming.best.effects.front().law->closed_form);
}

TEST(OneShape, TwoLawsThatAreKnownStay) {
  const Naming naming = naming_of(3000.0, 3000.0);
  EXPECT_EQ(naming.best.effects.size(), 2U);
}

}  // namespace
}  // namespace sealwatch::mismatch
