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
    case Operation::table:
    case Operation::constant:
    case Operation::variable:
      break;
  }
  return "";
}

std::string table_call(const equations::Expressions::Entry& entry, const std::string& at) {
  const std::string name = "table" + std::to_string(entry.a / equations::kOrdersOfTable);
  return "table_value(" + name + "_x, " + name + "_y, " + name + "_slope, " + name + "_last, " + at + ", " +
         std::to_string(entry.a % equations::kOrdersOfTable) + ")";
}

/// equations::Table::value.
constexpr const char* kTableValue =
    R"c(static double table_value(const double* x, const double* y, const double* slope, int last, double at, int order) {
  int k = 0, end = last;
  double h, z, rise, c, d;
  if (at <= x[0] || !(at < x[last])) {
    k = at <= x[0] ? 0 : last;
    return order == 0 ? y[k] + slope[k] * (at - x[k]) : order == 1 ? slope[k] : 0.0;
  }
  while (end - k > 1) {
    const int middle = (k + end) / 2;
    if (x[middle] <= at) k = middle;
    else end = middle;
  }
  h = x[k + 1] - x[k], z = (at - x[k]) / h, rise = y[k + 1] - y[k];
  c = 3.0 * rise - h * (2.0 * slope[k] + slope[k + 1]), d = h * (slope[k] + slope[k + 1]) - 2.0 * rise;
  if (order == 0) return y[k] + z * (h * slope[k] + z * (c + z * d));
  return order == 1 ? slope[k] + z * (2.0 * c + 3.0 * z * d) / h : (2.0 * c + 6.0 * z * d) / (h * h);
}

)c";

}  // namespace

std::string c_number(double value) {
  std::string result = text::exact(value);
  return result.find_first_of(".en") == std::string::npos ? result.append(".0") : result;
}

std::string c_tables(const equations::Expressions& expressions) {
  if (expressions.tables().empty()) return "";
  std::string text;
  for (std::size_t k = 0; k < expressions.tables().size(); ++k) {
    const equations::Table& table = expressions.tables()[k];
    const std::string name = "table" + std::to_string(k);
    for (const auto& [part, values] : {std::pair{"_x", &table.x()}, {"_y", &table.y()}, {"_slope", &table.slope()}}) {
      text.append("static const double ").append(name).append(part).append("[] = {");
      for (std::size_t n = 0; n < values->size(); ++n) text.append(n > 0 ? ", " : "").append(c_number((*values)[n]));
      text.append("};\n");
    }
    text.append("enum { ").append(name).append("_last = ").append(std::to_string(table.x().size() - 1)).append(" };\n");
  }
  return text + kTableValue;
}

std::string c_function(const std::string& name, const equations::TextEquationsParts& parts, std::span<const Node> nodes,
                       std::span<const std::size_t> rates) {
  const auto& entries = parts.expressions.entries();
  std::vector<bool> needed(entries.size(), false);
  for (const Node node : nodes) needed[node] = true;
  for (std::size_t k = entries.size(); k-- > 0;) {
    const bool leaf = entries[k].operation == Operation::constant || entries[k].operation == Operation::variable;
    if (!needed[k] || leaf) continue;
    const std::string_view pattern = pattern_of(entries[k].operation);
    if (pattern.find("$a") != std::string_view::npos) needed[entries[k].a] = true;
    if (entries[k].operation == Operation::table || pattern.find("$b") != std::string_view::npos)
      needed[entries[k].b] = true;
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
      const bool table = entry.operation == Operation::table;
      value[k] = "n" + std::to_string(k);
      text.append("  const double ").append(value[k]).append(" = ");
      text.append(table ? table_call(entry, value[entry.b])
                        : filled(pattern_of(entry.operation), value[entry.a], value[entry.b]));
      text.append(";\n");
    }
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    text.append("  result[").append(std::to_string(k)).append("] = ").append(value[nodes[k]]).append(";\n");
  return text.append("}\n");
}

}  // namespace sealwatch::fmi
