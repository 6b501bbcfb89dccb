// Expressions of a plant that is written as text: one graph in which equal subexpressions are one node, and exact
// derivatives as further nodes of the same graph.
//
//   Expressions e;
//   Node x = e.variable(0), y = e.multiply(x, e.apply(Function::sine, x));   // x sin x
//   Node dy = e.derivative(y, 0);                                            // sin x + x cos x
//
// A node's operands come before it, so that the order of the nodes is an order of evaluation. Sums and products with 0 and
// 1 and operations on constants are carried out at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace sealwatch::equations {

using Node = std::uint32_t;

enum class Operation : std::uint8_t {
  constant,
  variable,
  add,
  subtract,
  multiply,
  divide,
  power,  ///< a^b
  negate,
  exponential,
  logarithm,
  square_root,
  sine,
  cosine,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,
  hyperbolic_tangent,
  magnitude,  ///< |a|; its slope at 0 is taken as 1
  sign,       ///< of |a|'s slope: -1 or 1
  softplus,   ///< ln(1 + exp a)
  logistic,   ///< 1 / (1 + exp(-a)), the slope of softplus
  table       ///< a: table's number and order of derivative, b: where
};

/// A smooth curve through points: cubic pieces whose slopes keep each rise and fall of the points (F. N. Fritsch, R. E.
/// Carlson, SIAM J. Numer. Anal. 17 (1980) 238); straight beyond its ends.
class Table {
 public:
  Table(std::vector<double> x, std::vector<double> y);
  /// The curve (order 0), its slope (1) or its curvature (2).
  [[nodiscard]] double value(double at, int order) const;

  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& y() const { return y_; }
  /// At the points.
  [[nodiscard]] const std::vector<double>& slope() const { return slope_; }

 private:
  std::vector<double> x_, y_, slope_;
};

/// Of a table's curve, its slope or its curvature: which table, and the order.
inline constexpr std::size_t kOrdersOfTable = 3;

double evaluate(Operation operation, double a, double b);

class Expressions {
 public:
  struct Entry {
    Operation operation = Operation::constant;
    Node a = 0, b = 0;    ///< operands; of a variable: its number; of a table: its number and order, and where
    double number = 0.0;  ///< of a constant
  };

  [[nodiscard]] Node constant(double number);
  [[nodiscard]] Node variable(std::size_t number);
  [[nodiscard]] Node apply(Operation operation, Node a, Node b = 0);
  [[nodiscard]] Node table(std::size_t number, Node at, int order = 0);
  std::size_t add_table(Table table);

  [[nodiscard]] Node add(Node a, Node b) { return apply(Operation::add, a, b); }
  [[nodiscard]] Node subtract(Node a, Node b) { return apply(Operation::subtract, a, b); }
  [[nodiscard]] Node multiply(Node a, Node b) { return apply(Operation::multiply, a, b); }
  [[nodiscard]] Node divide(Node a, Node b) { return apply(Operation::divide, a, b); }

  /// d of / d variable.
  [[nodiscard]] Node derivative(Node of, std::size_t variable);
  /// Which variables the nodes depend on; `count`: how many variables there are.
  [[nodiscard]] std::vector<bool> variables_of(std::span<const Node> nodes, std::size_t count) const;
  [[nodiscard]] bool is_constant(Node node, double number) const;

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const std::vector<Table>& tables() const { return tables_; }

 private:
  [[nodiscard]] Node intern(const Entry& entry);
  [[nodiscard]] Node simplified(Operation operation, Node a, Node b, bool& known);
  [[nodiscard]] Node derivative_of(const Entry& entry, Node node, Node da, Node db);

  std::vector<Entry> entries_;
  std::map<std::tuple<Operation, Node, Node, std::uint64_t>, Node> known_;
  std::map<std::pair<Node, std::size_t>, Node> derivatives_;
  std::vector<Table> tables_;
};

}  // namespace sealwatch::equations
