#include "services/common/fmi/export/wrapper_ports.hpp"

#include <algorithm>

namespace sealwatch::fmi {
namespace {

using equations::Expressions;
using equations::Node;
using equations::Operation;

bool is_binary(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract || operation == Operation::multiply ||
         operation == Operation::divide || operation == Operation::power;
}

/// The expression where nothing is added at any site.
Node without_added(Expressions& expressions, Node node, const equations::VariablePlaces& places) {
  const Expressions::Entry entry = expressions.entries()[node];
  if (entry.operation == Operation::constant) return node;
  if (entry.operation == Operation::variable) return entry.a < places.added ? node : expressions.constant(0.0);
  if (entry.operation == Operation::table)
    return expressions.table(entry.a / equations::kOrdersOfTable, without_added(expressions, entry.b, places),
                             static_cast<int>(entry.a % equations::kOrdersOfTable));
  const Node a = without_added(expressions, entry.a, places);
  return is_binary(entry.operation) ? expressions.apply(entry.operation, a, without_added(expressions, entry.b, places))
                                    : expressions.apply(entry.operation, a);
}

class Finder {
 public:
  Finder(const FmuEquations& unit, const equations::TextEquationsParts& frame)
      : block_(unit.block()),
        description_(block_.file->description()),
        frame_(frame),
        outputs_(unit.counts().outputs),
        expressions_(frame.expressions) {}

  Result<WrapperPorts> find() {
    for (std::size_t k = 0; k < block_.inputs.size(); ++k)
      found_.inputs.push_back(driven(block_.setup.inputs, block_.inputs[k], FmiCausality::input, outputs_ + k));
    for (std::size_t k = 0; k < block_.parameters.size(); ++k)
      found_.parameters.push_back(driven(block_.setup.parameters, block_.parameters[k], FmiCausality::parameter,
                                         outputs_ + block_.inputs.size() + k));
    for (const DrivenVariable& input : found_.inputs)
      if (input.port.kind != std::string_view("kReal") && (!input.alone || input.with_laws))
        return fail(Error{.file = block_.file->name(),
                          .place = {},
                          .value = description_.variables[input.variable].name,
                          .rule = "is an input that changes at events alone, and an expression in the plant file",
                          .advice = "give it a channel of its own"});
    for (std::size_t k = 0; k < block_.states.size(); ++k) {
      found_.states.push_back({block_.setup.states[k].reference, "kReal", block_.states[k]});
      found_.rates.push_back({block_.setup.derivatives[k].reference, "kReal", {}});
    }
    for (const Port& port : block_.variables)
      found_.variables.push_back({block_.setup.outputs[port.place].reference,
                                  kind_of(at_reference(block_.setup.outputs[port.place].reference)), port.unit});
    for (std::size_t k = 0; k < outputs_; ++k) found_.shown.push_back(shown_by(frame_.outputs.values[k]));
    for (const Variable& variable : description_.variables) found_.own = std::max(found_.own, variable.reference + 1);
    return std::move(found_);
  }

 private:
  DrivenVariable driven(const std::vector<Handle>& handles, const Port& port, FmiCausality causality, std::size_t row) {
    DrivenVariable result{
        .variable = 0, .node = frame_.outputs.values[row], .alone = {}, .with_laws = false, .port = {}};
    const std::uint32_t reference = handles[port.place].reference;
    while (description_.variables[result.variable].reference != reference ||
           description_.variables[result.variable].causality != causality)
      ++result.variable;
    result.port = {reference, kind_of(description_.variables[result.variable]), port.unit};
    const Node plain = without_added(expressions_, result.node, frame_.places);
    result.with_laws = plain != result.node;
    const Expressions::Entry& entry = expressions_.entries()[plain];
    const bool input = causality == FmiCausality::input;
    const std::size_t first = input ? frame_.places.inputs : frame_.places.parameters,
                      end = input ? frame_.places.rates : frame_.places.added;
    if (entry.operation == Operation::variable && entry.a >= first && entry.a < end) result.alone = entry.a - first;
    return result;
  }

  [[nodiscard]] const Variable& at_reference(std::uint32_t reference) const {
    return *std::ranges::find(description_.variables, reference, &Variable::reference);
  }

  // A state of the FMU, or one of its variables.
  [[nodiscard]] std::optional<std::size_t> shown_by(Node node) const {
    const Expressions::Entry& entry = frame_.expressions.entries()[node];
    if (entry.operation != Operation::variable) return std::nullopt;
    const std::size_t states = block_.states.size();
    std::optional<std::uint32_t> reference;
    if (entry.a >= frame_.places.states && entry.a < frame_.places.states + states)
      reference = block_.setup.states[entry.a - frame_.places.states].reference;
    if (entry.a >= frame_.places.added + states && entry.a < frame_.places.added + states + block_.variables.size())
      reference = block_.setup.outputs[block_.variables[entry.a - frame_.places.added - states].place].reference;
    if (!reference) return std::nullopt;
    return static_cast<std::size_t>(&at_reference(*reference) - description_.variables.data());
  }

  const FmuBlock& block_;
  const ModelDescription& description_;
  const equations::TextEquationsParts& frame_;
  std::size_t outputs_;
  Expressions expressions_;
  WrapperPorts found_;
};

}  // namespace

const char* kind_of(const Variable& variable) {
  switch (variable.type) {
    case FmiType::float64:
      return changes_between_events(variable) || variable.causality != FmiCausality::input ? "kReal" : "kDiscrete";
    case FmiType::boolean:
      return "kBoolean";
    default:
      return "kInteger";
  }
}

Result<WrapperPorts> wrapper_ports(const FmuEquations& unit, const equations::TextEquationsParts& frame) {
  return Finder(unit, frame).find();
}

}  // namespace sealwatch::fmi
