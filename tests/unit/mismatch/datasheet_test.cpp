// Values that the asset file fixes, against laws that were found, without the search for laws.
#include "services/common/mismatch/datasheet.hpp"

#include <gtest/gtest.h>

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
  EXPECT_FALSE(value_in_place_of_laws({asset, *baseline, laws, data, 2}));
}

TEST(Datasheet, AWrongAreaIsFoundInPlaceOfAGainBesideALeak) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4e-14});
  truth.parameters.at("A_C").value *= 1.05;
  const Data data = two_tests_of(truth);
  const auto [baseline, laws] =
      found(asset, data,
            {{{*find_law("external_leakage", {"G"}), "chamber_a"}, {2e-14}}, gain_of("flow"), gain_of("position")});
  const auto wrong = value_in_place_of_laws({asset, *baseline, laws, data, 2});
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->values.front().front().name, "A_C");
  EXPECT_NEAR(wrong->values.front().front().fitted, 1.05 * 5.89e-3, 2e-5);
  ASSERT_EQ(wrong->with.effects.size(), 1U);
  EXPECT_EQ(wrong->with.effects.front().element, "chamber_a");
}

}  // namespace
}  // namespace sealwatch::mismatch
