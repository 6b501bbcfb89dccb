#include "services/common/fmi/export/c_expressions.hpp"

#include <algorithm>
#include <vector>

#include "services/common/text/numbers.hpp"

namespace sealwatch::fmi {
namespace {

using equations::Node;
using equations::Operation;

/// Where a variable of the equations stands in C; "": nowhere.
std::string place_of(std::size_t variable, const equations::TextEquationsParts& parts,
                     std::span<const std::size_t> rates) {
  const equations::VariablePlaces& places = parts.places;
  const auto element = [](const char* name, std::size_t index) {
    return std::string(name).append("[").append(std::to_string(index)).append("]");
  };
  const auto index_in = [](std::span<const std::size_t> list, std::size_t what) {
    return static_cast<std::size_t>(std::ranges::find(list, what) - list.begin());
  };
  if (variable == 0) return "t";
  if (variable < places.inputs) return element("x", variable - places.states);
  if (variable < places.rates) return element("u", index_in(parts.used_inputs, variable - places.inputs));
  if (variable < places.parameters)
    return element("u", parts.used_inputs.size() + index_in(rates, variable - places.rates));
  if (variable < places.added) return element("p", variable - places.parameters);
  return element("e", variable - places.added);
}

/// `a` and `b` in the place of $a and $b.
std::string filled(std::string pattern, const std::string& a, const std::string& b) {
  for (const auto& [mark, text] : {std::pair{"$a", &a}, {"$b", &b}})
    for (auto at = pattern.find(mark); at != std::string::npos; at = pattern.find(mark, at + text->size()))
      pattern.replace(at, 2, *text);
  return pattern;
}

/// "": the operation cannot be written.
const char* pattern_of(Operation operation) {
  switch (operation) {
    case Operation::add:
      return "$a + $b";
    case Operation::subtract:
      return "$a - $b";
    case Operation::multiply:
      return "$a * $b";
    case Operation::divide:
      return "$a / $b";
    case Operation::power:
      return "pow($a, $b)";
    case Operation::negate:
      return "-$a";
    case Operation::exponential:
      return "exp($a)";
    case Operation::logarithm:
      return "log($a)";
    case Operation::square_root:
      return "sqrt($a)";
    case Operation::sine:
      return "sin($a)";
    case Operation::cosine:
      return "cos($a)";
    case Operation::tangent:
      return "tan($a)";
    case Operation::arc_sine:
      return "asin($a)";
    case Operation::arc_cosine:
      return "acos($a)";
    case Operation::arc_tangent:
      return "atan($a)";
    case Operation::hyperbolic_tangent:
      return "tanh($a)";
    case Operation::magnitude:
      return "fabs($a)";
    case Operation::sign:
      return "($a < 0.0 ? -1.0 : 1.0)";
    case Operation::softplus:
      return "($a > 0.0 ? $a : 0.0) + log1p(exp(-fabs($a)))";
    case Operation::logistic:
      return "0.5 * (1.0 + tanh(0.5 * $a))";
    default:
      return "";
  }
}

}  // namespace

std::string c_number(double value) {
  std::string result = text::exact(value);
  return result.find_first_of(".en") == std::string::npos ? result.append(".0") : result;
}

Result<std::string> c_function(const std::string& name, const equations::TextEquationsParts& parts,
                               std::span<const Node> nodes, std::span<const std::size_t> rates) {
  const auto& entries = parts.expressions.entries();
  std::vector<bool> needed(entries.size(), false);
  for (const Node node : nodes) needed[node] = true;
  for (std::size_t k = entries.size(); k-- > 0;) {
    const bool leaf = entries[k].operation == Operation::constant || entries[k].operation == Operation::variable;
    if (!needed[k] || leaf) continue;
    needed[entries[k].a] = true;
    const std::string_view pattern = pattern_of(entries[k].operation);
    if (pattern.find("$b") != std::string_view::npos) needed[entries[k].b] = true;
  }
  std::string text = "static void ";
  text.append(name).append(
      "(double t, const double* x, const double* u, const double* p, const double* e, double* result) {\n"
      "  (void)t, (void)x, (void)u, (void)p, (void)e, (void)result;\n");
  std::vector<std::string> value(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (!needed[k]) continue;
    const auto& entry = entries[k];
    if (entry.operation == Operation::constant) {
      value[k] = "(" + c_number(entry.number) + ")";
    } else if (entry.operation == Operation::variable) {
      value[k] = place_of(entry.a, parts, rates);
    } else {
      const std::string pattern = pattern_of(entry.operation);
      if (pattern.empty())
        return fail("has a table, which is not written in C yet", "write it as an expression, or fit one to it");
      value[k] = "n" + std::to_string(k);
      text.append("  const double ").append(value[k]).append(" = ");
      text.append(filled(pattern, value[entry.a], value[entry.b])).append(";\n");
    }
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    text.append("  result[").append(std::to_string(k)).append("] = ").append(value[nodes[k]]).append(";\n");
  return text.append("}\n");
}

}  // namespace sealwatch::fmi
