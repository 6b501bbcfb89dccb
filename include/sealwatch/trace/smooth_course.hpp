// A sampled course between its samples, and its slopes.
//
// Between two samples the cubic of Hermite with central differences as slopes (Catmull-Rom); beyond the ends the last
// value. smooth_slope() takes the slope over as many samples as the course's own noise needs.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

namespace sealwatch::trace {

class Course {
 public:
  /// At least two strictly increasing times.
  Course(std::vector<double> time_s, std::vector<double> values);
  [[nodiscard]] double begin_s() const { return time_s_.front(); }
  [[nodiscard]] double end_s() const { return time_s_.back(); }
  /// Value and slope [1/s] at `time_s`.
  [[nodiscard]] std::pair<double, double> at(double time_s) const;

 private:
  std::vector<double> time_s_, values_, slopes_;
};

/// d/dt of uniformly sampled values: central difference over k samples to either side, averaged, with the least k that
/// brings the noise of the slope below a tenth of its root mean square.
[[nodiscard]] Eigen::VectorXd smooth_slope(const Eigen::VectorXd& values, double interval_s);

}  // namespace sealwatch::trace
