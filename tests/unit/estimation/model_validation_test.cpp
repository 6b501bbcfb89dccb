#include "services/common/estimation/model_validation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/simulate_test.hpp"
#include "tests/unit/verification/actuator.hpp"

namespace sealwatch {
namespace {

Recording recorded(const AssetConfig& asset, const std::map<std::string, double>& parameters, std::uint64_t seed) {
  return bench::simulate_test(asset, bench::pst_profile(asset.pst), {.parameters = parameters, .load_factor = 0.1},
                              {.sample_rate_Hz = 200.0, .seed = seed})
      .value();
}

TEST(ModelValidation, FindsNothingInRecordingsOfTheModel) {
  const AssetConfig asset = verification::testing::actuator();
  const std::vector<Recording> recordings{recorded(asset, {}, 1), recorded(asset, {}, 2)};
  const auto validation = validate_model(asset, recordings, {"a.csv", "b.csv"}, false);
  ASSERT_TRUE(validation) << validation.error().describe();
  EXPECT_TRUE(validation->reasons.empty()) << validation->reasons.front();
  ASSERT_EQ(validation->recordings.size(), 2U);
  EXPECT_EQ(validation->recordings[1].recording, "b.csv");
  int white = 0;
  int channels = 0;
  for (const RecordingValidation& recording : validation->recordings)
    for (const ChannelValidation& channel : recording.channels) {
      EXPECT_NEAR(channel.fit.noise_normalised_rms, 1.0, 0.15) << channel.fit.channel;
      EXPECT_GT(channel.fit.nrmse_percent, 90.0) << channel.fit.channel;
      EXPECT_NEAR(channel.autocorrelation.front(), 1.0, 1e-12);
      EXPECT_EQ(channel.autocorrelation.size(), kAutocorrelationLags + 1);
      white += channel.fit.whiteness_p > 1e-3 ? 1 : 0;
      ++channels;
    }
  EXPECT_EQ(channels, 14);
  EXPECT_GE(white, 12);
}

TEST(ModelValidation, SeesAnotherParameterAndFitsIt) {
  const AssetConfig asset = verification::testing::actuator();
  const std::vector<Recording> recordings{recorded(asset, {{"R_CL", 0.7e13}}, 1)};
  const auto as_it_stands = validate_model(asset, recordings, {"worn.csv"}, false);
  ASSERT_TRUE(as_it_stands);
  ASSERT_FALSE(as_it_stands->reasons.empty());
  EXPECT_NE(as_it_stands->reasons.front().find("noise standard deviations; at most 3 pass"), std::string::npos);
  EXPECT_TRUE(as_it_stands->parameters.empty());
  const auto fitted = validate_model(asset, recordings, {"worn.csv"}, true);
  ASSERT_TRUE(fitted);
  EXPECT_TRUE(fitted->reasons.empty()) << fitted->reasons.front();
  const auto leakage = std::find_if(fitted->parameters.begin(), fitted->parameters.end(),
                                    [](const EstimatedParameter& parameter) { return parameter.name == "R_CL"; });
  ASSERT_NE(leakage, fitted->parameters.end());
  EXPECT_NEAR(leakage->value, 0.7e13, 5.0 * leakage->std_error);
}

// As of one that jumps: far off, until all its jumps are met.
TEST(ModelValidation, OfAPlantWithoutASealTheSearchIsNotGivenUp) {
  AssetConfig asset = verification::testing::actuator();
  EXPECT_LT(search_of(asset).hopeless_rms, 100.0);
  asset.model = "emps";
  ASSERT_TRUE(find_plant(asset.model));
  EXPECT_GT(search_of(asset).hopeless_rms, 1e300);
}

TEST(ModelValidation, SaysOfEachChannelOnceThatItMisfitsTheWorstFirst) {
  const AssetConfig asset = verification::testing::actuator();
  const double area = 1.2 * asset.parameters.at("A_C").value;  // is not estimated
  const std::vector<Recording> recordings{recorded(asset, {{"A_C", area}}, 1), recorded(asset, {{"A_C", area}}, 2)};
  const auto fitted = validate_model(asset, recordings, {"a.csv", "b.csv"}, true);
  ASSERT_TRUE(fitted);
  for (const RecordingValidation& recording : fitted->recordings)
    for (const ChannelValidation& channel : recording.channels) {
      const auto names_it = [&](const std::string& reason) {
        return reason.find(channel.fit.channel + " ") != std::string::npos;
      };
      EXPECT_LE(std::ranges::count_if(fitted->reasons, names_it), 1) << channel.fit.channel;
    }
  const auto first = std::ranges::find_if(fitted->reasons, [](const std::string& reason) {
    return reason.find("noise standard deviations") != std::string::npos;
  });
  ASSERT_NE(first, fitted->reasons.end());
  double worst = 0.0;
  std::string name;
  for (const RecordingValidation& recording : fitted->recordings)
    for (const ChannelValidation& channel : recording.channels)
      if (channel.fit.noise_normalised_rms > worst)
        worst = channel.fit.noise_normalised_rms, name = channel.fit.channel;
  EXPECT_TRUE(first->starts_with(name + " ")) << *first << ", worst is " << name;
}

// Within the limits, but no noise: the leak is off by a little, which the position shows.
TEST(ModelValidation, RemarksOnWhatIsMoreThanNoiseWithinTheLimits) {
  const AssetConfig asset = verification::testing::actuator();
  const double R_CL = 0.985 * asset.parameters.at("R_CL").value;
  const auto validation = validate_model(asset, {recorded(asset, {{"R_CL", R_CL}}, 1)}, {"worn.csv"}, false);
  ASSERT_TRUE(validation);
  EXPECT_TRUE(validation->reasons.empty()) << validation->reasons.front();
  ASSERT_FALSE(validation->remarks.empty());
  const auto same = validate_model(asset, {recorded(asset, {}, 1)}, {"same.csv"}, false);
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->remarks.empty()) << same->remarks.front();
}

TEST(ModelValidation, RefusesWhatCannotBeSimulated) {
  const AssetConfig asset = verification::testing::actuator();
  EXPECT_FALSE(validate_model(asset, {}, {}, false));
  Recording poor = recorded(asset, {}, 1);
  std::erase_if(poor.samples.channels, [](const Series& channel) { return channel.name != "position"; });
  const auto refused = validate_model(asset, {poor}, {"poor.csv"}, false);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().describe().find("poor.csv"), std::string::npos);
  EXPECT_FALSE(validate_model(asset, {poor}, {"poor.csv"}, true));
}

}  // namespace
}  // namespace sealwatch
