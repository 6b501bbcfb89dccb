// Degradation of the piston seal over the months, as a random recursion (docs/model.md).
//
//   theta(n) = theta(n-1) - (gamma(n) + Upsilon(n)) ln((n + n_0) / (n - 1 + n_0))
//   gamma(n) = gamma(n-1) + Gamma(n)
//
//   theta   seal condition, leakage-derived index [1], theta(0) = 1;   n   months since installation [1]
//   gamma   ageing by the medium, steepened by seawater ingress [1]; gamma(0) is one actuator's own, U(0.02, 0.04)
//   Gamma   monthly steepening [1], U(0, Gamma_max); Gamma_max is one actuator's own, U(0.0016, 0.003)
//   Upsilon irregularity of the month [1], U(Upsilon_min, Upsilon_max)
//   n_0     month that the logarithm starts from [1]
//
// The limits are calibrated from the reference model's starting values so that a seal fails (theta = 0.60) between 8
// and 20 years in nine lives of ten, at 13 years in the median.
//
// Randomness: std::mt19937_64, whose numbers the standard fixes, and no distribution of the standard library, whose
// results it leaves open: the same seed gives the same life everywhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace sealwatch::forecast {

/// Uniform random numbers that depend on the seed alone.
class UniformRandom {
 public:
  explicit UniformRandom(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1), a multiple of 2^-53.
  [[nodiscard]] double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::mt19937_64 engine_;
};

struct Range {
  double min = 0.0;
  double max = 0.0;
};

struct DegradationSetting {
  double initial_condition = 1.0;         ///< theta(0) [1]
  double n_0 = 1.0;                       ///< [months]
  Range initial_gamma{0.02, 0.04};        ///< gamma(0) [1]
  Range steepening_limit{0.0016, 0.003};  ///< Gamma_max [1]
  Range irregularity{-0.05, 0.08};        ///< Upsilon [1]
};

/// One actuator's seal.
class Degradation {
 public:
  explicit Degradation(std::uint64_t seed, const DegradationSetting& setting = {})
      : setting_(setting),
        random_(seed),
        gamma_(random_.between(setting.initial_gamma.min, setting.initial_gamma.max)),
        steepening_limit_(random_.between(setting.steepening_limit.min, setting.steepening_limit.max)),
        condition_(setting.initial_condition) {}

  [[nodiscard]] int month() const { return month_; }             ///< n
  [[nodiscard]] double condition() const { return condition_; }  ///< theta(n)
  [[nodiscard]] double gamma() const { return gamma_; }          ///< gamma(n)
  /// Gamma_max of this seal.
  [[nodiscard]] double steepening_limit() const { return steepening_limit_; }

  /// Goes on to the next month; returns theta(n).
  double advance() {
    ++month_;
    gamma_ += random_.between(0.0, steepening_limit_);
    const double upsilon = random_.between(setting_.irregularity.min, setting_.irregularity.max);
    condition_ -= (gamma_ + upsilon) * std::log((month_ + setting_.n_0) / (month_ - 1 + setting_.n_0));
    return condition_;
  }

 private:
  DegradationSetting setting_;
  UniformRandom random_;
  double gamma_;
  double steepening_limit_;
  double condition_;
  int month_ = 0;
};

}  // namespace sealwatch::forecast
