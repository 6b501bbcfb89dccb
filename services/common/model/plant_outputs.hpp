// PlantSystem with what RecordingRun asks for besides its equations: allowed errors, states that settle, outputs that
// are no state with their derivatives.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "services/common/model/plant_system.hpp"

namespace sealwatch {

template <class Model, int Width, bool WithPhysics>
class RecordedPlantSystem : public PlantSystem<Model, Width, WithPhysics> {
 public:
  using System = PlantSystem<Model, Width, WithPhysics>;
  using System::kStates;
  using Vector = typename SquareSystem<kStates>::Vector;
  using Mask = typename SquareSystem<kStates>::Mask;

  RecordedPlantSystem(const RecordedInput& input, const PhysicsTerms& terms, const ModelValues& values,
                      std::span<const FreeQuantity> free, InjectedColumns* injected)
      : System(input, terms, values, free, injected),
        terms_(terms),
        injected_(injected),
        free_(free.size()),
        columns_(1 + free.size() + (injected == nullptr ? 0 : injected->columns())) {}

  [[nodiscard]] int maximum_order() const { return Model::kMaximumOrder; }
  [[nodiscard]] std::string trouble() const { return {}; }

  [[nodiscard]] Vector scale(double relative_tolerance) const {
    Vector scale;
    scale.fill(relative_tolerance / 1e-6);
    for (int k = 0; k < System::kPlantStates; ++k) scale[k] *= Model::kScale[k];
    for (std::size_t k = 0; k < terms_.hidden_scales.size(); ++k)
      scale[static_cast<std::size_t>(System::kPlantStates) + k] *= kHiddenShare * terms_.hidden_scales[k];
    return scale;
  }

  [[nodiscard]] Mask settled() const {
    Mask fast{};
    std::copy(Model::kQuasiSteady.begin(), Model::kQuasiSteady.end(), fast.begin());
    if constexpr (WithPhysics)
      for (const ActiveTerm& term : terms_.active)
        if (term.hidden >= 0 && term.law->hidden->settled)
          fast[static_cast<std::size_t>(System::kPlantStates + term.hidden)] = true;
    return fast;
  }

  void output(int which, double t, const double* point, std::size_t stride, double* signal) const {
    if constexpr (WithPhysics)
      injected_ != nullptr ? with_physics<kStates + static_cast<int>(System::kSites)>(which, t, point, stride, signal)
                           : with_physics<kStates>(which, t, point, stride, signal);
    else
      of_blocks(which, t, point, stride, signal);
    for (const auto& column : this->recording()) add_recording_part(which, column, t, point, stride, signal);
  }

 private:
  // What the recording is off by moves the output itself where it sees the input; the clock moves no value of it.
  template <class Column>
  void add_recording_part(int which, const Column& column, double t, const double* point, std::size_t stride,
                          double* signal) const {
    if (column.quantity.kind == FreeQuantity::Kind::clock_rate) return;
    const auto state = plain(point, stride);
    const auto value = [&](const typename System::Equations::Input& input) -> std::array<double, 1> {
      if constexpr (WithPhysics) {
        const auto extra = this->template extra<double>(state, input, this->values());
        return {evaluate_output(which, System::plant_state(state), input, this->values().plant, extra)};
      } else {
        return {Model::output(which, state, input, this->values().plant)};
      }
    };
    signal[column.place] += this->by_input(column.quantity, t, value)[0];
  }

  // dh/dp + dh/dy S by dual numbers whose states carry S.
  void of_blocks(int which, double t, const double* point, std::size_t stride, double* signal) const {
    const auto input = this->input_at(t);
    if (this->blocks().empty()) signal[0] = Model::output(which, plain(point, stride), input, this->values().plant);
    for (const auto& block : this->blocks()) {
      const auto result = Model::output(which, seeded(point, stride, block), input, block.values.plant);
      signal[0] = result.value;
      std::copy(result.derivative.begin(), result.derivative.begin() + block.count, signal + 1 + block.first);
    }
  }

  [[nodiscard]] static auto plain(const double* point, std::size_t stride) {
    typename System::template State<double> state;
    for (int k = 0; k < kStates; ++k) state[k] = point[k * stride];
    return state;
  }

  template <class Block>
  [[nodiscard]] static auto seeded(const double* point, std::size_t stride, const Block& block) {
    typename System::template State<Dual<Width>> state;
    for (int k = 0; k < kStates; ++k) {
      state[k].value = point[k * stride];
      const double* seeds = point + k * stride + 1 + block.first;
      std::copy(seeds, seeds + block.count, state[k].derivative.begin());
    }
    return state;
  }

  template <class State, class Input, class Parameters, class Extra>
  static auto evaluate_output(int which, const State& y, const Input& input, const Parameters& p, const Extra& extra) {
    if constexpr (requires { Model::output(which, y, input, p, extra); })
      return Model::output(which, y, input, p, extra);
    else
      return Model::output(which, y, input, p);
  }

  // The same with what the laws add, and for the injected columns through the gradients by state and by site.
  template <int Directions>
  void with_physics(int which, double t, const double* point, std::size_t stride, double* signal) const {
    using Gradient = Dual<Directions>;
    const auto input = this->input_at(t);
    typename System::template State<Gradient> state;
    for (int k = 0; k < kStates; ++k) state[k] = Gradient::variable(point[k * stride], k);
    auto extra = this->template extra<Gradient>(state, input, this->values());
    if constexpr (Directions > kStates)
      for (std::size_t site = 0; site < System::kSites; ++site)
        extra[site].derivative[static_cast<std::size_t>(kStates) + site] += 1.0;
    const Gradient result = evaluate_output(which, System::plant_state(state), input, this->values().plant, extra);
    signal[0] = result.value;
    std::fill(signal + 1, signal + columns_, 0.0);
    for (int k = 0; k < kStates; ++k) {
      const double slope = result.derivative[static_cast<std::size_t>(k)];
      if (slope == 0.0) continue;  // an output shows few states
      for (std::size_t column = 1; column < columns_; ++column) signal[column] += slope * point[k * stride + column];
    }
    if constexpr (Directions > kStates)
      for (std::size_t e = 0; e < injected_->entries().size(); ++e) {
        const auto [column, site] = injected_->entries()[e];
        signal[1 + free_ + column] += result.derivative[static_cast<std::size_t>(kStates) + site] * this->weights()[e];
      }
    add_parameter_part(which, plain(point, stride), input, signal);
  }

  template <class State, class Input>
  void add_parameter_part(int which, const State& state, const Input& input, double* signal) const {
    for (const auto& block : this->blocks()) {
      if (!block.has_parameters) continue;
      const auto extra = this->template extra<Dual<Width>>(state, input, block.values);
      const Dual<Width> result = evaluate_output(which, System::plant_state(state), input, block.values.plant, extra);
      for (int k = 0; k < block.count; ++k)
        signal[static_cast<std::size_t>(1 + block.first + k)] += result.derivative[k];
    }
  }

  const PhysicsTerms& terms_;
  InjectedColumns* injected_;
  std::size_t free_, columns_;
};

}  // namespace sealwatch
