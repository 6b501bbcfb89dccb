// The missing term against the truth that made the recording: simulations of the plant with a law in force and seeded
// noise, fitted without the law.
#include "services/common/mismatch/missing_term.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <random>

#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/drawn_terms.hpp"
#include "services/common/mismatch/regime.hpp"
#include "services/common/mismatch/smooth_input.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// One recording.
Data data_of(TimeSeries samples) {
  Data data;
  data.names = {"pst"};
  data.samples = {std::move(samples)};
  return data;
}

/// Share of the time within the 95 % band: less than that, as the band is that of a smooth input and friction jumps at
/// each start and stop.
constexpr double kMostOfTheTime = 0.8;

/// A plant with one law in force, its recording, and models fitted without and with the law.
struct Concealed {
  const Law* law = nullptr;
  std::vector<double> parameters;  ///< as fitted
  Data data;
  TimeSeries clean;  ///< without noise
  FittedModel without, with;
};

AssetConfig plant() {
  AssetConfig asset = nominal_asset("eha");
  for (auto& [channel, sensor] : asset.sensors) sensor.time_constant_s = 0.0;  // channels are states: the truth is seen
  return asset;
}

Concealed conceal(const std::string& id, const std::string& element, const std::vector<std::string>& names,
                  const std::vector<double>& values) {
  const Law* law = find_law(id, names).value();
  Concealed made;
  made.law = law;
  const AssetConfig truth = with_law(plant(), *law, element, values);
  made.data = data_of(simulated_test(truth, 1.0, &made.clean));
  made.without = fit_model(plant(), made.data, nullptr, 1).value();
  made.with = fit_model(with_law(plant(), *law, element, values), made.data, &made.without, 1).value();
  for (const LawParameter& parameter : law->parameters)
    made.parameters.push_back(estimate_of(made.with, physics_parameter_name(element, id, parameter.name)).value());
  return made;
}

/// Share of the knots at which the curve is within its band of the truth; rms of the difference over rms of the truth.
struct Agreement {
  double within = 0.0, relative_rms = 0.0;
};
Agreement compare(const MissingTerm& term, const std::vector<double>& curve, const std::vector<double>& truth) {
  Agreement agreement;
  double error = 0.0, size = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double difference = std::abs(curve[k] - truth[k]);
    if (difference <= term.band[k]) agreement.within += 1.0 / static_cast<double>(truth.size());
    error += difference * difference, size += truth[k] * truth[k];
  }
  agreement.relative_rms = std::sqrt(error / size);
  return agreement;
}

/// A parameter as made and as fitted with the law: what they differ by is missing too.
struct MadeAndFitted {
  double made = 0.0, fitted = 0.0;
};
MadeAndFitted made_and_fitted(const Concealed& concealed, const std::string& name) {
  return {plant().parameter(name), concealed.with.asset.parameter(name)};
}

template <class Of>
std::vector<double> truth_at_knots(const Concealed& concealed, const Of& of) {
  std::vector<double> values;
  for (std::size_t k = 0; k < concealed.clean.time_s.size(); ++k) values.push_back(of(k));
  return hat_means(make_knots(concealed.clean.time_s), concealed.clean.time_s, values);
}

TEST(MissingTerm, OfCoulombFrictionIsItsForceOverTime) {
  constexpr double kForce_N = 1500.0, kWidth_m_s = 1e-4;
  const Concealed coulomb = conceal("coulomb_friction", "piston", {"F_c", "v_s"}, {kForce_N, kWidth_m_s});
  const auto term = missing_term(coulomb.without, &coulomb.with, coulomb.data, 0, "piston", SiteKind::piston_force,
                                 coulomb.law, coulomb.parameters);
  ASSERT_TRUE(term) << term.error().describe();
  const auto& v = coulomb.clean.find("velocity")->values;
  const MadeAndFitted f_C = made_and_fitted(coulomb, "f_C");
  const auto truth = truth_at_knots(
      coulomb, [&](std::size_t k) { return kForce_N * std::tanh(v[k] / kWidth_m_s) + (f_C.made - f_C.fitted) * v[k]; });
  ASSERT_EQ(term->time_s.size(), truth.size());
  const Agreement demanded = compare(*term, term->demanded, truth), law = compare(*term, term->law, truth);
  EXPECT_GT(demanded.within, kMostOfTheTime);
  EXPECT_LT(demanded.relative_rms, 0.1);
  EXPECT_LT(law.relative_rms, 0.1);
  EXPECT_EQ(term->quantity, "force against +x, up to a constant");  // the load is each recording's own
  EXPECT_EQ(term->unit, "N");
  EXPECT_EQ(term->state, "velocity");
  EXPECT_NEAR(*std::ranges::max_element(term->state_value), 1.33e-3, 1e-4);
  EXPECT_THAT(regime_of(term_paths(coulomb.with, "piston", *coulomb.law, coulomb.parameters), SiteKind::piston_force),
              StartsWith("moving, both directions, "));
  RecordProperty("within", std::to_string(demanded.within));
  RecordProperty("relative_rms", std::to_string(demanded.relative_rms));
}

TEST(MissingTerm, IsDrawnOverTheRecordingInWhichItCanBeRead) {
  const Law* law = find_law("coulomb_friction", {"F_c", "v_s"}).value();
  const AssetConfig truth = with_law(plant(), *law, "piston", std::array{1500.0, 1e-4});
  TimeSeries rocking = standard_pst(truth, 100.0);
  for (Series& series : rocking.channels)
    for (std::size_t k = 0; series.name == "motor_voltage" && k < series.values.size(); ++k)
      series.values[k] = k / 10 % 2 == 0 ? 6.0 : -6.0;  // five times a second: faster than the term can be followed
  Data data = data_of(simulated(truth, rocking, 1.0));
  data.names = {"rocking", "stroke"};
  data.samples.push_back(simulated_test(truth, 1.0));
  const FittedModel without = fit_model(plant(), data, nullptr, 1).value();
  const Trial best{.effects = {{law, "piston"}},
                   .model = std::make_shared<FittedModel>(fit_model(truth, data, &without, 1).value())};
  Explanation result;
  result.effects.resize(1);  // claimed
  draw_missing_terms(without, best, data, true, result);
  ASSERT_EQ(result.missing.size(), 1U);
  const MissingTerm& term = result.missing.front();
  EXPECT_EQ(term.recording, "stroke");
  ASSERT_EQ(term.path_state.size(), term.path_law.size());
  for (std::size_t k = 0; k < term.path_law.size(); ++k)  // the law itself: no mean of both sides of a jump
    if (std::abs(term.path_state[k]) > 5e-4) {
      EXPECT_NEAR(std::abs(term.path_law[k]), 1500.0, 50.0);
    }
}

TEST(MissingTerm, DepartsFromALawThatIsWrong) {
  constexpr double kForce_N = 1500.0, kWidth_m_s = 1e-4;
  Concealed coulomb = conceal("coulomb_friction", "piston", {"F_c", "v_s"}, {kForce_N, kWidth_m_s});
  const Law* spring = find_law("spring_load", {"k"}).value();
  // The plant's parameters stay what they are, so that nothing else takes the friction up.
  const AssetConfig wrong = with_law(with_fixed_parameters(plant()), *spring, "piston", std::array{5e4});
  coulomb.with = fit_model(wrong, coulomb.data, nullptr, 1).value();
  const std::array stiffness{estimate_of(coulomb.with, "piston.spring_load.k").value()};
  const auto term = missing_term(coulomb.without, &coulomb.with, coulomb.data, 0, "piston", SiteKind::piston_force,
                                 spring, stiffness);
  ASSERT_TRUE(term) << term.error().describe();
  const auto& v = coulomb.clean.find("velocity")->values;
  auto truth = truth_at_knots(coulomb, [&](std::size_t k) { return kForce_N * std::tanh(v[k] / kWidth_m_s); });
  const auto mean = [](const std::vector<double>& of) {
    return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
  };
  const double level = mean(term->law) - mean(truth);  // a constant is the law's
  for (double& value : truth) value += level;
  const double demanded = compare(*term, term->demanded, truth).relative_rms;
  const double law = compare(*term, term->law, truth).relative_rms;
  EXPECT_LT(demanded, 0.1);
  EXPECT_GT(law, 0.5);
  RecordProperty("relative_rms", std::to_string(demanded));
  RecordProperty("law_relative_rms", std::to_string(law));
}

TEST(MissingTerm, OfAScoredBoreIsItsLeakageOverTime) {
  constexpr double kFlow = 3e-14, kPosition_m = 0.052, kWidth_m = 4e-3;
  const Concealed score = conceal("unlisted", "piston_seal", {"G_l", "x_l", "w_l"}, {kFlow, kPosition_m, kWidth_m});
  const auto term = missing_term(score.without, &score.with, score.data, 0, "piston_seal", SiteKind::seal_leakage,
                                 score.law, score.parameters);
  ASSERT_TRUE(term) << term.error().describe();
  const auto &p_A = score.clean.find("pressure_a")->values, &p_B = score.clean.find("pressure_b")->values;
  const auto& x = score.clean.find("position")->values;
  const MadeAndFitted R_CL = made_and_fitted(score, "R_CL");
  const auto truth = truth_at_knots(score, [&](std::size_t k) {
    const double bell = std::exp(-std::pow((x[k] - kPosition_m) / kWidth_m, 2));
    return (p_A[k] - p_B[k]) * (kFlow * bell + 1.0 / R_CL.made - 1.0 / R_CL.fitted);
  });
  const Agreement demanded = compare(*term, term->demanded, truth);
  EXPECT_GT(demanded.within, kMostOfTheTime);
  EXPECT_LT(demanded.relative_rms, 0.1);
  EXPECT_LT(compare(*term, term->law, truth).relative_rms, 0.05);
  EXPECT_EQ(term->quantity, "flow from chamber A to B");
  EXPECT_EQ(term->state, "pressure difference across the piston");
  EXPECT_THAT(regime_of(term_paths(score.with, "piston_seal", *score.law, score.parameters), SiteKind::seal_leakage),
              HasSubstr("; position between "));
  RecordProperty("within", std::to_string(demanded.within));
  RecordProperty("relative_rms", std::to_string(demanded.relative_rms));
}

TEST(MissingTerm, IsNothingBeyondItsBandWhereNothingIsMissing) {
  const Data data = data_of(simulated_test(plant(), 1.0, nullptr));
  const FittedModel model = fit_model(plant(), data, nullptr, 1).value();
  for (const auto& [element, kind] :
       {std::pair("piston", SiteKind::piston_force), std::pair("piston_seal", SiteKind::seal_leakage),
        std::pair("shaft", SiteKind::shaft_torque), std::pair("sensor:flow", SiteKind::sensor_bias)}) {
    const auto term = missing_term(model, nullptr, data, 0, element, kind, nullptr, {});
    ASSERT_TRUE(term) << element << ": " << term.error().describe();
    EXPECT_TRUE(term->law.empty());
    const std::vector<double> nothing(term->time_s.size(), 0.0);
    EXPECT_GT(compare(*term, term->demanded, nothing).within, kMostOfTheTime) << element;
  }
}

TEST(MissingTerm, OfASensorIsTheShiftOfItsReading) {
  const double bias = 20.0 * plant().sensors.at("flow").noise_std;
  const Concealed biased = conceal("sensor_bias", "sensor:flow", {"b"}, {bias});
  const auto term = missing_term(biased.without, &biased.with, biased.data, 0, "sensor:flow", SiteKind::sensor_bias,
                                 biased.law, biased.parameters);
  ASSERT_TRUE(term) << term.error().describe();
  EXPECT_EQ(term->unit, "m3/s");
  for (std::size_t k = 0; k < term->time_s.size(); ++k) EXPECT_NEAR(term->law[k], biased.parameters[0], 1e-3 * bias);
  EXPECT_GT(compare(*term, term->demanded, std::vector<double>(term->time_s.size(), bias)).within, kMostOfTheTime);
}

TEST(MissingTerm, OfAPlaceThatThePlantDoesNotHaveIsAnError) {
  const Data data = data_of(simulated_test(plant(), 1.0, nullptr));
  const FittedModel model = fit_model(plant(), data, nullptr, 1).value();
  for (const auto& [element, kind] :
       {std::pair("gearbox", SiteKind::piston_force), std::pair("sensor:gearbox", SiteKind::sensor_bias)}) {
    const auto term = missing_term(model, nullptr, data, 0, element, kind, nullptr, {});
    ASSERT_FALSE(term.has_value());
    EXPECT_THAT(term.error().describe(), HasSubstr(element));
  }
}

TEST(SmoothInput, OfALineIsTheLineWithItsError) {
  // Seen directly with noise 1: residual = w, a line from 0 to 10 over 400 samples.
  constexpr Eigen::Index kSamples = 400;
  std::vector<double> time_s;
  for (Eigen::Index k = 0; k < kSamples; ++k) time_s.push_back(0.025 * static_cast<double>(k));
  const Knots knots = make_knots(time_s);
  RowMatrix hats = RowMatrix::Zero(kSamples, static_cast<Eigen::Index>(knots.count));
  Eigen::VectorXd residual(kSamples);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    const double t = time_s[static_cast<std::size_t>(k)];
    const auto [knot, share] = knots.at(t);
    hats(k, static_cast<Eigen::Index>(knot)) = 1.0 - share;
    hats(k, static_cast<Eigen::Index>(knot) + 1) = share;
    residual(k) = t + normal(random);
  }
  const auto line = smooth_input(hats, RowMatrix(kSamples, 0), residual);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->level_known);
  const double middle_error = 1.0 / std::sqrt(static_cast<double>(kSamples));  // of a straight line at its middle
  const auto middle = static_cast<Eigen::Index>(knots.count / 2);
  EXPECT_NEAR(line->value(middle), knots.time_s(knots.count / 2), 4.0 * line->standard_error(middle));
  EXPECT_NEAR(line->standard_error(middle), middle_error, middle_error);
  EXPECT_NEAR(line->dispersion, 1.0, 0.2);
  // A constant beside it takes the level up.
  const auto centred = smooth_input(hats, RowMatrix::Ones(kSamples, 1), residual);
  ASSERT_TRUE(centred);
  EXPECT_FALSE(centred->level_known);
  EXPECT_NEAR(centred->value.mean(), 0.0, 1e-9);
  EXPECT_NEAR(centred->value(static_cast<Eigen::Index>(knots.count) - 1), 5.0, 0.5);
  EXPECT_FALSE(smooth_input(0.0 * hats, RowMatrix(kSamples, 0), residual).has_value());
}

/// A path of the piston: signals v, x, p_A, p_B each 10 ms.
template <class Of>
TermPath path_of(const Of& force) {
  TermPath path;
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.01 * k,
                 v = 1e-3 * (t < 10.0   ? 1.0
                             : t < 20.0 ? -1.0
                                        : 0.0),
                 x = 0.05 + 1e-3 * std::min(t, 20.0 - t);
    path.time_s.push_back(t);
    path.signals.push_back({v, t < 20.0 ? x : 0.05, 1e7, 1e6});
    path.contribution.push_back(force(t, v, path.signals.back()[1]));
  }
  return path;
}

TEST(Regime, IsNamedByWhereTheEnergyIs) {
  const auto regime = [](const auto& force) {
    const std::array paths{path_of(force)};
    return regime_of(paths, SiteKind::piston_force);
  };
  EXPECT_EQ(regime([](double, double, double) { return 100.0; }), "throughout");
  EXPECT_EQ(regime([](double, double, double) { return 0.0; }), "nowhere in these recordings");
  EXPECT_EQ(regime([](double, double v, double) { return 1e5 * v; }), "moving, both directions, 67 % of the time");
  EXPECT_THAT(regime([](double, double v, double) { return v > 0.0 ? 100.0 : 0.0; }), HasSubstr("moving towards +x"));
  EXPECT_THAT(regime([](double, double v, double) { return v < 0.0 ? 100.0 : 0.0; }), HasSubstr("moving towards -x"));
  EXPECT_THAT(regime([](double, double v, double) { return v == 0.0 ? 100.0 : 0.0; }), HasSubstr("at rest"));
  EXPECT_EQ(regime([](double, double v, double x) { return x > 0.057 ? 1e5 * v : 0.0; }),
            "moving, both directions; position above 57 mm, 20 % of the time");
  EXPECT_EQ(regime([](double, double v, double x) { return v != 0.0 && std::abs(x - 0.055) > 0.003 ? 100.0 : 0.0; }),
            "moving, both directions; position below 51.6 mm or above 58 mm, 27 % of the time");
  EXPECT_EQ(regime_of({}, SiteKind::piston_force), "");
}

TEST(Regime, OfASensorGoesByWhatItMeasures) {
  TermPath path;
  for (int k = 0; k <= 1000; ++k) {
    path.time_s.push_back(4.0 * k);
    path.signals.push_back({0.012 * k});
    path.contribution.push_back(-0.9 * std::max(0.012 * k - 10.8, 0.0));
  }
  const std::array paths{path};
  const std::array<SignalWords, kSiteSignals> signals{SignalWords{"measured value", "V"}};
  EXPECT_THAT(regime_of(paths, SiteKind::sensor_saturation, signals), StartsWith("measured value above 10.9 V"));
}

TEST(Regime, IsShownAgainstTheSignalThatTheTermGoesBy) {
  const auto signal = [](const auto& force) {
    const std::array paths{path_of(force)};
    return deciding_signal(paths, SiteKind::piston_force, {true, true, true, true});
  };
  EXPECT_EQ(signal([](double, double v, double) { return 100.0 * std::tanh(v / 1e-4); }), 0U);
  EXPECT_EQ(signal([](double, double, double x) { return 1e4 * (x - 0.054) * (x - 0.054); }), 1U);
  EXPECT_EQ(signal([](double, double, double) { return 4.0; }), 0U);
}

TEST(Regime, ALawSeesWhatMovesItAndNotWhatItCauses) {
  using testing::ElementsAre;
  TermPath path = path_of([](double, double, double) { return 0.0; });
  for (auto& signals : path.signals) signals[2] = signals[3] = 5e6;
  const std::array paths{path};
  const PlantDescription& plant = **find_plant("eha");
  const Law& coulomb = **find_law("coulomb_friction", {"F_c", "v_s"});
  EXPECT_THAT(signals_seen(paths, coulomb, std::array{500.0, 5e-4}, plant), ElementsAre(true, false, false, false));
  const Law& hysteretic = **find_law("hysteretic_load", {"F_h", "x_y"});
  EXPECT_THAT(signals_seen(paths, hysteretic, std::array{500.0, 2e-3}, plant), ElementsAre(true, true, false, false));
}

}  // namespace
}  // namespace sealwatch::mismatch
