// A small law beside a large one is told from what the large one's form may be off by.
#include "services/common/mismatch/form_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig asset() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

const Law& law(const char* id, const std::vector<std::string>& parameters) { return **find_law(id, parameters); }

const Law& spring() { return law("spring_load", {"k"}); }
const Law& dead_time() { return law("driver_dead_time", {"V_d", "i_s"}); }

// Of what an actuator records that the model with a straight spring leaves: the laws elsewhere that are more than that
// spring's form.
struct Left {
  std::vector<std::string> asked, more;
};

Left beside_a_straight_spring(const AssetConfig& truth) {
  const std::vector<Recording> tests{recording_of(truth, 1.0), recording_of(truth, 1.1)};
  const Data data = data_of(tests);
  const AssetConfig straight = with_law(asset(), spring(), "piston", std::vector{1e5});
  const FittedModel model = fit_model(straight, data, nullptr, 2).value();
  const Screening screening = screen(model, data, {}).value();
  Left left;
  std::vector<LawStart> laws;
  for (LawStart& start : ranked_laws(screening, 20))
    if (start.effect.element != "piston" && laws.size() < 3) laws.push_back(std::move(start));
  for (const LawStart& one : laws) left.asked.emplace_back(one.effect.law->id);
  for (const LawStart& one : more_than_form(model, {&spring(), "piston"}, laws, data, {}))
    left.more.emplace_back(one.effect.law->id);
  return left;
}

TEST(FormError, WhatNoFormOfTheLargeLawCouldDoIsMore) {
  const AssetConfig truth =
      with_law(with_law(asset(), spring(), "piston", std::vector{2e5}), dead_time(), "driver", std::vector{0.3, 0.05});
  EXPECT_THAT(beside_a_straight_spring(truth).more, testing::Contains("driver_dead_time"));
}

TEST(FormError, WhatABentSpringLeavesIsItsForm) {
  const Law& bent = law("spring_load", {"F_x", "a_x"});
  const Left left = beside_a_straight_spring(with_law(asset(), bent, "piston", std::vector{1e4, 1.15}));
  EXPECT_FALSE(left.asked.empty()) << "others would take something of it";
  EXPECT_THAT(left.more, testing::IsEmpty());
}

TEST(FormError, AtTheSameElementItCannotBeAsked) {
  const std::vector<Recording> tests{recording_of(asset(), 1.0)};
  const Data data = data_of(tests);
  const FittedModel model =
      fit_model(with_law(asset(), spring(), "piston", std::vector{1e5}), data, nullptr, 2).value();
  const LawStart drag{{&law("quadratic_drag", {"k"}), "piston"}, {1e9}};
  EXPECT_THAT(more_than_form(model, {&spring(), "piston"}, {drag}, data, {}), testing::IsEmpty());
}

}  // namespace
}  // namespace sealwatch::mismatch
