// The equations of a run-time plant with the recorded input and the laws in force, as the system that RecordingRun
// integrates: what PlantSystem is for plants that are known when sealwatch is built.
//
//   y = [x; h]  states and the laws' hidden states;   e = laws(s(x, u, p, e of earlier sites), h)
//   dy/dt: df/dx + df/de de/dx,  df/dp + df/de de/dp,  df/de w for injected columns
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/runtime_equations.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/model/injected_weights.hpp"
#include "services/common/model/physics_terms.hpp"
#include "services/common/model/recorded_input.hpp"
#include "services/common/model/recorded_system.hpp"

namespace sealwatch {

/// What the free quantities are to the plant's equations.
struct FreeColumns {
  struct OfPlant {
    std::size_t column = 0;          ///< of the sensitivities, from 0
    std::size_t differentiated = 0;  ///< place in `differentiated`
    double factor = 1.0;             ///< of the load: d(phi (1 + Phi))
  };
  struct OfLaw {
    std::size_t column = 0;
    std::size_t parameter = 0;  ///< in the values' parameters
  };
  std::size_t count = 0;
  std::vector<std::size_t> differentiated;  ///< parameters of the plant
  std::vector<OfPlant> of_plant;
  std::vector<OfLaw> of_law;
};
[[nodiscard]] FreeColumns free_columns(const PlantDescription& plant, const ModelValues& values,
                                       std::span<const FreeQuantity> free);
/// The plant's parameters, the load with its factor.
[[nodiscard]] std::vector<double> effective_parameters(const PlantDescription& plant, const ModelValues& values);

class RuntimeSystem final : public SizedSystem<kDynamicSize> {
 public:
  RuntimeSystem(const RuntimePlant& plant, std::unique_ptr<RuntimeEvaluator> evaluator, const RecordedInput& input,
                const PhysicsTerms& terms, const ModelValues& values, FreeColumns free, InjectedColumns* injected);

  [[nodiscard]] int states() const override { return static_cast<int>(plant_states_ + hidden_states_); }
  [[nodiscard]] int maximum_order() const override { return plant_.maximum_order; }
  [[nodiscard]] std::vector<double> scale(double relative_tolerance) const override;
  [[nodiscard]] std::vector<bool> settled() const override;
  [[nodiscard]] std::string trouble() const override;
  [[nodiscard]] std::string said() const override { return evaluator_->trouble(); }
  void set_segment(std::size_t segment) override;

  [[nodiscard]] bool start(std::span<const FreeQuantity> free, double* y, double* point,
                           std::size_t stride) const override;

  [[nodiscard]] bool has_events() const override { return evaluator_->has_events(); }
  [[nodiscard]] double next_event_s() const override { return evaluator_->next_event_s(); }
  [[nodiscard]] bool event_before(double t, const double* y) const override;
  [[nodiscard]] bool accept(double t, const double* y) const override;
  [[nodiscard]] Passed pass_event(double t, double* y) const override;

  void evaluate(double t, const double* y, double* f) const override;
  void linearise(double t, const double* y, double* f, DynamicMatrix& jacobian) const override;
  void add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                 std::size_t stride) const override;
  void outputs(std::span<const int> which, double t, const double* point, std::size_t stride,
               double* signals) const override;

 private:
  struct Term {
    const ActiveTerm* active = nullptr;
    std::vector<double> parameters;
    struct Free {
      std::size_t parameter = 0;  ///< of the law
      std::size_t column = 0;
    };
    std::vector<Free> free;
  };
  /// A quantity that depends on y and on the free quantities.
  struct Rows {
    std::vector<double> values;
    RuntimeMatrix by_state, by_free;
    void resize(std::size_t rows, std::size_t states, std::size_t free);
    void clear();
  };

  void locate(double t, const double* y, std::size_t segment) const;
  [[nodiscard]] bool add_laws(bool differentiate) const;
  void add_law(const LawScalar& law, const Term& term, std::size_t site, Rows& to, std::size_t row) const;
  [[nodiscard]] const double* signals(bool differentiate) const;
  std::span<const double> weigh(double t) const;
  [[nodiscard]] std::span<const double> weights_at(double t) const;
  [[nodiscard]] bool linearise_outputs(double t, const double* point, std::size_t stride) const;
  void note(std::span<const double> rates) const;

  const RuntimePlant& plant_;
  std::unique_ptr<RuntimeEvaluator> evaluator_;
  const RecordedInput& input_;
  FreeColumns free_;
  InjectedColumns* injected_;
  std::size_t plant_states_, hidden_states_, sites_, columns_;
  bool signals_see_added_;
  std::vector<double> parameters_;
  std::vector<Term> terms_;
  std::vector<std::vector<std::size_t>> terms_at_site_;
  std::vector<double> hidden_scales_;
  std::size_t segment_ = 0;

  mutable std::size_t cursor_ = 0;
  mutable RuntimePoint point_;
  mutable std::vector<double> inputs_, input_rates_, hidden_, signal_values_, state_, outputs_, last_rates_;
  mutable const RuntimeLinearisation* signal_slopes_ = nullptr;
  mutable Rows added_, hidden_rates_;
  mutable InjectedWeights weights_;
};

}  // namespace sealwatch
