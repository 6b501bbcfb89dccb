// What a simulation's faults leave behind in the difference from a recording, as regressors (difference_tests.hpp) of a
// channel's simulated course: what depends on the motion and the drives alone is worked out once.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "services/common/trace/difference_tests.hpp"
#include "services/common/trace/regimes.hpp"

namespace sealwatch::trace {

/// Samples of the common times.
struct SampleRange {
  Eigen::Index first = 0, count = 0;
};

class FaultRegressors {
 public:
  /// A course's own white noise is in the difference, too: none of a sample's may be in its regressors.
  struct Shape {
    Eigen::VectorXd value, slope, curvature;
  };
  using ShapeOf = std::function<Shape(const Eigen::VectorXd&)>;

  /// `time_s`: the common times, which outlive this. `shape_of`: of a course at them.
  FaultRegressors(const std::vector<double>& time_s, ShapeOf shape_of)
      : time_s_(time_s), shape_of_(std::move(shape_of)) {}

  /// What may drive the simulation, as recorded.
  void add_drive(const std::string& name, const Eigen::VectorXd& values);
  /// Velocity of whatever moves; where none is set, a channel's own slope tells its regimes.
  void set_motion(const Eigen::VectorXd& velocity);

  /// An input does not drive itself: as recorded it has the noise that is judged.
  [[nodiscard]] std::vector<RegressorGroup> groups_of(const std::string& channel, const Eigen::VectorXd& course,
                                                      const SampleRange& range) const;
  [[nodiscard]] std::vector<RegressorGroup> partitions_of(const Eigen::VectorXd& course,
                                                          const SampleRange& range) const;
  /// At rest, moving either way, reversing.
  [[nodiscard]] std::vector<Regime> regimes_of_course(const Eigen::VectorXd& course) const;

 private:
  struct Drive {
    std::string name;
    Eigen::VectorXd values, slope;
  };

  const std::vector<double>& time_s_;
  ShapeOf shape_of_;
  std::vector<Drive> drives_;
  std::vector<Regime> motion_;
  std::vector<Eigen::VectorXd> saturations_;  ///< of the motion
};

}  // namespace sealwatch::trace
