// Values and derivatives of a unit at a few points near its start, in its own units: what is checked before it runs.
#pragma once

#include <span>
#include <vector>

#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

/// What an evaluation answered, kept beyond the next request.
struct Partials {
  std::vector<double> derivatives, outputs;
  std::vector<double> derivatives_by_state, outputs_by_state, derivatives_by_input, outputs_by_input;
};

struct DerivativePoint {
  std::vector<double> states, inputs;
};

class DerivativePoints {
 public:
  explicit DerivativePoints(const FmuBlock& block);
  /// What the unit says, or differences over steps that are `wider` times as large; empty where it fails at a point.
  [[nodiscard]] Result<std::vector<Partials>> partials(FmuProcess& process, double wider) {
    return evaluate(process, wider, block_.parameter_start, {1, 1, 0});
  }
  /// Values alone, of a unit with these parameters.
  [[nodiscard]] Result<std::vector<Partials>> values(FmuProcess& process, std::span<const double> parameters) {
    return evaluate(process, 1.0, parameters, {});
  }
  [[nodiscard]] const std::vector<DerivativePoint>& all() const { return points_; }
  /// Of differences, for values that are no larger than usual.
  [[nodiscard]] double step(bool by_inputs, std::size_t column) const {
    return by_inputs ? input_steps_[column] : state_steps_[column];
  }

 private:
  [[nodiscard]] Result<std::vector<Partials>> evaluate(FmuProcess& process, double wider,
                                                       std::span<const double> parameters,
                                                       const EvaluationRequest& wanted);
  void choose(const std::vector<double>& start);
  const FmuBlock& block_;
  std::vector<double> state_steps_, input_steps_;
  std::vector<DerivativePoint> points_;
};

}  // namespace sealwatch::fmi
