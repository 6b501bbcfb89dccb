// Equations with their recorded input, as RecordingRun simulates them.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "sealwatch/ode/bdf.hpp"
#include "services/common/model/held_to_recording.hpp"
#include "services/common/model/quasi_steady.hpp"

namespace sealwatch {

/// `point`: [y | S], row by row.
class RecordedSystem {
 public:
  virtual ~RecordedSystem() = default;
  /// Allowed local error of each state per step.
  [[nodiscard]] virtual std::vector<double> scale(double relative_tolerance) const = 0;
  /// States that start at rest.
  [[nodiscard]] virtual std::vector<bool> settled() const = 0;
  [[nodiscard]] virtual int maximum_order() const = 0;
  /// Of the recorded input.
  virtual void set_segment(std::size_t segment) = 0;
  /// What a segment's begin adds to `point`.
  virtual void cross_jump(double /*t*/, double* /*point*/, std::size_t /*stride*/) const {}
  /// Outputs that are no states, a row of `signals` each: its value and its derivatives by all columns.
  virtual void outputs(std::span<const int> which, double t, const double* point, std::size_t stride,
                       double* signals) const = 0;
  /// Why it could not be evaluated; "": nothing that is known.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  /// What the equations themselves say of it; "": nothing.
  [[nodiscard]] virtual std::string said() const { return {}; }

  /// States that start where the equations say, with their sensitivities; not those that are free.
  [[nodiscard]] virtual bool start(std::span<const FreeQuantity> /*free*/, double* /*y*/, double* /*point*/,
                                   std::size_t /*stride*/) const {
    return true;
  }

  [[nodiscard]] virtual bool has_events() const { return false; }
  [[nodiscard]] virtual double next_event_s() const { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] virtual bool event_before(double /*t*/, const double* /*y*/) const { return false; }
  [[nodiscard]] virtual bool accept(double /*t*/, const double* /*y*/) const { return false; }
  /// What an event does: fails, changes nothing that sensitivities see, or more than they can cross.
  enum class Passed { failed, smooth, jump };
  [[nodiscard]] virtual Passed pass_event(double /*t*/, double* /*y*/) const { return Passed::smooth; }

  /// Integrated so from now on. `at`: a state at which the equations have a value.
  virtual void hold_to(MeasuredStates measured, const std::vector<double>& at) = 0;
  /// What integrates it.
  [[nodiscard]] virtual std::unique_ptr<BackwardDifferences> integrator(int parameters, std::vector<double> scale,
                                                                        const BdfOptions& options) const = 0;
  /// Moves the states that are `fast` to rest and completes their rows of `point`; false where they find none.
  [[nodiscard]] virtual bool settle(double time, const std::vector<bool>& fast, const std::vector<double>& scale,
                                    std::vector<double>& state, double* point, std::size_t stride) const = 0;
};

/// Of N states; N may be kDynamicSize or at_most(n).
template <int N>
class SizedSystem : public RecordedSystem, public OdeSystem<N> {
 public:
  [[nodiscard]] std::unique_ptr<BackwardDifferences> integrator(int parameters, std::vector<double> scale,
                                                                const BdfOptions& options) const final {
    const OdeSystem<N>& integrated = held_ ? static_cast<const OdeSystem<N>&>(*held_) : *this;
    return std::make_unique<Bdf<N>>(integrated, parameters, std::move(scale), options);
  }
  void hold_to(MeasuredStates measured, const std::vector<double>& at) final {
    std::vector<double> size = scale(1.0);
    held_ = std::make_unique<HeldToRecording<N>>(*this, std::move(measured), at, size);
  }
  [[nodiscard]] bool settle(double time, const std::vector<bool>& fast, const std::vector<double>& scale,
                            std::vector<double>& state, double* point, std::size_t stride) const final {
    QuasiSteadyState<N> rest(*this, time, fast, scale);
    return rest.solve(state) && rest.differentiate(state, point, stride);
  }

 private:
  std::unique_ptr<HeldToRecording<N>> held_;
};

}  // namespace sealwatch
