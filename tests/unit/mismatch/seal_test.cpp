// What an analysis says of the seal: one that ages from test to test is no missing physics, and one whose leak a law
// tells in part is no healthier seal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/fitted_model.hpp"
#include "services/common/mismatch/own_gains.hpp"
#include "services/common/mismatch/own_values.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

TEST(Seal, ThatAgedBetweenTestsIsNoMissingPhysics) {
  const std::filesystem::path life = std::filesystem::path(SEALWATCH_SHARED_DATA) / "pst_life" / "xt03-mv2";
  if (!std::filesystem::exists(life)) GTEST_SKIP() << "no shared recordings: pst_life";
  const AssetConfig asset = actuator();
  const auto read = [&](const char* month) {
    return read_recording((life / (std::string(month) + ".csv")).string(), **find_plant(asset.model)).value();
  };
  const std::vector<Recording> fit{read("2009-04"), read("2009-07"), read("2009-10"), read("2010-01")};
  const std::vector<Recording> holdout{read("2009-05"), read("2009-08")};
  const auto explanation = explain(asset, fit, holdout);
  ASSERT_TRUE(explanation) << explanation.error().describe();
  EXPECT_EQ(explanation->verdict, Verdict::undetermined) << explanation->summary;
  EXPECT_TRUE(explanation->effects.empty());
  EXPECT_TRUE(explanation->explained.physics.empty());
  EXPECT_NE(explanation->summary.find("R_CL is 2.286·10¹³ (2009-04-18)"), std::string::npos) << explanation->summary;
  ASSERT_FALSE(explanation->location.empty());
  EXPECT_EQ(explanation->location.front().element, "piston_seal");
  EXPECT_FALSE(explanation->prognosis.known) << "one condition for tests of different ones";

  // Two tests alone tell it too: what is held out takes no part in that.
  const auto of_two = explain(asset, std::vector{read("2016-10"), read("2016-11")}, std::vector{read("2016-12")});
  ASSERT_TRUE(of_two) << of_two.error().describe();
  EXPECT_EQ(of_two->verdict, Verdict::undetermined) << of_two->summary;
  EXPECT_TRUE(of_two->effects.empty());
}

// Months apart, with a seal that wears from one to the next.
Recording monthly_test(AssetConfig truth, int month, double leakage) {
  truth.parameters.at("R_CL").value = leakage;
  Recording recording = recording_of(truth, 1.0 + 0.1 * month);
  recording.start_time = add_months(UtcTime{}, month);
  return recording;
}

// Beside a leak that takes nearly all of the misfit, a leakage for each test would fill the winding's place.
TEST(Seal, ThatStaysDoesNotAgeWhereTheWindingChanges) {
  const AssetConfig asset = actuator();
  AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4.0e-13});
  const auto test_with = [&](int month, double winding) {
    truth.parameters.at("R_M").value = winding * asset.parameter("R_M");
    return monthly_test(truth, month, 2.0e13);
  };
  const std::vector<Recording> fit{test_with(1, 1.05), test_with(2, 1.00), test_with(3, 0.95)};
  const auto explanation = explain(asset, fit, std::vector{test_with(4, 1.0)});
  ASSERT_TRUE(explanation) << explanation.error().describe();
  ASSERT_EQ(explanation->effects.size(), 1U) << explanation->summary;
  EXPECT_EQ(explanation->effects[0].what.id, "external_leakage");
  EXPECT_THAT(explanation->summary, Not(HasSubstr("aged"))) << explanation->summary;
}

TEST(Seal, ThatAgesBesideMissingPhysicsIsToldApartFromIt) {
  const AssetConfig asset = actuator();
  const AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{4.0e-13});
  const std::vector<Recording> fit{monthly_test(truth, 4, 1.8e13), monthly_test(truth, 1, 2.2e13)};
  const std::vector<Recording> holdout{monthly_test(truth, 6, 1.5e13)};
  const auto explanation = explain(asset, fit, holdout);
  ASSERT_TRUE(explanation) << explanation.error().describe();
  ASSERT_EQ(explanation->verdict, Verdict::mismatch) << explanation->summary;
  ASSERT_EQ(explanation->effects.size(), 1U) << explanation->summary;
  EXPECT_EQ(explanation->effects[0].what.id, "external_leakage");
  EXPECT_EQ(explanation->effects[0].what.element, "chamber_a");
  EXPECT_EQ(explanation->effects[0].what.form, "laminar");
  EXPECT_NEAR(explanation->effects[0].parameters[0].value, 4.0e-13, 0.01 * 4.0e-13);
  EXPECT_NE(explanation->summary.find("The piston seal aged between these tests. From test to test R_CL is 2.2"),
            std::string::npos)
      << explanation->summary;
  EXPECT_EQ(explanation->fit_recordings.front(), fit[1].recording_id) << "in the order of time";
  EXPECT_NEAR(explanation->prognosis.R_CL_after, 1.8e13, 0.01 * 1.8e13) << "of the latest test that was fitted";
  EXPECT_NEAR(explanation->explained.parameters.at("R_CL").value, 1.8e13, 0.01 * 1.8e13);
}

TEST(Seal, ThatWasReplacedBetweenTestsNamesNoLaw) {
  const AssetConfig asset = actuator();
  const AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{1.0e-13});
  const std::vector<Recording> fit{monthly_test(truth, 1, 1.2e13), monthly_test(truth, 4, 2.6e13)};
  const auto explanation = explain(asset, fit, std::vector{monthly_test(truth, 5, 2.5e13)});
  ASSERT_TRUE(explanation) << explanation.error().describe();
  EXPECT_EQ(explanation->verdict, Verdict::undetermined) << explanation->summary;
  EXPECT_TRUE(explanation->effects.empty());
  EXPECT_NE(explanation->summary.find("R_CL is 1.2·10¹³ (1970-01-31), 2.6"), std::string::npos) << explanation->summary;
  EXPECT_NE(explanation->summary.find("not wear"), std::string::npos) << explanation->summary;
}

// Months apart, each with the viscous friction of its own temperature.
Recording test_with_friction(AssetConfig truth, int month, double times) {
  truth.parameters.at("f_C").value *= times;
  return monthly_test(truth, month, truth.parameters.at("R_CL").value);
}

TEST(ParameterThatDiffers, IsToldApartFromMissingPhysics) {
  const AssetConfig asset = actuator();
  const AssetConfig truth = with_law(asset, **find_law("external_leakage", {"G"}), "chamber_a", std::vector{1.0e-13});
  const std::vector<Recording> fit{test_with_friction(truth, 1, 1.3), test_with_friction(truth, 2, 0.8),
                                   test_with_friction(truth, 3, 1.15)};
  const auto explanation = explain(asset, fit, std::vector{test_with_friction(truth, 4, 0.95)});
  ASSERT_TRUE(explanation) << explanation.error().describe();
  ASSERT_EQ(explanation->verdict, Verdict::mismatch) << explanation->summary;
  ASSERT_EQ(explanation->effects.size(), 1U) << explanation->summary;
  EXPECT_EQ(explanation->effects[0].what.id, "external_leakage");
  EXPECT_EQ(explanation->effects[0].what.element, "chamber_a");
  EXPECT_NEAR(explanation->effects[0].parameters[0].value, 1.0e-13, 0.02 * 1.0e-13);
  EXPECT_NE(explanation->summary.find("Something changed between these tests. From test to test f_C is"),
            std::string::npos)
      << explanation->summary;
  for (const ChannelComparison& channel : explanation->holdout.channels)
    EXPECT_LT(channel.rms_after, 1.1) << channel.channel << ": its own value is fitted there";
}

TEST(ParameterThatDiffers, AloneNamesNoLaw) {
  const AssetConfig asset = actuator();
  const std::vector<Recording> fit{test_with_friction(asset, 1, 1.3), test_with_friction(asset, 2, 0.8),
                                   test_with_friction(asset, 3, 1.15)};
  const Data data = data_of(fit);
  const FittedModel common = fit_model(asset, data, nullptr, 1).value();
  const std::vector<OwnGain> gains = gains_of_own_values(common, may_differ(asset, data));
  ASSERT_FALSE(gains.empty());
  EXPECT_EQ(gains.front().parameter, "f_C");
  const std::optional<OwnValues> own = each_its_own("f_C", data, common, 1);
  ASSERT_TRUE(own);
  EXPECT_NEAR(gains.front().gain, common.misfit - own->baseline->misfit, 0.1 * gains.front().gain);

  const auto explanation = explain(asset, fit, {});
  ASSERT_TRUE(explanation) << explanation.error().describe();
  EXPECT_EQ(explanation->verdict, Verdict::undetermined) << explanation->summary;
  EXPECT_TRUE(explanation->effects.empty());
  EXPECT_NE(explanation->summary.find("f_C is"), std::string::npos) << explanation->summary;
}

TEST(ParameterThatDiffers, IsNotAskedInTestsOfOneDay) {
  const AssetConfig asset = actuator();
  std::vector<Recording> tests{test_with_friction(asset, 1, 1.0), test_with_friction(asset, 2, 1.0)};
  EXPECT_THAT(may_differ(asset, data_of(tests)), testing::Contains("f_C"));
  EXPECT_THAT(may_differ(asset, data_of(tests)), testing::Not(testing::Contains("R_CL"))) << "that is wear";
  tests[1].start_time = tests[0].start_time;
  EXPECT_TRUE(may_differ(asset, data_of(tests)).empty());
}

TEST(Seal, IsNotSaidToHaveChangedBetweenTestsOfOneDay) {
  const AssetConfig asset = actuator();
  std::vector<Recording> tests{monthly_test(asset, 1, 1.8e13), monthly_test(asset, 2, 2.2e13)};
  const auto change = [&] {
    const Data data = data_of(tests);
    return change_between_tests(asset, data, fit_model(asset, data, nullptr, 1).value());
  };
  EXPECT_TRUE(change());
  tests[1].start_time = tests[0].start_time;
  EXPECT_FALSE(change());
}

TEST(Seal, WhoseLeakALawTellsInPartIsNotCalledHealthier) {
  const AssetConfig asset = actuator();
  const Law& law = **find_law("turbulent_seal_leakage", {"k"});
  std::vector<Recording> fit;
  for (const double load : {0.8, 1.0, 1.2})
    fit.push_back(recording_of(with_law(asset, law, "piston_seal", std::vector{1.5e-10}), load));
  const auto explanation = explain(asset, fit, {});
  ASSERT_TRUE(explanation) << explanation.error().describe();
  ASSERT_EQ(explanation->verdict, Verdict::mismatch) << explanation->summary;
  EXPECT_EQ(explanation->effects.at(0).what.element, "piston_seal");
  EXPECT_FALSE(explanation->prognosis.known);
  EXPECT_TRUE(std::ranges::any_of(explanation->notes, [](const std::string& note) {
    return note.find("R_CL alone no longer describes") != std::string::npos;
  }));
}

TEST(Seal, IsNotSaidToHaveChangedWhereItHasNot) {
  const AssetConfig asset = actuator();
  const auto shift = [&](double after, double after_std) {
    return prognosis_shift(asset, {{.name = "R_CL",
                                    .unit = "Pa s/m3",
                                    .before = 2.0e13,
                                    .before_std = 1e10,
                                    .after = after,
                                    .after_std = after_std,
                                    .datasheet = 2.6e13}});
  };
  EXPECT_NE(shift(2.000001e13, 1e10).sentence.find("with and without what was found"), std::string::npos);
  EXPECT_EQ(shift(2.0e13, 1e10).sentence.find("found"), std::string::npos) << "nothing was";
  EXPECT_NE(shift(2.2e13, 1e10).sentence.find("instead of"), std::string::npos);
  EXPECT_FALSE(shift(2.2e13, std::numeric_limits<double>::infinity()).known) << "at a bound, or not told";
}

}  // namespace
}  // namespace sealwatch::mismatch
