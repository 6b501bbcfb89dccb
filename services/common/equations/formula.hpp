// The meaning of an expression's tree: names resolved, units checked, a node of the graph.
//
// Functions: sqrt exp log sin cos tan asin acos atan tanh hypot(a, b) abs(a) min(a, b) max(a, b), and rounded ones whose
// last argument is the width over which their corner or jump is rounded:
//   abs(a, w)     sqrt(a^2 + w^2) - w            sign(a, w)    tanh(a / w)
//   max(a, b, w)  b + w ln(1 + exp((a - b)/w))   min(a, b, w)  a - w ln(1 + exp((a - b)/w))
//   step(a, w)    (1 + tanh(a / w)) / 2          root(a, w)    a / sqrt(|a| + w), a signed square root
// A number without a unit is a plain number; 0 has any unit; 0.2[bar] is converted to SI.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/common/equations/dimension.hpp"
#include "services/common/equations/expression.hpp"
#include "services/common/equations/syntax.hpp"

namespace sealwatch::equations {

struct Formula {
  Node node = 0;
  Dimension dimension;
  bool any_unit = false;  ///< the number 0, or something with a fault that was told already
};

/// What names mean in an expression.
class Names {
 public:
  virtual ~Names() = default;
  /// A quantity; an Error when it is not known (or defined in a circle).
  [[nodiscard]] virtual Result<Formula> quantity(const std::string& name) = 0;
  /// A function beside those of every expression (a table, the rate of an input); nothing: there is none of that name.
  [[nodiscard]] virtual std::optional<Result<Formula>> call(const std::string& name,
                                                            const std::vector<Syntax>& arguments) = 0;
  /// Names of such functions, for suggestions.
  [[nodiscard]] virtual std::vector<std::string> functions() const = 0;
};

[[nodiscard]] Result<Formula> understand(const Syntax& syntax, Expressions& expressions, Names& names);
[[nodiscard]] Result<Formula> understand(const std::string& text, Expressions& expressions, Names& names);
/// The same where a unit is expected; nothing: any is right.
[[nodiscard]] Result<Formula> understand(const std::string& text, Expressions& expressions, Names& names,
                                         const std::optional<Dimension>& expected);

/// Names of the functions that every expression knows.
[[nodiscard]] std::vector<std::string> known_functions();

}  // namespace sealwatch::equations
