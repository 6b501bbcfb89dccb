// Values that the asset file fixes, against laws that were found, without the search for laws.
#include "services/common/mismatch/datasheet.hpp"

#include <gtest/gtest.h>

#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/value_swaps.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig actuator() {
  AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  for (const char* name : {"R_M", "f_M", "R_PL"}) asset.parameters.at(name).estimate = false;  // fewer to fit
  return asset;
}

Data two_tests_of(const AssetConfig& truth) {
  constexpr double kRate_Hz = 20.0;
  Data data;
  for (const double load : {0.7, 1.2}) {
    AssetConfig loaded = truth;
    loaded.parameters.at("phi").value *= load;
    data.names.push_back(number(load));
    data.samples.push_back(simulated(loaded, standard_pst(loaded, kRate_Hz), 1.0));
  }
  return data;
}

struct Found {
  std::shared_ptr<const FittedModel> baseline;
  Trial laws;
};

Found found(const AssetConfig& asset, const Data& data, const std::vector<LawStart>& laws) {
  Found found{std::make_shared<const FittedModel>(fit_model(asset, data, nullptr, 2).value()), {}};
  AssetConfig with = asset;
  for (const LawStart& law : laws) {
    with = with_law(with, *law.effect.law, law.effect.element, law.parameters);
    found.laws.effects.push_back(law.effect);
  }
  found.laws.model = std::make_shared<const FittedModel>(fit_model(with, data, nullptr, 2).value());
  return found;
}

LawStart gain_of(const std::string& channel) {
  return {{*find_law("sensor_gain", {"g"}), "sensor:" + channel}, {0.01}};
}

TEST(Datasheet, AWrongAreaIsFoundAlone) {
  AssetConfig asset = actuator(), truth = asset;
  truth.parameters.at("A_C").value *= 1.05;
  const Data data = two_tests_of(truth);
  const auto [baseline, laws] = found(asset, data, {gain_of("flow")});
  const auto wrong = values_alone({asset, *baseline, laws, data, 2}, 1);
  ASSERT_TRUE(wrong);
  EXPECT_LT(wrong->behind, -12.0);
  ASSERT_EQ(wrong->values.front().size(), 1U);
  const AssetValue& value = wrong->values.front().front();
  EXPECT_EQ(value.name, "A_C");
  EXPECT_DOUBLE_EQ(value.in_asset_file, 5.89e-3);
  EXPECT_NEAR(value.fitted, 1.05 * 5.89e-3, 5.0 * value.std_error);
  EXPECT_GT(value.std_error, 0.0);
  EXPECT_LT(value.std_error, 1e-5);
  EXPECT_TRUE(values_in_words(wrong->values).starts_with("A_C = 0.00618"));

  // What the asset file itself rules out is not blamed.
  asset.parameters.at("A_C").max = 6.0e-3;
  const auto within = values_alone({asset, *baseline, laws, data, 2}, 1);
  EXPECT_TRUE(!within || within->values.front().front().name != "A_C");
}

TEST(Datasheet, ARightAssetFileIsNotBlamed) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("quadratic_drag", {"k"}), "piston", std::vector{2e9});
  truth = with_law(truth, **find_law("sensor_gain", {"g"}), "sensor:flow", std::vector{0.03});
  const Data data = two_tests_of(truth);
  const auto [baseline, laws] =
      found(asset, data, {{{*find_law("quadratic_drag", {"k"}), "piston"}, {1e9}}, gain_of("flow")});
  EXPECT_FALSE(values_alone({asset, *baseline, laws, data, 2}, 2));
  EXPECT_FALSE(values_in_place_of_laws({asset, *baseline, laws, data, 2}));
}

TEST(Datasheet, AWrongAreaIsFoundInPlaceOfAGainBesideALeak) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4e-14});
  truth.parameters.at("A_C").value *= 1.05;
  const Data data = two_tests_of(truth);
  const auto [baseline, laws] =
      found(asset, data,
            {{{*find_law("external_leakage", {"G"}), "chamber_a"}, {2e-14}}, gain_of("flow"), gain_of("position")});
  const auto wrong = values_in_place_of_laws({asset, *baseline, laws, data, 2});
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->values.front().front().name, "A_C");
  EXPECT_NEAR(wrong->values.front().front().fitted, 1.05 * 5.89e-3, 2e-5);
  ASSERT_EQ(wrong->with.effects.size(), 1U);
  EXPECT_EQ(wrong->with.effects.front().element, "chamber_a");
}

std::vector<KnownValue> fixed_values(const AssetConfig& asset) {
  return known_values(asset, **find_plant(asset.model));
}

// An input's gain does nearly what another constant of the motor does: found as the one, told as the other.
TEST(ValueSwaps, FindWhichValueDoesWhatALawDoes) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4e-14});
  truth.parameters.at("Omega_M").value *= 1.1;
  const Data data = two_tests_of(truth);
  const auto [baseline, laws] = found(asset, data,
                                      {{{*find_law("input_gain", {"g"}), "input:motor_voltage"}, {-0.05}},
                                       {{*find_law("external_leakage", {"G"}), "chamber_a"}, {2e-14}}});
  const std::vector<KnownValue> values = fixed_values(asset);
  const auto out = subsets_of(2);
  const auto swaps = values_in_place_of({laws, out, values, data, 2, kCannotTell});
  ASSERT_FALSE(swaps.empty());
  EXPECT_EQ(swaps.front().value.name, "Omega_M");
  EXPECT_EQ(swaps.front().out, std::vector<std::size_t>{0});
  ASSERT_EQ(swaps.front().with.effects.size(), 1U);
  EXPECT_EQ(swaps.front().with.effects.front().element, "chamber_a");
  EXPECT_NEAR(*estimate_of(*swaps.front().with.model, "Omega_M") / asset.parameter("Omega_M"), 1.1, 0.01);

  EXPECT_NEAR(swaps.front().predicted / asset.parameter("Omega_M"), 1.1, 0.02) << "before any fit";

  // It back at what is known of it, and another in its place: none does.
  std::vector<KnownValue> back = values;
  std::erase_if(back, [](const KnownValue& value) { return value.name != "Omega_M"; });
  const std::vector<std::vector<std::size_t>> no_law(1);
  for (const ValueSwap& other : values_in_place_of({swaps.front().with, no_law, values, data, 2, kCannotTell, back}))
    EXPECT_NE(other.value.name, "A_C");
}

TEST(ValueSwaps, LeaveALawThatNoValueDoes) {
  const AssetConfig asset = actuator();
  const Data data = two_tests_of(with_law(asset, **find_law("quadratic_drag", {"k"}), "piston", std::vector{2e9}));
  const auto [baseline, laws] = found(asset, data, {{{*find_law("quadratic_drag", {"k"}), "piston"}, {1e9}}});
  const auto out = subsets_of(1);
  EXPECT_TRUE(values_in_place_of({laws, out, fixed_values(asset), data, 2, kCannotTell}).empty());
}

TEST(Search, GoesOnBesideAValueThatIsOff) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4e-14});
  truth.parameters.at("A_C").value *= 1.05;
  Data data = two_tests_of(truth);
  data.fixed = fixed_values(asset);
  const auto baseline = std::make_shared<const FittedModel>(fit_model(asset, data, nullptr, 2).value());
  const ExplainOptions options{.threads = 2};
  const Naming naming = name_effects(baseline, data, options, {}).value();
  EXPECT_EQ(naming.freed, std::vector<std::string>{"A_C"});
  EXPECT_FALSE(naming.replaced.empty());
  EXPECT_LT(naming.behind_laws, -kCannotTell);
  ASSERT_EQ(naming.best.effects.size(), 1U);
  EXPECT_EQ(naming.best.effects.front().element, "chamber_a");
  ASSERT_NE(naming.with_laws, nullptr);
  EXPECT_EQ(as_it_began(naming).baseline, baseline);
  EXPECT_NEAR(*estimate_of(*naming.best.model, "A_C"), 1.05 * 5.89e-3, 2e-5);

  // Without the list of what is fixed only laws are asked.
  data.fixed.clear();
  EXPECT_TRUE(name_effects(baseline, data, options, {}).value().freed.empty());
}

// A pump that sweeps 8 % more than its datasheet says: gains of half the sensors would be asked one by one.
TEST(Search, AsksAValueThatEndsAGrossMisfitBeforeLaws) {
  const AssetConfig asset = actuator();
  AssetConfig truth = asset;
  truth.parameters.at("alpha_P").value *= 1.08;
  Data data = two_tests_of(truth);
  data.fixed = fixed_values(asset);
  const auto baseline = std::make_shared<const FittedModel>(fit_model(asset, data, nullptr, 2).value());
  ASSERT_GT(excess(*baseline), kGross);
  const Naming naming = name_effects(baseline, data, {.threads = 2}, {}).value();
  EXPECT_EQ(naming.freed, std::vector<std::string>{"alpha_P"});
  EXPECT_TRUE(naming.best.effects.empty());
  EXPECT_TRUE(naming.replaced.empty()) << "no law stood in for it";
  EXPECT_LE(naming.behind_laws, 0.0);
  ASSERT_NE(naming.with_laws, nullptr);
  EXPECT_TRUE(naming.with_laws->best.effects.empty());
  EXPECT_NEAR(*estimate_of(*naming.best.model, "alpha_P") / asset.parameter("alpha_P"), 1.08, 0.005);
}

}  // namespace
}  // namespace sealwatch::mismatch
