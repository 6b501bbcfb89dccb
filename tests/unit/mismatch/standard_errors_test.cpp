// A straight-line model by hand: what its estimates really scatter by, against what is said.
#include "services/common/mismatch/standard_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/resolution.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr int kRows = 3000, kRecordings = 3;
constexpr double kSpacing_s = 0.01;

Unknown unknown(double bound) {
  return {.name = "a", .unit = "N", .quantity = {}, .scale = 2.0, .start = 0.0, .min = -bound, .max = bound};
}

// Rows: two shared unknowns and the recording's own offset.
RowMatrix jacobian(int recording) {
  RowMatrix j(kRows, 3);
  for (int row = 0; row < kRows; ++row) {
    const double t = row * kSpacing_s;
    j.row(row) << 1.0 + std::sin(0.2 * t + recording), std::cos(0.3 * t), 1.0;
  }
  return j;
}

FittedModel model_with(const std::vector<Eigen::VectorXd>& noise, double bound = 1e9) {
  FittedModel model;
  model.problem.shared = {unknown(bound), unknown(1e9)};
  model.optimum.point.shared = {0.0, 0.0};
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(2 + kRecordings, 2 + kRecordings);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 + kRecordings);
  std::vector<RowMatrix> all;
  for (int i = 0; i < kRecordings; ++i) {
    RowMatrix wide = RowMatrix::Zero(kRows, 2 + kRecordings);
    wide.leftCols(2) = jacobian(i).leftCols(2);
    wide.col(2 + i).setOnes();
    information += wide.transpose() * wide;
    right += wide.transpose() * noise[static_cast<std::size_t>(i)];
    all.push_back(std::move(wide));
  }
  const Eigen::VectorXd estimate = information.ldlt().solve(right);
  if (bound > 1e6) model.optimum.point.shared = {estimate(0), estimate(1)};
  for (int i = 0; i < kRecordings; ++i) {
    const auto k = static_cast<std::size_t>(i);
    PemRecording recording;
    for (int row = 0; row < kRows; ++row) recording.time_s.push_back(row * kSpacing_s);
    model.problem.recordings.push_back(std::move(recording));
    model.optimum.at_optimum.push_back(
        {.simulated = RowMatrix::Zero(kRows, 1), .residual = noise[k] - all[k] * estimate, .jacobian = jacobian(i)});
    model.misfit += model.optimum.at_optimum.back().residual.squaredNorm();
    model.residuals += kRows;
  }
  return model;
}

std::vector<Eigen::VectorXd> draw(std::mt19937_64& random, int same_for) {
  std::normal_distribution<double> normal;
  std::vector<Eigen::VectorXd> noise(kRecordings, Eigen::VectorXd(kRows));
  for (Eigen::VectorXd& one : noise)
    for (int row = 0; row < kRows; ++row) one(row) = row % same_for == 0 ? normal(random) : one(row - 1);
  return noise;
}

struct Scatter {
  double really = 0.0, said = 0.0;
};

Scatter scatter(int same_for) {
  std::mt19937_64 random(4);
  constexpr int kDraws = 400;
  Scatter found;
  for (int draws = 0; draws < kDraws; ++draws) {
    const FittedModel model = model_with(draw(random, same_for));
    found.really += std::pow(2.0 * model.optimum.point.shared[0], 2) / kDraws;
    found.said += std::pow(standard_errors(model)[0], 2) / kDraws;
  }
  return {std::sqrt(found.really), std::sqrt(found.said)};
}

TEST(StandardErrors, AreThoseOfWhiteNoiseWhereThatIsLeft) {
  const Scatter white = scatter(1);
  EXPECT_GT(white.said, 0.9 * white.really);
  EXPECT_LT(white.said, 1.2 * white.really);  // the larger of two estimates, one of them with 45 blocks
}

// What neighbouring samples share counts once: the plain (J'J)^-1 would be 10 times too small here.
TEST(StandardErrors, HoldWhereACourseIsLeft) {
  const Scatter course = scatter(100), white = scatter(1);
  EXPECT_GT(course.really, 7.0 * white.really);
  EXPECT_GT(course.said, 0.75 * course.really);
  EXPECT_LT(course.said, 1.2 * course.really);
}

// What the model misses grossly is held against the recordings, not against a value that is known beforehand.
TEST(StandardErrors, OfAKnownValueAreNoLargerThanWhatIsKnown) {
  std::mt19937_64 random(4);
  std::vector<Eigen::VectorXd> course = draw(random, 100);
  for (Eigen::VectorXd& one : course) one *= 1e4;
  FittedModel model = model_with(course);
  constexpr double kKnown = 0.01;  // in the unknown's own unit of 2 N
  model.problem.shared[0].prior_std = kKnown;
  const double said = standard_errors(model)[0];
  EXPECT_LE(said, 1.001 * 2.0 * kKnown);
  EXPECT_GT(said, 0.9 * 2.0 * kKnown);
}

TEST(StandardErrors, AreInfiniteAtABound) {
  std::mt19937_64 random(4);
  const std::vector<double> errors = standard_errors(model_with(draw(random, 1), 0.0));
  EXPECT_TRUE(std::isinf(errors[0]));
  EXPECT_TRUE(std::isfinite(errors[1]));
}

TEST(Resolution, IsAShareOfWhatMattersAndOfTheSamplingInterval) {
  PlantDescription plant;
  plant.law_sizes = {{.unit = "N", .factor = 0.1}};
  Data data;
  data.samples.emplace_back();
  for (int row = 0; row < 101; ++row) data.samples[0].time_s.push_back(0.01 * row);
  LawParameter force, delay, offset;
  force.unit = "N";
  force.significant = 500.0;
  delay.unit = "s";
  delay.significant = 1e-3;
  offset.unit = "channel";
  offset.significant = 1.0;
  EXPECT_DOUBLE_EQ(resolution_of(data, plant).of(force, 0.0), 0.5);
  EXPECT_DOUBLE_EQ(resolution_of(data, plant).of(force, 10.0), 0.1);  // moves the outputs by their noise
  EXPECT_NEAR(resolution_of(data, plant).of(delay, 0.0), 5e-4, 1e-5);
  EXPECT_EQ(resolution_of(data, plant).of(offset, 0.0), 0.0);
  data.samples[0].input_hold = true;
  EXPECT_DOUBLE_EQ(resolution_of(data, plant).of(delay, 0.0), 1e-5);
}

// Two recordings with a value of their own each, which both read through one gain that is only known within 0.5.
FittedModel values_read_through_one_gain(double difference) {
  FittedModel model;
  Unknown gain = unknown(1e9);
  gain.prior_mean = 0.0;
  gain.prior_std = 0.5;
  model.problem.shared = {unknown(1e9), unknown(1e9), gain};
  model.optimum.point.shared = {0.1, 0.1 + difference, 0.0};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2; ++i) {
    PemRecording recording;
    RowMatrix j = RowMatrix::Zero(kRows, 3);
    Eigen::VectorXd residual(kRows);
    for (int row = 0; row < kRows; ++row) {
      recording.time_s.push_back(row * kSpacing_s);
      j(row, i) = j(row, 2) = std::sin(0.5 * row * kSpacing_s);
      residual(row) = normal(random);
    }
    model.problem.recordings.push_back(std::move(recording));
    model.optimum.at_optimum.push_back({.simulated = RowMatrix::Zero(kRows, 1), .residual = residual, .jacobian = j});
    model.misfit += residual.squaredNorm();
    model.residuals += kRows;
  }
  return model;
}

TEST(StandardErrors, OfADifferenceLeavesOutWhatBothShare) {
  const std::vector<std::size_t> values{0, 1};
  const FittedModel apart = values_read_through_one_gain(0.4);
  EXPECT_GT(standard_errors(apart)[0], 0.4) << "its slope is the scale's, 2";
  EXPECT_GT(standard_errors_apart(apart, values), 8.0);
  EXPECT_LT(standard_errors_apart(values_read_through_one_gain(0.01), values), 1.0);
  FittedModel untold = values_read_through_one_gain(0.4);
  for (Linearisation& at : untold.optimum.at_optimum) at.jacobian.col(0).setZero();
  EXPECT_EQ(standard_errors_apart(untold, values), 0.0);
}

}  // namespace
}  // namespace sealwatch::mismatch
