// What one test may be at most, and which numbers no sensor gives. One owner: the reader of recordings, data
// acquisition, data manipulation and the admission of messages ask here, so that no algorithm sees more or worse.
//
// A partial stroke test has some 10^4 rows and takes half a minute. The limits leave room for a hundred times as much,
// and keep what a service holds of one test, at most 150 bytes a number, under 512 MB (tests/perf/services/memory.py).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

struct TestLimits {
  /// Samples times channels, time among them: four hours of twelve channels at 10 Hz, half a minute at 5 kHz.
  std::size_t most_numbers = 2'000'000;
  /// A plant has a dozen; a block of thousands is no block of samples.
  std::size_t most_channels = 256;
  /// 100 kHz: the fastest thing in an actuator, its pressure waves, takes milliseconds. Filters reach back a number of
  /// rows that grows with the rate.
  double shortest_interval_s = 1e-5;
  /// Seven days: the slowest plants' tests take hours. What goes on for longer is no test but a log.
  double longest_s = 7.0 * 86400.0;
  /// Steps of the longest permitted size that one simulation of a test takes within a service: an estimate needs up to a
  /// hundred simulations, of 8 us a step, state detection as many, and two minutes of a processor are given for them.
  /// Seven hours.
  double most_steps_of_simulation = 100'000.0;
  /// Times count from the start of a test, or from 1970 for some senders; beyond it they are no times.
  double largest_time_s = 1e10;
  /// A window is uniform: missing rows are interpolated. Where nine of ten are missing there is nothing to stand on.
  double most_window_rows_per_row = 10.0;
};
inline constexpr TestLimits kTestLimits{};

/// Times beyond the largest of a plant's range that no slip of unit explains (the largest, Pa for MPa, is 10^6): such a
/// number is damage, and its powers leave a double's range.
inline constexpr double kImplausible = 1e6;
/// For a channel without a range, and for messages whose plant is not known: whole numbers of 64 bits are below it.
inline constexpr double kLargestOfAnyChannel = 1e20;
/// Below it a number is zero: the powers of smaller ones are not normal numbers.
inline constexpr double kSmallestNumber = 1e-100;

/// The largest number, in magnitude, that a sensor of this range can be thought to give; the range may be unknown
/// (max <= min).
[[nodiscard]] double largest_plausible(double range_min, double range_max);

/// `value`, zero where it is too small to count with; nothing for what is no number or larger than `largest`.
[[nodiscard]] std::optional<double> plausible(double value, double largest);

/// What is wrong with the extent of one test's samples, in words: "4000001 numbers, more than the 4000000 that ...".
/// Nothing for a test that can be taken. Times must increase.
[[nodiscard]] std::optional<std::string> beyond_limits(std::span<const double> time_s, std::size_t channels,
                                                       const TestLimits& limits = kTestLimits);
/// The same of numbers, duration and mean interval that are counted elsewhere.
[[nodiscard]] std::optional<std::string> too_many_numbers(double numbers, const TestLimits& limits = kTestLimits);
[[nodiscard]] std::optional<std::string> too_long(double duration_s, const TestLimits& limits = kTestLimits);
/// For what is simulated beside other tests; it need not be for any other use. model/too_long_to_simulate.hpp asks it of
/// a test's times.
[[nodiscard]] std::optional<std::string> too_long_to_simulate(double duration_s, double longest_step_s,
                                                              const TestLimits& limits = kTestLimits);
[[nodiscard]] std::optional<std::string> too_fast(double interval_s, const TestLimits& limits = kTestLimits);

/// What is wrong with samples as a message of another process brings them: times that do not increase or are none, a
/// channel of another length, numbers that no sensor gives, too many of them. `gaps`: not-a-number marks a missing
/// sample.
[[nodiscard]] std::optional<std::string> malformed(const TimeSeries& samples, bool gaps,
                                                   const TestLimits& limits = kTestLimits);

}  // namespace sealwatch
