// Simulation of one recording with a plant's equations, and the forward sensitivities of the simulated channels.
//
//   auto simulation = PlantSimulation::create(asset, recorded);          // Result
//   ModelValues values = (*simulation)->start();                         // asset's parameters, states from first
//   samples std::vector<FreeQuantity> free = {*(*simulation)->find("R_CL"), *(*simulation)->find("load_factor"),
//                                     *(*simulation)->find("initial:p_A")};
//   auto outputs = (*simulation)->run(values, free);                     // values and d values / d free
//
// The simulation is driven by the recorded input alone (linear between samples, or held): `eha` by the motor's voltage,
// or, where that is not recorded, its hydraulic part by the flow into chamber A. Sensors' low-pass filters are
// applied to the sampled outputs and to their sensitivities. Initial state: what is free, and the plant's slow states
// (`eha`: p_A, p_B, x), starts from ModelValues::initial_state; all other states start from the quasi-steady state that
// goes with them (their time derivatives are zero), which is differentiated too.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/deadline.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

struct Law;
struct LawParameter;

/// Everything that a simulation depends on besides the recording. SI units.
struct ModelValues {
  std::vector<double> parameters;  ///< in the order of PlantDescription::parameters, then those of the asset's physics
  double load_factor = 0.0;        ///< Phi of this recording: load = phi (1 + Phi)
  std::vector<double> initial_state;  ///< in the order of PlantSimulation::state_names()
  /// (1 + gain) signal + offset, in the order of PlantSimulation::sensors().
  std::vector<double> sensor_gain = {}, sensor_offset = {};
};

/// One quantity with respect to which outputs are differentiated. Made by PlantSimulation::find.
struct FreeQuantity {
  /// The last five are what a recording is off by (services/common/model/recorded_input.hpp).
  enum class Kind {
    parameter,
    load_factor,
    initial_state,
    sensor_gain,
    sensor_offset,
    input_gain,
    input_bias,
    input_delay,
    input_clock_rate,
    clock_rate
  };
  Kind kind = Kind::parameter;
  std::size_t index = 0;  ///< into the member of ModelValues, or among PlantSimulation::inputs()
  [[nodiscard]] bool is_of_sensor() const { return kind == Kind::sensor_gain || kind == Kind::sensor_offset; }
  [[nodiscard]] bool is_of_recording() const { return kind >= Kind::input_gain; }
  [[nodiscard]] double& in(ModelValues& values) const;
  [[nodiscard]] double in(const ModelValues& values) const;
};

/// Steps are no longer than this or, where samples are far apart, than a sixteenth of the shortest distance between two of
/// them, so that no event of the input is stepped over.
inline constexpr double kLongestStep_s = 0.25;
[[nodiscard]] double longest_step_s(std::span<const double> times_s);

struct SimulationOptions {
  double relative_tolerance = 1e-6;  ///< of each step, per state; the absolute one is this times the state's usual size
  double maximum_step_s = 1e300;     ///< beside kLongestStep_s
  std::size_t maximum_steps = 200000;
  /// Above 0: measured states are held to their recorded course within so many seconds, and the run is no free one.
  double held_within_s = 0.0;
  const Deadline* deadline = nullptr;  ///< when it passes the run ends, as an Error
};

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct SimulatedOutputs {
  RowMatrix values;         ///< samples x channels
  RowMatrix sensitivities;  ///< (samples * channels) x free quantities; row = sample * channels + channel
  std::size_t steps = 0;    ///< of the integrator
  std::size_t points = 0;   ///< at which sensors were passed the signal
  std::size_t linearisations = 0;
};

/// A parameter of a law in the asset's `physics`.
struct PhysicsParameter {
  std::string name;  ///< "piston.coulomb_friction.F_c"
  const Law* law = nullptr;
  const LawParameter* parameter = nullptr;
  ParameterSetting setting;
};
[[nodiscard]] std::string physics_parameter_name(std::string_view element, std::string_view id,
                                                 std::string_view parameter);

/// "sensor:flow.gain_error" and "sensor:flow.offset_error".
[[nodiscard]] std::string sensor_gain_name(std::string_view channel);
[[nodiscard]] std::string sensor_offset_name(std::string_view channel);

/// Contributions at sites that are given from outside, each a direction of differentiation: dS/dt = J S + df/dextra
/// w(t). This is how laws that are not in the model (strength 0) and unknown inputs are looked at.
class InjectedColumns {
 public:
  struct Entry {
    std::size_t column = 0;  ///< several entries may feed one column
    std::size_t site = 0;
  };
  using Signals = std::span<const std::array<double, kSiteSignals>>;
  virtual ~InjectedColumns() = default;
  [[nodiscard]] virtual std::size_t columns() const = 0;
  [[nodiscard]] virtual std::span<const Entry> entries() const = 0;
  /// w at time t for each entry, from the signals of all sites. Called at the ends of steps. Where an input jumps, time
  /// goes back to before the last end: that step passed the jump, and what it saw there was not.
  virtual void weigh(double t, Signals signals, std::span<double> weights) = 0;
};

/// One recording, ready to be simulated as often as wanted. Immutable, so that threads may share it.
class PlantSimulation {
 public:
  virtual ~PlantSimulation() = default;

  /// An Error when the model is unknown, a needed input is not recorded or no simulated output is.
  [[nodiscard]] static Result<std::unique_ptr<PlantSimulation>> create(const AssetConfig& asset,
                                                                       const TimeSeries& recorded);

  [[nodiscard]] virtual const PlantDescription& plant() const = 0;
  /// The recorded output channels that the plant simulates: the columns of all matrices.
  [[nodiscard]] virtual std::span<const std::string> channels() const = 0;
  /// "z", "i", "omega", ...
  [[nodiscard]] virtual std::span<const std::string> state_names() const = 0;
  /// The states whose initial values should be estimated with every recording: p_A, p_B, x.
  [[nodiscard]] virtual std::span<const std::string> slow_state_names() const = 0;
  /// Between what the initial value of a law's hidden state lies; unbounded for the plant's own states.
  [[nodiscard]] virtual std::pair<double, double> initial_range(std::string_view state) const = 0;
  /// Those, and the states that are known where a recording begins but not in its midst (at rest before a test).
  [[nodiscard]] virtual std::span<const std::string> free_state_names() const = 0;
  /// The asset's parameters, the initial state from the first samples, the load factor from the mean force balance.
  [[nodiscard]] virtual const ModelValues& start() const = 0;
  /// Recorded samples of channels(): samples x channels.
  [[nodiscard]] virtual const RowMatrix& recorded() const = 0;
  /// Where laws may act; empty: nowhere in this plant.
  [[nodiscard]] virtual std::span<const Site> sites() const = 0;
  /// The recorded channels that drive the simulation.
  [[nodiscard]] virtual std::span<const std::string> inputs() const = 0;
  /// channels(), then the inputs that sensors of the plant measured (the flow into a cylinder that is simulated alone).
  [[nodiscard]] virtual std::span<const std::string> sensors() const = 0;
  /// Smallest and largest recorded value of an input.
  [[nodiscard]] virtual std::pair<double, double> input_range(std::size_t input) const = 0;
  /// Parameters of the asset's physics, in the order in which they follow the plant's in ModelValues::parameters.
  [[nodiscard]] virtual std::span<const PhysicsParameter> physics_parameters() const = 0;

  /// "R_CL" (a parameter's name, or that of a law: "piston.coulomb_friction.F_c"), "load_factor", "initial:p_A" or what
  /// a sensor is off by ("sensor:flow.gain_error", "sensor:flow.offset_error"); an Error with the nearest name otherwise.
  [[nodiscard]] Result<FreeQuantity> find(std::string_view quantity) const;

  /// An Error when the integration fails (parameters that no step size can follow).
  /// Columns of the sensitivities: free quantities, then the injected ones.
  [[nodiscard]] virtual Result<SimulatedOutputs> run(const ModelValues& values, std::span<const FreeQuantity> free,
                                                     const SimulationOptions& options = {},
                                                     InjectedColumns* injected = nullptr) const = 0;

  /// A law of the recording, or of an input's sensor. `input`: index among inputs(); a clock has none.
  struct RecordingLaw {
    SiteKind kind = SiteKind::input_gain;
    std::size_t input = 0;
  };
  /// d values / d strength of laws that are not in force, a column each; rows as of SimulatedOutputs::sensitivities.
  [[nodiscard]] virtual Result<RowMatrix> recording_columns(const ModelValues& values,
                                                            std::span<const RecordingLaw> laws,
                                                            const SimulationOptions& options = {}) const = 0;
};

}  // namespace sealwatch
