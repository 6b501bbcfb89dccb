#include "sealwatch/signal/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sealwatch/signal/jumps.hpp"

namespace sealwatch::signal {
namespace {

constexpr std::size_t kFewestSamples = 8;
constexpr double kGaussianStdOverMad = 1.4826;     // standard deviation over median absolute deviation
constexpr double kThirdDifferenceVariance = 20.0;  // 1 + 9 + 9 + 1
constexpr int kHighOrder = 12;
constexpr double kHighOrderVariance = 2704156.0;  // 24 over 12
constexpr std::size_t kEnoughForHighOrder = 120;
constexpr double kClearly = 1.5;                  // noise of a first-order sensor shows within 1.1 in both orders
constexpr double kCoarse = 0.2;                   // a step larger than this share of the noise shows in the median
constexpr double kLargestShareOffTheGrid = 0.01;  // of steps that are no multiple of the smallest
constexpr double kGridTolerance = 1e-3;           // of a step: rounding of decimal numbers

// The upper of the two in the middle of an even number.
double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Differences of a rounded signal are multiples of its step, and so is their median; the mean square of all but the
// largest tenth sees between the steps. For normal differences that is 0.623 of the variance.
double trimmed_standard_deviation(std::vector<double> magnitudes) {
  constexpr double kKept = 0.9, kShareOfVariance = 0.623;
  const auto kept = static_cast<std::ptrdiff_t>(kKept * static_cast<double>(magnitudes.size()));
  std::nth_element(magnitudes.begin(), magnitudes.begin() + kept, magnitudes.end());
  double squares = 0.0;
  for (auto value = magnitudes.begin(); value != magnitudes.begin() + kept; ++value) squares += *value * *value;
  return std::sqrt(squares / static_cast<double>(kept) / kShareOfVariance);
}

// The smallest change between neighbours, if nearly all changes are multiples of it.
double find_quantisation_step(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  const double rounding = 1e-12 * largest;
  double step = 0.0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double change = std::abs(values[k] - values[k - 1]);
    if (change > rounding && (step == 0.0 || change < step)) step = change;
  }
  if (step == 0.0) return 0.0;
  std::size_t off_the_grid = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double steps = (values[k] - values[k - 1]) / step;
    if (std::abs(steps - std::round(steps)) > kGridTolerance * std::max(1.0, std::abs(steps))) ++off_the_grid;
  }
  const bool on_the_grid =
      static_cast<double>(off_the_grid) <= kLargestShareOffTheGrid * static_cast<double>(values.size());
  return on_the_grid ? step : 0.0;
}

double from_high_order(std::span<const double> values) {
  std::vector<double> difference(values.begin(), values.end());
  for (int order = 0; order < kHighOrder; ++order) {
    for (std::size_t k = 0; k + 1 < difference.size(); ++k) difference[k] = difference[k + 1] - difference[k];
    difference.pop_back();
  }
  for (double& value : difference) value = std::abs(value);
  return trimmed_standard_deviation(std::move(difference)) / std::sqrt(kHighOrderVariance);
}

// Whether distances differ by more than the rounding of times.
bool is_uneven(std::span<const double> time_s) {
  constexpr double kRounding = 1e-6;
  const double mean = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (std::size_t k = 1; k < time_s.size(); ++k)
    if (std::abs(time_s[k] - time_s[k - 1] - mean) > kRounding * mean) return true;
  return false;
}

// Divided differences of this order, of white noise with its own standard deviation.
std::vector<double> divided_differences(std::span<const double> values, std::span<const double> time_s, int order) {
  const auto width = static_cast<std::size_t>(order) + 1;
  const double mean = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  std::vector<double> magnitudes;
  for (std::size_t first = 0; first + width <= values.size(); ++first) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t j = 0; j < width; ++j) {
      double weight = 1.0;
      for (std::size_t i = 0; i < width; ++i)
        if (i != j) weight *= mean / (time_s[first + j] - time_s[first + i]);
      sum += weight * values[first + j];
      squares += weight * weight;
    }
    magnitudes.push_back(std::abs(sum) / std::sqrt(squares));
  }
  return magnitudes;
}

// The least that divided differences show; infinite where the samples are equally spaced.
double from_divided_differences(std::span<const double> values, std::span<const double> time_s, bool high_order) {
  if (time_s.size() != values.size() || !is_uneven(time_s)) return std::numeric_limits<double>::infinity();
  const double third = trimmed_standard_deviation(divided_differences(values, time_s, 3));
  return high_order ? std::min(third, trimmed_standard_deviation(divided_differences(values, time_s, kHighOrder)))
                    : third;
}

// Magnitudes of the third differences: where jumps take part in many, of those alone in which none does. Of a few the
// median knows nothing.
std::vector<double> third_differences(std::span<const double> values, double step) {
  constexpr double kSteps = 8.0;  // a counter that turns slowly goes on by one step at a time
  constexpr double kFew = 0.05;   // of all
  std::vector<double> all, between_jumps;
  const std::vector<std::size_t> jumps = find_jumps(values, kSteps * step);
  auto next = jumps.begin();
  for (std::size_t k = 0; k + 3 < values.size(); ++k) {
    all.push_back(std::abs(values[k + 3] - 3.0 * values[k + 2] + 3.0 * values[k + 1] - values[k]));
    while (next != jumps.end() && *next <= k) ++next;
    if (next == jumps.end() || *next > k + 3) between_jumps.push_back(all.back());
  }
  const bool many = static_cast<double>(between_jumps.size()) < (1.0 - kFew) * static_cast<double>(all.size());
  return many && between_jumps.size() >= kFewestSamples ? between_jumps : all;
}

}  // namespace

NoiseFloor estimate_noise_floor(std::span<const double> samples, std::span<const double> sample_times_s) {
  std::vector<double> values, time_s;
  values.reserve(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!std::isfinite(samples[k])) continue;
    values.push_back(samples[k]);
    if (sample_times_s.size() == samples.size()) time_s.push_back(sample_times_s[k]);
  }
  if (values.size() < kFewestSamples) return {};
  const double step = find_quantisation_step(values);
  std::vector<double> difference = third_differences(values, step);
  double from_differences = kGaussianStdOverMad * middle_of(difference) / std::sqrt(kThirdDifferenceVariance);
  if (step > kCoarse * from_differences)
    from_differences = trimmed_standard_deviation(std::move(difference)) / std::sqrt(kThirdDifferenceVariance);
  const double least = step / std::sqrt(12.0);
  const bool enough = values.size() >= kEnoughForHighOrder;
  const double high_order = enough ? from_high_order(values) : from_differences;
  const double other = std::max(std::min(high_order, from_divided_differences(values, time_s, enough)), least);
  const bool signal_shows = other * kClearly < from_differences;
  return {.standard_deviation = std::max(signal_shows ? other : from_differences, least), .quantisation_step = step};
}

NoiseFloor estimate_noise_floor(std::span<const double> values) { return estimate_noise_floor(values, {}); }

double believed_noise_std(const Series& channel, double usual_noise_std, std::span<const double> time_s) {
  constexpr double kLeastShareOfUsual = 0.1;
  if (channel.noise_std > 0.0) return channel.noise_std;
  const double shown = estimate_noise_floor(channel.values, time_s).standard_deviation;
  return shown > 0.0 ? std::max(shown, kLeastShareOfUsual * usual_noise_std) : usual_noise_std;
}

double believed_noise_std(const Series& channel, double usual_noise_std) {
  return believed_noise_std(channel, usual_noise_std, {});
}

}  // namespace sealwatch::signal
