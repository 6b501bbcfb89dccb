#include "services/common/model/recording_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "services/common/model/sensor_filter.hpp"
#include "services/common/model/sensor_laws.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

// Where sensors have a low-pass or a lag, coarser recordings are simulated at points between their samples too,
// because these filters take the signal as a parabola through points. A log of minutes is that of a slow plant.
constexpr double kLongestPointDistance_s = 0.0101;
constexpr double kMostPoints = 800.0;  // between two samples
// A filter forgets by exp(-age / time constant). Further back than kAllRemembered time constants points need not be as
// close: e times as far apart every kForgotten time constants, the error that each leaves still falls with age.
constexpr double kAllRemembered = 2.0, kForgotten = 4.0;
// After a jump of the input the integration starts anew, from the first order and a small step.
constexpr std::size_t kStepsOfARestart = 30;
constexpr std::size_t kManyJumps = 100;

// The system, held to the recorded course of its measured states where that is wanted.
RecordedSystem& held(const RecordedSimulation& simulation, const RecordedInput& input, RecordedSystem& system,
                     const SimulationOptions& options) {
  if (!(options.held_within_s > 0.0)) return system;
  const ModelValues& start = simulation.start();
  std::vector<MeasuredStates::State> states;
  for (std::size_t k = 0; k < simulation.simulated_channels().size(); ++k) {
    const int state = simulation.simulated_channels()[k].state;
    if (state < 0) continue;
    const double gain = 1.0 + start.sensor_gain[k], smoothed_s = MeasuredStates::kSmoothed * options.held_within_s;
    const Eigen::ArrayXd recorded =
        (simulation.recorded().col(static_cast<Eigen::Index>(k)).array() - start.sensor_offset[k]) / gain;
    states.push_back({.state = state,
                      .recorded = {input.times(),
                                   {recorded.begin(), recorded.end()},
                                   simulation.recorded_noise()[k] / std::abs(gain),
                                   smoothed_s}});
  }
  if (states.empty()) return system;
  system.hold_to({input.times().front(), std::move(states), options.held_within_s}, start.initial_state);
  return system;
}

class RecordingRun {
 public:
  RecordingRun(const RecordedSimulation& simulation, const RecordedInput& input, RecordedSystem& system,
               const ModelValues& values, std::span<const FreeQuantity> free, const SimulationOptions& options,
               const InjectedColumns* injected)
      : simulation_(simulation),
        input_(input),
        free_(free),
        columns_(1 + free.size() + (injected == nullptr ? 0 : injected->columns())),
        system_(held(simulation, input, system, options)),
        scale_(system_.scale(options.relative_tolerance)),
        deadline_(options.deadline),
        most_steps_(options.maximum_steps + kStepsOfARestart * (std::max<std::size_t>(input.segment_count(), 1) - 1)),
        owned_(system_.integrator(static_cast<int>(columns_) - 1, scale_,
                                  {.maximum_step = std::min(options.maximum_step_s, longest_step_s(input.times())),
                                   .maximum_steps = most_steps_,
                                   .maximum_order = system_.maximum_order()})),
        integrator_(*owned_),
        point_(integrator_.size(), 0.0) {
    const std::vector<SensorTerm>& laws = simulation.terms().sensors;
    for (const SimulatedChannel& channel : simulation.simulated_channels()) {
      filters_.emplace_back(channel.time_constant_s, columns_);
      filtered_ = filtered_ || channel.time_constant_s > 0.0;
      memory_s_ = std::max(memory_s_, channel.time_constant_s);
      if (channel.state < 0) computed_.push_back(channel.output);
    }
    signals_.resize(computed_.size() * columns_);
    double lag_s = 0.0;
    for (const SensorTerm& term : laws) {
      if (term.kind != SiteKind::sensor_lag) continue;
      filtered_ = true;
      lag_s = std::max(lag_s, values.parameters[term.parameter]);
    }
    memory_s_ += lag_s;
    for (std::size_t c = 0; !laws.empty() && c < filters_.size(); ++c)
      sensors_.emplace_back(laws, simulation.channels()[c], values, free, columns_);
    const Eigen::Index rows = simulation.recorded().rows(), channels = simulation.recorded().cols();
    outputs_.values.resize(rows, channels);
    outputs_.sensitivities.resize(rows * channels, static_cast<Eigen::Index>(columns_) - 1);
  }

  /// Whether an event ended the run that sensitivities do not cross; without columns it goes on.
  [[nodiscard]] bool stopped_by_event() const { return stopped_by_event_; }

  [[nodiscard]] Result<SimulatedOutputs> simulate(const ModelValues& values) {
    if (!initial_point(values)) return no_start();
    filtered_until_ = input_.times().front();
    if (!has_events()) {
      pass_sensors(filtered_until_, point_.data());
      sample(next_++);
    }
    for (std::size_t segment = 0; segment < input_.segment_count(); ++segment)
      if (!run_segment(segment)) return failure(integrator_.time());
    outputs_.steps = integrator_.statistics().steps;
    outputs_.linearisations = integrator_.statistics().linearisations;
    return std::move(outputs_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> no_start() const {
    return fail(Error{.file = {},
                      .place = "t = " + text::general(input_.times().front()) + " s",
                      .value = system_.trouble(),
                      .rule = "the simulation has no start: the states that settle there find no rest",
                      .advice = "check the start of the others, or let fewer states settle"});
  }

  [[nodiscard]] tl::unexpected<Error> failure(double time) const {
    if (passed(deadline_)) return fail("the simulation was ended: its time was up");
    if (at_once_ > kMostAtOnce)
      return fail(Error{.file = {},
                        .place = "t = " + text::general(time) + " s",
                        .value = system_.trouble(),
                        .rule = "events follow each other without end: something in the model switches to and fro, as "
                                "dry friction where it sticks",
                        .advice = "give what switches a hysteresis, or round it (tanh for the sign of a speed)"});
    if (integrator_.statistics().steps >= most_steps_)
      return fail(Error{
          .file = {},
          .place = "t = " + text::general(time) + " s",
          .value = system_.trouble(),
          .rule = "the simulation was given up after " + std::to_string(most_steps_) + " steps",
          .advice = std::string("something explodes, swings fast or is integrated too finely: check the parameters' "
                                "values and the sizes of the states") +
                    (input_.segment_count() > kManyJumps ? "; an input that is held jumps at every sample: 'course: "
                                                           "averaged' in the plant's file takes fewer steps"
                                                         : "")});
    if (std::string words = system_.said(); !words.empty())
      return fail(went_no_further("t = " + text::general(time) + " s", std::move(words)));
    return fail(Error{.file = {},
                      .place = "t = " + text::general(time) + " s",
                      .value = system_.trouble(),
                      .rule = "the simulation failed: no step size follows the equations from here",
                      .advice = "check the parameters' values and the recorded input around this time"});
  }

  // Held states and their seeds from the values, settled ones with them.
  [[nodiscard]] bool initial_point(const ModelValues& values) {
    const std::size_t stride = integrator_.stride();
    std::vector<bool> fast = system_.settled();
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (free_[k].kind != FreeQuantity::Kind::initial_state) continue;
      fast[free_[k].index] = false;
      point_[free_[k].index * stride + 1 + k] = 1.0;
    }
    std::vector<double> state = values.initial_state;
    state.resize(static_cast<std::size_t>(integrator_.states()), 0.0);
    if (!system_.start(free_, state.data(), point_.data(), stride)) return false;
    const std::vector<double> finest = system_.scale(SimulationOptions{}.relative_tolerance);  // or none is found
    if (!system_.settle(input_.times().front(), fast, finest, state, point_.data(), stride)) return false;
    for (int k = 0; k < integrator_.states(); ++k) point_[k * stride] = state[k];
    return true;
  }

  // The integrator may step beyond the segment's end, where the held input is continued: no step is shortened.
  [[nodiscard]] bool run_segment(std::size_t segment) {
    system_.set_segment(segment);
    event_s_ = kNoEvent;
    const double begin = input_.segment_begin(segment);
    if (segment > 0) system_.cross_jump(begin, point_.data(), integrator_.stride());
    if (!has_events()) return integrator_.start(begin, point_.data()) && run_samples(segment);
    if (!pass_event(begin)) return false;  // the input may have jumped: a sample here shows what comes after
    if (next_ < input_.times().size() && input_.times()[next_] == begin) {
      pass_sensors(begin, point_.data());
      sample(next_++);
    }
    return run_samples(segment);
  }

  [[nodiscard]] bool has_events() const { return system_.has_events(); }

  [[nodiscard]] bool run_samples(std::size_t segment) {
    const std::vector<double>& times = input_.times();
    const double end = input_.segment_end(segment);
    const bool jumps = has_events() && segment + 1 < input_.segment_count();
    double last = input_.segment_begin(segment);
    for (; next_ < times.size() && times[next_] <= end; last = times[next_++]) {
      if (!pass_points(last, times[next_])) return false;
      if (jumps && times[next_] == end) return true;
      sample(next_);
    }
    return last == end || pass_points(last, end);  // a held input that acts late jumps between samples
  }

  [[nodiscard]] bool pass_points(double begin, double end) {
    const double distance = end - begin;
    double last = distance;  // before the end
    for (const std::vector<double>& ages = ages_of_points(distance); const double age : ages) {
      if (!advance_to(end - age, last - age)) return false;
      last = age;
    }
    return advance_to(end, last);
  }

  // How long before its end a distance between samples has points, the oldest first.
  [[nodiscard]] const std::vector<double>& ages_of_points(double distance) {
    if (distance == distance_of_ages_) return ages_;
    distance_of_ages_ = distance;
    ages_.clear();
    if (!filtered_ || distance <= kLongestPointDistance_s) return ages_;
    const double step = distance / std::min(std::ceil(distance / kLongestPointDistance_s), kMostPoints);
    constexpr double kAlmost = 1.0 - 1e-9;  // as the sum of all steps is rounded
    for (double age = step; age < kAlmost * distance;) {
      ages_.push_back(age);
      const double forgotten = (age / memory_s_ - kAllRemembered) / kForgotten;
      age += step * std::exp(std::max(forgotten, 0.0));
    }
    std::ranges::reverse(ages_);
    return ages_;
  }

  // Steps until `time` is reached and passes the sensors the signal there, and at the ends of steps that are shorter
  // than the distance between points: there the signal moves too fast to be a parabola.
  [[nodiscard]] bool advance_to(double time, double distance) {
    if (time_is_up()) return false;
    if (integrator_.states() == 0) return pass_known_events(time) && (pass_sensors(time, point_.data()), true);
    while (integrator_.time() < time || event_s_ <= time) {
      if (event_s_ <= integrator_.time()) {
        integrator_.interpolate(event_s_, point_.data());
        if (!pass_event(event_s_)) return false;
        continue;
      }
      const double begin = integrator_.time();
      if (time_is_up() || !integrator_.step()) return false;
      if (has_events()) look_for_event(begin);
      const double end = std::min(integrator_.time(), event_s_);
      if (filtered_ && end < time && end > filtered_until_ && end - begin < distance) {
        integrator_.interpolate(end, point_.data());
        pass_sensors(end, point_.data());
      }
    }
    integrator_.interpolate(time, point_.data());
    pass_sensors(time, point_.data());
    return true;
  }

  // A look at the clock costs as much as a short step.
  [[nodiscard]] bool time_is_up() {
    constexpr unsigned kEvery = 32;
    return asked_++ % kEvery == 0 && passed(deadline_);
  }

  // Without states nothing moves by itself, but at events.
  [[nodiscard]] bool pass_known_events(double time) {
    while (has_events() && system_.next_event_s() <= time)
      if (!pass_event(system_.next_event_s())) return false;
    return true;
  }

  // Finds the first event of the last step, by halving where only its two sides are known.
  void look_for_event(double begin) {
    const double end = std::min(integrator_.time(), std::max(begin, system_.next_event_s()));
    if (!event_before(end)) {
      const bool known_before = end < integrator_.time() || end == system_.next_event_s();
      if (known_before || system_.accept(end, states_at(end))) event_s_ = end;
      return;
    }
    double before = begin, after = end;
    constexpr double kPrecision = 1e-13;
    while (after - before > kPrecision * std::max(1.0, std::abs(after))) {
      const double middle = 0.5 * (before + after);
      if (middle <= before || middle >= after) break;
      (event_before(middle) ? after : before) = middle;
    }
    event_s_ = after;
  }

  [[nodiscard]] const double* states_at(double time) {
    integrator_.interpolate(time, point_.data());
    event_state_.resize(static_cast<std::size_t>(integrator_.states()));
    for (std::size_t k = 0; k < event_state_.size(); ++k) event_state_[k] = point_[k * integrator_.stride()];
    return event_state_.data();
  }
  [[nodiscard]] bool event_before(double time) { return system_.event_before(time, states_at(time)); }

  // An event at the point: states after it, and the integration starts anew. Sensitivities cross what is smooth.
  [[nodiscard]] bool pass_event(double time) {
    event_s_ = kNoEvent;
    if (has_events()) {
      at_once_ = time - last_event_s_ < at_once_s() ? at_once_ + 1 : 0;
      last_event_s_ = time;
      if (at_once_ > kMostAtOnce) return false;
      std::vector<double> state(static_cast<std::size_t>(integrator_.states()));
      for (std::size_t k = 0; k < state.size(); ++k) state[k] = point_[k * integrator_.stride()];
      const auto outcome = system_.pass_event(time, state.data());
      if (outcome == RecordedSystem::Passed::failed) return false;
      const bool at_begin = time <= input_.times().front();  // nothing has happened yet
      if (outcome == RecordedSystem::Passed::jump && columns_ > 1 && !at_begin) return stopped_by_event_ = true, false;
      for (std::size_t k = 0; k < state.size(); ++k) point_[k * integrator_.stride()] = state[k];
    }
    return integrator_.states() == 0 || integrator_.start(time, point_.data());
  }

  // Events that follow each other so soon, again and again, end nowhere: what sticks is switched to and fro.
  [[nodiscard]] double at_once_s() const {
    constexpr double kShareOfDistance = 1e-5;
    const std::vector<double>& times = input_.times();
    const double distance_s = (times.back() - times.front()) / static_cast<double>(times.size());
    return std::max(1e-9, kShareOfDistance * distance_s);
  }

  void pass_sensors(double time, const double* point) {
    ++outputs_.points;
    if (!computed_.empty()) system_.outputs(computed_, time, point, integrator_.stride(), signals_.data());
    const double* computed = signals_.data();
    for (std::size_t c = 0; c < filters_.size(); ++c) {
      const int state = simulation_.simulated_channels()[c].state;
      filters_[c].advance(time - filtered_until_, state < 0 ? computed : point + state * integrator_.stride());
      if (state < 0) computed += columns_;
      if (!sensors_.empty()) sensors_[c].advance(time - filtered_until_, filters_[c].output());
    }
    filtered_until_ = time;
  }

  void sample(std::size_t row) {
    const auto first = static_cast<Eigen::Index>(row * filters_.size());
    double* sensitivities = outputs_.sensitivities.data() + first * outputs_.sensitivities.cols();
    double* values = outputs_.values.data() + first;
    for (std::size_t c = 0; c < filters_.size(); ++c) {
      const std::vector<double>& output = sensors_.empty() ? filters_[c].output() : sensors_[c].output();
      *values++ = output.front();
      sensitivities = std::copy(output.begin() + 1, output.end(), sensitivities);
    }
  }

  const RecordedSimulation& simulation_;
  const RecordedInput& input_;
  std::span<const FreeQuantity> free_;
  std::size_t columns_;
  RecordedSystem& system_;
  std::vector<double> scale_;
  const Deadline* deadline_;
  std::size_t most_steps_;
  std::unique_ptr<BackwardDifferences> owned_;
  BackwardDifferences& integrator_;
  std::vector<double> point_;
  std::vector<int> computed_;    ///< outputs that are no states, in the order of the channels
  std::vector<double> signals_;  ///< of these
  std::vector<SensorFilter> filters_;
  std::vector<SensorLaws> sensors_;  ///< empty where no sensor has a law
  SimulatedOutputs outputs_;
  std::size_t next_ = 0;         ///< sample that has not been taken yet
  double filtered_until_ = 0.0;  ///< time of the sensors' last point
  bool filtered_ = false;        ///< some channel has a low-pass or a lag
  double memory_s_ = 0.0;        ///< time constant of the slowest of them
  std::vector<double> ages_;     ///< of points, for the last distance
  double distance_of_ages_ = 0.0;
  static constexpr double kNoEvent = std::numeric_limits<double>::infinity();
  double event_s_ = kNoEvent;  ///< that lies within the last step and is not passed yet
  double last_event_s_ = -kNoEvent;
  static constexpr int kMostAtOnce = 1000;
  int at_once_ = 0;
  bool stopped_by_event_ = false;
  unsigned asked_ = 0;  ///< for the time
  std::vector<double> event_state_;
};

}  // namespace

RecordingRunResult run_over_recording(const RecordedSimulation& simulation, const RecordedInput& input,
                                      RecordedSystem& system, const ModelValues& values,
                                      std::span<const FreeQuantity> free, const SimulationOptions& options,
                                      const InjectedColumns* injected) {
  RecordingRun run(simulation, input, system, values, free, options, injected);
  Result<SimulatedOutputs> outputs = run.simulate(values);
  return {.outputs = std::move(outputs), .stopped_by_event = run.stopped_by_event()};
}

}  // namespace sealwatch
