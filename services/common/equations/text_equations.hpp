// The equations of a plant that is written as text, as tapes (services/common/equations/tape.hpp).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/model/runtime_equations.hpp"
#include "services/common/equations/plant_names.hpp"

namespace sealwatch::equations {

/// Of a state's size that one step's integration may err by.
inline constexpr double kErrorOfSize = 1e-7;

/// A function of the plant and its derivatives: rows of nodes.
struct FunctionNodes {
  std::vector<Node> values;
  std::vector<std::vector<Node>> by_state, by_parameter, by_added;  ///< [row][column]
};
[[nodiscard]] FunctionNodes differentiated(Expressions& expressions, std::vector<Node> values,
                                           const VariablePlaces& places);

/// The start of one state: the first of its expressions whose channels are recorded.
struct StartOfState {
  struct Choice {
    Node node = 0;
    std::vector<std::string> channels;  ///< that it needs
  };
  std::string state;
  std::vector<Choice> choices;
};
/// Variables of starts: the parameters, then first value, slope and mean of each channel.
struct StartNodes {
  Expressions expressions;
  std::vector<std::string> channels;
  std::size_t parameters = 0;
  std::vector<StartOfState> states;
};
[[nodiscard]] StartNodes understand_starts(const TextPlant& plant, const Faults& faults);

struct TextEquationsParts {
  Expressions expressions;
  VariablePlaces places;
  FunctionNodes derivatives, signals, outputs;
  std::vector<std::size_t> used_inputs;  ///< of the plant's inputs, those that the equations need
  StartNodes start;
  bool signals_see_added = false, outputs_see_added = false;
};

class TextEquations final : public RuntimeEquations {
 public:
  explicit TextEquations(TextEquationsParts parts) : parts_(std::move(parts)) {}
  [[nodiscard]] Result<std::unique_ptr<RuntimeEvaluator>> evaluator(
      const RuntimePoint& first, std::span<const std::size_t> differentiated_by) const override;
  [[nodiscard]] Result<std::vector<double>> initial_state(std::span<const double> parameters,
                                                          const TimeSeries& recorded) const override;
  [[nodiscard]] bool signals_see_added() const override { return parts_.signals_see_added; }
  [[nodiscard]] bool outputs_see_added() const override { return parts_.outputs_see_added; }
  /// For those who write the equations in another language.
  [[nodiscard]] const TextEquationsParts& parts() const { return parts_; }

 private:
  TextEquationsParts parts_;
};

}  // namespace sealwatch::equations
