// What a law of several is worth: the model without it.
#include <gmock/gmock.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using testing::SizeIs;

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

/// A leak that is missed by far, and a drag.
AssetConfig with_two_laws() {
  AssetConfig asset = actuator();
  asset.physics.push_back({.id = "external_leakage",
                           .element = "chamber_a",
                           .parameters = {{"G", {.value = 1e-13, .min = 0.0, .max = 1e-10, .estimate = true}}}});
  asset.physics.push_back({.id = "quadratic_drag",
                           .element = "piston",
                           .parameters = {{"k", {.value = 2e10, .min = 0.0, .max = 1e12, .estimate = true}}}});
  return asset;
}

class LessOneLaw : public ::testing::Test {
 protected:
  std::shared_ptr<const FittedModel> fitted(const AssetConfig& asset) const {
    return std::make_shared<const FittedModel>(fit_model(asset, data_, nullptr, 2).value());
  }

  std::vector<Recording> recordings_{recording_of(with_two_laws(), 0.8), recording_of(with_two_laws(), 1.2)};
  Data data_ = data_of(recordings_);
  Trial both_{{{find_law("external_leakage", {"G"}).value(), "chamber_a"},
               {find_law("quadratic_drag", {"k"}).value(), "piston"}},
              fitted(with_two_laws())};
  Naming naming_{.baseline = fitted(actuator()), .best = both_, .trials = {}, .first = {}, .last = {}};
};

TEST_F(LessOneLaw, IsFittedNoFurtherThanTellsThatTheLawIsNeeded) {
  ASSERT_LT(excess(*both_.model), kGross);
  const auto without_drag = without_law(naming_, both_, 1, data_, 2);
  ASSERT_TRUE(without_drag);
  ASSERT_THAT(without_drag->effects, SizeIs(1));
  EXPECT_EQ(without_drag->effects.front().law->id, "external_leakage");
  EXPECT_GT(excess(*without_drag->model), kGross);
  EXPECT_FALSE(without_drag->model->optimum.converged);
}

TEST_F(LessOneLaw, IsFittedOnceFromAModelWhereverThatEnded) {
  const auto first = without_law(naming_, both_, 1, data_, 2), second = without_law(naming_, both_, 1, data_, 2);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->model, second->model);
}

TEST_F(LessOneLaw, IsNotRememberedWhereTimeWasUp) {
  Deadline deadline;
  deadline.set_in(-1.0);
  data_.deadline = &deadline;
  static_cast<void>(without_law(naming_, both_, 0, data_, 2));
  EXPECT_TRUE(naming_.fewer.empty());
}

}  // namespace
}  // namespace sealwatch::mismatch
