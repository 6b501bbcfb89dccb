// One run of an FMU's equations (fmu_equations.hpp).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

/// What the FMU gave at a point, in SI: z = [dx/dt; w] and its derivatives as far as they were asked for.
struct BlockValues {
  std::vector<double> z;
  std::vector<bool> signs;  ///< of the event indicators
  RuntimeMatrix by_state, by_input, by_parameter;
};

/// How far to go beside a point, in SI: in each of the states or of the inputs alone; 0: not at all.
struct BesidePoint {
  bool of_states = true;
  std::vector<double> sizes;
};

/// The FMU itself: begins, and gives z at points.
class RunningBlock {
 public:
  /// `starts`: v and q of the run, then those of each direction of differentiation at a step `steps[k]` away.
  [[nodiscard]] static Result<std::unique_ptr<RunningBlock>> begin(const FmuBlock& block,
                                                                   std::shared_ptr<ProcessPool> pool,
                                                                   const RuntimePoint& first,
                                                                   const std::vector<BlockStart>& starts,
                                                                   std::vector<double> steps);
  ~RunningBlock();
  RunningBlock(const RunningBlock&) = delete;
  RunningBlock& operator=(const RunningBlock&) = delete;
  /// Null where the FMU has no value; trouble() says why.
  [[nodiscard]] const BlockValues* at(double time_s, std::span<const double> states, std::span<const double> inputs,
                                      EvaluationRequest wanted);
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  [[nodiscard]] bool has_events() const;
  [[nodiscard]] double next_event_s() const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (ended_s_ < kNever) return kNever;
    return beginning_.outcome.next_time_s;
  }
  /// Whether an indicator has another sign than when accept() or pass_event() was called last.
  [[nodiscard]] bool event_before(double time_s, std::span<const double> states, std::span<const double> inputs);
  [[nodiscard]] bool accept(double time_s, std::span<const double> states, std::span<const double> inputs);
  [[nodiscard]] bool pass_event(double time_s, std::span<double> states, std::span<const double> inputs);
  /// States at the start, in SI, and their derivatives by the parameters.
  void start(std::span<double> states, RuntimeMatrix& by_parameter) const;

 private:
  RunningBlock(const FmuBlock& block, std::shared_ptr<ProcessPool> pool, const Deadline* deadline,
               std::vector<double> steps)
      : block_(block), pool_(std::move(pool)), deadline_(deadline), steps_(std::move(steps)) {}
  /// Another process, with these instances.
  [[nodiscard]] Status begin_process(double time_s, double stop_s, std::span<const BlockStart> starts);
  void set_point(std::span<const double> states, std::span<const double> inputs);
  /// A Co-Simulation unit goes on to this time, with inputs that are linear from the last one or held since.
  [[nodiscard]] const BlockValues* step_to(double time_s);
  /// What forbids a step of this length; "": nothing.
  [[nodiscard]] bool is_jump(double step_s) const;
  [[nodiscard]] std::string fault_of_step(double step_s);
  [[nodiscard]] const BlockValues* in_trouble(std::string words) { return trouble_ = std::move(words), nullptr; }
  /// Whether the derivatives that the unit gave at the point asked last are those of its values: looked at ever less
  /// often, so that no fifth of a run is passed over; false three times in a row: trouble.
  [[nodiscard]] bool derivatives_hold(double time_s, const EvaluationRequest& asked);
  /// Whether states that were moved together, by what ModelStructure declares, do what the unit does at the point asked
  /// last.
  [[nodiscard]] bool groups_hold(double time_s);
  /// Again at the point asked last.
  [[nodiscard]] bool differentiate_one_by_one(double time_s, EvaluationRequest asked);
  [[nodiscard]] BesidePoint beside_inputs() const;
  /// dz by a step from the last point asked, over its share of a size; nothing where the unit has no value there.
  [[nodiscard]] std::optional<std::vector<double>> slope_along(double time_s, const BesidePoint& beside,
                                                               std::size_t column, double share);
  /// The first row of z with a derivative that is not that of its values; nothing where none is wrong.
  [[nodiscard]] std::optional<std::size_t> false_row(double time_s, const BesidePoint& beside,
                                                     const RuntimeMatrix& given);
  void end_at(double time_s);
  [[nodiscard]] bool is_known(double time_s, const EvaluationRequest& wanted) const;
  void convert(const Evaluation& values, const EvaluationRequest& wanted);
  [[nodiscard]] std::vector<double> z_of(const Evaluation& values) const;
  void convert_jacobian(std::span<const double> derivatives, std::span<const double> outputs, std::size_t columns,
                        bool of_states);
  [[nodiscard]] bool differentiate_by_parameters(double time_s);
  [[nodiscard]] double rate(std::size_t state, double value) const { return block_.states[state].factor * value; }

  const FmuBlock& block_;
  std::shared_ptr<ProcessPool> pool_;
  const Deadline* deadline_;
  std::vector<std::unique_ptr<FmuProcess>> processes_;  ///< several where the binary allows one instance in each
  std::vector<double> steps_, state_factors_;
  Beginning beginning_;
  std::vector<double> states_, inputs_, known_states_, known_inputs_;  ///< in the FMU's units
  std::vector<bool> signs_;
  double known_time_s_ = std::numeric_limits<double>::quiet_NaN();
  EvaluationRequest known_;
  double ended_s_ = std::numeric_limits<double>::infinity();  ///< when it asked to end: it has no values after that
  double step_s_ = 0.0;                                       ///< of a Co-Simulation unit with equal steps
  double stepped_to_s_ = std::numeric_limits<double>::quiet_NaN();  ///< by a Co-Simulation unit
  std::uint64_t times_differentiated_ = 0, next_look_ = 0;
  std::uint64_t times_false_by_state_ = 0, times_false_by_input_ = 0;  ///< in a row
  BlockValues values_;
  std::string trouble_;
};

class FmuEvaluator final : public RuntimeEvaluator {
 public:
  FmuEvaluator(const FmuBlock& block, std::unique_ptr<RuntimeEvaluator> frame, std::unique_ptr<RunningBlock> running,
               std::size_t outputs, std::size_t sites, std::size_t differentiated, bool signals_use_block);
  [[nodiscard]] bool evaluate(RuntimeFunction function, const RuntimePoint& point, std::span<double> values) override;
  [[nodiscard]] const RuntimeLinearisation* linearise(RuntimeFunction function, const RuntimePoint& point,
                                                      RuntimeDirections directions) override;
  [[nodiscard]] std::string trouble() const override;
  [[nodiscard]] bool start(std::span<double> states, RuntimeMatrix& by_parameter) override {
    running_->start(states, by_parameter);
    return true;
  }
  [[nodiscard]] bool has_events() const override { return running_->has_events(); }
  [[nodiscard]] double next_event_s() const override { return running_->next_event_s(); }
  [[nodiscard]] bool event_before(const RuntimePoint& point) override;
  [[nodiscard]] bool accept(const RuntimePoint& point) override;
  [[nodiscard]] bool pass_event(const RuntimePoint& point, std::span<double> states) override;

 private:
  [[nodiscard]] RuntimePoint framed(const RuntimePoint& point);
  [[nodiscard]] std::span<const double> inputs_at(const RuntimePoint& point);
  [[nodiscard]] bool needs_block(RuntimeFunction function) const {
    return function != RuntimeFunction::signals || signals_use_block_;
  }
  /// The frame has signals of what the FMU gives too, before the plant's own.
  [[nodiscard]] std::size_t first_row(RuntimeFunction function) const {
    return function == RuntimeFunction::signals ? z_count_ * kSiteSignals : 0;
  }

  const FmuBlock& block_;
  std::unique_ptr<RuntimeEvaluator> frame_;
  std::unique_ptr<RunningBlock> running_;
  std::size_t outputs_, sites_, differentiated_, z_count_;
  bool signals_use_block_;
  std::vector<double> added_, frame_outputs_, frame_signals_;
  RuntimeMatrix v_by_state_, v_by_parameter_, v_by_added_;
  RuntimeMatrix z_by_state_, z_by_parameter_, z_by_added_;
  RuntimeLinearisation result_;
};

}  // namespace sealwatch::fmi
