// The whole actuator's fit: derivatives, known parameters from an independent bench, coverage, and what cannot be
// fitted.
#include "sealwatch/estimation/actuator_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <thread>

#include "sealwatch/estimation/pem_estimator.hpp"
#include "sealwatch/model/simulation.hpp"
#include "sealwatch/model/too_long_to_simulate.hpp"
#include "services/common/estimation/pem_problem.hpp"
#include "services/virtual_bench/simulate_test.hpp"
#include "tests/unit/estimation/recordings.hpp"

namespace sealwatch {
namespace {

using test::nominal_asset;

const std::map<std::string, double> kTruth = {{"R_CL", 1.3e13}, {"f_C", 1.8e6},   {"R_PL", 4.2e13},
                                              {"f_M", 1.0e-3},  {"beta", 1.05e9}, {"R_M", 0.53}};
constexpr double kLoadFactor = 0.1;

/// 16 s.
PstSetting short_test() {
  PstSetting pst;
  pst.stroke_m = -0.006;
  pst.hold_s = 3.0;
  return pst;
}

/// A test of the virtual bench, whose integrator, controller and sensors the estimator does not know.
TimeSeries bench_recording(double noise_share, double rate_Hz = 50.0,
                           const std::map<std::string, double>& truth = kTruth, const PstSetting& pst = short_test()) {
  AssetConfig asset = nominal_asset();
  for (auto& [channel, sensor] : asset.sensors) sensor.noise_std *= noise_share;
  bench::TestSetting setting;
  setting.sample_rate_Hz = rate_Hz;
  return bench::simulate_test(asset, bench::pst_profile(pst), {.parameters = truth, .load_factor = kLoadFactor},
                              setting)
      ->samples;
}

TimeSeries with_noise(TimeSeries samples, const AssetConfig& asset, unsigned seed) {
  std::mt19937_64 generator(seed);
  for (Series& channel : samples.channels) {
    const double noise_std = asset.sensors.at(channel.name).noise_std;
    if (!(noise_std > 0.0)) continue;
    channel.noise_std = noise_std;
    std::normal_distribution<double> noise(0.0, noise_std);
    for (double& value : channel.values) value += noise(generator);
  }
  return samples;
}

const EstimatedParameter* find(const FitReport& report, const std::string& name) {
  for (const EstimatedParameter& parameter : report.parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

JointFit fit_one(const AssetConfig& asset, const TimeSeries& samples) { return fit_actuator(asset, {&samples, 1}); }

TEST(ActuatorFit, JacobianIsTheDerivativeOfTheResidual) {
  const TimeSeries samples = bench_recording(1.0);
  PemProblem problem = *make_pem_problem(nominal_asset(), {&samples, 1});
  problem.simulation_options.relative_tolerance = 1e-9;
  std::vector<double> shared, own;
  for (const Unknown& unknown : problem.shared) shared.push_back(unknown.to_unknown(unknown.start));
  for (const Unknown& unknown : problem.recordings[0].own) own.push_back(unknown.to_unknown(unknown.start));
  const Linearisation at = *linearise(problem, 0, shared, own);
  constexpr double kStep = 1e-3;       // of an unknown, all of which are of the order of one
  constexpr double kTolerance = 5e-3;  // of the column's norm: curvature over the step and the integrator's error
  for (std::size_t k = 0; k < shared.size() + own.size(); ++k) {
    double& unknown = k < shared.size() ? shared[k] : own[k - shared.size()];
    const double centre = unknown;
    unknown = centre + kStep;
    const Eigen::VectorXd above = linearise(problem, 0, shared, own)->residual;
    unknown = centre - kStep;
    const Eigen::VectorXd below = linearise(problem, 0, shared, own)->residual;
    unknown = centre;
    const Eigen::VectorXd expected = (above - below) / (2.0 * kStep),
                          column = at.jacobian.col(static_cast<Eigen::Index>(k));
    EXPECT_LT((column - expected).norm(), kTolerance * expected.norm()) << "unknown " << k;
  }
}

TEST(ActuatorFit, CompressedProblemIsTheSameLeastSquaresProblem) {
  Linearisation full{.simulated = {}, .residual = Eigen::VectorXd::Random(300), .jacobian = RowMatrix::Random(300, 5)};
  full.jacobian.col(2) *= 1e6;
  full.jacobian.col(4) = full.jacobian.col(1);  // rank loss must survive
  const Eigen::MatrixXd small = compress(full);
  ASSERT_EQ(small.rows(), 6);
  const Eigen::MatrixXd normal = full.jacobian.transpose() * full.jacobian;
  const Eigen::VectorXd gradient = full.jacobian.transpose() * full.residual;
  constexpr double kRounding = 1e-12;
  EXPECT_LT((small.leftCols(5).transpose() * small.leftCols(5) - normal).norm(), kRounding * normal.norm());
  EXPECT_LT((small.leftCols(5).transpose() * small.col(5) - gradient).norm(), kRounding * gradient.norm());
  EXPECT_NEAR(small.col(5).squaredNorm(), full.residual.squaredNorm(), 1e-9);
}

// Columns 1 and 3 are of unknowns that are known beforehand.
TEST(ActuatorFit, KeptDerivativesOfTheSamePointChangeNothing) {
  PemProblem problem;
  problem.shared.resize(4);
  problem.shared[1].prior_std = problem.shared[3].prior_std = 1.0;
  const Linearisation full{
      .simulated = {}, .residual = Eigen::VectorXd::Random(300), .jacobian = RowMatrix::Random(300, 6)};
  const KeptDerivatives kept = kept_derivatives(problem, full);
  EXPECT_EQ(kept.jacobian.col(1), full.jacobian.col(3));
  Linearisation others = full;
  others.jacobian = not_known_jacobian(problem, full.jacobian);
  ASSERT_EQ(others.jacobian.cols(), 4);
  EXPECT_EQ(whole_jacobian(problem, others.jacobian, kept), full.jacobian);
  const Eigen::MatrixXd with_kept = compress(problem, others, kept), of_all = compress(full);
  constexpr double kRounding = 1e-12;
  EXPECT_LT((with_kept.transpose() * with_kept - of_all.transpose() * of_all).norm(), kRounding * of_all.squaredNorm());
}

TEST(ActuatorFit, RecoversTheBenchsParameters) {
  const TimeSeries samples = bench_recording(1.0);
  const JointFit fit = fit_one(nominal_asset(), samples);
  ASSERT_TRUE(fit.report.admissible) << testing::PrintToString(fit.report.reasons) << fit.report.termination;
  constexpr double kSigmas = 4.0;  // seven checks: a false alarm in two thousand
  for (const auto& [name, truth] : kTruth) {
    const EstimatedParameter& parameter = *find(fit.report, name);
    EXPECT_NEAR(parameter.value, truth, kSigmas * parameter.std_error) << name;
    EXPECT_LT(parameter.std_error, 0.05 * truth) << name;
  }
  EXPECT_NEAR(fit.report.load_factor, kLoadFactor, kSigmas * find(fit.report, "load_factor")->std_error);
  for (const ChannelFit& channel : fit.report.channels)
    EXPECT_NEAR(channel.noise_normalised_rms, 1.0, 0.15) << channel.channel;
}

// Without flow the circuit gives no start for R_CL, and from a new seal's value the search ends elsewhere.
TEST(ActuatorFit, FindsAWornSealWithoutAFlowSensor) {
  for (const double leakage : {5.0e12, 5.6e12, 6.2e12, 6.8e12, 8.0e12}) {
    TimeSeries samples = bench_recording(1.0, 50.0, {{"R_CL", leakage}}, PstSetting{});
    std::erase_if(samples.channels, [](const Series& channel) { return channel.name == "flow"; });
    const FitReport fit = fit_one(nominal_asset(), samples).report;
    ASSERT_TRUE(fit.admissible) << leakage << testing::PrintToString(fit.reasons) << fit.termination;
    constexpr double kSigmas = 4.0;
    EXPECT_NEAR(find(fit, "R_CL")->value, leakage, kSigmas * find(fit, "R_CL")->std_error);
  }
}

TEST(ActuatorFit, IntervalsCoverTheTruthAsOftenAsTheySay) {
  const AssetConfig asset = nominal_asset();
  const TimeSeries noiseless = bench_recording(0.0);
  // 40 runs of seven parameters at a nominal 95 %. Were they independent, the share would scatter by 1.3 %; they are
  // not quite, so three times twice that.
  constexpr unsigned kRuns = 25;
  constexpr double kTolerance = 0.1;
  int covered = 0, checks = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const FitReport report = fit_one(asset, with_noise(noiseless, asset, seed)).report;
    ASSERT_TRUE(report.converged) << report.termination;
    for (const auto& [name, truth] : kTruth) {
      covered += std::abs(find(report, name)->value - truth) < 1.96 * find(report, name)->std_error;
      ++checks;
    }
    covered += std::abs(report.load_factor - kLoadFactor) < 1.96 * find(report, "load_factor")->std_error;
    ++checks;
  }
  EXPECT_NEAR(static_cast<double>(covered) / checks, 0.95, kTolerance);
}

TEST(ActuatorFit, SeveralRecordingsShareTheirParameters) {
  const AssetConfig asset = nominal_asset();
  const TimeSeries noiseless = bench_recording(0.0);
  const std::vector<TimeSeries> recordings = {with_noise(noiseless, asset, 1), with_noise(noiseless, asset, 2)};
  const JointFit one = fit_one(asset, recordings.front()), both = fit_actuator(asset, recordings);
  ASSERT_TRUE(both.report.admissible) << testing::PrintToString(both.report.reasons);
  ASSERT_EQ(both.recordings.size(), 2U);
  EXPECT_EQ(find(both.report, "load_factor"), nullptr);
  // Twice the data: the standard error falls by sqrt(2), but for what noise does to the Jacobian.
  EXPECT_NEAR(find(one.report, "R_CL")->std_error / find(both.report, "R_CL")->std_error, std::sqrt(2.0), 0.1);
  for (const RecordingFit& recording : both.recordings) {
    EXPECT_NEAR(recording.load.value, kLoadFactor, 4.0 * recording.load.std_error);
    EXPECT_EQ(recording.simulated.time_s, noiseless.time_s);
  }
}

TEST(ActuatorFit, WhatTheChannelsCannotTellHasNoStandardError) {
  AssetConfig asset = nominal_asset();
  asset.parameters["d_P"].estimate = true;  // only f_M + d_P shows
  const JointFit fit = fit_one(asset, bench_recording(1.0));
  EXPECT_TRUE(std::isinf(find(fit.report, "f_M")->std_error));
  EXPECT_TRUE(std::isinf(find(fit.report, "d_P")->std_error));
  EXPECT_TRUE(std::isfinite(find(fit.report, "R_CL")->std_error));
  EXPECT_THAT(fit.report.termination, testing::HasSubstr("not identifiable from these channels: f_M, d_P"));
}

TEST(ActuatorFit, AParameterOutsideItsBoundsEndsThereAndSaysSo) {
  AssetConfig asset = nominal_asset();
  asset.parameters["R_CL"].min = 2e13;
  const JointFit fit = fit_one(asset, bench_recording(1.0));
  EXPECT_TRUE(find(fit.report, "R_CL")->at_bound);
  EXPECT_TRUE(std::isinf(find(fit.report, "R_CL")->std_error));
  EXPECT_FALSE(fit.report.admissible);
  EXPECT_THAT(fit.report.reasons, testing::Contains(testing::HasSubstr("R_CL ended at its bound 2·10¹³ Pa·s/m³")));
}

TEST(ActuatorFit, TellsItsIterationsAndEndsAtItsDeadlineWithTheBestSoFar) {
  const AssetConfig asset = nominal_asset();
  const TimeSeries recorded = bench_recording(1.0);
  ActuatorFitOptions options;
  std::vector<double> shares;
  options.progress = [&](std::string_view /*step*/, double share) { shares.push_back(share); };
  const JointFit whole = fit_actuator(asset, {&recorded, 1}, options);
  ASSERT_TRUE(whole.report.converged);
  EXPECT_GE(shares.size(), 2U);
  EXPECT_GT(shares.back(), 0.0);
  EXPECT_LE(*std::ranges::max_element(shares), 1.0);

  Deadline deadline;
  options.deadline = &deadline;
  options.progress = [&](std::string_view /*step*/, double share) {
    if (share > 0.0) deadline.set_in(0.0);  // after the first step
  };
  const JointFit cut = fit_actuator(asset, {&recorded, 1}, options);
  EXPECT_FALSE(cut.report.converged);
  EXPECT_FALSE(cut.report.admissible);
  EXPECT_THAT(cut.report.termination, ::testing::HasSubstr("out of time"));
  EXPECT_FALSE(cut.report.parameters.empty());

  deadline.set_in(0.0);
  const JointFit none = fit_actuator(asset, {&recorded, 1}, options);
  EXPECT_FALSE(none.report.admissible);
  EXPECT_FALSE(none.report.reasons.empty()) << "nothing was simulated";
}

TEST(ActuatorFit, UnusableInputGetsAReason) {
  const TimeSeries good = bench_recording(1.0);
  const auto reasons = [&](const TimeSeries& samples) {
    const FitReport report = fit_one(nominal_asset(), samples).report;
    EXPECT_FALSE(report.admissible);
    return report.reasons;
  };
  EXPECT_THAT(reasons({}), testing::Not(testing::IsEmpty()));
  TimeSeries no_input = good;
  std::erase_if(no_input.channels,
                [](const Series& channel) { return channel.name == "motor_voltage" || channel.name == "flow"; });
  EXPECT_THAT(reasons(no_input), testing::Contains(testing::HasSubstr("not recorded")));
  TimeSeries gap = good;
  gap.channels[2].values[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(reasons(gap), testing::Contains(testing::HasSubstr("not numbers")));
  TimeSeries two = good;
  two.time_s.resize(2);
  for (Series& channel : two.channels) channel.values.resize(2);
  EXPECT_THAT(reasons(two), testing::Not(testing::IsEmpty()));
  TimeSeries constant = good;
  for (Series& channel : constant.channels)
    std::fill(channel.values.begin(), channel.values.end(), channel.values.front());
  EXPECT_THAT(reasons(constant), testing::Not(testing::IsEmpty()));
  EXPECT_FALSE(fit_actuator(nominal_asset(), {}).report.admissible);
}

TEST(PemEstimator, PutsTheFitToTrustFirst) {
  const auto estimator = make_pem_estimator();
  TimeSeries samples = bench_recording(1.0);
  const std::vector<Phase> phases = {{PhaseKind::hold, 6.0, 8.3}};
  std::vector<FitReport> fits = estimator->estimate(nominal_asset(), samples, phases, {});
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_EQ(fits[0].model, "eha");
  EXPECT_EQ(fits[1].model, "cylinder_circuit");
  EXPECT_TRUE(fits[0].admissible && fits[1].admissible);
  std::erase_if(samples.channels, [](const Series& channel) { return channel.name == "motor_voltage"; });
  fits = estimator->estimate(nominal_asset(), samples, phases, {});
  EXPECT_EQ(fits[0].model, "cylinder_circuit");
}

/// Of six hours, which take a minute or more.
TEST(PemEstimator, EndsSoonWhenItIsCalledOff) {
  TimeSeries samples = bench_recording(1.0, 500.0);
  const double apart_s = 6.0 * 3600.0 / static_cast<double>(samples.time_s.size());
  for (std::size_t row = 0; row < samples.time_s.size(); ++row)
    samples.time_s[row] = apart_s * static_cast<double>(row);
  std::stop_source stop;
  const std::jthread caller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop.request_stop();
  });
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<FitReport> fits = make_pem_estimator()->estimate(nominal_asset(), samples, {}, stop.get_token());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const auto whole = std::ranges::find(fits, "eha", &FitReport::model);
  ASSERT_NE(whole, fits.end());
  EXPECT_FALSE(whole->converged) << "after " << took.count() << " s";
  EXPECT_LT(took.count(), 10.0) << "a busy machine";
}

/// The same rows as those of a test that lasts nine hours: a simulation would take most of the estimate's time.
TEST(PemEstimator, DoesNotSimulateATestOfManyHours) {
  constexpr double kApart_s = 4.0;
  TimeSeries samples = bench_recording(1.0, 500.0);
  for (std::size_t row = 0; row < samples.time_s.size(); ++row)
    samples.time_s[row] = kApart_s * static_cast<double>(row);
  ASSERT_TRUE(too_long_to_simulate(samples.time_s));
  const std::vector<FitReport> fits = make_pem_estimator()->estimate(nominal_asset(), samples, {}, {});
  const auto whole = std::ranges::find(fits, "eha", &FitReport::model);
  ASSERT_NE(whole, fits.end());
  EXPECT_FALSE(whole->admissible);
  EXPECT_THAT(whole->reasons, testing::ElementsAre(testing::HasSubstr("cut the recording to the stroke")));
  EXPECT_EQ(fits.size(), 2U) << "the cylinder circuit takes no simulation";
}

}  // namespace
}  // namespace sealwatch
