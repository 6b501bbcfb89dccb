// PlantSystem with its derivatives by the free quantities and its outputs that are no state: what depends on how many
// directions of differentiation are carried at once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "services/common/model/plant_system.hpp"

namespace sealwatch {

/// `Width` directions at once; free quantities beyond them make further blocks.
template <class Model, int Width, bool WithPhysics>
class RecordedPlantSystem final : public PlantSystem<Model, WithPhysics> {
 public:
  using System = PlantSystem<Model, WithPhysics>;
  using System::kStates;

  RecordedPlantSystem(const RecordedInput& input, const PhysicsTerms& terms, const ModelValues& values,
                      std::span<const FreeQuantity> free, InjectedColumns* injected)
      : System(input, terms, values, free, injected),
        injected_(injected),
        free_(free.size()),
        columns_(1 + free.size() + (injected == nullptr ? 0 : injected->columns())),
        outputs_see_laws_(outputs_see(terms)) {
    for (std::size_t first = 0; first < free.size(); first += Width)
      blocks_.push_back(make_block(values, free, static_cast<int>(first)));
  }

  void add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                 std::size_t stride) const override {
    const auto state = this->state_of(y);
    for (const Block& block : blocks_) {
      if (!block.has_parameters) continue;
      const auto result = this->template rates<Dual<Width>>(state, this->input_at(t), block.values);
      for (int row = 0; row < this->rows(); ++row)
        for (int k = 0; k < block.count; ++k)
          x[row * stride + 1 + block.first + k] += factor * result[row].derivative[k];
    }
    if constexpr (WithPhysics)
      if (injected_ != nullptr) this->add_injected(t, state, factor, x, stride);
    this->add_recording(t, state, factor, x, stride);
  }

  void outputs(std::span<const int> which, double t, const double* point, std::size_t stride,
               double* signals) const override {
    if constexpr (WithPhysics)
      injected_ != nullptr ? with_physics<kStates + static_cast<int>(System::kSites)>(which, t, point, stride, signals)
                           : with_physics<kStates>(which, t, point, stride, signals);
    else
      of_blocks(which, t, point, stride, signals);
    for (const auto& column : this->recording())
      for (std::size_t k = 0; k < which.size(); ++k)
        add_recording_part(which[k], column, t, point, stride, signals + k * columns_);
  }

 private:
  /// Consecutive free quantities first .. first + Width - 1 with the parameters seeded for them.
  struct Block {
    int first = 0;
    int count = 0;
    bool has_parameters = false;
    bool seen_by_outputs = false;  ///< some output depends on one of its parameters directly
    typename System::template Values<Dual<Width>> values;
  };

  static Block make_block(const ModelValues& values, std::span<const FreeQuantity> free, int first) {
    Block block;
    block.first = first;
    block.count = std::min(Width, static_cast<int>(free.size()) - first);
    System::assign(block.values, values);
    for (int k = 0; k < block.count; ++k) {
      const FreeQuantity& quantity = free[first + k];
      if (quantity.kind == FreeQuantity::Kind::initial_state || quantity.is_of_recording()) continue;
      block.has_parameters = true;
      const bool load = quantity.kind == FreeQuantity::Kind::load_factor;
      if (!load && quantity.index >= System::kPlantParameters) {
        block.values.laws[quantity.index - System::kPlantParameters].derivative[k] = 1.0;
      } else {
        const std::size_t parameter = load ? System::kPlantParameters : quantity.index;
        seed(block.values.plant, parameter, k);
        block.seen_by_outputs = block.seen_by_outputs || kSeen[parameter];
      }
    }
    return block;
  }

  /// Which parameters, the load factor behind them, some output depends on: one that is not a number leaves none. Made
  /// before main: a copy of the process (core/process_copy.hpp) would wait for the thread that was making it.
  using Seen = std::array<bool, System::kPlantParameters + 1>;
  static Seen seen_parameters() {
    Seen seen{};
    for (std::size_t which = 0; which < seen.size(); ++which) seen[which] = some_output_sees(which);
    return seen;
  }
  static inline const Seen kSeen = seen_parameters();
  static bool some_output_sees(std::size_t parameter) {
    typename System::Parameters parameters;
    std::size_t index = 0;
    parameters.visit(
        [&](std::string_view, double& value) {
          value = index++ == parameter ? std::numeric_limits<double>::quiet_NaN() : 1.0;
        },
        parameters);
    typename System::template PlantState<double> state;
    for (std::size_t k = 0; k < state.size(); ++k) state[k] = 1.0 + static_cast<double>(k);
    for (std::size_t k = 0; k < Model::kOutputs.size(); ++k)
      if (Model::kOutputs[k].state < 0 && std::isnan(Model::output(static_cast<int>(k), state, {}, parameters)))
        return true;
    return false;
  }

  static void seed(typename System::Equations::template Parameters<Dual<Width>>& parameters, std::size_t which,
                   int direction) {
    std::size_t index = 0;
    parameters.visit(
        [&](std::string_view, Dual<Width>& parameter) {
          if (index++ == which) parameter.derivative[direction] = 1.0;
        },
        parameters);
  }

  // What the recording is off by moves the output itself where it sees the input; the clock moves no value of it.
  template <class Column>
  void add_recording_part(int which, const Column& column, double t, const double* point, std::size_t stride,
                          double* signal) const {
    if (column.quantity.kind == FreeQuantity::Kind::clock_rate) return;
    const auto state = this->state_of(point, stride);
    const auto value = [&](const typename System::Equations::Input& input) -> std::array<double, 1> {
      if constexpr (WithPhysics) {
        const auto extra = seen_extra<double>(state, input, this->values());
        return {evaluate_output(which, System::plant_state(state), input, this->values().plant, extra)};
      } else {
        return {Model::output(which, state, input, this->values().plant)};
      }
    };
    signal[column.place] += this->by_input(column.quantity, t, value)[0];
  }

  // dh/dp + dh/dy S by dual numbers whose states carry S.
  void of_blocks(std::span<const int> which, double t, const double* point, std::size_t stride, double* signals) const {
    const auto input = this->input_at(t);
    if (blocks_.empty()) {
      const auto state = this->state_of(point, stride);
      for (std::size_t k = 0; k < which.size(); ++k)
        signals[k * columns_] = Model::output(which[k], state, input, this->values().plant);
    }
    for (const auto& block : blocks_) {
      const auto state = seeded(point, stride, block);
      for (std::size_t k = 0; k < which.size(); ++k) {
        const auto result = Model::output(which[k], state, input, block.values.plant);
        double* signal = signals + k * columns_;
        signal[0] = result.value;
        std::copy(result.derivative.begin(), result.derivative.begin() + block.count, signal + 1 + block.first);
      }
    }
  }

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

  // What the laws add at the sites that outputs see; 0 where none in force acts there.
  template <class R, class S, class P>
  auto seen_extra(const typename System::template State<S>& state, const typename System::Equations::Input& input,
                  const typename System::template Values<P>& values) const {
    return outputs_see_laws_ ? this->template extra<R>(state, input, values) : std::array<R, System::kSites>{};
  }

  [[nodiscard]] static bool outputs_see(const PhysicsTerms& terms) {
    if constexpr (requires { Model::kOutputSites; }) {
      const auto seen = [](std::size_t site) { return std::ranges::count(Model::kOutputSites, site) > 0; };
      return std::ranges::any_of(terms.active,
                                 [&](const ActiveTerm& term) { return std::ranges::any_of(term.sites, seen); });
    }
    return false;
  }

  // The same with what the laws add, and for the injected columns through the gradients by state and by site.
  template <int Directions>
  void with_physics(std::span<const int> which, double t, const double* point, std::size_t stride,
                    double* signals) const {
    using Gradient = Dual<Directions>;
    const auto input = this->input_at(t);
    typename System::template State<Gradient> state;
    for (int k = 0; k < this->rows(); ++k) state[k] = Gradient::variable(point[k * stride], k);
    auto extra = seen_extra<Gradient>(state, input, this->values());
    if constexpr (Directions > kStates)
      for (std::size_t site = 0; site < System::kSites; ++site)
        extra[site].derivative[static_cast<std::size_t>(kStates) + site] += 1.0;
    std::span<const double> weights;
    if (injected_ != nullptr) weights = this->weights_at(t);
    for (std::size_t k = 0; k < which.size(); ++k)
      chain_to_columns(evaluate_output(which[k], System::plant_state(state), input, this->values().plant, extra), point,
                       stride, weights, signals + k * columns_);
    add_parameter_parts(which, this->state_of(point, stride), input, signals);
  }

  template <int Directions>
  void chain_to_columns(const Dual<Directions>& result, const double* point, std::size_t stride,
                        std::span<const double> weights, double* signal) const {
    signal[0] = result.value;
    std::fill(signal + 1, signal + columns_, 0.0);
    for (int k = 0; k < this->rows(); ++k) {
      const double slope = result.derivative[static_cast<std::size_t>(k)];
      if (slope == 0.0) continue;  // an output shows few states
      for (std::size_t column = 1; column < columns_; ++column) signal[column] += slope * point[k * stride + column];
    }
    if constexpr (Directions > kStates)
      for (std::size_t e = 0; e < weights.size(); ++e) {
        const auto [column, site] = injected_->entries()[e];
        signal[1 + free_ + column] += result.derivative[static_cast<std::size_t>(kStates) + site] * weights[e];
      }
  }

  template <class State, class Input>
  void add_parameter_parts(std::span<const int> which, const State& state, const Input& input, double* signals) const {
    for (const auto& block : blocks_) {
      if (!(block.seen_by_outputs || (outputs_see_laws_ && block.has_parameters))) continue;
      const auto extra = seen_extra<Dual<Width>>(state, input, block.values);
      for (std::size_t k = 0; k < which.size(); ++k) {
        const Dual<Width> result =
            evaluate_output(which[k], System::plant_state(state), input, block.values.plant, extra);
        double* signal = signals + k * columns_ + 1 + block.first;
        for (int column = 0; column < block.count; ++column) signal[column] += result.derivative[column];
      }
    }
  }

  std::vector<Block> blocks_;
  InjectedColumns* injected_;
  std::size_t free_, columns_;
  bool outputs_see_laws_;
};

}  // namespace sealwatch
