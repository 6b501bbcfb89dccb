// What ode/bdf.hpp does with differences and step sizes, whatever the number of states: compiled once.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sealwatch {

struct BdfOptions {
  double maximum_step = 1e300;
  std::size_t maximum_steps = 200000;
  int maximum_order = 5;
};

struct BdfStatistics {
  std::size_t steps = 0;
  std::size_t rejected = 0;       ///< by the error test
  std::size_t not_converged = 0;  ///< Newton's iteration failed
  std::size_t linearisations = 0;
};

class BackwardDifferences {
 public:
  static constexpr int kMaximumOrder = 5;

  /// `parameters`: number of columns of S. `scale`: allowed local error of each state per step.
  BackwardDifferences(int states, int parameters, std::vector<double> scale, BdfOptions options);
  virtual ~BackwardDifferences() = default;

  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] int states() const { return states_; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(states_) * stride_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double step_size() const { return step_; }
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] const BdfStatistics& statistics() const { return statistics_; }
  /// [y | S] at time(), row by row.
  [[nodiscard]] const double* values() const { return differences_[0].data(); }

  /// Starts (again) at time t from [y | S] with first order. The step: by the curvature, at most 1 ms the first time, later
  /// at most that or the last one.
  [[nodiscard]] virtual bool start(double time, const double* values) = 0;
  /// One accepted step; false when no step size works.
  [[nodiscard]] bool step();
  /// [y | S] at a time within the last step, to `result`.
  void interpolate(double time, double* result) const;

 protected:
  using Table = std::array<double, kMaximumOrder + 3>;
  struct Coefficients {
    Table gamma{}, alpha{}, error{};
  };
  static const Coefficients& coefficients();

  /// A step's states from the prediction, and error_; false where they are not found.
  [[nodiscard]] virtual bool attempt() = 0;
  virtual void solve_sensitivities(double c) = 0;

  [[nodiscard]] double norm(const double* values, std::size_t stride) const;
  void restart(double time, const double* values);
  void predict();

  int parameters_;
  std::size_t stride_;
  std::vector<double> scale_;
  BdfOptions options_;
  BdfStatistics statistics_;

  double time_ = 0.0;
  double step_ = 0.0;
  int order_ = 1;
  double error_ = 0.0;
  std::array<std::vector<double>, kMaximumOrder + 3> differences_;
  std::vector<double> prediction_, constants_, work_;

 private:
  void accept();
  void choose_order_and_step();
  void change_step(double factor);
  [[nodiscard]] std::array<const double*, kMaximumOrder + 1> differences() const;

  int states_;
  int equal_steps_ = 0;
};

}  // namespace sealwatch
