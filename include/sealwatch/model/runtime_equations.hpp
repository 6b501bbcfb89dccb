// A plant that is known at run time only: its equations come from a text, or from a Functional Mock-up Unit.
//
//   dx/dt = f(t, x, u, du/dt, p, e)     derivatives, one a state                 x  states
//   s     = s(t, x, u, du/dt, p, e)     signals, kSiteSignals a site             u  inputs, du/dt their slopes
//   y     = y(t, x, u, du/dt, p, e)     outputs                                  p  parameters
//                                                                                e  what laws add, one a site
//
// An implementer gives a RuntimePlant: the plant's table (PlantDescription), what its states, inputs and outputs are,
// and RuntimeEquations, which make one RuntimeEvaluator for each run of a simulation. An evaluator has values and exact
// derivatives (or the best there are) of the three functions; everything else is done by sealwatch: integration with
// forward sensitivities, laws of the catalogue with their hidden states and their chain rule, injected columns,
// sensors' low-passes and laws, the load factor, fitting. add_plant() makes the plant known; from then on every command
// takes it by its name. Sizes follow from the table: f has states.size() rows, y outputs.size(), s kSiteSignals *
// sites.size(). Plants without states, inputs, sites are possible. All numbers are SI.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/core/deadline.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

struct RuntimeRun;
struct SimulatedOutputs;

enum class RuntimeFunction { derivatives, signals, outputs };

/// Where the functions are evaluated. The spans are valid during the call.
struct RuntimePoint {
  double time_s = 0.0;
  std::span<const double> states;
  std::span<const double> inputs;
  std::span<const double> input_rates;  ///< slopes of the recorded inputs; 0 where they are held
  std::span<const double> parameters;   ///< in the order of the table; they are the same in all calls of one run
  std::span<const double> added;        ///< e: contribution of the laws at each site, a loss is positive
  /// Of a run's first point: nothing is asked beyond this time.
  double last_time_s = std::numeric_limits<double>::infinity();
  const Deadline* deadline = nullptr;  ///< of a run's first point: of the run
};

struct RuntimeMatrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< row by row
  void resize(std::size_t new_rows, std::size_t new_columns) {
    rows = new_rows, columns = new_columns;
    values.assign(rows * columns, 0.0);
  }
  [[nodiscard]] double* row(std::size_t index) { return values.data() + index * columns; }
  [[nodiscard]] const double* row(std::size_t index) const { return values.data() + index * columns; }
};

/// Which derivatives of a function are asked for.
struct RuntimeDirections {
  bool states = false;
  bool parameters = false;
  bool added = false;
  bool operator==(const RuntimeDirections&) const = default;
};

struct RuntimeLinearisation {
  std::vector<double> values;
  RuntimeMatrix by_state;
  RuntimeMatrix by_parameter;  ///< a column for each parameter that the evaluator was asked to differentiate by
  RuntimeMatrix by_added;
};

/// Belongs to one run on one thread.
class RuntimeEvaluator {
 public:
  virtual ~RuntimeEvaluator() = default;
  /// Values of a function; false: it has none there (trouble() says why), and the integrator tries a shorter step.
  [[nodiscard]] virtual bool evaluate(RuntimeFunction function, const RuntimePoint& point,
                                      std::span<double> values) = 0;
  /// Values and the derivatives asked for; null: there are none there. Valid until the next call; matrices that were
  /// not asked for may hold anything.
  [[nodiscard]] virtual const RuntimeLinearisation* linearise(RuntimeFunction function, const RuntimePoint& point,
                                                              RuntimeDirections directions) = 0;
  /// What went wrong last, in words for the user; "": nothing that is known.
  [[nodiscard]] virtual std::string trouble() const { return {}; }

  /// Where states start by the equations' own account (RuntimeState::by_equations), and the derivatives by the parameters
  /// that the evaluator was asked to differentiate by; other states are left as they are.
  [[nodiscard]] virtual bool start(std::span<double>, RuntimeMatrix&) { return true; }

  // Events, where equations or states change at once. Points come in the order of time; what happens at an event is
  // remembered by the evaluator.
  [[nodiscard]] virtual bool has_events() const { return false; }
  /// When the next event is that is known beforehand.
  [[nodiscard]] virtual double next_event_s() const { return std::numeric_limits<double>::infinity(); }
  /// Whether an event lies between the last point that was accepted (or an event) and this one.
  [[nodiscard]] virtual bool event_before(const RuntimePoint&) { return false; }
  /// The integration has come to the point; true: there is an event at it.
  [[nodiscard]] virtual bool accept(const RuntimePoint&) { return false; }
  /// Passes an event: `states` are those after it. False where that fails (trouble()).
  [[nodiscard]] virtual bool pass_event(const RuntimePoint&, std::span<double>) { return true; }
};

/// Immutable, so that threads may share it.
class RuntimeEquations {
 public:
  virtual ~RuntimeEquations() = default;
  /// `first`: where the run begins, without what laws add; its parameters are those of the run. `differentiated`: indices
  /// of those by which it will ask for derivatives. An Error when the plant cannot be run (a unit that does not start).
  [[nodiscard]] virtual Result<std::unique_ptr<RuntimeEvaluator>> evaluator(
      const RuntimePoint& first, std::span<const std::size_t> differentiated) const = 0;
  /// All states at the first sample; those that settle only need a guess, and those that start by the equations any value.
  [[nodiscard]] virtual Result<std::vector<double>> initial_state(std::span<const double> parameters,
                                                                  const TimeSeries& recorded) const = 0;
  /// Whether signals of a site depend on what is added at sites before it (never on its own or on later ones).
  [[nodiscard]] virtual bool signals_see_added() const { return false; }
  /// Whether outputs depend on what is added otherwise than through the states.
  [[nodiscard]] virtual bool outputs_see_added() const { return true; }
  /// Whether runs are made elsewhere, by run(): where the equations are, so that not every value has to come from there.
  [[nodiscard]] virtual bool runs_elsewhere() const { return false; }
  [[nodiscard]] virtual Result<SimulatedOutputs> run(const RuntimeRun& run) const;
};

struct RuntimeState {
  double scale = 1.0;         ///< allowed local error of one step at the relative tolerance 1e-6
  bool slow = true;           ///< its initial value is each recording's own and is estimated
  bool settles = false;       ///< starts where its time derivative is zero, its neighbours being held
  bool by_equations = false;  ///< starts where RuntimeEvaluator::start() says
};

/// How a recorded input runs between samples.
enum class InputCourse {
  as_recorded,   ///< linear, or held where the recording says so
  band_limited,  ///< a cubic spline through the samples: of a signal without anything above half the sampling rate
  held,          ///< until the next sample, whatever the recording says
  averaged       ///< held, but simulated as linear between the means of neighbours: same delay and area, no jumps
};

struct RuntimeInput {
  std::string channel;
  InputCourse course = InputCourse::as_recorded;
  /// A measured input whose slope is used: value and slope are those of a parabola through the samples within this time
  /// on both sides. 0: as it is.
  double smoothing_s = 0.0;
};

struct RuntimeOutput {
  std::string channel;
  int state = -1;  ///< the state that it equals; -1: y computes it
};

struct RuntimePlant {
  PlantDescription description;  ///< states, sites in the order of x and e
  std::vector<RuntimeState> states;
  std::vector<RuntimeInput> inputs;    ///< that drive the plant and must be recorded, in the order of u
  std::vector<RuntimeOutput> outputs;  ///< in the order of y
  std::shared_ptr<const RuntimeEquations> equations;
  int maximum_order = 5;  ///< of the integrator; 2 where something oscillates almost undamped
  PlantPart whole = {};   ///< what drives it beside its inputs, if anything
};

/// Makes the plant known by its description's name, before other threads run. An Error when the name is taken.
Status add_plant(RuntimePlant plant);

}  // namespace sealwatch
