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
    for (auto* list : {&found_.inputs, &found_.parameters}) keep_arrays_whole(*list);
    for (const DrivenVariable& input : found_.inputs)
      if (!input.port.continuous && (!input.alone || input.with_laws))
        return fail(Error{.file = block_.file->name(),
                          .place = {},
                          .value = description_.variables[input.variable].name,
                          .rule = "is an input that changes at events alone, and an expression in the plant file",
                          .advice = "give it a channel of its own"});
    for (std::size_t k = 0; k < block_.states.size(); ++k) {
      found_.states.push_back(port_at(block_.setup.states, {k, block_.states[k]}));
      found_.rates.push_back(port_at(block_.setup.derivatives, {k, {}}));
    }
    for (const Port& port : block_.variables) found_.variables.push_back(port_at(block_.setup.outputs, port));
    for (std::size_t k = 0; k < outputs_; ++k) found_.shown.push_back(shown_by(frame_.outputs.values[k]));
    for (const Variable& variable : description_.variables) found_.own = std::max(found_.own, variable.reference + 1);
    return std::move(found_);
  }

 private:
  /// Of an element among those of whole variables.
  [[nodiscard]] WrapperPort port_at(const std::vector<Handle>& handles, const Port& port) const {
    std::size_t place = port.place, handle = 0;
    while (place >= handles[handle].size) place -= handles[handle++].size;
    return {.reference = handles[handle].reference,
            .type = type_in_c(handles[handle].type, description_.version),
            .unit = port.unit,
            .element = static_cast<std::uint32_t>(place),
            .size = handles[handle].size};
  }

  // An array is one variable, which brings values of the plant with all of its elements that are driven, or with none.
  static void keep_arrays_whole(std::vector<DrivenVariable>& driven) {
    const auto is_kept = [&](const DrivenVariable& one) {
      return one.alone && std::ranges::count(driven, one.alone, &DrivenVariable::alone) == 1;
    };
    std::vector<std::size_t> broken;
    for (const DrivenVariable& one : driven)
      if (one.port.size > 1 && !is_kept(one)) broken.push_back(one.variable);
    for (DrivenVariable& one : driven)
      if (std::ranges::find(broken, one.variable) != broken.end()) one.alone.reset();
  }

  DrivenVariable driven(const std::vector<Handle>& handles, const Port& port, FmiCausality causality, std::size_t row) {
    DrivenVariable result{
        .variable = 0, .node = frame_.outputs.values[row], .alone = {}, .with_laws = false, .port = {}};
    result.port = port_at(handles, port);
    const auto is_driven = [&](const Variable& variable) {
      return variable.reference == result.port.reference && variable.causality == causality &&
             type_in_c(variable.type, description_.version) == std::string_view(result.port.type);
    };
    while (!is_driven(description_.variables[result.variable])) ++result.variable;
    const Variable& variable = description_.variables[result.variable];
    const bool real = variable.type == FmiType::float64 || variable.type == FmiType::float32;
    result.port.continuous = real && (causality != FmiCausality::input || changes_between_events(variable));
    const Node plain = without_added(expressions_, result.node, frame_.places);
    result.with_laws = plain != result.node;
    const Expressions::Entry& entry = expressions_.entries()[plain];
    const bool input = causality == FmiCausality::input;
    const std::size_t first = input ? frame_.places.inputs : frame_.places.parameters,
                      end = input ? frame_.places.rates : frame_.places.added;
    if (entry.operation == Operation::variable && entry.a >= first && entry.a < end) result.alone = entry.a - first;
    return result;
  }

  [[nodiscard]] const Variable& at_port(const WrapperPort& port) const {
    return *std::ranges::find_if(description_.variables, [&](const Variable& variable) {
      return variable.reference == port.reference &&
             type_in_c(variable.type, description_.version) == std::string_view(port.type);
    });
  }

  // A state of the FMU, or one of its variables.
  [[nodiscard]] std::optional<std::size_t> shown_by(Node node) const {
    const Expressions::Entry& entry = frame_.expressions.entries()[node];
    if (entry.operation != Operation::variable) return std::nullopt;
    const std::size_t states = block_.states.size();
    std::optional<WrapperPort> port;
    if (entry.a >= frame_.places.states && entry.a < frame_.places.states + states)
      port = port_at(block_.setup.states, {entry.a - frame_.places.states, {}});
    if (entry.a >= frame_.places.added + states && entry.a < frame_.places.added + states + block_.variables.size())
      port = port_at(block_.setup.outputs, block_.variables[entry.a - frame_.places.added - states]);
    if (!port || port->size != 1) return std::nullopt;
    return static_cast<std::size_t>(&at_port(*port) - description_.variables.data());
  }

  const FmuBlock& block_;
  const ModelDescription& description_;
  const equations::TextEquationsParts& frame_;
  std::size_t outputs_;
  Expressions expressions_;
  WrapperPorts found_;
};

}  // namespace

const char* type_in_c(FmiType type, Version version) {
  switch (type) {
    case FmiType::float64:
      return "kReal";
    case FmiType::float32:
      return "kSingle";
    case FmiType::boolean:
      return "kBoolean";
    case FmiType::string:
      return "kText";
    case FmiType::int8:
      return "kInt8";
    case FmiType::uint8:
      return "kUInt8";
    case FmiType::int16:
      return "kInt16";
    case FmiType::uint16:
      return "kUInt16";
    case FmiType::uint32:
      return "kUInt32";
    case FmiType::uint64:
      return "kUInt64";
    case FmiType::int64:
      return "kInt64";
    case FmiType::enumeration:
      return version == Version::fmi3 ? "kInt64" : "kInteger";
    default:
      return "kInteger";
  }
}

Result<WrapperPorts> wrapper_ports(const FmuEquations& unit, const equations::TextEquationsParts& frame) {
  return Finder(unit, frame).find();
}

}  // namespace sealwatch::fmi
