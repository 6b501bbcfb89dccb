// A small law beside a large one is told from what the large one's form may be off by.
#include "services/common/mismatch/form_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/naming.hpp"
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
  const Effect large{&spring(), "piston"};
  for (const LawStart& one : more_than_form(model, {&large, 1}, laws, data, {}))
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

// Of a leaking chamber that the model with a laminar leak leaves: whether its hose is more than that leak's form.
bool hose_is_more_than_form_of_leak(const AssetConfig& truth) {
  const std::vector<Recording> tests{recording_of(truth, 1.0), recording_of(truth, 1.1)};
  const Data data = data_of(tests);
  const Effect leak{&law("external_leakage", {"G"}), "chamber_a"};
  const FittedModel model =
      fit_model(with_law(asset(), *leak.law, leak.element, std::vector{1e-13}), data, nullptr, 2).value();
  const LawStart hose{{&law("hose_compliance", {"C_h"}), "chamber_a"}, {1e-14}};
  return !more_than_form(model, {&leak, 1}, {hose}, data, {}).empty();
}

TEST(FormError, AtTheSameElementItIsMoreThanWhatOtherLawsThereCouldDo) {
  const AssetConfig leaks = with_law(asset(), law("external_leakage", {"G"}), "chamber_a", std::vector{1e-13});
  EXPECT_TRUE(hose_is_more_than_form_of_leak(
      with_law(leaks, law("hose_compliance", {"C_h"}), "chamber_a", std::vector{6e-14})));
  const Law& bent = law("external_leakage", {"q_o", "a_o"});
  EXPECT_FALSE(hose_is_more_than_form_of_leak(with_law(asset(), bent, "chamber_a", std::vector{1e-6, 0.7})));
}

// The leak takes nearly all: what it leaves is less than its form could be off by.
TEST(FormError, ASecondLawAtTheElementIsFoundBesideOneThatTakesNearlyAll) {
  const Law &leak = law("external_leakage", {"G"}), &hose = law("hose_compliance", {"C_h"});
  const AssetConfig truth =
      with_law(with_law(asset(), leak, "chamber_a", std::vector{1e-13}), hose, "chamber_a", std::vector{6e-14});
  const std::vector<Recording> tests{recording_of(truth, 1.0), recording_of(truth, 1.1)};
  const Data data = data_of(tests);
  const auto baseline = std::make_shared<const FittedModel>(fit_model(asset(), data, nullptr, 2).value());
  const AssetConfig leaking = with_law(asset(), leak, "chamber_a", std::vector{1e-13});
  const Trial found{{{&leak, "chamber_a"}},
                    std::make_shared<const FittedModel>(fit_model(leaking, data, baseline.get(), 2).value())};
  const Naming naming = name_effects(baseline, data, {.maximum_laws = 2, .threads = 2}, {}, found).value();
  ASSERT_THAT(naming.best.effects, testing::SizeIs(2));
  EXPECT_EQ(naming.best.effects.back().law->id, "hose_compliance");
  EXPECT_EQ(naming.best.effects.back().element, "chamber_a");
}

}  // namespace
}  // namespace sealwatch::mismatch
