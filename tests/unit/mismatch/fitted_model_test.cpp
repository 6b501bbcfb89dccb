// A search that goes on where another ended, on a simulated test with noise.
#include "services/common/mismatch/fitted_model.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sealwatch::mismatch
