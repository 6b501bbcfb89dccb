// Populations: what the constants say, and what a fleet says.
#include "sealwatch/forecast/fleet_population.hpp"

#include <gmock/gmock.h>

#include <random>

#include "sealwatch/forecast/configured.hpp"
#include "sealwatch/forecast/fleet_uncertainty.hpp"
#include "sealwatch/forecast/forecaster.hpp"
#include "tests/unit/forecast/random_life.hpp"

namespace sealwatch::forecast {
namespace {

std::vector<FleetLife> fleet(int lives, const std::string& scenario) {
  std::vector<FleetLife> result;
  for (int seed = 1; seed <= lives; ++seed) {
    FleetLife life{.history = {}, .installed = test::kInstalled};
    for (const auto& one : test::random_life(static_cast<std::uint64_t>(seed), scenario, 0.003, 0.6).months)
      if (one.sample) life.history.push_back(*one.sample);
    result.push_back(std::move(life));
  }
  return result;
}

TEST(FleetPopulation, DefaultsAreTheReferenceConstants) {
  const FleetPopulation from_constants = reference_population();
  const FleetPopulation defaults;
  constexpr double kDigits = 1e-4;  // the defaults are printed with five
  EXPECT_NEAR(from_constants.initial_rate / defaults.initial_rate, 1.0, kDigits);
  EXPECT_NEAR(from_constants.initial_rate_std / defaults.initial_rate_std, 1.0, kDigits);
  EXPECT_NEAR(from_constants.steepening / defaults.steepening, 1.0, kDigits);
  EXPECT_NEAR(from_constants.steepening_std / defaults.steepening_std, 1.0, kDigits);
  EXPECT_NEAR(from_constants.steepening_scatter / defaults.steepening_scatter, 1.0, kDigits);
  EXPECT_NEAR(from_constants.irregularity_std / defaults.irregularity_std, 1.0, kDigits);
  EXPECT_TRUE(from_constants.validate());
}

// Against simulated lives: half of them last longer than the mean seal, from new and from halfway.
TEST(FleetPopulation, TheMeanSealLivesAsLongAsTheMedianOfTheLives) {
  std::vector<double> from_new, from_half;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Degradation seal(seed);
    int at_half = 0;
    while (seal.condition() > 0.6) {
      seal.advance();
      if (at_half == 0 && seal.condition() <= 0.8) at_half = seal.month();
    }
    from_new.push_back(seal.month());
    from_half.push_back(seal.month() - at_half);
  }
  std::ranges::sort(from_new);
  std::ranges::sort(from_half);
  constexpr double kScatter = 0.06;  // of the median of 400 lives, and of a mean path against the lives' median
  EXPECT_NEAR(mean_remaining_months(1.0, 0.6) / from_new[200], 1.0, kScatter);
  EXPECT_NEAR(mean_remaining_months(0.8, 0.6) / from_half[200], 1.0, kScatter);
  EXPECT_EQ(mean_remaining_months(0.6, 0.6), 0.0);
  EXPECT_EQ(mean_remaining_months(0.5, 0.6), 0.0);
  EXPECT_EQ(mean_remaining_months(1.1, 0.6), mean_remaining_months(1.0, 0.6));
  EXPECT_TRUE(std::isinf(mean_remaining_months(1.0, -10.0)));
}

// 60 lives tell the means to a few per cent, and that a fleet which ages twice as fast does so.
TEST(FleetPopulation, FitFindsTheFleet) {
  const FleetFit usual = fit_population(fleet(60, "reference")).value();
  EXPECT_EQ(usual.lives, 60);
  EXPECT_NEAR(usual.population.initial_rate, 0.045, 0.006);
  EXPECT_NEAR(usual.population.steepening, 0.00115, 0.0001);
  EXPECT_NEAR(usual.population.irregularity_std / 0.0375, 1.0, 0.5);
  const FleetFit fast = fit_population(fleet(60, "unlike")).value();
  EXPECT_NEAR(fast.population.initial_rate, 0.08 + 0.015, 0.01);
  EXPECT_NEAR(fast.population.steepening, 0.002125, 0.0004);
}

TEST(FleetPopulation, ASmallFleetIsPulledToTheReference) {
  const FleetFit one = fit_population(fleet(1, "unlike")).value();
  const FleetFit many = fit_population(fleet(40, "unlike")).value();
  EXPECT_GT(one.population.initial_rate, 0.045);
  EXPECT_LT(one.population.initial_rate, many.population.initial_rate);
}

TEST(FleetPopulation, EmptyOrShortFleetsAreErrors) {
  EXPECT_THAT(fit_population({}).error().describe(), testing::HasSubstr("fleet is empty"));
  const std::vector<FleetLife> young{{.history = test::straight_life(5, 0.004, 0.003), .installed = test::kInstalled}};
  EXPECT_THAT(fit_population(young).error().describe(), testing::HasSubstr("at least 12 tests"));
  std::vector<FleetLife> mixed = fleet(2, "reference");
  mixed.push_back(young.front());
  EXPECT_EQ(fit_population(mixed)->passed_over, 1);
  EXPECT_FALSE(fit_population(mixed, {.n_0 = 0.0}));
}

// Before 24 tests exist: a fitted fleet knows what a straight line cannot, on lives that the fit has not seen.
TEST(FleetPopulation, TellsYoungSealsMoreThanTheReferenceDoes) {
  ForecasterSettings fitted{"fleet", kWholeLife_months};
  fitted.population = fit_population(fleet(40, "unlike"))->population;
  double error_fitted = 0.0;
  double error_reference = 0.0;
  for (std::uint64_t seed = 101; seed <= 140; ++seed) {
    const test::RandomLife life = test::random_life(seed, "unlike", 0.003, 0.6);
    ForecastRequest request{.threshold = 0.6, .now = test::month(12), .installed = test::kInstalled};
    for (int n = 0; n < 12; ++n) request.history.push_back(*life.months[static_cast<std::size_t>(n)].sample);
    const double left = life.end_months - 12.0;
    error_fitted += std::abs(make_forecaster(fitted).value()->forecast(request).value().rul_months - left);
    error_reference +=
        std::abs(make_forecaster({"fleet", kWholeLife_months}).value()->forecast(request).value().rul_months - left);
  }
  EXPECT_LT(error_fitted, 0.5 * error_reference);
}

// The error of the mean rate against the scatter of the fits of many fleets.
TEST(FleetUncertainty, StandardErrorsAreTheScatterOfManyFleets) {
  constexpr int kFleets = 20, kLives = 8;
  const std::vector<FleetLife> all = fleet(kFleets * kLives, "reference");
  double mean = 0.0, squares = 0.0, claimed = 0.0;
  double irregular = 0.0, irregular_squares = 0.0, irregular_claimed = 0.0;
  for (int k = 0; k < kFleets; ++k) {
    const std::span<const FleetLife> one(all.data() + k * kLives, kLives);
    const Result<FleetFit> fit = fit_population(one);
    ASSERT_TRUE(fit);
    const FleetErrors errors = fleet_errors(one, *fit);
    mean += fit->population.initial_rate / kFleets;
    squares += fit->population.initial_rate * fit->population.initial_rate / kFleets;
    claimed += errors.initial_rate / kFleets;
    irregular += fit->population.irregularity_std / kFleets;
    irregular_squares += fit->population.irregularity_std * fit->population.irregularity_std / kFleets;
    irregular_claimed += errors.irregularity_std / kFleets;
    EXPECT_GT(errors.irregularity_std, 0.0) << "fleet " << k;
    EXPECT_GT(constants_for_forecasts(fit->population, errors).initial_rate_std, fit->population.initial_rate_std);
  }
  const double scatter = std::sqrt(squares - mean * mean);
  EXPECT_GT(claimed / scatter, 0.6) << "of 20 fleets the scatter is good to a sixth, the model of 8 to a quarter";
  EXPECT_LT(claimed / scatter, 1.7);
  const double irregular_scatter = std::sqrt(irregular_squares - irregular * irregular);
  EXPECT_GT(irregular_claimed / irregular_scatter, 0.6);
  EXPECT_LT(irregular_claimed / irregular_scatter, 1.7);
}

// Lives that are alike by chance scatter nowhere, but none of them is known exactly.
TEST(FleetUncertainty, LivesThatAreAlikeLeaveAnErrorOfTheirOwn) {
  const std::vector<FleetLife> one = fleet(1, "reference");
  const std::vector<FleetLife> alike(4, one.front());
  const Result<FleetFit> fit = fit_population(alike);
  ASSERT_TRUE(fit) << fit.error().describe();
  const FleetErrors errors = fleet_errors(alike, *fit);
  // Lives that are known exactly, n = 4 and the reference's k = 4: spread sqrt(n) / (n + k).
  constexpr double kOfTheSpread = 0.25, kByTheirOwnErrors = 0.05;
  EXPECT_NEAR(errors.initial_rate / fit->population.initial_rate_std, kOfTheSpread, kByTheirOwnErrors);
  EXPECT_NEAR(errors.steepening / fit->population.steepening_std, kOfTheSpread, kByTheirOwnErrors);
}

/// Lives that fall along the mean path, with the errors that are told of them.
std::vector<FleetLife> regular_fleet(int lives, double irregular_std) {
  std::vector<FleetLife> result;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  const FleetPopulation mean;
  constexpr double kError = 0.002;
  for (int k = 0; k < lives; ++k) {
    FleetLife life{.history = {}, .installed = test::kInstalled};
    double theta = 1.0;
    for (int n = 1; n <= 60; ++n) {
      theta -= (mean.initial_rate + mean.steepening * n + irregular_std * normal(random)) * std::log((n + 1.0) / n);
      life.history.push_back({test::month(n), theta + kError * normal(random), kError});
    }
    result.push_back(std::move(life));
  }
  return result;
}

// The reference's least irregularity is more than these lives have: no estimate, but a limit that still covers them.
TEST(FleetUncertainty, RegularLivesTellALimitOfTheirIrregularity) {
  const std::vector<FleetLife> regular = regular_fleet(3, 0.002);
  const Result<FleetFit> fit = fit_population(regular);
  ASSERT_TRUE(fit) << fit.error().describe();
  EXPECT_TRUE(fit->irregularity_is_limit);
  const double least = 0.25 * FleetPopulation{}.irregularity_std;
  EXPECT_NEAR(fit->likeliest_irregularity, least, 1e-12);
  EXPECT_GT(fit->population.irregularity_std, least);
  EXPECT_LT(fit->population.irregularity_std, 4.0 * least);
  const FleetErrors errors = fleet_errors(regular, *fit);
  EXPECT_EQ(errors.irregularity_std, 0.0);
  EXPECT_EQ(constants_for_forecasts(fit->population, errors).irregularity_std, fit->population.irregularity_std);
}

// Ten times as irregular as the reference: beyond the multiples that are tried first.
TEST(FleetUncertainty, AnIrregularFleetIsEstimatedHoweverIrregularItIs) {
  const std::vector<FleetLife> rough = regular_fleet(6, 0.375);
  const Result<FleetFit> fit = fit_population(rough);
  ASSERT_TRUE(fit) << fit.error().describe();
  EXPECT_FALSE(fit->irregularity_is_limit);
  constexpr double kOf360Months = 0.15;
  EXPECT_NEAR(fit->population.irregularity_std / 0.375, 1.0, kOf360Months);
  const FleetErrors errors = fleet_errors(rough, *fit);
  EXPECT_GT(constants_for_forecasts(fit->population, errors).irregularity_std, fit->population.irregularity_std);
}

TEST(FleetUncertainty, ForecastersTakeTheConfiguredFleet) {
  Configuration configuration;
  configuration.fleet = FleetConstants{.initial_rate = 0.09,
                                       .initial_rate_std = 0.01,
                                       .steepening = 0.002,
                                       .steepening_std = 0.0003,
                                       .rate_steepening_correlation = 0.1,
                                       .irregularity_std = 0.02};
  for (const ForecasterSettings& settings : configured_forecasters(configuration)) {
    EXPECT_EQ(settings.population.initial_rate, 0.09) << settings.method;
    EXPECT_EQ(settings.population.n_0, FleetPopulation{}.n_0) << "what a fit does not give stays the reference's";
  }
}

}  // namespace
}  // namespace sealwatch::forecast
