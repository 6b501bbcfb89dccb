// Where the states of a plant start: expressions of its parameters and of what a recording begins with. A channel's name
// is its first value; rate(channel) its slope over the first samples, mean(channel) its mean.
#include <algorithm>

#include "sealwatch/core/text.hpp"
#include "services/common/equations/text_equations.hpp"

namespace sealwatch::equations {
namespace {

class StartNames final : public Names {
 public:
  StartNames(const TextPlant& plant, StartNodes& start) : plant_(plant), start_(start) {
    const auto add = [&](const ChannelDescription& channel) {
      start_.channels.push_back(channel.name);
      units_.push_back(find_dimension(channel.unit).value_or(Dimension{}));
    };
    for (const TextInput& input : plant.inputs) add(input.channel);
    for (const TextOutput& output : plant.outputs) add(output.channel);
    start_.parameters = plant.parameters.size();
  }

  Result<Formula> quantity(const std::string& name) override {
    const auto parameter = std::ranges::find(plant_.parameters, name, &ParameterDescription::name);
    if (parameter == plant_.parameters.end()) return channel(name, 0);
    const auto index = static_cast<std::size_t>(parameter - plant_.parameters.begin());
    return Formula{start_.expressions.variable(index), find_dimension(parameter->unit).value_or(Dimension{}), false};
  }

  std::optional<Result<Formula>> call(const std::string& name, const std::vector<Syntax>& arguments) override {
    if (name != "rate" && name != "mean") return std::nullopt;
    if (arguments.size() != 1 || arguments[0].kind != Syntax::Kind::name)
      return fail(Error{.file = {}, .place = {}, .value = name, .rule = "takes the name of a channel", .advice = {}});
    Result<Formula> formula = channel(arguments[0].text, name == "rate" ? 1 : 2);
    if (formula && name == "rate") formula->dimension = multiply(formula->dimension, *find_dimension("s"), -1.0);
    return formula;
  }

  std::vector<std::string> functions() const override { return {"rate", "mean"}; }

  std::vector<std::string> used;  ///< channels of the expression that was understood last

 private:
  Result<Formula> channel(const std::string& name, std::size_t statistic) {
    const auto known = std::ranges::find(start_.channels, name);
    if (known == start_.channels.end()) {
      std::vector<std::string> names = start_.channels;
      for (const ParameterDescription& parameter : plant_.parameters) names.push_back(parameter.name);
      return fail(Error{.file = {},
                        .place = {},
                        .value = name,
                        .rule = "is neither a parameter nor a channel, of which alone a start may be made",
                        .advice = suggest(name, names)});
    }
    used.push_back(name);
    const auto index = static_cast<std::size_t>(known - start_.channels.begin());
    return Formula{start_.expressions.variable(start_.parameters + 3 * index + statistic), units_[index], false};
  }

  const TextPlant& plant_;
  StartNodes& start_;
  std::vector<Dimension> units_;
};

}  // namespace

StartNodes understand_starts(const TextPlant& plant, const Faults& faults) {
  StartNodes start;
  StartNames names(plant, start);
  for (const TextState& state : plant.states) {
    StartOfState of{.state = state.description.name, .choices = {}};
    const Dimension unit = find_dimension(state.description.unit).value_or(Dimension{});
    for (const std::string& text : state.start) {
      names.used.clear();
      const Result<Formula> formula = understand(text, start.expressions, names, unit);
      if (!formula) faults("states." + state.description.name + ".start", formula.error());
      if (formula) of.choices.push_back({formula->node, names.used});
    }
    start.states.push_back(std::move(of));
  }
  return start;
}

}  // namespace sealwatch::equations
