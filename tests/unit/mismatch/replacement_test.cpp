// What a law would leave in the place of another one, told without a refit.
#include "services/common/mismatch/replacement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kLeak = 1e-13;  // m3/(s Pa)

const Law& leak() { return **find_law("external_leakage", {"G"}); }

// An actuator with a leak of chamber A, and the model that has it.
struct Leaking {
  AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  AssetConfig truth = with_law(asset, leak(), "chamber_a", std::vector{kLeak});
  std::vector<Recording> tests{recording_of(truth, 1.0), recording_of(truth, 1.1)};
  Data data = data_of(tests);
  Trial whole{{{&leak(), "chamber_a"}},
              std::make_shared<const FittedModel>(fit_model(truth, data, nullptr, 2).value())};
};

std::optional<StandIn> leak_in_place(const Leaking& leaking, const char* element) {
  const std::vector<Candidate> laws = candidates_of({{{&leak(), element}, {kLeak}}}, *leaking.whole.model);
  const Screening beside = screen_laws(*leaking.whole.model, laws, leaking.data, {.draws = 1}).value();
  return Replacement(leaking.whole, {0}).stand_in(beside, {&leak(), element});
}

TEST(Replacement, OfALawByItselfLeavesNothing) {
  const Leaking leaking;
  const auto itself = leak_in_place(leaking, "chamber_a");
  ASSERT_TRUE(itself);
  const double fitted = leaking.whole.model->asset.physics.front().parameters.at("G").value;
  EXPECT_NEAR(itself->start.parameters.front(), fitted, 0.01 * fitted);
  EXPECT_LT(itself->rise, 0.01 * leaking.whole.model->misfit);
  for (const double change : itself->start.beside.shared) EXPECT_NEAR(change, 0.0, 1e-3) << "of the other unknowns";
  EXPECT_TRUE(Replacement(leaking.whole, {0}).may_do_as_well(*itself));
}

TEST(Replacement, ElsewhereIsAsFarOffAsItsRefitWithinATenth) {
  const Leaking leaking;
  const auto elsewhere = leak_in_place(leaking, "chamber_b");
  ASSERT_TRUE(elsewhere);
  const AssetConfig twin = with_law(leaking.asset, leak(), "chamber_b", elsewhere->start.parameters);
  const FittedModel refitted = fit_model(twin, leaking.data, leaking.whole.model.get(), 2).value();
  const double rise = refitted.misfit - leaking.whole.model->misfit;
  EXPECT_GT(rise, 0.1 * elsewhere->rise);
  EXPECT_FALSE(Replacement(leaking.whole, {0}).may_do_as_well(*elsewhere));
  const auto starts =
      stand_ins(leaking.whole, {0}, candidates_of({elsewhere->start}, *leaking.whole.model), leaking.data, {});
  EXPECT_THAT(starts, testing::IsEmpty());
}

TEST(Replacement, OfNothingALawThatTakesMuchDoesNotGo) {
  const Leaking leaking;
  EXPECT_FALSE(Replacement(leaking.whole, {0}).may_go());
  const Law& spring = **find_law("spring_load", {"k"});
  const AssetConfig more = with_law(leaking.truth, spring, "piston", std::vector{1.0});
  const Trial idle{{{&leak(), "chamber_a"}, {&spring, "piston"}},
                   std::make_shared<const FittedModel>(fit_model(more, leaking.data, nullptr, 2).value())};
  EXPECT_TRUE(Replacement(idle, {1}).may_go());
  EXPECT_FALSE(Replacement(idle, {0}).may_go());
}

TEST(Refit, DoesNotSetOutWhereThreeTimesItsPromiseIsOutOfReach) {
  const Leaking leaking;
  const LawStart spring{{*find_law("spring_load", {"k"}), "piston"}, {1e4}};
  const double here = leaking.whole.model->misfit;
  const auto refits = [&](double promised) {
    LawStart start = spring;
    start.promised = promised;
    start.asked_at = here;
    return refit(leaking.whole, {{start}}, leaking.data, 2, {.to_beat = here - 1000.0}).size();
  };
  EXPECT_EQ(refits(100.0), 0U);
  EXPECT_EQ(refits(400.0), 1U);
}

}  // namespace
}  // namespace sealwatch::mismatch
