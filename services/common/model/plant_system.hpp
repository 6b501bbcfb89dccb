// A plant's equations with the recorded input, as the system that ode/bdf.hpp integrates: values and Jacobian by dual
// numbers; derivatives by what the recording is off by from differences of the equations over a little of the input.
//
// Sensitivities are those at a sample, not at a time. With the clock fast by c, samples t_0 + (t_recorded - t_0) / (1 + c)
// lie closer: dy/dt_recorded = f / (1 + c), and S of c follows  dS/dt = J S - f / (1 + c).  Where a held input jumps from
// f_before to f_after, a later jump (its delay) leaves S += f_before - f_after.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sealwatch/model/dual.hpp"
#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/model/injected_weights.hpp"
#include "services/common/model/physics_terms.hpp"
#include "services/common/model/recorded_input.hpp"
#include "services/common/model/recorded_system.hpp"

namespace sealwatch {

/// With physics the state ends with the hidden states of the laws in force.
template <class Model, bool WithPhysics>
inline constexpr int kStatesOf = Model::Equations::kStates + (WithPhysics ? kMaximumHiddenStates : 0);
template <class Model, bool WithPhysics>
inline constexpr int kSizeOf = WithPhysics ? at_most(kStatesOf<Model, WithPhysics>) : kStatesOf<Model, WithPhysics>;

template <class Model, bool WithPhysics>
class PlantSystem : public SizedSystem<kSizeOf<Model, WithPhysics>> {
 public:
  using Equations = typename Model::Equations;
  static constexpr int kPlantStates = Equations::kStates;
  static constexpr int kStates = kStatesOf<Model, WithPhysics>;  ///< at most
  static constexpr std::size_t kSites = [] {
    if constexpr (WithPhysics) return Equations::kSites.size();
    return std::size_t{0};
  }();
  using typename OdeSystem<kSizeOf<Model, WithPhysics>>::Matrix;
  using Parameters = typename Equations::template Parameters<double>;
  template <class S>
  using State = std::array<S, kStates>;
  template <class S>
  using PlantState = typename Equations::template State<S>;

  /// Parameters of the plant and of the laws in force.
  template <class P>
  struct Values {
    typename Equations::template Parameters<P> plant;
    std::vector<P> laws;
  };

  PlantSystem(const RecordedInput& input, const PhysicsTerms& terms, const ModelValues& values,
              std::span<const FreeQuantity> free, InjectedColumns* injected)
      : input_(input), terms_(terms), injected_(injected), weights_(injected), injected_begin_(1 + free.size()) {
    assign(values_, values);
    for (std::size_t k = 0; k < free.size(); ++k)
      if (free[k].is_of_recording()) recording_.push_back({1 + k, free[k]});
    for (const ActiveTerm& term : terms.active) {
      const double* parameters = values.parameters.data() + term.first_parameter;
      constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
      const std::span own(parameters, term.law->parameters.size());
      known_laws_.insert(known_laws_.end(), kSites, {.at = law_input({}, kNowhere, own, term.roundings)});
    }
  }

  [[nodiscard]] int states() const override { return rows(); }
  [[nodiscard]] int maximum_order() const override { return Model::kMaximumOrder; }

  [[nodiscard]] std::vector<double> scale(double relative_tolerance) const override {
    std::vector<double> scale(static_cast<std::size_t>(rows()), relative_tolerance / 1e-6);
    for (int k = 0; k < kPlantStates; ++k) scale[k] *= Model::kScale[k];
    for (std::size_t k = 0; k < terms_.hidden_scales.size(); ++k)
      scale[static_cast<std::size_t>(kPlantStates) + k] *= kHiddenShare * terms_.hidden_scales[k];
    return scale;
  }

  [[nodiscard]] std::vector<bool> settled() const override {
    std::vector<bool> fast(Model::kQuasiSteady.begin(), Model::kQuasiSteady.end());
    fast.resize(static_cast<std::size_t>(rows()), false);
    if constexpr (WithPhysics)
      for (const ActiveTerm& term : terms_.active)
        if (term.hidden >= 0 && term.law->hidden->settled)
          fast[static_cast<std::size_t>(kPlantStates) + static_cast<std::size_t>(term.hidden)] = true;
    return fast;
  }

  void set_segment(std::size_t segment) override {
    segment_ = segment;
    weights_.forget();
  }
  [[nodiscard]] const Values<double>& values() const { return values_; }
  /// Of the injected columns, within the last step.
  [[nodiscard]] std::span<const double> weights_at(double t) const { return weights_.at(t); }

  void evaluate(double t, const double* y, double* f) const override {
    const auto result = rates<double>(state_of(y), input_at(t), values_);
    std::copy(result.begin(), result.begin() + rows(), f);
  }

  void linearise(double t, const double* y, double* f, Matrix& jacobian) const override {
    State<Dual<kStates>> state;
    for (int k = 0; k < rows(); ++k) state[k] = Dual<kStates>::variable(y[k], k);
    const auto result = rates<Dual<kStates>>(state, input_at(t), values_);
    for (int k = 0; k < rows(); ++k) {
      f[k] = result[k].value;
      jacobian[k] = result[k].derivative;
    }
  }

  /// At the begin of a segment: what the jump there adds to [y | S].
  void cross_jump(double t, double* point, std::size_t stride) const override {
    for (const Column& column : recording_) {
      const std::size_t channel = column.quantity.index;
      const bool by_clock = column.quantity.kind == FreeQuantity::Kind::input_clock_rate;
      if (!by_clock && column.quantity.kind != FreeQuantity::Kind::input_delay) continue;
      if (!input_.channels()[channel].hold) continue;
      const double later = by_clock ? input_.jump_by_clock_rate(channel, t) : input_.jump_by_delay(channel);
      const State<double> state = state_of(point, stride);
      auto [values, slopes] = course_at(t);
      const auto after = rates<double>(state, make_input(values, slopes), values_);
      values[channel] = input_.value(channel, t, segment_ - 1, cursor_);
      const auto before = rates<double>(state, make_input(values, slopes), values_);
      for (int row = 0; row < rows(); ++row) point[row * stride + column.place] += later * (before[row] - after[row]);
    }
  }

  /// What the laws in force add at each site.
  template <class R, class S, class P>
  [[nodiscard]] auto extra(const State<S>& y, const typename Equations::Input& input, const Values<P>& values) const {
    std::array<R, kSites> sum{};
    if constexpr (WithPhysics) {
      const PlantState<S> plant = plant_state(y);
      for (const ActiveTerm& term : terms_.active)
        for (const std::size_t site : term.sites)
          sum[site] = sum[site] + evaluate_law<R>(&LawOutput::contribution, term, site, y, plant, input, values, sum);
    }
    return sum;
  }

  /// y, whose rows lie `stride` apart; 0 for hidden states that no law in force has.
  [[nodiscard]] State<double> state_of(const double* y, std::size_t stride = 1) const {
    State<double> state{};
    for (int k = 0; k < rows(); ++k) state[k] = y[static_cast<std::size_t>(k) * stride];
    return state;
  }

  template <class S>
  [[nodiscard]] static PlantState<S> plant_state(const State<S>& y) {
    PlantState<S> plant{};
    std::copy(y.begin(), y.begin() + kPlantStates, plant.begin());
    return plant;
  }

  [[nodiscard]] auto input_at(double t) const {
    const auto [values, slopes] = course_at(t);
    return make_input(values, slopes);
  }

 protected:
  /// The plant's states and the hidden ones of the laws in force.
  [[nodiscard]] int rows() const {
    if constexpr (WithPhysics)
      return kPlantStates + static_cast<int>(terms_.hidden_scales.size());
    else
      return kPlantStates;
  }

  /// One of the free quantities that are of the recording, and its place in [y | S].
  struct Column {
    std::size_t place = 0;
    FreeQuantity quantity;
  };
  [[nodiscard]] const std::vector<Column>& recording() const { return recording_; }

  /// The slope of f(input), an array, by the gain, bias or delay of an input, without what a delay does to the input's own
  /// slope: central differences over so small a share of the input that f is straight there, and above rounding.
  template <class F>
  [[nodiscard]] auto by_input(const FreeQuantity& quantity, double t, const F& f) const {
    constexpr double kShare = 1e-6;
    const std::size_t channel = quantity.index;
    std::array<double, 2> direction{1.0, 0.0};
    if (quantity.kind == FreeQuantity::Kind::input_gain) direction = input_.by_gain(channel, t, segment_, cursor_);
    if (quantity.kind == FreeQuantity::Kind::input_delay) direction = {input_.by_delay(channel, t, cursor_), 0.0};
    if (quantity.kind == FreeQuantity::Kind::input_clock_rate)
      direction = {input_.by_clock_rate(channel, t, cursor_), 0.0};
    const auto moved = [&](double by) {
      auto [values, slopes] = course_at(t);
      values[channel] += by * direction[0];
      slopes[channel] += by * direction[1];
      return f(make_input(values, slopes));
    };
    auto slope = decltype(moved(0.0)){};
    const double size = input_.size(channel);
    if (direction[0] == 0.0 || size == 0.0) return slope;
    const double step = kShare * size / std::abs(direction[0]);
    const auto above = moved(step), below = moved(-step);
    for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = (above[k] - below[k]) / (2.0 * step);
    return slope;
  }

  static constexpr std::size_t kPlantParameters = Parameters::kFieldCount - 1;  // without the load factor

  template <class P>
  static void assign(Values<P>& to, const ModelValues& values) {
    std::size_t index = 0;
    to.plant.visit(
        [&](std::string_view, P& parameter) {
          parameter = index < kPlantParameters ? values.parameters[index] : values.load_factor;
          ++index;
        },
        to.plant);
    to.laws.assign(values.parameters.begin() + static_cast<std::ptrdiff_t>(kPlantParameters), values.parameters.end());
  }

  template <class R, class S, class P>
  [[nodiscard]] std::array<R, kStates> rates(const State<S>& y, const typename Equations::Input& input,
                                             const Values<P>& values) const {
    if constexpr (!WithPhysics) {
      return Equations::derivatives(y, input, values.plant);
    } else {
      std::array<R, kStates> result{};
      const PlantState<S> plant = plant_state(y);
      const std::array<R, kSites> sum = extra<R>(y, input, values);
      for (const ActiveTerm& term : terms_.active)
        if (term.hidden >= 0)
          result[kPlantStates + term.hidden] =
              evaluate_law<R>(&LawOutput::rate, term, term.sites.back(), y, plant, input, values, sum);
      const auto of_plant = Equations::derivatives(plant, input, values.plant, sum);
      std::copy(of_plant.begin(), of_plant.end(), result.begin());
      return result;
    }
  }

  void add_recording(double t, const State<double>& state, double factor, double* x, std::size_t stride) const {
    for (const Column& column : recording_) {
      State<double> slope;
      const auto rates_by = [&](const typename Equations::Input& input) {
        return rates<double>(state, input, values_);
      };
      if (column.quantity.kind == FreeQuantity::Kind::clock_rate) {
        slope = rates_by(input_at(t));
        for (double& value : slope) value *= -1.0 / (1.0 + input_.clock_rate());
      } else {
        slope = by_input(column.quantity, t, rates_by);
      }
      for (int row = 0; row < rows(); ++row) x[row * stride + column.place] += factor * slope[row];
    }
  }

  // df/dextra w for the injected columns.
  void add_injected(double t, const State<double>& y, double factor, double* x, std::size_t stride) const {
    using Direction = Dual<static_cast<int>(kSites == 0 ? 1 : kSites)>;
    const PlantState<double> plant = plant_state(y);
    const auto input = input_at(t);
    std::array<std::array<double, kSiteSignals>, kSites> signals;
    const std::array<double, kSites> base = extra<double>(y, input, values_);
    for (std::size_t site = 0; site < kSites; ++site)
      signals[site] = Equations::template signals<double>(site, plant, input, values_.plant, base);
    const std::span<const double> weights = weights_.weigh(t, signals);
    std::array<Direction, kSites> sum;
    for (std::size_t site = 0; site < kSites; ++site)
      sum[site] = Direction::variable(base[site], static_cast<int>(site));
    const auto result = Equations::derivatives(plant, input, values_.plant, sum);
    const auto entries = injected_->entries();
    for (std::size_t e = 0; e < entries.size(); ++e)
      for (int row = 0; row < kPlantStates; ++row)
        x[row * stride + injected_begin_ + entries[e].column] +=
            factor * result[row].derivative[entries[e].site] * weights[e];
  }

 private:
  using Course = std::array<double, Model::kInputs.size()>;
  /// Values and slopes of all inputs.
  [[nodiscard]] std::pair<Course, Course> course_at(double t) const {
    std::pair<Course, Course> course;
    for (std::size_t channel = 0; channel < course.first.size(); ++channel) {
      course.first[channel] = input_.value(channel, t, segment_, cursor_);
      course.second[channel] = WithPhysics ? input_.slope(channel, t, cursor_) : 0.0;
    }
    return course;
  }
  [[nodiscard]] static auto make_input(const Course& values, const Course& slopes) {
    if constexpr (requires { Model::input(values, slopes); })
      return Model::input(values, slopes);
    else
      return Model::input(values);
  }

  /// Contribution, or rate of the hidden state, of one law at one site.
  template <class R, class S, class P>
  [[nodiscard]] R evaluate_law(LawScalar LawOutput::*what, const ActiveTerm& term, std::size_t site, const State<S>& y,
                               const PlantState<S>& plant, const typename Equations::Input& input,
                               const Values<P>& values, const std::array<R, kSites>& added) const {
    const auto signals = Equations::template signals<R>(site, plant, input, values.plant, added);
    const std::size_t count = term.law->parameters.size();
    const P* parameter = values.laws.data() + (term.first_parameter - kPlantParameters);
    const S hidden = term.hidden >= 0 ? y[kPlantStates + term.hidden] : S(0.0);
    return chain(law_output(term, site, signals, hidden).*what, signals, hidden, parameter, count);
  }

  /// Of one law at one site. Blocks of parameters, outputs and rates of hidden states ask at the same point again.
  template <class R, class S>
  [[nodiscard]] const LawOutput& law_output(const ActiveTerm& term, std::size_t site,
                                            const std::array<R, kSiteSignals>& signals, const S& hidden) const {
    KnownLaw& known = known_laws_[static_cast<std::size_t>(&term - terms_.active.data()) * kSites + site];
    bool same = known.at.hidden.value == value_of(hidden);
    known.at.hidden.value = value_of(hidden);
    for (std::size_t k = 0; k < kSiteSignals; ++k) {
      same = same && known.at.signal[k].value == value_of(signals[k]);
      known.at.signal[k].value = value_of(signals[k]);
    }
    if (!same) known.output = term.law->evaluate(known.at);
    return known.output;
  }

  const RecordedInput& input_;
  const PhysicsTerms& terms_;
  InjectedColumns* injected_;
  mutable InjectedWeights weights_;
  std::size_t injected_begin_;
  Values<double> values_;
  std::vector<Column> recording_;
  /// A law in force with its parameters, where it was evaluated last at a site.
  struct KnownLaw {
    LawInput at;
    LawOutput output{};
  };
  mutable std::vector<KnownLaw> known_laws_;  ///< for each law all sites
  std::size_t segment_ = 0;
  mutable std::size_t cursor_ = 0;
};

}  // namespace sealwatch
