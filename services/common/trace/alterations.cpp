#include "services/common/trace/alterations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

#include "sealwatch/trace/coloured_regression.hpp"
#include "services/common/dense/dense.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLargestDelayShare = 0.2;  // of the recording's length
constexpr double kLargestClockError = 0.12;
constexpr Index kScanned = 1000;  // samples that the global search looks at
constexpr int kNearDelays = 200, kFarDelays = 100, kSteps = 12;
constexpr std::size_t kLargestOrder = 30;
constexpr double kNoGain = 1e-6;  // of the criterion

/// theta = (g, b, tau, c), whichever are free.
struct Parameters {
  double gain, offset, delay_s, clock;
};

class Problem {
 public:
  Problem(const std::vector<double>& time_s, const std::vector<AlteredChannel>& channels, const Freedom& freedom,
          const Joints& joints)
      : time_s_(time_s), channels_(channels), freedom_(freedom), joints_(joints) {
    for (const AlteredChannel& channel : channels_)
      spreads_.push_back((channel.recorded.array() - channel.recorded.mean()).square().mean());
  }

  std::optional<AlterationFit> solve() {
    Parameters theta{freedom_.fixed_gain, 0.0, 0.0, 1.0};
    if (freedom_.delay && !scan(theta, &Parameters::delay_s, delays())) return {};
    if (freedom_.clock && !scan(theta, &Parameters::clock, clocks())) return {};
    noises_.assign(channels_.size(), {});
    double best = refine(theta);
    for (int round = 0; round < 3; ++round) {  // noise and parameters in turn
      learn_noise(theta);
      best = refine(theta);
    }
    return result(theta, best);
  }

 private:
  [[nodiscard]] double length_s() const { return time_s_.back() - time_s_.front(); }
  [[nodiscard]] double warped(double time_s, const Parameters& theta) const {
    return origin_s() + (time_s - origin_s()) / theta.clock - theta.delay_s;
  }
  /// What a clock runs fast from: 0, where both files count from the same moment; the first sample where 0 is far away.
  [[nodiscard]] double origin_s() const { return std::abs(time_s_.front()) <= length_s() ? 0.0 : time_s_.front(); }

  /// The samples whose altered time lies within every simulated course.
  [[nodiscard]] std::pair<Index, Index> range(const Parameters& theta) const {
    double begin = -std::numeric_limits<double>::infinity(), end = -begin;
    for (const AlteredChannel& channel : channels_)
      begin = std::max(begin, channel.simulated->begin_s()), end = std::min(end, channel.simulated->end_s());
    const double rounding = 1e-9 * length_s();
    const auto at = [&](double time_s) { return warped(time_s, theta); };
    const auto first = std::ranges::lower_bound(time_s_, begin - rounding, {}, at);
    const auto last = std::ranges::upper_bound(first, time_s_.end(), end + rounding, {}, at);
    return {first - time_s_.begin(), last - first};
  }

  /// Least squares of g and b where these are free, for one channel.
  static void fit_line(const VectorXd& s, const VectorXd& y, const AlteredChannel& channel, const Freedom& freedom,
                       double& gain, double& offset) {
    const double a = channel.about;
    if (freedom.gain && freedom.offset) {
      const double mean_s = s.mean(), mean_y = y.mean();
      const double squares = (s.array() - mean_s).square().sum();
      if (squares > 0.0) gain = ((s.array() - mean_s) * (y.array() - mean_y)).sum() / squares;
      offset = mean_y - a - gain * (mean_s - a);
    } else if (freedom.gain) {
      const double squares = (s.array() - a).square().sum();
      if (squares > 0.0) gain = ((s.array() - a) * (y.array() - a)).sum() / squares;
    } else if (freedom.offset) {
      offset = (y.array() - a - gain * (s.array() - a)).mean();
    }
  }

  /// Mean square of what is left over the channels' variances, with the best gain and offset.
  [[nodiscard]] double raw_misfit(Parameters theta) const {
    const auto [first, count] = range(theta);
    if (2 * count < static_cast<Index>(time_s_.size())) return std::numeric_limits<double>::infinity();
    const Index step = std::max<Index>(1, count / kScanned), rows = count / step;
    double misfit = 0.0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const AlteredChannel& channel = channels_[c];
      VectorXd s(rows), y(rows);
      for (Index k = 0; k < rows; ++k) {
        const Index t = first + k * step;
        s(k) = channel.simulated->at(warped(time_s_[static_cast<std::size_t>(t)], theta)).first;
        y(k) = channel.recorded(t);
      }
      fit_line(s, y, channel, freedom_, theta.gain, theta.offset);
      const VectorXd left = y.array() - channel.about - theta.offset - theta.gain * (s.array() - channel.about);
      if (spreads_[c] > 0.0) misfit += left.squaredNorm() / static_cast<double>(rows) / spreads_[c];
    }
    return misfit;
  }

  /// The best of rising values for one parameter; false where it lies at the edge.
  bool scan(Parameters& theta, double Parameters::*target, const std::vector<double>& values) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < values.size(); ++k) {
      Parameters tried = theta;
      tried.*target = values[k];
      if (const double misfit = raw_misfit(tried); misfit < least) least = misfit, best = k;
    }
    theta.*target = values[best];
    return best > 0 && best + 1 < values.size() && std::isfinite(least);
  }

  /// Every sample near to none, for courses that change from sample to sample; pieces of the length farther away.
  [[nodiscard]] std::vector<double> delays() const {
    double step = length_s();
    for (std::size_t k = 1; k < time_s_.size(); ++k) step = std::min(step, time_s_[k] - time_s_[k - 1]);
    std::vector<double> values;
    for (int k = -kNearDelays; k <= kNearDelays; ++k) values.push_back(k * step);
    for (int k = -kFarDelays; k <= kFarDelays; ++k) values.push_back(kLargestDelayShare * length_s() * k / kFarDelays);
    std::ranges::sort(values);
    return values;
  }

  /// So fine that the last sample moves by one from one to the next, within reason.
  [[nodiscard]] std::vector<double> clocks() const {
    const int half = std::clamp(static_cast<int>(kLargestClockError * static_cast<double>(time_s_.size())), 60, 1200);
    std::vector<double> values;
    for (int k = -half; k <= half; ++k) values.push_back(1.0 + kLargestClockError * k / half);
    return values;
  }

  /// What is left of one channel and its derivatives with respect to the free parameters.
  void residual(const AlteredChannel& channel, const Parameters& theta, Index first, Index count, VectorXd& left,
                MatrixXd& slopes) const {
    left.resize(count);
    slopes.resize(count, freedom_.count());
    for (Index k = 0; k < count; ++k) {
      const double t = time_s_[static_cast<std::size_t>(first + k)];
      const auto [value, slope] = channel.simulated->at(warped(t, theta));
      const double about = value - channel.about;
      left(k) = channel.recorded(first + k) - channel.about - theta.offset - theta.gain * about;
      Index column = 0;
      if (freedom_.gain) slopes(k, column++) = about;
      if (freedom_.offset) slopes(k, column++) = 1.0;
      if (freedom_.delay) slopes(k, column++) = -theta.gain * slope;
      if (freedom_.clock) slopes(k, column++) = -theta.gain * slope * (t - origin_s()) / (theta.clock * theta.clock);
    }
  }

  void learn_noise(const Parameters& theta) {
    const auto [first, count] = range(theta);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      VectorXd left;
      MatrixXd slopes;
      residual(channels_[c], theta, first, count, left, slopes);
      const std::span<const double> values(left.data(), static_cast<std::size_t>(left.size()));
      const auto largest = std::min<std::size_t>(kLargestOrder, static_cast<std::size_t>(count / 20));
      noises_[c] = burg(values, choose_order(values, largest));
    }
  }

  /// Criterion and the normal equations of one step, all channels weighted by their innovations.
  double linearise(const Parameters& theta, MatrixXd& normal, VectorXd& gradient) const {
    const auto [first, count] = range(theta);
    const Index free = freedom_.count();
    normal = MatrixXd::Zero(free, free);
    gradient = VectorXd::Zero(free);
    if (2 * count < static_cast<Index>(time_s_.size())) return std::numeric_limits<double>::infinity();
    double criterion = 0.0;
    const Joints joints = joints_within(joints_, first, count);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      VectorXd left;
      MatrixXd slopes;
      residual(channels_[c], theta, first, count, left, slopes);
      const MatrixXd gram = whitened_gram(slopes, left, noises_[c], kLargestOrder, joints);
      const double samples = static_cast<double>(whole_windows(count, kLargestOrder, joints).size());
      if (!(samples > 0.0)) return std::numeric_limits<double>::infinity();
      const double variance = std::max(gram(free, free) / samples, channels_[c].least_variance);
      normal += gram.topLeftCorner(free, free) / variance;
      gradient += gram.topRightCorner(free, 1) / variance;
      criterion += static_cast<double>(time_s_.size()) * std::log(variance);
    }
    return criterion;
  }

  [[nodiscard]] Parameters moved(Parameters theta, const VectorXd& step, double share) const {
    Index column = 0;
    if (freedom_.gain) theta.gain += share * step(column++);
    if (freedom_.offset) theta.offset += share * step(column++);
    if (freedom_.delay) theta.delay_s += share * step(column++);
    if (freedom_.clock) theta.clock += share * step(column++);
    return theta;
  }

  /// Gauss-Newton with the present noise, halved steps where the criterion would rise, until a step would gain nothing.
  /// Keeps the covariance.
  double refine(Parameters& theta) {
    MatrixXd normal;
    VectorXd gradient;
    double criterion = linearise(theta, normal, gradient);
    for (int round = 0; round < kSteps && freedom_.count() > 0; ++round) {
      const VectorXd step = dense::Symmetric(normal).solve(gradient);
      if (!step.allFinite() || !(gradient.dot(step) > kNoGain)) break;
      bool better = false;
      for (double share = 1.0; share > 0.01 && !better; share *= 0.5) {
        const Parameters tried = moved(theta, step, share);
        if (!(tried.clock > 1.0 - 2 * kLargestClockError)) continue;
        MatrixXd next_normal;
        VectorXd next_gradient;
        const double next = linearise(tried, next_normal, next_gradient);
        if (!(next < criterion)) continue;
        better = criterion - next > kNoGain;
        theta = tried, criterion = next, normal = next_normal, gradient = next_gradient;
      }
      if (!better) break;
    }
    covariance_ = freedom_.count() > 0 ? dense::inverse(normal) : MatrixXd();
    return criterion;
  }

  [[nodiscard]] AlterationFit result(const Parameters& theta, double criterion) const {
    AlterationFit fit;
    fit.gain = theta.gain, fit.offset = theta.offset, fit.delay_s = theta.delay_s, fit.clock = theta.clock;
    Index column = 0;
    const auto error = [&] {
      const Index at = column++;
      return std::sqrt(std::max(covariance_(at, at), 0.0));
    };
    if (freedom_.gain) fit.gain_std = error();
    if (freedom_.offset) fit.offset_std = error();
    if (freedom_.delay) fit.delay_std_s = error();
    if (freedom_.clock) fit.clock_std = error();
    std::tie(fit.first, fit.count) = range(theta);
    fit.criterion = criterion + freedom_.count() * std::log(static_cast<double>(time_s_.size()));
    for (const AlteredChannel& channel : channels_) {
      VectorXd altered(static_cast<Index>(time_s_.size()));
      for (Index k = 0; k < altered.size(); ++k) {
        const double value = channel.simulated->at(warped(time_s_[static_cast<std::size_t>(k)], theta)).first;
        altered(k) = channel.about + theta.offset + theta.gain * (value - channel.about);
      }
      fit.altered.push_back(std::move(altered));
    }
    return fit;
  }

  const std::vector<double>& time_s_;
  const std::vector<AlteredChannel>& channels_;
  Freedom freedom_;
  const Joints& joints_;
  std::vector<double> spreads_;              ///< of the recorded channels: variances
  std::vector<std::vector<double>> noises_;  ///< coefficients, one set a channel
  MatrixXd covariance_;
};

}  // namespace

std::optional<AlterationFit> fit_alteration(const std::vector<double>& time_s,
                                            const std::vector<AlteredChannel>& channels, const Freedom& freedom,
                                            const Joints& joints) {
  return Problem(time_s, channels, freedom, joints).solve();
}

}  // namespace sealwatch::trace
