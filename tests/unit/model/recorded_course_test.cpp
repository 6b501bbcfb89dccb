// The course of a measured state between its samples: noise is taken out of it, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "services/common/model/recorded_course.hpp"

namespace sealwatch {
namespace recorded_course {
namespace {

constexpr double kSample_s = 0.01, kNoise = 0.01, kLongest_s = 0.2;

struct Recorded {
  std::vector<double> time_s, values;
};

Recorded wave(double period_s) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, kNoise);
  Recorded recorded;
  for (int k = 0; k < 2000; ++k) {
    recorded.time_s.push_back(k * kSample_s);
    recorded.values.push_back(std::sin(2.0 * M_PI * recorded.time_s.back() / period_s) + noise(random));
  }
  return recorded;
}

double rms_error(double period_s) {
  const Recorded recorded = wave(period_s);
  const RecordedCourse course(recorded.time_s, recorded.values, kNoise, kLongest_s);
  double squares = 0.0;
  int count = 0;
  for (double t = 1.0; t < 19.0; t += 0.003, ++count)
    squares += std::pow(course.at(t) - std::sin(2.0 * M_PI * t / period_s), 2);
  return std::sqrt(squares / count);
}

TEST(RecordedCourse, LeavesOutTheNoiseOfASlowCourse) { EXPECT_LT(rms_error(5.0), 0.5 * kNoise); }

/// Ten samples a period: the longest distance would leave nothing of it.
TEST(RecordedCourse, KeepsAFastOne) { EXPECT_LT(rms_error(0.1), 2.0 * kNoise); }

TEST(RecordedCourse, KeepsTwoSamples) {
  const RecordedCourse course({0.0, 1.0}, {2.0, 4.0}, 0.0, kLongest_s);
  EXPECT_NEAR(course.at(0.5), 3.0, 1e-12);
}

/// As of a free spline's end: a cubic would run away.
TEST(RecordedCourse, GoesStraightOnBeyondItsEnd) {
  const RecordedCourse course({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 0.0, 1.0}, 0.0, 0.1);
  EXPECT_NEAR(course.at(6.0) - course.at(5.0), course.at(4.0) - course.at(3.0), 1e-12);
}

}  // namespace
}  // namespace recorded_course
}  // namespace sealwatch
