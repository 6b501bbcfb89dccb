#include "services/common/mismatch/unrecorded_input.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/estimation/interpolation_error.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kTimesTheChange = 1.5;
constexpr Eigen::Index kReach = 10;  // of every second sample, either side
constexpr double kMatters = 0.95;    // a weight below it
constexpr double kLittle = 0.5;
constexpr double kSwings = 54.0;   // per recording: twice lambda (screening.hpp), a change that shows by itself
constexpr double kFeigned = 0.05;  // of a significant strength: twice what was seen

// Sum of the squares of a change [noise], weighed; of every second sample, each standing for two.
double noncentrality(const RowMatrix& change, const Eigen::VectorXd& noise_std, const Eigen::VectorXd& weight) {
  const Eigen::Index channels = noise_std.size();
  double sum = 0.0;
  for (Eigen::Index half = 0; half < change.rows(); ++half)
    for (Eigen::Index c = 0; c < channels; ++c)
      sum += 2.0 * std::pow(weight(2 * half * channels + c) * change(half, c) / noise_std(c), 2);
  return sum;
}

}  // namespace

UnrecordedInput unrecorded_input(const FittedModel& model, const Data& data) {
  UnrecordedInput unrecorded;
  std::vector<Eigen::VectorXd>& weights = unrecorded.weight;
  double least = 1.0, changes = 0.0;
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    const Eigen::Index channels = part.noise_std.size(), samples = static_cast<Eigen::Index>(part.time_s.size());
    weights.push_back(Eigen::VectorXd::Ones(samples * channels));
    const RowMatrix change =
        change_without_every_second_sample(model.problem, k, model.optimum, model.asset, data.samples[k]).cwiseAbs();
    for (Eigen::Index sample = 0; sample < samples && change.rows() > 0; ++sample) {
      const Eigen::Index first = std::max<Eigen::Index>(0, sample / 2 - kReach),
                         last = std::min(change.rows(), sample / 2 + kReach + 1);
      const Eigen::RowVectorXd largest = change.middleRows(first, last - first).colwise().maxCoeff();
      for (Eigen::Index c = 0; c < channels; ++c)
        weights.back()(sample * channels + c) = 1.0 / std::hypot(1.0, kTimesTheChange * largest(c) / part.noise_std(c));
    }
    least = std::min(least, weights.back().minCoeff());
    changes += noncentrality(change, part.noise_std, weights.back());
  }
  if (least >= kMatters) weights.clear();
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
