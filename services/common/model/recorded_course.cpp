#include "services/common/model/recorded_course.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "services/common/model/measured_input.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kOfAParabola = 3;
constexpr double kAsNoise = 1.2;  // times the noise: the knots have taken out some of it, and it is known to a tenth

// At sample `at`, of the parabola fitted to the samples from `from` to `to`, in units of their distance.
double parabola_at(const std::vector<double>& time_s, const std::vector<double>& values, std::size_t at,
                   std::size_t from, std::size_t to) {
  const double unit_s = time_s[to] - time_s[from];
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = from; k <= to; ++k) {
    const double d = (time_s[k] - time_s[at]) / unit_s;
    const Eigen::Vector3d powers(1.0, d, d * d);
    gram += powers * powers.transpose();
    right += values[k] * powers;
  }
  return gram.ldlt().solve(right)(0);
}

}  // namespace

RecordedCourse::RecordedCourse(const std::vector<double>& time_s, const std::vector<double>& values, double noise,
                               double longest_s) {
  const double sample_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (double distance_s = longest_s; distance_s > sample_s; distance_s /= 2.0) {
    smooth(time_s, values, distance_s);
    double squares = 0.0;
    for (std::size_t k = 0; k < time_s.size(); ++k) squares += std::pow(values[k] - at(time_s[k]), 2);
    if (std::sqrt(squares / static_cast<double>(time_s.size())) <= kAsNoise * noise) return;
  }
  smooth(time_s, values, 0.0);
}

void RecordedCourse::smooth(const std::vector<double>& time_s, const std::vector<double>& values, double distance_s) {
  times_.clear();
  values_.clear();
  knot_ = 0;
  const std::size_t last = values.size() - 1;
  for (std::size_t k = 0, from = 0, to = 0; k <= last; ++k) {
    if (k > 0 && k < last && time_s[k] - times_.back() < distance_s) continue;
    while (time_s[k] - time_s[from] > distance_s) ++from;
    while (to < last && time_s[to + 1] - time_s[k] <= distance_s) ++to;
    times_.push_back(time_s[k]);
    values_.push_back(to - from > kOfAParabola ? parabola_at(time_s, values, k, from, to) : values[k]);
  }
  slopes_ = spline_slopes(times_, values_);
}

// Hermite's cubic between two knots; straight on beyond the last, where the integrator's last step may lead.
double RecordedCourse::at(double time_s) const {
  if (time_s > times_.back()) return values_.back() + slopes_.back() * (time_s - times_.back());
  while (knot_ + 2 < times_.size() && times_[knot_ + 1] <= time_s) ++knot_;
  while (knot_ > 0 && times_[knot_] > time_s) --knot_;
  const double distance_s = times_[knot_ + 1] - times_[knot_], s = (time_s - times_[knot_]) / distance_s, r = 1.0 - s;
  return r * r * ((1.0 + 2.0 * s) * values_[knot_] + s * distance_s * slopes_[knot_]) +
         s * s * ((1.0 + 2.0 * r) * values_[knot_ + 1] - r * distance_s * slopes_[knot_ + 1]);
}

}  // namespace sealwatch
