#include "services/common/equations/expression.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sealwatch::equations {
namespace {

bool has_two_operands(Operation operation) { return operation >= Operation::add && operation <= Operation::power; }
bool is_leaf(Operation operation) { return operation <= Operation::variable; }

}  // namespace

double evaluate(Operation operation, double a, double b) {
  switch (operation) {
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    case Operation::power:
      return std::pow(a, b);
    case Operation::negate:
      return -a;
    case Operation::exponential:
      return std::exp(a);
    case Operation::logarithm:
      return std::log(a);
    case Operation::square_root:
      return std::sqrt(a);
    case Operation::sine:
      return std::sin(a);
    case Operation::cosine:
      return std::cos(a);
    case Operation::tangent:
      return std::tan(a);
    case Operation::arc_sine:
      return std::asin(a);
    case Operation::arc_cosine:
      return std::acos(a);
    case Operation::arc_tangent:
      return std::atan(a);
    case Operation::hyperbolic_tangent:
      return std::tanh(a);
    case Operation::magnitude:
      return std::abs(a);
    case Operation::sign:
      return a < 0.0 ? -1.0 : 1.0;
    case Operation::softplus:
      return a > 0.0 ? a + std::log1p(std::exp(-a)) : std::log1p(std::exp(a));
    case Operation::logistic:
      return a > 0.0 ? 1.0 / (1.0 + std::exp(-a)) : std::exp(a) / (1.0 + std::exp(a));
    case Operation::constant:
    case Operation::variable:
    case Operation::table:
      break;
  }
  return a;
}

Table::Table(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size(), 0.0) {
  const std::size_t last = x_.size() - 1;
  std::vector<double> secant(last);
  for (std::size_t k = 0; k < last; ++k) secant[k] = (y_[k + 1] - y_[k]) / (x_[k + 1] - x_[k]);
  slope_.front() = secant.front(), slope_.back() = secant.back();
  for (std::size_t k = 1; k < last; ++k)
    slope_[k] = secant[k - 1] * secant[k] > 0.0 ? 0.5 * (secant[k - 1] + secant[k]) : 0.0;
  constexpr double kSteepest = 3.0;  // secants, so that a piece rises or falls all along
  for (std::size_t k = 0; k < last; ++k)
    for (const std::size_t end : {k, k + 1})
      if (std::abs(slope_[end]) > kSteepest * std::abs(secant[k])) slope_[end] = kSteepest * secant[k];
}

double Table::value(double at, int order) const {
  const bool before = at <= x_.front();
  if (before || !(at < x_.back())) {  // what is no number too
    const double end = before ? x_.front() : x_.back(), slope = before ? slope_.front() : slope_.back();
    if (order > 0) return order == 1 ? slope : 0.0;
    return (before ? y_.front() : y_.back()) + slope * (at - end);
  }
  const auto k = static_cast<std::size_t>(std::ranges::upper_bound(x_, at) - x_.begin()) - 1;
  const double h = x_[k + 1] - x_[k], t = (at - x_[k]) / h, rise = y_[k + 1] - y_[k];
  const double c = 3.0 * rise - h * (2.0 * slope_[k] + slope_[k + 1]), d = h * (slope_[k] + slope_[k + 1]) - 2.0 * rise;
  if (order == 0) return y_[k] + t * (h * slope_[k] + t * (c + t * d));
  return order == 1 ? slope_[k] + t * (2.0 * c + 3.0 * t * d) / h : (2.0 * c + 6.0 * t * d) / (h * h);
}

Node Expressions::intern(const Entry& entry) {
  const auto key = std::make_tuple(entry.operation, entry.a, entry.b, std::bit_cast<std::uint64_t>(entry.number));
  const auto [known, added] = known_.try_emplace(key, static_cast<Node>(entries_.size()));
  if (added) entries_.push_back(entry);
  return known->second;
}

Node Expressions::constant(double number) {
  return intern({.operation = Operation::constant, .a = 0, .b = 0, .number = number == 0.0 ? 0.0 : number});
}

Node Expressions::variable(std::size_t number) {
  return intern({.operation = Operation::variable, .a = static_cast<Node>(number), .b = 0, .number = 0.0});
}

std::size_t Expressions::add_table(Table table) {
  tables_.push_back(std::move(table));
  return tables_.size() - 1;
}

Node Expressions::table(std::size_t number, Node at, int order) {
  if (static_cast<std::size_t>(order) >= kOrdersOfTable) return constant(0.0);
  const auto which = static_cast<Node>(number * kOrdersOfTable + static_cast<std::size_t>(order));
  return intern({.operation = Operation::table, .a = which, .b = at, .number = 0.0});
}

bool Expressions::is_constant(Node node, double number) const {
  return entries_[node].operation == Operation::constant && entries_[node].number == number;
}

// a + 0, a - 0, a * 1, a / 1, 0 * a, 0 / a, a^1, a^0, operations on constants.
Node Expressions::simplified(Operation operation, Node a, Node b, bool& known) {
  known = true;
  const bool two = has_two_operands(operation);
  if (entries_[a].operation == Operation::constant && (!two || entries_[b].operation == Operation::constant))
    return constant(evaluate(operation, entries_[a].number, entries_[b].number));
  if (operation == Operation::add && is_constant(a, 0.0)) return b;
  if ((operation == Operation::add || operation == Operation::subtract) && is_constant(b, 0.0)) return a;
  if (operation == Operation::subtract && is_constant(a, 0.0)) return apply(Operation::negate, b);
  if (operation == Operation::multiply && (is_constant(a, 0.0) || is_constant(b, 0.0))) return constant(0.0);
  if (operation == Operation::multiply && is_constant(a, 1.0)) return b;
  if ((operation == Operation::multiply || operation == Operation::divide || operation == Operation::power) &&
      is_constant(b, 1.0))
    return a;
  if (operation == Operation::divide && is_constant(a, 0.0)) return a;
  if (operation == Operation::power && is_constant(b, 0.0)) return constant(1.0);
  if (operation == Operation::power && is_constant(b, 2.0)) return multiply(a, a);
  if (operation == Operation::negate && entries_[a].operation == Operation::negate) return entries_[a].a;
  known = false;
  return 0;
}

Node Expressions::apply(Operation operation, Node a, Node b) {
  bool known = false;
  const Node simple = simplified(operation, a, b, known);
  if (known) return simple;
  const bool commutes = operation == Operation::add || operation == Operation::multiply;
  if (commutes && a > b) std::swap(a, b);
  return intern({.operation = operation, .a = a, .b = b, .number = 0.0});
}

Node Expressions::derivative_of(const Entry& entry, Node node, Node da, Node db) {
  const auto one = [this] { return constant(1.0); };
  const auto times = [&](Node slope) { return multiply(slope, da); };
  const Node a = entry.a, b = entry.b;
  switch (entry.operation) {
    case Operation::add:
    case Operation::subtract:
      return apply(entry.operation, da, db);
    case Operation::multiply:
      return add(multiply(da, b), multiply(a, db));
    case Operation::divide:
      return divide(subtract(da, multiply(node, db)), b);
    case Operation::power: {
      const Node by_base = multiply(b, apply(Operation::power, a, subtract(b, one())));
      if (is_constant(db, 0.0)) return times(by_base);
      return add(times(by_base), multiply(multiply(node, apply(Operation::logarithm, a)), db));
    }
    case Operation::negate:
      return apply(Operation::negate, da);
    case Operation::exponential:
      return times(node);
    case Operation::logarithm:
      return divide(da, a);
    case Operation::square_root:
      return divide(multiply(constant(0.5), da), node);
    case Operation::sine:
      return times(apply(Operation::cosine, a));
    case Operation::cosine:
      return apply(Operation::negate, times(apply(Operation::sine, a)));
    case Operation::tangent:
      return times(add(one(), multiply(node, node)));
    case Operation::arc_sine:
    case Operation::arc_cosine: {
      const Node slope = divide(da, apply(Operation::square_root, subtract(one(), multiply(a, a))));
      return entry.operation == Operation::arc_sine ? slope : apply(Operation::negate, slope);
    }
    case Operation::arc_tangent:
      return divide(da, add(one(), multiply(a, a)));
    case Operation::hyperbolic_tangent:
      return times(subtract(one(), multiply(node, node)));
    case Operation::magnitude:
      return times(apply(Operation::sign, a));
    case Operation::softplus:
      return times(apply(Operation::logistic, a));
    case Operation::logistic:
      return times(multiply(node, subtract(one(), node)));
    case Operation::table:
      return multiply(table(a / kOrdersOfTable, b, static_cast<int>(a % kOrdersOfTable) + 1), db);
    case Operation::constant:
    case Operation::variable:
    case Operation::sign:
      break;
  }
  return constant(0.0);
}

// Operands first, without recursion: an expression may be deep.
Node Expressions::derivative(Node of, std::size_t variable) {
  std::vector<Node> open{of};
  while (!open.empty()) {
    const Node node = open.back();
    const auto key = std::pair(node, variable);
    if (derivatives_.contains(key)) {
      open.pop_back();
      continue;
    }
    const Entry entry = entries_[node];
    if (is_leaf(entry.operation)) {
      const bool itself = entry.operation == Operation::variable && entry.a == variable;
      derivatives_[key] = constant(itself ? 1.0 : 0.0);
      continue;
    }
    const bool first = entry.operation != Operation::table;
    const bool second = has_two_operands(entry.operation) || entry.operation == Operation::table;
    const auto ready = [&](Node operand) { return derivatives_.contains({operand, variable}); };
    const std::size_t before = open.size();
    if (first && !ready(entry.a)) open.push_back(entry.a);
    if (second && !ready(entry.b)) open.push_back(entry.b);
    if (open.size() > before) continue;
    const Node zero = constant(0.0);
    const Node da = first ? derivatives_.at({entry.a, variable}) : zero;
    const Node db = second ? derivatives_.at({entry.b, variable}) : zero;
    const bool still = is_constant(da, 0.0) && is_constant(db, 0.0);
    derivatives_[key] = still ? zero : derivative_of(entry, node, da, db);
  }
  return derivatives_.at({of, variable});
}

std::vector<bool> Expressions::variables_of(std::span<const Node> nodes, std::size_t count) const {
  std::vector<bool> needed(entries_.size(), false), variables(count, false);
  for (const Node node : nodes) needed[node] = true;
  for (std::size_t node = entries_.size(); node-- > 0;) {
    if (!needed[node]) continue;
    const Entry& entry = entries_[node];
    if (entry.operation == Operation::variable) variables[entry.a] = true;
    if (is_leaf(entry.operation)) continue;
    if (entry.operation != Operation::table) needed[entry.a] = true;
    if (has_two_operands(entry.operation) || entry.operation == Operation::table) needed[entry.b] = true;
  }
  return variables;
}

}  // namespace sealwatch::equations
