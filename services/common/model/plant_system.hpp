// A plant's equations with the recorded input, as the system that ode/bdf.hpp integrates: values, Jacobian and
// parameter derivatives by dual numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sealwatch/model/dual.hpp"
#include "sealwatch/model/simulation.hpp"
#include "sealwatch/ode/lu.hpp"
#include "services/common/model/recorded_input.hpp"

namespace sealwatch {

/// `Width` directions of differentiation are carried at once; free quantities beyond them make further blocks.
template <class Model, int Width>
class PlantSystem {
 public:
  using Equations = typename Model::Equations;
  static constexpr int kStates = Equations::kStates;
  using Matrix = typename LuFactorisation<kStates>::Matrix;
  using Parameters = typename Equations::template Parameters<double>;
  template <class S>
  using State = typename Equations::template State<S>;

  /// Consecutive free quantities first .. first + Width - 1 with the parameters seeded for them.
  struct Block {
    int first = 0;
    int count = 0;
    bool has_parameters = false;
    typename Equations::template Parameters<Dual<Width>> parameters;
  };

  PlantSystem(const RecordedInput& input, const ModelValues& values, std::span<const FreeQuantity> free)
      : input_(input) {
    assign(parameters_, values);
    for (std::size_t first = 0; first < free.size(); first += Width)
      blocks_.push_back(make_block(values, free, static_cast<int>(first)));
  }

  void set_segment(std::size_t segment) { segment_ = segment; }
  [[nodiscard]] const Parameters& parameters() const { return parameters_; }
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }

  void evaluate(double t, const double* y, double* f) const {
    State<double> state;
    std::copy(y, y + kStates, state.begin());
    const auto result = Equations::derivatives(state, input_at(t), parameters_);
    std::copy(result.begin(), result.end(), f);
  }

  void linearise(double t, const double* y, double* f, Matrix& jacobian) const {
    State<Dual<kStates>> state;
    for (int k = 0; k < kStates; ++k) state[k] = Dual<kStates>::variable(y[k], k);
    const auto result = Equations::derivatives(state, input_at(t), parameters_);
    for (int k = 0; k < kStates; ++k) {
      f[k] = result[k].value;
      jacobian[k] = result[k].derivative;
    }
  }

  void add_parameter_derivatives(double t, const double* y, double factor, double* x, std::size_t stride) const {
    State<double> state;
    std::copy(y, y + kStates, state.begin());
    for (const Block& block : blocks_) {
      if (!block.has_parameters) continue;
      const auto result = Equations::derivatives(state, input_at(t), block.parameters);
      for (int row = 0; row < kStates; ++row)
        for (int k = 0; k < block.count; ++k)
          x[row * stride + 1 + block.first + k] += factor * result[row].derivative[k];
    }
  }

  [[nodiscard]] auto input_at(double t) const {
    std::array<double, Model::kInputs.size()> values;
    for (std::size_t channel = 0; channel < values.size(); ++channel)
      values[channel] = input_.value(channel, t, segment_, cursor_);
    return Model::input(values);
  }

 private:
  template <class P>
  static void assign(typename Equations::template Parameters<P>& parameters, const ModelValues& values) {
    std::size_t index = 0;
    parameters.visit(
        [&](std::string_view, P& parameter) {
          parameter = index < values.parameters.size() ? values.parameters[index] : values.load_factor;
          ++index;
        },
        parameters);
  }

  static Block make_block(const ModelValues& values, std::span<const FreeQuantity> free, int first) {
    Block block;
    block.first = first;
    block.count = std::min(Width, static_cast<int>(free.size()) - first);
    assign(block.parameters, values);
    for (int k = 0; k < block.count; ++k) {
      const FreeQuantity& quantity = free[first + k];
      if (quantity.kind == FreeQuantity::Kind::initial_state) continue;
      const bool load = quantity.kind == FreeQuantity::Kind::load_factor;
      seed(block.parameters, load ? values.parameters.size() : quantity.index, k);
      block.has_parameters = true;
    }
    return block;
  }

  static void seed(typename Equations::template Parameters<Dual<Width>>& parameters, std::size_t which, int direction) {
    std::size_t index = 0;
    parameters.visit(
        [&](std::string_view, Dual<Width>& parameter) {
          if (index++ == which) parameter.derivative[direction] = 1.0;
        },
        parameters);
  }

  const RecordedInput& input_;
  Parameters parameters_;
  std::vector<Block> blocks_;
  std::size_t segment_ = 0;
  mutable std::size_t cursor_ = 0;
};

}  // namespace sealwatch
