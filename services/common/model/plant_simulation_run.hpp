// One run of a PlantSimulationOf (included by plant_simulation.hpp).
#pragma once

namespace sealwatch {

/// Where sensors have a low-pass or a lag, coarser recordings are simulated at points between their samples too,
/// because these filters take the signal as linear from point to point.
inline constexpr double kLongestPointDistance_s = 0.0051;

template <class Model>
template <int Width, bool WithPhysics>
class PlantSimulationOf<Model>::Run {
 public:
  using System = PlantSystem<Model, Width, WithPhysics>;
  static constexpr int kStates = System::kStates;
  using Integrator = Bdf<System>;
  using Vector = typename Integrator::Vector;

  Run(const PlantSimulationOf& simulation, const ModelValues& values, std::span<const FreeQuantity> free,
      const SimulationOptions& options, InjectedColumns* injected)
      : simulation_(simulation),
        free_(free),
        columns_(1 + free.size() + (injected == nullptr ? 0 : injected->columns())),
        injected_(injected),
        system_(simulation.input_, simulation.terms_, values, free, injected),
        scale_(scaled(simulation.terms_, options.relative_tolerance)),
        integrator_(system_, static_cast<int>(columns_) - 1, scale_,
                    {.maximum_step = options.maximum_step_s,
                     .maximum_steps = options.maximum_steps,
                     .maximum_order = Model::kMaximumOrder}),
        point_(integrator_.size(), 0.0),
        signal_(columns_, 0.0) {
    for (const SimulatedChannel& channel : simulation.channels_) {
      filters_.emplace_back(channel.time_constant_s, columns_);
      filtered_ = filtered_ || channel.time_constant_s > 0.0;
    }
    for (const SensorTerm& term : simulation.terms_.sensors) filtered_ = filtered_ || term.kind == SiteKind::sensor_lag;
    if constexpr (WithPhysics)
      for (std::size_t c = 0; c < simulation.channels_.size(); ++c)
        sensors_.emplace_back(simulation.terms_.sensors, simulation.channel_names_[c], values, free, columns_);
    const Eigen::Index rows = simulation.recorded_.rows(), channels = simulation.recorded_.cols();
    outputs_.values.resize(rows, channels);
    outputs_.sensitivities.resize(rows * channels, static_cast<Eigen::Index>(columns_) - 1);
  }

  [[nodiscard]] Result<SimulatedOutputs> simulate(const ModelValues& values) {
    const RecordedInput& input = simulation_.input_;
    if (!initial_point(values)) return failure(input.times().front());
    filtered_until_ = input.times().front();
    pass_sensors(filtered_until_, point_.data());
    sample(0);
    for (std::size_t segment = 0; segment < input.segment_count(); ++segment)
      if (!run_segment(segment)) return failure(integrator_.time());
    outputs_.steps = integrator_.statistics().steps;
    outputs_.linearisations = integrator_.statistics().linearisations;
    return std::move(outputs_);
  }

 private:
  static Vector scaled(const PhysicsTerms& terms, double relative_tolerance) {
    constexpr double kHiddenShare = 1e-5;  // of a hidden state's usual size at the relative tolerance 1e-6
    Vector scale;
    scale.fill(relative_tolerance / 1e-6);
    for (int k = 0; k < System::kPlantStates; ++k) scale[k] *= Model::kScale[k];
    for (std::size_t k = 0; k < terms.hidden_scales.size(); ++k)
      scale[static_cast<std::size_t>(System::kPlantStates) + k] *= kHiddenShare * terms.hidden_scales[k];
    return scale;
  }

  [[nodiscard]] static tl::unexpected<Error> failure(double time) {
    return fail(Error{.file = {},
                      .place = "t = " + std::to_string(time) + " s",
                      .value = {},
                      .rule = "the simulation failed: no step size follows the equations from here",
                      .advice = "check the parameters' values and the recorded input around this time"});
  }

  // Held states and their seeds from the values, quasi-steady ones with them.
  [[nodiscard]] bool initial_point(const ModelValues& values) {
    const std::size_t stride = integrator_.stride();
    std::array<bool, kStates> fast{};
    std::copy(Model::kQuasiSteady.begin(), Model::kQuasiSteady.end(), fast.begin());
    if constexpr (WithPhysics)
      for (const ActiveTerm& term : simulation_.terms_.active)
        if (term.hidden >= 0 && term.law->hidden->settled)
          fast[static_cast<std::size_t>(System::kPlantStates + term.hidden)] = true;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (free_[k].kind != FreeQuantity::Kind::initial_state) continue;
      fast[free_[k].index] = false;
      point_[free_[k].index * stride + 1 + k] = 1.0;
    }
    Vector state{};
    std::copy(values.initial_state.begin(), values.initial_state.end(), state.begin());
    const double begin = simulation_.input_.times().front();
    QuasiSteadyState<System> rest(system_, begin, fast, scale_);
    if (!rest.solve(state) || !rest.differentiate(state, point_.data(), stride)) return false;
    for (int k = 0; k < kStates; ++k) point_[k * stride] = state[k];
    return true;
  }

  // The integrator may step beyond the segment's end, where the held input is continued: no step is shortened.
  [[nodiscard]] bool run_segment(std::size_t segment) {
    const RecordedInput& input = simulation_.input_;
    system_.set_segment(segment);
    if (!integrator_.start(input.segment_begin(segment), point_.data())) return false;
    for (; next_ < input.times().size() && input.times()[next_] <= input.segment_end(segment); ++next_) {
      const double last = input.times()[next_ - 1], distance = input.times()[next_] - last;
      const int points = filtered_ ? static_cast<int>(std::ceil(distance / kLongestPointDistance_s)) : 1;
      for (int k = 1; k <= points; ++k)
        if (!advance_to(k == points ? input.times()[next_] : last + distance * k / points, distance / points))
          return false;
      sample(next_);
    }
    return true;
  }

  // Steps until `time` is reached and passes the sensors the signal there, and at the ends of steps that are shorter
  // than the distance between points: there the signal moves too fast to be taken as linear.
  [[nodiscard]] bool advance_to(double time, double distance) {
    while (integrator_.time() < time) {
      const double begin = integrator_.time();
      if (!integrator_.step()) return false;
      const double end = integrator_.time();
      if (filtered_ && end < time && end > filtered_until_ && end - begin < distance)
        pass_sensors(end, integrator_.values());
    }
    integrator_.interpolate(time, point_.data());
    pass_sensors(time, point_.data());
    return true;
  }

  void pass_sensors(double time, const double* point) {
    for (std::size_t c = 0; c < filters_.size(); ++c) {
      const int output = simulation_.channels_[c].output;
      const int state = Model::kOutputs[output].state;
      if (state < 0) compute_output(output, point);
      const double* signal = state < 0 ? signal_.data() : point + state * integrator_.stride();
      filters_[c].advance(time - filtered_until_, signal);
      if constexpr (WithPhysics) sensors_[c].advance(time - filtered_until_, filters_[c].output());
    }
    filtered_until_ = time;
  }

  void sample(std::size_t row) {
    const auto first = static_cast<Eigen::Index>(row * filters_.size());
    double* sensitivities = outputs_.sensitivities.data() + first * outputs_.sensitivities.cols();
    double* values = outputs_.values.data() + first;
    for (std::size_t c = 0; c < filters_.size(); ++c) {
      const std::vector<double>* output = &filters_[c].output();
      if constexpr (WithPhysics) output = &sensors_[c].output();
      *values++ = output->front();
      sensitivities = std::copy(output->begin() + 1, output->end(), sensitivities);
    }
  }

  void compute_output(int output, const double* point) {
    if constexpr (WithPhysics)
      injected_ != nullptr ? output_with_physics<kStates + static_cast<int>(System::kSites)>(output, point)
                           : output_with_physics<kStates>(output, point);
    else
      output_of_blocks(output, point);
  }

  // dh/dp + dh/dy S by dual numbers whose states carry S.
  void output_of_blocks(int output, const double* point) {
    const std::size_t stride = integrator_.stride();
    const auto input = system_.input_at(integrator_.time());
    if (system_.blocks().empty()) {
      typename System::template State<double> state;
      for (int k = 0; k < kStates; ++k) state[k] = point[k * stride];
      signal_[0] = Model::output(output, state, input, system_.values().plant);
    }
    for (const auto& block : system_.blocks()) {
      const auto result = Model::output(output, seeded(point, block), input, block.values.plant);
      signal_[0] = result.value;
      std::copy(result.derivative.begin(), result.derivative.begin() + block.count, signal_.begin() + 1 + block.first);
    }
  }

  template <class Block>
  [[nodiscard]] auto seeded(const double* point, const Block& block) const {
    const std::size_t stride = integrator_.stride();
    typename System::template State<Dual<Width>> state;
    for (int k = 0; k < kStates; ++k) {
      state[k].value = point[k * stride];
      const double* seeds = point + k * stride + 1 + block.first;
      std::copy(seeds, seeds + block.count, state[k].derivative.begin());
    }
    return state;
  }

  template <class State, class Input, class Parameters, class Extra>
  static auto evaluate_output(int output, const State& y, const Input& input, const Parameters& p, const Extra& extra) {
    if constexpr (requires { Model::output(output, y, input, p, extra); })
      return Model::output(output, y, input, p, extra);
    else
      return Model::output(output, y, input, p);
  }

  // The same with what the laws add, and for the injected columns through the gradients by state and by site.
  template <int Directions>
  void output_with_physics(int output, const double* point) {
    using Gradient = Dual<Directions>;
    const std::size_t stride = integrator_.stride();
    const auto input = system_.input_at(integrator_.time());
    typename System::template State<Gradient> state;
    for (int k = 0; k < kStates; ++k) state[k] = Gradient::variable(point[k * stride], k);
    auto extra = system_.template extra<Gradient>(state, input, system_.values());
    if constexpr (Directions > kStates)
      for (std::size_t site = 0; site < System::kSites; ++site)
        extra[site].derivative[static_cast<std::size_t>(kStates) + site] += 1.0;
    const Gradient result = evaluate_output(output, System::plant_state(state), input, system_.values().plant, extra);
    signal_[0] = result.value;
    std::fill(signal_.begin() + 1, signal_.end(), 0.0);
    for (int k = 0; k < kStates; ++k)
      for (std::size_t column = 1; column < columns_; ++column)
        signal_[column] += result.derivative[static_cast<std::size_t>(k)] * point[k * stride + column];
    if constexpr (Directions > kStates)
      for (std::size_t e = 0; e < injected_->entries().size(); ++e) {
        const auto [column, site] = injected_->entries()[e];
        signal_[1 + free_.size() + column] +=
            result.derivative[static_cast<std::size_t>(kStates) + site] * system_.weights()[e];
      }
    add_parameter_part(output, point, input);
  }

  template <class Input>
  void add_parameter_part(int output, const double* point, const Input& input) {
    typename System::template State<double> state;
    for (int k = 0; k < kStates; ++k) state[k] = point[k * integrator_.stride()];
    for (const auto& block : system_.blocks()) {
      if (!block.has_parameters) continue;
      const auto extra = system_.template extra<Dual<Width>>(state, input, block.values);
      const Dual<Width> result = evaluate_output(output, System::plant_state(state), input, block.values.plant, extra);
      for (int k = 0; k < block.count; ++k)
        signal_[static_cast<std::size_t>(1 + block.first + k)] += result.derivative[k];
    }
  }

  const PlantSimulationOf& simulation_;
  std::span<const FreeQuantity> free_;
  std::size_t columns_;
  InjectedColumns* injected_;
  System system_;
  Vector scale_;
  Integrator integrator_;
  std::vector<double> point_, signal_;
  std::vector<SensorFilter> filters_;
  std::vector<SensorLaws> sensors_;  ///< with physics only
  SimulatedOutputs outputs_;
  std::size_t next_ = 1;
  double filtered_until_ = 0.0;  ///< time of the sensors' last point
  bool filtered_ = false;        ///< some channel has a low-pass or a lag
};

}  // namespace sealwatch
