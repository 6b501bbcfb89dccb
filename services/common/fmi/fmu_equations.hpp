// A plant whose derivatives come from an FMU. What stands around the FMU is written as text (sealwatch/services/common/
// equations) and is here the `frame`, a run-time plant of its own:
//
//   v = v(t, x, u, p, e)        inputs of the FMU            (frame outputs behind the plant's own)
//   q = q(p)                    parameters of the FMU        (the next frame outputs)
//   z = [dx/dt; w] = F(t, x, v, q)      the FMU: its derivatives and the variables that are used
//   f, s, y = frame(t, x, u, p, [z; e])                      z stands where the frame has its first `added`
//
//   df/dx = df_frame/dx + df_frame/dz (F_x + F_v dv/dx),  and so on for p and e by the chain rule
//
// It begins with v at the first sample. What laws add goes to f behind the FMU, or to v before it, but for its beginning:
// the user's model stays as it is. F_x and F_v are the
// binary's directional derivatives or central differences on the instance; F_q one-sided differences on further
// instances. The unit of every quantity of the FMU is converted: SI = factor * value + offset.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/model/runtime_equations.hpp"
#include "services/common/fmi/fmu_file.hpp"
#include "services/common/fmi/hosted_runs.hpp"

namespace sealwatch::fmi {

/// An element of the FMU that the frame sets or reads: its place among the elements of its group in Setup.
struct Port {
  std::size_t place = 0;
  Conversion unit;
};

struct FmuBlock {
  std::shared_ptr<const FmuFile> file;
  Setup setup;
  std::vector<Conversion> states;
  std::vector<double> state_sizes;  ///< SI
  std::vector<Port> variables, inputs, parameters;
  std::vector<bool> held_inputs;                     ///< of each input: it does not change between samples
  std::vector<double> input_start, parameter_start;  ///< of all elements of the groups, in the FMU's units
  std::vector<double> input_sizes;                   ///< of as many, in their own units: their nominal values
  double start_time_s = 0.0, stop_time_s = kNoStop;  ///< as the description has them
  HostedPlant plant;                                 ///< for runs in the process that has the binary
};

/// With what an instance begins, in SI.
struct BlockStart {
  std::vector<double> inputs, parameters;
};

/// Processes that run the FMU, kept for the next run.
class ProcessPool {
 public:
  /// One that keeps the deadline until it is given back.
  [[nodiscard]] Result<std::unique_ptr<FmuProcess>> take(const FmuBlock& block, std::size_t slots,
                                                         const Deadline* deadline);
  void give_back(std::unique_ptr<FmuProcess> process);

 private:
  FreeInCopies mutex_;
  std::vector<std::unique_ptr<FmuProcess>> idle_;
  LostProcesses lost_;
};

class FmuEquations final : public RuntimeEquations {
 public:
  /// How many of each the plant has; its outputs are the frame's first ones.
  struct Counts {
    std::size_t inputs = 0, outputs = 0, sites = 0;
  };
  FmuEquations(FmuBlock block, std::shared_ptr<const RuntimeEquations> frame, Counts counts, bool outputs_see_added);
  [[nodiscard]] Result<std::unique_ptr<RuntimeEvaluator>> evaluator(
      const RuntimePoint& first, std::span<const std::size_t> differentiated) const override;
  [[nodiscard]] Result<std::vector<double>> initial_state(std::span<const double> parameters,
                                                          const TimeSeries& recorded) const override {
    return frame_->initial_state(parameters, recorded);
  }
  [[nodiscard]] bool signals_see_added() const override { return frame_->signals_see_added(); }
  [[nodiscard]] bool outputs_see_added() const override { return outputs_see_added_; }
  [[nodiscard]] bool runs_elsewhere() const override;
  [[nodiscard]] Result<SimulatedOutputs> run(const RuntimeRun& run) const override { return runs_->run(run); }
  // For those who write the plant in another language.
  [[nodiscard]] const FmuBlock& block() const { return block_; }
  [[nodiscard]] const RuntimeEquations& frame() const { return *frame_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  /// v and q, a step along one of the directions of differentiation.
  [[nodiscard]] BlockStart start_of(const RuntimeLinearisation& at, std::size_t direction, double step) const;
  FmuBlock block_;
  std::shared_ptr<const RuntimeEquations> frame_;
  Counts counts_;
  bool outputs_see_added_;
  std::shared_ptr<ProcessPool> pool_ = std::make_shared<ProcessPool>();
  std::unique_ptr<HostedRuns> runs_;
};

/// Compares the directional derivatives that the FMU gives, of its state derivatives and outputs by its states and
/// inputs, with differences near its start; an Error that names the first that is wrong. Those by parameters are never
/// asked for: their differences are of further instances. Also refuses derivatives that are not finite numbers. A unit that fails over them, and for
/// good, is asked for none from then on.
[[nodiscard]] Status check_derivatives(FmuBlock& block);

/// The name of an element of whole variables that stand one behind the other.
[[nodiscard]] std::string element_of(const ModelDescription& description, std::span<const Handle> handles,
                                     std::size_t place);

/// The unit is refused: `which` of its directional derivatives are wrong.
[[nodiscard]] Error false_derivatives(const FmuFile& file, std::string which);

}  // namespace sealwatch::fmi
