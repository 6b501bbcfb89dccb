// The work of sealwatch-fmu-host: instances of the model in one binary, and what is asked of them.
//
// Slot 0 is the model with the run's parameters; each further slot is the model with one parameter changed, for the
// differences by which parameters are differentiated. State and input derivatives come from the binary, or else from
// central differences with the steps that sealwatch gives.
#pragma once

#include <memory>
#include <vector>

#include "services/common/fmi/column_groups.hpp"
#include "services/common/fmi/fmi_instance.hpp"

namespace sealwatch::fmi {

class FmuHost {
 public:
  explicit FmuHost(Setup setup);
  /// Answers one request; what it takes and gives is in FmuProcess (fmu_process.hpp), function by function.
  void serve(Operation operation, std::span<std::byte> heap);

 private:
  void begin(Unpacker request, Packer answer);
  void evaluate(Unpacker request, Packer answer);
  void event(Unpacker request, Packer answer);
  void completed_step(Unpacker request, Packer answer);
  void do_step(Unpacker request, Packer answer);

  void place(FmiInstance& instance, double time, std::span<const double> states, std::span<const double> inputs);
  void read(FmiInstance& instance, std::span<double> derivatives, std::span<double> outputs);
  enum class Known { states, inputs };
  void differentiate(Known known, double time, std::span<double> by_derivative, std::span<double> by_output);
  void by_differences(Known known, double time, std::span<double> derivative_part, std::span<double> output_part);
  void by_directions(Known known, const std::vector<Reference>& unknowns, std::size_t rows, std::size_t first,
                     std::span<double> part);
  [[nodiscard]] const std::vector<ColumnGroup>& groups_of(Known known) const;

  Setup setup_;
  std::vector<Constant> constants_;
  Group parameters_, inputs_, outputs_, continuous_inputs_;
  std::size_t states_, indicators_;
  std::vector<Reference> state_references_, derivative_references_;
  std::vector<ColumnGroup> state_groups_, single_states_, single_inputs_;
  bool grouped_ = true;
  Library library_;
  MakeInstance make_;
  std::vector<std::unique_ptr<FmiInstance>> slots_;
  std::vector<double> state_steps_, input_steps_, state_, input_, upper_, lower_, seed_, column_, here_, width_;
};

}  // namespace sealwatch::fmi
