// What a binary is asked, request by request: values and derivatives together.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "services/common/fmi/host_process.hpp"

namespace sealwatch::fmi {

struct Outcome {
  bool terminate = false;
  bool values_changed = false;
  double next_time_s = 0.0;  ///< of the next time event; infinite: none
};

struct Beginning {
  Outcome outcome;
  std::vector<double> states, nominals;
  std::vector<double> slot_states;  ///< of each further slot in turn
};

/// Values; derivatives where they were asked for, row by row. `parameter` has f and y of each further slot in turn.
struct Evaluation {
  std::span<const double> derivatives, outputs, indicators;
  std::span<const double> derivatives_by_state, outputs_by_state;
  std::span<const double> derivatives_by_input, outputs_by_input;
  std::span<const double> parameter;
};

struct StepEnd {
  bool event = false;
  bool terminate = false;
};

/// A step of a Co-Simulation unit: the outputs of all slots in turn. It may end the simulation by itself.
struct CoStepEnd {
  std::span<const double> outputs;
  bool terminate = false;
  double reached_s = 0.0;
};

inline constexpr double kNoStop = std::numeric_limits<double>::infinity();  ///< a run that may go on for ever

class FmuProcess : public HostProcess {
 public:
  /// `most_slots`: how many instances a run may have.
  [[nodiscard]] static Result<std::unique_ptr<FmuProcess>> start(const std::string& file, Setup setup,
                                                                 std::size_t most_slots,
                                                                 const ProcessLimits& limits = {},
                                                                 const Deadline* deadline = nullptr);

  struct Run {
    double start_time_s = 0.0;
    double stop_time_s = kNoStop;
    std::span<const double> state_steps, input_steps;  ///< of differences, or larger where a value is
    std::span<const double> inputs;                    ///< at the start, of each slot in turn
    std::size_t slots = 1;
    std::span<const double> parameters;  ///< of each slot in turn
  };
  /// Of a binary that takes one instance in the life of its process, each run has a process of its own.
  [[nodiscard]] Result<Beginning> begin(const Run& run);
  /// The spans are valid until the next request.
  [[nodiscard]] Result<Evaluation> evaluate(double time_s, std::span<const double> states,
                                            std::span<const double> inputs, const EvaluationRequest& wanted);
  /// An event at this point: states are changed where the outcome says so.
  [[nodiscard]] Result<Outcome> event(double time_s, std::span<double> states, std::span<const double> inputs);
  [[nodiscard]] Result<StepEnd> completed_step(double time_s, std::span<const double> states,
                                               std::span<const double> inputs);
  /// A Co-Simulation unit does a step of all slots, with inputs `during` it; outputs are read with those at its `end`,
  /// which some follow at once. A step of 0 reads alone.
  [[nodiscard]] Result<CoStepEnd> do_step(double time_s, double step_s, std::span<const double> during,
                                          std::span<const double> end);

  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] std::size_t most_slots() const { return most_slots_; }

 private:
  FmuProcess(std::string file, Setup setup, std::size_t most_slots, const ProcessLimits& limits);
  [[nodiscard]] Status load();

  Setup setup_;
  bool begun_ = false;
  std::size_t most_slots_, slots_ = 1;
  std::size_t states_, inputs_, outputs_;
};

}  // namespace sealwatch::fmi
