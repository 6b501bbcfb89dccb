#include "services/common/mismatch/unrecorded_input.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "services/common/estimation/interpolation_error.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kMostTimesTheChange = 1.5;
constexpr Eigen::Index kReach = 10;  // of every second sample, either side
constexpr double kMatters = 0.95;    // a weight below it
constexpr double kLittle = 0.5;
constexpr double kSwings = 121.5;  // per recording: twice lambda (screening.hpp), of a course that is most off
constexpr double kFeigned = 0.05;  // of a significant strength: twice what was seen

// Of a recording, in units of the noise: the change of every second sample without the others, and for each residual
// the largest change near it, squared, beside the residual's own square.
struct Swings {
  RowMatrix change;
  Eigen::ArrayXd largest_squared, residual_squared;
};

Swings swings_of(const FittedModel& model, std::size_t k, const TimeSeries& samples) {
  const PemRecording& part = model.problem.recordings[k];
  const Eigen::RowVectorXd& noise_std = part.noise_std;
  const Eigen::Index channels = noise_std.size();
  Swings swings;
  swings.change = change_without_every_second_sample(model.problem, k, model.optimum, model.asset, samples);
  swings.change.array().rowwise() /= noise_std.array();
  RowMatrix largest = RowMatrix::Zero(std::ssize(samples.time_s), channels);
  for (Eigen::Index sample = 0; sample < largest.rows() && swings.change.rows() > 0; ++sample) {
    const Eigen::Index first = std::max<Eigen::Index>(0, sample / 2 - kReach),
                       last = std::min(swings.change.rows(), sample / 2 + kReach + 1);
    largest.row(sample) = swings.change.middleRows(first, last - first).cwiseAbs().colwise().maxCoeff();
  }
  const RowMatrix residual =
      (part.simulation->recorded() - model.optimum.at_optimum[k].simulated).array().rowwise() / noise_std.array();
  swings.largest_squared = largest.reshaped<Eigen::RowMajor>().array().square();
  swings.residual_squared = residual.reshaped<Eigen::RowMajor>().array().square();
  return swings;
}

// -2 ln of how likely the residuals are with variances phi (1 + c^2 m^2), m the largest change near them, phi >= 1.
double misfit_at(double c, std::span<const Swings> recordings) {
  double sum = 0.0, logarithms = 0.0, residuals = 0.0;
  for (const Swings& swings : recordings) {
    const Eigen::ArrayXd variance = 1.0 + c * c * swings.largest_squared;
    sum += (swings.residual_squared / variance).sum();
    logarithms += variance.log().sum();
    residuals += static_cast<double>(variance.size());
  }
  const double phi = std::max(1.0, sum / residuals);
  return sum / phi + residuals * std::log(phi) + logarithms;
}

// c. A gross misfit says nothing of it.
double times_the_change(const FittedModel& model, std::span<const Swings> recordings) {
  constexpr int kSteps = 30;
  if (excess(model) > kGross) return kMostTimesTheChange;
  double likeliest = 0.0, least = misfit_at(0.0, recordings);
  for (int step = 1; step <= kSteps; ++step) {
    const double c = kMostTimesTheChange * step / kSteps;
    if (const double misfit = misfit_at(c, recordings); misfit < least) least = misfit, likeliest = c;
  }
  return likeliest;
}

// Sum of the squares of what the course leaves, weighed; of every second sample, each standing for two.
double noncentrality(const Swings& swings, const Eigen::VectorXd& weight, double c) {
  const Eigen::Index channels = swings.change.cols();
  double sum = 0.0;
  for (Eigen::Index half = 0; half < swings.change.rows(); ++half)
    sum += 2.0 * (c * swings.change.row(half).transpose().cwiseProduct(weight.segment(2 * half * channels, channels)))
                     .squaredNorm();
  return sum;
}

}  // namespace

UnrecordedInput unrecorded_input(const FittedModel& model, const Data& data) {
  UnrecordedInput unrecorded;
  std::vector<Swings> recordings;
  for (std::size_t k = 0; k < data.samples.size(); ++k) recordings.push_back(swings_of(model, k, data.samples[k]));
  const double c = times_the_change(model, recordings);
  double least = 1.0, changes = 0.0;
  for (const Swings& swings : recordings) {
    unrecorded.weight.emplace_back((1.0 + c * c * swings.largest_squared).rsqrt());
    least = std::min(least, unrecorded.weight.back().minCoeff());
    changes += noncentrality(swings, unrecorded.weight.back(), c);
  }
  if (least >= kMatters) unrecorded.weight.clear();
  if (changes > kSwings * static_cast<double>(data.samples.size())) unrecorded.resolution = kFeigned;
  return unrecorded;
}

std::string unrecorded_input_in_words(const FittedModel& model) {
  const std::span<const std::string> channels = model.problem.recordings.front().simulation->channels();
  std::vector<double> little(channels.size(), 0.0);
  double samples = 0.0;
  for (const PemRecording& part : model.problem.recordings) {
    samples += static_cast<double>(part.time_s.size());
    for (Eigen::Index row = 0; row < part.weight.size(); ++row)
      if (part.weight(row) > 0.0 && part.weight(row) < kLittle)
        ++little[static_cast<std::size_t>(row) % channels.size()];
  }
  std::vector<std::string> texts;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (little[c] > 0.0)
      texts.push_back(in_words(channels[c]) + " in " + number(100.0 * little[c] / samples, 2) + " %");
  if (texts.empty()) return {};
  return "What the input does between two samples is not recorded. Where the simulation depends on it (" +
         joined(texts, " and ") + " of the time) residuals count less than half.";
}

}  // namespace sealwatch::mismatch
