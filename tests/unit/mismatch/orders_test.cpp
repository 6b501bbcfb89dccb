// Order analysis: a torque that changes with the shaft's angle is asked at the number of periods that the residuals show.
#include "services/common/mismatch/orders.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

TEST(Orders, OfAShaftThatCogsComeFirst) {
  constexpr double kPeriods = 7.0;  // not among the usual numbers of the law
  const AssetConfig asset = nominal_asset("eha");
  AssetConfig truth = asset;
  truth.physics.push_back(
      {"cogging_torque",
       "shaft",
       {{"A", {.value = 0.02, .min = 0.0, .max = 2.0}}, {"N", {.value = kPeriods, .min = 1.0, .max = 120.0}}}});
  Data data;
  data.names = {"one"};
  data.samples = {simulated_test(truth, 1.0)};
  const Result<FittedModel> model = fit_model(asset, data, nullptr, 2);
  ASSERT_TRUE(model);
  std::vector<Candidate> candidates = find_candidates(*model->problem.recordings.front().simulation, {}, Laws::listed);
  const std::vector<Candidate> before = candidates;
  set_out_from_strongest_orders(candidates, *model, 2);
  ASSERT_EQ(candidates.size(), before.size());
  int asked = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    ASSERT_EQ(candidates[k].grid.size(), before[k].grid.size()) << candidates[k].law->id;
    if (candidates[k].law->id != "cogging_torque") {
      EXPECT_EQ(candidates[k].grid, before[k].grid) << candidates[k].law->id;
      EXPECT_EQ(candidates[k].passed_over, 0U);
      continue;
    }
    ++asked;
    EXPECT_TRUE(std::ranges::none_of(before[k].grid, [&](const auto& point) { return point[1] == kPeriods; }));
    EXPECT_EQ(candidates[k].grid.front()[1], kPeriods);
    EXPECT_EQ(candidates[k].grid.size() + candidates[k].passed_over, 120U) << "all that were chosen from are counted";
    EXPECT_EQ(candidates[k].grid.front()[0], before[k].grid.front()[0]) << "the amplitude's usual size stays";
  }
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace sealwatch::mismatch
