// What the simulations of all plants have in common: the recording's channels, the laws in force, the names of states
// and the values from which a simulation starts.
#pragma once

#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/model/physics_terms.hpp"
#include "services/common/model/recorded_input.hpp"

namespace sealwatch {

/// An output that a plant can simulate.
struct OutputName {
  std::string channel;
  int state = -1;  ///< the state that it equals; -1: the equations compute it
};

/// One simulated and recorded channel.
struct SimulatedChannel {
  int output = 0;  ///< index among the plant's outputs
  int state = -1;  ///< the state that it equals; -1: the equations compute it
  double time_constant_s = 0.0;
};

class RecordedSimulation : public PlantSimulation {
 public:
  [[nodiscard]] const PlantDescription& plant() const override { return plant_; }
  [[nodiscard]] std::span<const std::string> channels() const override { return channel_names_; }
  [[nodiscard]] std::span<const std::string> state_names() const override { return state_names_; }
  [[nodiscard]] std::span<const std::string> slow_state_names() const override { return slow_state_names_; }
  [[nodiscard]] std::pair<double, double> initial_range(std::string_view state) const override;
  [[nodiscard]] std::span<const std::string> free_state_names() const override { return free_state_names_; }
  [[nodiscard]] const ModelValues& start() const override { return start_; }
  [[nodiscard]] const RowMatrix& recorded() const override { return recorded_; }
  [[nodiscard]] std::span<const PhysicsParameter> physics_parameters() const override { return terms_.parameters; }
  [[nodiscard]] std::span<const std::string> inputs() const override { return input_names_; }
  [[nodiscard]] std::span<const std::string> sensors() const override { return sensor_names_; }
  [[nodiscard]] std::pair<double, double> input_range(std::size_t input) const override;
  [[nodiscard]] Result<SimulatedOutputs> run(const ModelValues& values, std::span<const FreeQuantity> free,
                                             const SimulationOptions& options, InjectedColumns* injected) const final;
  [[nodiscard]] Result<RowMatrix> recording_columns(const ModelValues& values, std::span<const RecordingLaw> laws,
                                                    const SimulationOptions& options) const final;
  [[nodiscard]] std::span<const SimulatedChannel> simulated_channels() const { return channels_; }
  [[nodiscard]] const PhysicsTerms& terms() const { return terms_; }
  /// Standard deviation of each recorded channel's noise, as its samples show it.
  [[nodiscard]] const std::vector<double>& recorded_noise() const;

 protected:
  RecordedSimulation(const PlantDescription& plant, PhysicsTerms terms, std::vector<std::string> input_names,
                     RecordedInput input);
  /// One run, driven by `input`; laws of the recording have done their work.
  [[nodiscard]] virtual Result<SimulatedOutputs> run_driven_by(const RecordedInput& input, const ModelValues& values,
                                                               std::span<const FreeQuantity> free,
                                                               const SimulationOptions& options,
                                                               InjectedColumns* injected) const = 0;
  /// Whether run_driven_by() takes free quantities of the recording; else they come from differences of whole runs.
  [[nodiscard]] virtual bool differentiates_by_recording() const { return false; }
  /// Takes the outputs that are recorded, and the sensors of what drives the simulation.
  void select_channels(std::span<const OutputName> outputs, const AssetConfig& asset, const TimeSeries& recorded);
  /// The plant's states and start, to which those of the laws are added. `at_rest`: known at the beginning alone.
  void set_states(std::vector<std::string> names, std::vector<std::string> slow, ModelValues start,
                  const std::vector<std::string>& at_rest = {});

 private:
  /// With exact sensors of the outputs.
  [[nodiscard]] Result<SimulatedOutputs> run_exact(const ModelValues& values, std::span<const FreeQuantity> free,
                                                   const SimulationOptions& options, InjectedColumns* injected) const;
  [[nodiscard]] RecordingErrors errors_at(const ModelValues& values) const;
  [[nodiscard]] std::size_t input_index(const std::string& name) const;
  /// A law of the recording by which a run is differentiated. `parameter`: its size, where it is in force as such.
  struct Differentiated {
    std::size_t free = 0;
    RecordingLaw law;
    double size = 0.0;
    std::size_t parameter = static_cast<std::size_t>(-1);
  };
  [[nodiscard]] std::vector<Differentiated> of_recording(const ModelValues& values,
                                                         std::span<const FreeQuantity> free) const;
  [[nodiscard]] bool is_of_output(const FreeQuantity& sensors) const { return sensors.index < channel_names_.size(); }
  void add_sensor(const std::string& channel, const AssetConfig& asset);
  struct ByRecording {
    FreeQuantity quantity;
    double factor = 1.0;  ///< of the quantity's column
  };
  [[nodiscard]] ByRecording by_recording(RecordingLaw law, const RecordingErrors& errors, double size) const;
  [[nodiscard]] Result<RowMatrix> difference(const ModelValues& values, RecordingLaw law, std::size_t parameter,
                                             const SimulationOptions& options) const;

  const PlantDescription& plant_;
  PhysicsTerms terms_;
  std::vector<std::string> input_names_;
  RecordedInput input_;
  std::vector<std::string> state_names_, slow_state_names_, free_state_names_, channel_names_, sensor_names_;
  std::vector<SimulatedChannel> channels_;
  std::vector<double> sensor_gain_, sensor_offset_;  ///< the asset's, per sensor
  RowMatrix recorded_;
  ModelValues start_;
  mutable std::once_flag noise_is_known_;
  mutable std::vector<double> noise_;
};

}  // namespace sealwatch
