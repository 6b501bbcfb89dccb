// A sampled course between its samples, and its slopes.
//
// Between two samples the cubic of Hermite with central differences as slopes (Catmull-Rom); beyond the ends the last
// value. smooth_course() takes values and slopes over as many samples as the course's own noise needs.
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
  /// Of the value at `time_s`, what the samples leave open, as a variance: nothing on a sample, nothing where the course
  /// through every second sample finds the others, much at corners and jumps.
  [[nodiscard]] double variance_at(double time_s) const;
  /// Mean of variance_at() over the whole course.
  [[nodiscard]] double mean_variance() const;

 private:
  [[nodiscard]] std::size_t interval_of(double time_s) const;
  [[nodiscard]] std::pair<double, double> cubic(std::size_t from, std::size_t to, double from_slope, double to_slope,
                                                double time_s) const;
  [[nodiscard]] double missed_at(std::size_t sample) const;
  [[nodiscard]] double missed_in(std::size_t interval) const;

  std::vector<double> time_s_, values_, slopes_;
  std::vector<double> missed_;  ///< of each sample, by the course through every second sample
};

/// A uniformly sampled course without most of its own white noise, none of which reaches a sample's slope, curvature and
/// `beside`. Lines through the 2k + 1 samples about each, with the least k that brings the noise of the slope below a tenth
/// of its root mean square: k = 1 where there is next to none.
struct SmoothCourse {
  Eigen::Index half_window = 1;                                      ///< k
  Eigen::VectorXd values, slope;                                     ///< of the lines
  Eigen::VectorXd beside;                                            ///< mean of the window's other samples
  [[nodiscard]] Eigen::VectorXd curvature(double interval_s) const;  ///< of slopes whose windows leave the sample out
};
[[nodiscard]] SmoothCourse smooth_course(const Eigen::VectorXd& values, double interval_s);

}  // namespace sealwatch::trace
