#include "services/common/mismatch/proof.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "sealwatch/estimation/residual_statistics.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBlock_s = 1.0;
constexpr double kLeastBlock = 10.0;  // samples, where they are further apart than a plant for which 1 s is long
constexpr int kDraws = 1000;
constexpr double kPastInput_s = 1.0;

std::vector<double> column(const RowMatrix& matrix, Eigen::Index c) {
  const Eigen::VectorXd values = matrix.col(c);
  return {values.data(), values.data() + values.size()};
}

std::vector<double> driving_input(const PlantSimulation& simulation, const TimeSeries& recorded) {
  for (const ChannelDescription& channel : simulation.plant().channels)
    if (const Series* series = channel.input ? recorded.find(channel.name) : nullptr; series != nullptr)
      return series->values;
  return {};
}

struct ChannelFigures {
  double rms = 0.0, weighed_rms = 0.0, nrmse = 0.0, whiteness = 1.0, independence = 1.0;
};

// `weights`: of the channel's residuals; those with none (beside a jump, where the drive is not recorded) tell nothing.
ChannelFigures figures(const std::vector<double>& recorded, const std::vector<double>& simulated, double noise_std,
                       const std::vector<double>& weights, const PastInput& past) {
  std::vector<double> residual(recorded.size()), plain, weighed, measured, predicted;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (weights[k] == 0.0) continue;
    plain.push_back((recorded[k] - simulated[k]) / noise_std);
    weighed.push_back(residual[k] = weights[k] * plain.back());
    measured.push_back(recorded[k]);
    predicted.push_back(simulated[k]);
  }
  if (plain.empty()) return {};
  return {.rms = root_mean_square(plain),
          .weighed_rms = root_mean_square(weighed),
          .nrmse = nrmse_percent(measured, predicted),
          .whiteness = whiteness_p(residual),
          .independence = past.independence_p(residual)};
}

double pooled_percent(const std::vector<double>& percents) {
  double squares = 0.0;
  for (const double percent : percents) squares += std::pow(1.0 - percent / 100.0, 2);
  return 100.0 * (1.0 - std::sqrt(squares / static_cast<double>(percents.size())));
}

}  // namespace

BlockGains block_gains(const FittedModel& before, const FittedModel& after, std::size_t recording) {
  const Linearisation &a = before.optimum.at_optimum[recording], &b = after.optimum.at_optimum[recording];
  const std::vector<double>& time_s = before.problem.recordings[recording].time_s;
  const Eigen::Index channels = a.simulated.cols();
  BlockGains blocks;
  const double spacing_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  const double block_s = std::max(kBlock_s, kLeastBlock * spacing_s);
  double end = time_s.front();
  for (std::size_t row = 0; row < time_s.size(); ++row) {
    if (time_s[row] >= end) {
      blocks.gain.push_back(0.0);
      end += block_s;
    }
    const auto first = static_cast<Eigen::Index>(row) * channels;
    blocks.gain.back() +=
        0.5 * (a.residual.segment(first, channels).squaredNorm() - b.residual.segment(first, channels).squaredNorm());
  }
  return blocks;
}

GainInterval gain_interval(const BlockGains& blocks, double dispersion, std::uint64_t seed) {
  GainInterval interval{.gain = std::accumulate(blocks.gain.begin(), blocks.gain.end(), 0.0) / dispersion};
  if (blocks.gain.empty()) return interval;
  std::mt19937_64 random(seed);
  std::vector<double> sums;
  for (int draw = 0; draw < kDraws; ++draw) {
    double sum = 0.0;
    for (std::size_t k = 0; k < blocks.gain.size(); ++k) sum += blocks.gain[random() % blocks.gain.size()];
    sums.push_back(sum / dispersion);
  }
  std::ranges::sort(sums);
  interval.low = sums[static_cast<std::size_t>(0.025 * kDraws)];
  interval.high = sums[static_cast<std::size_t>(0.975 * kDraws)];
  return interval;
}

RecordingComparison compare(const FittedModel& before, const FittedModel& after, const Data& data,
                            std::size_t recording) {
  const PemRecording& part = before.problem.recordings[recording];
  const TimeSeries& recorded = data.samples[recording];
  const double duration_s = recorded.time_s.back() - recorded.time_s.front();
  const PastInput past(
      driving_input(*part.simulation, recorded),
      static_cast<std::size_t>(kPastInput_s / duration_s * static_cast<double>(recorded.time_s.size())));
  RecordingComparison comparison;
  comparison.recording = data.names[recording];
  for (TimeSeries* curves : {&comparison.recorded, &comparison.before, &comparison.after})
    curves->time_s = recorded.time_s;
  const auto channels = part.simulation->channels();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto index = static_cast<Eigen::Index>(c);
    const double noise_std = part.noise_std(index);
    if (!std::isfinite(noise_std)) continue;
    const Series& measured = *recorded.find(channels[c]);
    const std::vector<double> old_curve = column(before.optimum.at_optimum[recording].simulated, index);
    const std::vector<double> new_curve = column(after.optimum.at_optimum[recording].simulated, index);
    const std::vector<double> weights = weights_of(part, index);
    const ChannelFigures a = figures(measured.values, old_curve, noise_std, weights, past);
    const ChannelFigures b = figures(measured.values, new_curve, noise_std, weights, past);
    comparison.channels.push_back({.channel = channels[c],
                                   .rms_before = a.rms,
                                   .rms_after = b.rms,
                                   .nrmse_before = a.nrmse,
                                   .nrmse_after = b.nrmse,
                                   .whiteness_before = a.whiteness,
                                   .whiteness_after = b.whiteness,
                                   .independence_before = a.independence,
                                   .independence_after = b.independence,
                                   .weighed_rms_after = b.weighed_rms});
    comparison.recorded.channels.push_back({measured.name, measured.unit, noise_std, measured.values});
    comparison.before.channels.push_back({measured.name, measured.unit, noise_std, old_curve});
    comparison.after.channels.push_back({measured.name, measured.unit, noise_std, new_curve});
  }
  return comparison;
}

PooledFit pool(const std::vector<RecordingComparison>& recordings, bool holdout) {
  PooledFit pooled;
  std::vector<std::vector<const ChannelComparison*>> parts;
  for (const RecordingComparison& recording : recordings) {
    if ((recording.holdout || recording.left_out) != holdout) continue;
    for (const ChannelComparison& channel : recording.channels) {
      auto known = std::ranges::find(pooled.channels, channel.channel, &ChannelComparison::channel);
      if (known == pooled.channels.end()) {
        pooled.channels.push_back({.channel = channel.channel});
        parts.emplace_back();
        known = pooled.channels.end() - 1;
      }
      parts[static_cast<std::size_t>(known - pooled.channels.begin())].push_back(&channel);
    }
  }
  for (std::size_t k = 0; k < pooled.channels.size(); ++k) {
    ChannelComparison& all = pooled.channels[k];
    const auto count = static_cast<double>(parts[k].size());
    const auto root_mean = [&](double ChannelComparison::*rms) {
      double squares = 0.0;
      for (const ChannelComparison* one : parts[k]) squares += std::pow(one->*rms, 2);
      return std::sqrt(squares / count);
    };
    const auto percent = [&](double ChannelComparison::*nrmse) {
      std::vector<double> percents;
      for (const ChannelComparison* one : parts[k]) percents.push_back(one->*nrmse);
      return pooled_percent(percents);
    };
    const auto smallest = [&](double ChannelComparison::*p) {
      double least = 1.0;
      for (const ChannelComparison* one : parts[k]) least = std::min(least, one->*p);
      return std::min(1.0, count * least);  // Bonferroni
    };
    all.rms_before = root_mean(&ChannelComparison::rms_before);
    all.rms_after = root_mean(&ChannelComparison::rms_after);
    all.weighed_rms_after = root_mean(&ChannelComparison::weighed_rms_after);
    all.nrmse_before = percent(&ChannelComparison::nrmse_before);
    all.nrmse_after = percent(&ChannelComparison::nrmse_after);
    all.whiteness_before = smallest(&ChannelComparison::whiteness_before);
    all.whiteness_after = smallest(&ChannelComparison::whiteness_after);
    all.independence_before = smallest(&ChannelComparison::independence_before);
    all.independence_after = smallest(&ChannelComparison::independence_after);
  }
  return pooled;
}

namespace {

// Within its noise no channel fares badly.
double times_worse(const ChannelComparison& channel) {
  constexpr double kAboveNoise = 1.5;
  return channel.rms_after < kAboveNoise ? 0.0 : channel.rms_after / channel.rms_before;
}

}  // namespace

double times_worse(const PooledFit& fit) {
  double worst = 0.0;
  for (const ChannelComparison& channel : fit.channels) worst = std::max(worst, times_worse(channel));
  return worst;
}

const ChannelComparison* made_worse(const PooledFit& fit) {
  constexpr double kWorse = 1.1;
  const auto times = [](const ChannelComparison& channel) { return times_worse(channel); };
  const auto worst = std::ranges::max_element(fit.channels, {}, times);
  return worst == fit.channels.end() || times(*worst) < kWorse ? nullptr : &*worst;
}

const ChannelComparison* farthest_off(const PooledFit& fit) {
  constexpr double kHalf_percent = 50.0;
  constexpr double kFarAboveNoise = 10.0;
  const ChannelComparison* farthest = nullptr;
  for (const ChannelComparison& channel : fit.channels) {
    const bool far = channel.nrmse_after < kHalf_percent && channel.rms_after > kFarAboveNoise;
    if (far && (farthest == nullptr || channel.rms_after > farthest->rms_after)) farthest = &channel;
  }
  return farthest;
}

}  // namespace sealwatch::mismatch
