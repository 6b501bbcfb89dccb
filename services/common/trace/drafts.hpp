// Alterations of one or several channels at once, fitted but not yet judged, of which the simulation may have noise of its
// own: an alteration alters its course and not its noise e_s, which is no other than it was (a delay by half a sample would
// lessen it).
//
//   r = y - e_s - A(s - e_s)     A: the altered course; r as without an alteration where A changes nothing
//
// Where a recording carries the simulation's noise (one is a copy of the other), y - A(s) scatters less than e_s does, and
// is taken.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/trace/smooth_course.hpp"
#include "sealwatch/trace/trace_comparison.hpp"
#include "services/common/trace/alterations.hpp"

namespace sealwatch::trace {

/// One channel on the common times.
struct Pair {
  std::string name, unit;
  bool input = false;
  bool stands_still = false;  ///< the recording, while the simulation moves
  Eigen::VectorXd recorded, simulated;
  Eigen::VectorXd noise;              ///< the simulation's own
  Eigen::VectorXd between;            ///< variance of what the simulation's samples leave open of it
  Course course;                      ///< the simulation's
  std::optional<Course> smooth = {};  ///< the same without its own noise, where it has some
  double least_variance = 0.0;        ///< rounding of the arithmetic
  double step_variance = 0.0;         ///< of the steps in which both are written
  double white_variance = 0.0;        ///< of the recording's noise from sample to sample
  double noise_variance = 0.0;        ///< of the difference: what no alteration can remove
};

struct Draft {
  Alteration told;
  std::vector<const Pair*> pairs;
  AlterationFit fit;
  Freedom freedom;
  bool smooth = false;  ///< of courses without their noise
};

/// What an alteration must be compared by.
struct CommonTimes {
  const std::vector<double>& time_s;
  const Joints& joints;
};

/// Nothing where the fit finds none, or one that follows nothing of the simulation. Of several channels at once: the share
/// removed of their misfits, each in units of its noise. `about_start`: gains are of what a channel differs from its start.
[[nodiscard]] std::optional<Draft> draft_of(const CommonTimes& times, const std::vector<const Pair*>& pairs,
                                            const Freedom& freedom, bool about_start = false);

/// Criterion of no alteration at all: what is no better explains nothing.
[[nodiscard]] double unaltered_criterion(const CommonTimes& times, const std::vector<const Pair*>& pairs);

/// Of a gain that may be 0 nothing of the simulation is left to explain anything with.
[[nodiscard]] bool follows_nothing(const AlterationFit& fit, const Freedom& freedom);

/// Variance of what the simulation's samples leave open of an altered course. Its times lie between samples, and so they
/// may where they were on one.
[[nodiscard]] Eigen::VectorXd open_variance(const Pair& pair, const Freedom& freedom, bool smooth);

[[nodiscard]] inline std::span<const double> span_of(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

/// Standard errors: what is nearer to nothing is nothing.
inline constexpr double kShifted = 4.0;

}  // namespace sealwatch::trace
