// The binary of an FMU at work in a process of its own, sealwatch-fmu-host, with limits on memory and on the time of a
// call. A crash, a hang, an instance that is refused (a licence that is missing), a function that answers an error:
// each is an Error with the FMU's file, what it was asked, and the binary's own last words.
//
// One request takes one way there and back over shared memory (host_protocol.hpp), values and derivatives together.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "services/common/fmi/host_protocol.hpp"

namespace sealwatch::fmi {

struct ProcessLimits {
  std::uint64_t memory_bytes = 4ULL << 30U;
  double start_s = 120.0;  ///< for loading and for the start of a run: some tools' binaries ask a licence server
  double call_s = 30.0;    ///< for everything else
};

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

class FmuProcess {
 public:
  /// `most_slots`: how many instances a run may have.
  [[nodiscard]] static Result<std::unique_ptr<FmuProcess>> start(const std::string& file, Setup setup,
                                                                 std::size_t most_slots,
                                                                 const ProcessLimits& limits = {});
  ~FmuProcess();
  FmuProcess(const FmuProcess&) = delete;
  FmuProcess& operator=(const FmuProcess&) = delete;

  struct Run {
    double start_time_s = 0.0;
    std::span<const double> state_steps, input_steps;  ///< of differences, or larger where a value is
    std::span<const double> inputs;                    ///< at the start
    std::size_t slots = 1;
    std::span<const double> parameters;  ///< of each slot in turn
  };
  [[nodiscard]] Result<Beginning> begin(const Run& run);
  /// The spans are valid until the next request.
  [[nodiscard]] Result<Evaluation> evaluate(double time_s, std::span<const double> states,
                                            std::span<const double> inputs, const EvaluationRequest& wanted);
  /// An event at this point: states are changed where the outcome says so.
  [[nodiscard]] Result<Outcome> event(double time_s, std::span<double> states, std::span<const double> inputs);
  [[nodiscard]] Result<StepEnd> completed_step(double time_s, std::span<const double> states,
                                               std::span<const double> inputs);
  /// A Co-Simulation unit does a step of all slots. A step of 0 reads the outputs.
  [[nodiscard]] Result<CoStepEnd> do_step(double time_s, double step_s, std::span<const double> inputs);

  [[nodiscard]] bool alive() const { return alive_; }
  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] std::size_t most_slots() const { return most_slots_; }

 private:
  static constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
  FmuProcess(std::string file, Setup setup, std::size_t most_slots, const ProcessLimits& limits);
  [[nodiscard]] Status launch();
  /// `what` it is asked, at `time_s` unless that is NaN.
  [[nodiscard]] Status request(Operation operation, const char* what, double seconds, double time_s = kNoTime);
  [[nodiscard]] std::string advice_of(Operation operation) const;
  [[nodiscard]] Error failure(const std::string& what, std::string rule, std::string advice) const;
  [[nodiscard]] Error ended(const std::string& what, int status) const;
  [[nodiscard]] std::string printed() const;
  [[nodiscard]] std::span<std::byte> heap() const;
  [[nodiscard]] Packer packer() const { return Packer(heap()); }
  [[nodiscard]] Unpacker unpacker() const { return Unpacker(heap()); }
  void kill_and_reap(int* status);

  std::string file_;
  Setup setup_;
  std::size_t most_slots_, slots_ = 1;
  ProcessLimits limits_;
  std::size_t states_, inputs_, outputs_;
  std::size_t memory_bytes_ = 0;
  SharedHeader* header_ = nullptr;
  pid_t child_ = -1;
  int life_ = -1, output_ = -1;
  bool alive_ = false;
};

}  // namespace sealwatch::fmi
