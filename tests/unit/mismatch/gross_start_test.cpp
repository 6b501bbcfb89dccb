// Where a search sets out in a gross misfit of the whole actuator: not from what free runs say of absent laws.
#include <gtest/gtest.h>

#include <algorithm>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/held_start.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

/// A pump that slips by its speed, at 14 times a significant size, beside a small leak of a chamber, from another seal.
AssetConfig worn(AssetConfig asset) {
  asset.parameters.at("R_CL").value = 1.2e13;
  asset = with_law(std::move(asset), **find_law("speed_dependent_pump_slip", {"k_d"}), "pump", std::vector{5.6e-9});
  return with_law(std::move(asset), **find_law("external_leakage", {"G_t"}), "chamber_a", std::vector{1.5e-11});
}

TEST(GrossStart, HeldToItsStatesASimulationShowsTheLawThatItsFreeRunHides) {
  const AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  Data data;
  for (const double load : {0.7, 1.2}) {
    AssetConfig loaded = worn(asset);
    loaded.parameters.at("phi").value *= load;
    data.names.push_back(number(load));
    data.samples.push_back(simulated(loaded, standard_pst(loaded, 50.0), 1.0));
  }
  const auto baseline = fit_model(asset, data, nullptr, 2);
  ASSERT_TRUE(baseline) << baseline.error().describe();
  EXPECT_GT(excess(*baseline), 100.0);
  const auto slips = [](const Effect& effect) { return effect.law->id == "speed_dependent_pump_slip"; };
  const auto asked = screen(*baseline, data, {.threads = 2});
  ASSERT_TRUE(asked);
  const std::vector<LawStart> by_free_run = ranked_laws(*asked, 1);
  ASSERT_FALSE(by_free_run.empty());
  EXPECT_FALSE(slips(by_free_run.front().effect));
  ExplainOptions options;
  options.threads = 2;
  options.time_limit_s = 600.0;
  const HeldStart start = start_from_held(*baseline, data, options);
  ASSERT_TRUE(start.trial);
  ASSERT_EQ(start.trial->effects.size(), 2U);
  EXPECT_TRUE(slips(start.trial->effects[0]));
  EXPECT_EQ(start.trial->effects[1].law->id, "external_leakage");
  EXPECT_LT(excess(*start.trial->model), 1.2);
}

// Values within their tolerances bend to what is missing, and laws are asked without them: they are not compared. More
// than was recorded is no driver's: at its end of the range, less could be its saturation as well.
TEST(GrossStart, HeldToItsStatesASimulationShowsALawBesideValuesThatBentToIt) {
  const AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  const std::vector<KnownValue> known = known_values(asset, **find_plant(asset.model));
  AssetConfig truth = with_law(asset, **find_law("input_gain", {"g"}), "input:motor_voltage", std::vector{0.05});
  for (std::size_t k = 0; k < known.size(); ++k)
    truth.parameters.at(known[k].name).value += (k % 2 == 0 ? 0.7 : -0.7) * known[k].standard_deviation;
  Data data;
  data.names = {"one"};
  data.samples = {simulated(truth, standard_pst(truth, 50.0), 1.0)};
  const auto exact = fit_model(asset, data, nullptr, 2);
  ASSERT_TRUE(exact) << exact.error().describe();
  data.known = known;
  const auto baseline = fit_model(asset, data, &*exact, 2);
  ASSERT_TRUE(baseline) << baseline.error().describe();
  EXPECT_LT(excess(*baseline), 0.5 * excess(*exact)) << "they bend";
  EXPECT_GT(excess(*baseline), kGross);
  ExplainOptions options;
  options.threads = 2;
  options.time_limit_s = 600.0;
  const HeldStart start = start_from_held(*baseline, data, options);
  ASSERT_TRUE(start.trial);
  EXPECT_EQ(start.trial->effects.front().law->id, "input_gain");
  EXPECT_LT(excess(*start.trial->model), 1.2);
}

TEST(GrossStart, TheLawThatEndsItIsFittedBesideValuesWithinTheirTolerances) {
  const AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  const Law &spring = **find_law("spring_load", {"k"}), &friction = **find_law("coulomb_friction", {"F_c", "v_s"});
  const double area = asset.parameters.at("A_C").value;
  AssetConfig truth = with_law(asset, spring, "piston", std::vector{3e5});
  truth.parameters.at("A_C").value = 1.004 * area;
  Data data;
  data.names = {"one"};
  data.samples = {simulated_test(truth, 1.0)};
  data.known = {{.name = "A_C", .value = area, .standard_deviation = 0.005 * area}};
  const auto baseline = std::make_shared<const FittedModel>(fit_model(asset, data, nullptr, 2).value());
  ASSERT_GT(excess(*baseline), 10.0);
  const std::vector<Trial> trials =
      refit({{}, baseline}, {{{{&friction, "piston"}, {2000.0, 1e-4}}}, {{{&spring, "piston"}, {1e5}}}}, data, 2);
  ASSERT_FALSE(trials.empty());
  EXPECT_EQ(trials.front().effects.front().law->id, "spring_load");
  EXPECT_LT(excess(*trials.front().model), 1.1);
  const std::optional<double> found = estimate_of(*trials.front().model, "A_C");
  ASSERT_TRUE(found) << "it was fitted as if the area were exact";
  EXPECT_NEAR(*found / area, 1.004, 0.001);
}

}  // namespace
}  // namespace sealwatch::mismatch
