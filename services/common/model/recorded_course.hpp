// The course of a measured state between its samples, for an integrator: the cubic spline through knots, each the value of
// the parabola fitted to the samples around it. Knots are as far apart as leaves the recording within its noise.
#pragma once

#include <cstddef>
#include <vector>

namespace sealwatch {

class RecordedCourse {
 public:
  /// `noise`: standard deviation. `longest_s`: distance of knots, at most; where closer samples differ by more than
  /// their noise, it is halved.
  RecordedCourse(const std::vector<double>& time_s, const std::vector<double>& values, double noise, double longest_s);

  [[nodiscard]] double at(double time_s) const;

 private:
  void smooth(const std::vector<double>& time_s, const std::vector<double>& values, double distance_s);

  std::vector<double> times_, values_, slopes_;
  mutable std::size_t knot_ = 0;  ///< that was asked for last
};

}  // namespace sealwatch
