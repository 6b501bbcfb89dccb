#include "services/common/equations/formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "sealwatch/core/text.hpp"

namespace sealwatch::equations {
namespace {

constexpr Dimension kPlain{};

struct PlainFunction {
  std::string_view name;
  Operation operation;
};
constexpr std::array kOfPlainNumbers = {PlainFunction{"exp", Operation::exponential},
                                        PlainFunction{"log", Operation::logarithm},
                                        PlainFunction{"sin", Operation::sine},
                                        PlainFunction{"cos", Operation::cosine},
                                        PlainFunction{"tan", Operation::tangent},
                                        PlainFunction{"asin", Operation::arc_sine},
                                        PlainFunction{"acos", Operation::arc_cosine},
                                        PlainFunction{"atan", Operation::arc_tangent},
                                        PlainFunction{"tanh", Operation::hyperbolic_tangent}};

tl::unexpected<Error> wrong(std::string value, std::string rule, std::string advice = {}) {
  return fail(
      Error{.file = {}, .place = {}, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)});
}

std::string written(const Syntax& syntax);

std::string written_operands(const Syntax& syntax, const char* between) {
  std::string text;
  for (const Syntax& operand : syntax.operands) text.append(text.empty() ? "" : between).append(written(operand));
  return text;
}

std::string written(const Syntax& syntax) {
  switch (syntax.kind) {
    case Syntax::Kind::number:
      return syntax.unit.empty() ? syntax.text : syntax.text + "[" + syntax.unit + "]";
    case Syntax::Kind::name:
      return syntax.text;
    case Syntax::Kind::call:
      return std::string(syntax.text).append("(").append(written_operands(syntax, ", ")).append(")");
    case Syntax::Kind::negate:
      return std::string("-").append(written(syntax.operands.front()));
    case Syntax::Kind::add:
      return std::string("(").append(written_operands(syntax, " + ")).append(")");
    case Syntax::Kind::subtract:
      return std::string("(").append(written_operands(syntax, " - ")).append(")");
    case Syntax::Kind::multiply:
      return written_operands(syntax, "*");
    case Syntax::Kind::divide:
      return written_operands(syntax, "/");
    case Syntax::Kind::power:
      return written_operands(syntax, "^");
  }
  return {};
}

class Reader {
 public:
  Reader(Expressions& expressions, Names& names) : e_(expressions), names_(names) {}

  Result<Formula> read(const Syntax& syntax) { return finite(syntax, meaning(syntax)); }

 private:
  Result<Formula> meaning(const Syntax& syntax) {
    switch (syntax.kind) {
      case Syntax::Kind::number:
        return number(syntax);
      case Syntax::Kind::name:
        return names_.quantity(syntax.text);
      case Syntax::Kind::call:
        return call(syntax);
      default:
        return arithmetic(syntax);
    }
  }

  // No equation can be solved with an infinite number in it, or with none.
  Result<Formula> finite(const Syntax& syntax, Result<Formula> formula) const {
    if (!formula) return formula;
    const Expressions::Entry& entry = e_.entries()[formula->node];
    if (entry.operation != Operation::constant || std::isfinite(entry.number)) return formula;
    return wrong(written(syntax), "is a constant that is not finite", "give one that a double can hold, up to 1e308");
  }

  Result<Formula> number(const Syntax& syntax) {
    if (syntax.unit.empty()) return Formula{e_.constant(syntax.number), kPlain, syntax.number == 0.0};
    const Result<Dimension> unit = find_dimension(syntax.unit);
    if (!unit) return fail(unit.error());
    Formula result{e_.constant(syntax.number * unit->scale), *unit, false};
    result.dimension.scale = 1.0;
    return result;
  }

  Result<std::vector<Formula>> operands(const Syntax& syntax) {
    std::vector<Formula> all;
    for (const Syntax& operand : syntax.operands) {
      Result<Formula> one = read(operand);
      if (!one) return fail(one.error());
      all.push_back(*one);
    }
    return all;
  }

  // The unit that all share.
  Result<Dimension> common(const Syntax& syntax, const std::vector<Formula>& parts) {
    const auto known = std::ranges::find_if(parts, [](const Formula& part) { return !part.any_unit; });
    if (known == parts.end()) return kPlain;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (parts[k].any_unit || parts[k].dimension == known->dimension) continue;
      const auto first = static_cast<std::size_t>(known - parts.begin());
      const bool plain = syntax.operands[k].kind == Syntax::Kind::number && syntax.operands[k].unit.empty();
      return wrong(
          written(syntax),
          "joins " + words_of(known->dimension) + " (" + written(syntax.operands[first]) + ") and " +
              words_of(parts[k].dimension) + " (" + written(syntax.operands[k]) + ")",
          plain ? "give the number its unit: " + syntax.operands[k].text + "[" + words_of(known->dimension) + "]" : "");
    }
    return known->dimension;
  }

  // a + b - c is (a + b) - c: a long sum is deep at its left, which is gone through from its first part on.
  Result<Formula> arithmetic(const Syntax& syntax) {
    std::vector<const Syntax*> spine = {&syntax};
    while (is_arithmetic(spine.back()->operands.front())) spine.push_back(&spine.back()->operands.front());
    Result<Formula> left = read(spine.back()->operands.front());
    for (auto part = spine.rbegin(); left && part != spine.rend(); ++part) {
      std::vector<Formula> parts = {*left};
      for (std::size_t k = 1; k < (*part)->operands.size(); ++k) {
        const Result<Formula> one = read((*part)->operands[k]);
        if (!one) return fail(one.error());
        parts.push_back(*one);
      }
      left = finite(**part, joined(**part, parts));
    }
    return left;
  }

  static bool is_arithmetic(const Syntax& syntax) {
    return syntax.kind != Syntax::Kind::number && syntax.kind != Syntax::Kind::name &&
           syntax.kind != Syntax::Kind::call;
  }

  Result<Formula> joined(const Syntax& syntax, const std::vector<Formula>& parts) {
    const Formula& a = parts.front();
    const Formula& b = parts.back();
    switch (syntax.kind) {
      case Syntax::Kind::negate:
        return Formula{e_.apply(Operation::negate, a.node), a.dimension, a.any_unit};
      case Syntax::Kind::multiply:
        return Formula{e_.multiply(a.node, b.node), multiply(a.dimension, b.dimension), a.any_unit || b.any_unit};
      case Syntax::Kind::divide:
        if (e_.is_constant(b.node, 0.0)) return wrong(written(syntax), "divides by zero");
        return Formula{e_.divide(a.node, b.node), multiply(a.dimension, b.dimension, -1.0), a.any_unit || b.any_unit};
      case Syntax::Kind::power:
        return power(syntax, a, b);
      default:
        break;
    }
    const auto unit = common(syntax, parts);
    if (!unit) return fail(unit.error());
    const bool adds = syntax.kind == Syntax::Kind::add;
    return Formula{adds ? e_.add(a.node, b.node) : e_.subtract(a.node, b.node), *unit, a.any_unit && b.any_unit};
  }

  Result<Formula> power(const Syntax& syntax, const Formula& base, const Formula& exponent) {
    if (!(exponent.dimension == kPlain))
      return wrong(written(syntax), "has an exponent in " + words_of(exponent.dimension),
                   "an exponent is a plain number");
    const Node node = e_.apply(Operation::power, base.node, exponent.node);
    const Expressions::Entry& entry = e_.entries()[exponent.node];
    if (entry.operation == Operation::constant)
      return Formula{node, raised(base.dimension, entry.number), base.any_unit};
    if (!(base.dimension == kPlain))
      return wrong(written(syntax), "raises " + words_of(base.dimension) + " to a power that is not a fixed number",
                   "divide the base by a reference of its unit first");
    return Formula{node, kPlain, false};
  }

  Result<Formula> call(const Syntax& syntax) {
    if (const auto own = names_.call(syntax.text, syntax.operands)) return *own;
    const auto plain = std::ranges::find(kOfPlainNumbers, syntax.text, &PlainFunction::name);
    const std::vector<std::string> known = known_functions();
    if (plain == kOfPlainNumbers.end() && std::ranges::find(known, syntax.text) == known.end()) return unknown(syntax);
    const auto parts = operands(syntax);
    if (!parts) return fail(parts.error());
    if (plain == kOfPlainNumbers.end()) return rounded(syntax, *parts);
    if (parts->size() != 1) return arguments(syntax, "one argument");
    const Formula& a = parts->front();
    if (!(a.dimension == kPlain))
      return wrong(written(syntax), "takes a plain number, not " + words_of(a.dimension),
                   "divide the argument by a reference of its unit");
    return Formula{e_.apply(plain->operation, a.node), kPlain, false};
  }

  tl::unexpected<Error> unknown(const Syntax& syntax) {
    std::vector<std::string> functions = known_functions();
    for (const std::string& own : names_.functions()) functions.push_back(own);
    return wrong(syntax.text, "is not a known function", suggest(syntax.text, functions));
  }

  static tl::unexpected<Error> arguments(const Syntax& syntax, const std::string& needed) {
    return wrong(written(syntax), syntax.text + " takes " + needed);
  }

  // w ln(1 + exp((a - b) / w))
  Node rounded_excess(Node a, Node b, Node w) {
    return e_.multiply(w, e_.apply(Operation::softplus, e_.divide(e_.subtract(a, b), w)));
  }

  Result<Formula> rounded(const Syntax& syntax, const std::vector<Formula>& parts) {
    const std::string& name = syntax.text;
    if (name == "sqrt") {
      if (parts.size() != 1) return arguments(syntax, "one argument");
      return Formula{e_.apply(Operation::square_root, parts[0].node), raised(parts[0].dimension, 0.5),
                     parts[0].any_unit};
    }
    const auto unit = common(syntax, parts);
    if (!unit) return fail(unit.error());
    const bool any = std::ranges::all_of(parts, &Formula::any_unit);
    const auto of = [&](Node node) { return Formula{node, *unit, any}; };
    const auto square = [&](Node node) { return e_.multiply(node, node); };
    const auto root = [&](Node node) { return e_.apply(Operation::square_root, node); };
    const std::size_t count = parts.size();
    const Node a = parts[0].node, b = parts[count > 1 ? 1 : 0].node, w = parts.back().node;
    if (name == "hypot" && count == 2) return of(root(e_.add(square(a), square(b))));
    if (name == "abs" && count == 1) return of(e_.apply(Operation::magnitude, a));
    if (name == "abs" && count == 2) return of(e_.subtract(root(e_.add(square(a), square(w))), w));
    if ((name == "min" || name == "max") && count == 2) {
      const Node apart = e_.apply(Operation::magnitude, e_.subtract(a, b));
      const Node twice = name == "max" ? e_.add(e_.add(a, b), apart) : e_.subtract(e_.add(a, b), apart);
      return of(e_.multiply(e_.constant(0.5), twice));
    }
    if (name == "max" && count == 3) return of(e_.add(b, rounded_excess(a, b, w)));
    if (name == "min" && count == 3) return of(e_.subtract(a, rounded_excess(a, b, w)));
    if (name == "sign" && count == 2)
      return Formula{e_.apply(Operation::hyperbolic_tangent, e_.divide(a, w)), kPlain, false};
    if (name == "step" && count == 2)
      return Formula{e_.apply(Operation::logistic, e_.multiply(e_.constant(2.0), e_.divide(a, w))), kPlain, false};
    if (name == "root" && count == 2)
      return Formula{e_.divide(a, root(e_.add(e_.apply(Operation::magnitude, a), w))), raised(*unit, 0.5), any};
    const bool jump = name == "sign" || name == "step" || name == "root";
    return arguments(
        syntax, name == "hypot" ? "two arguments"
                : jump ? "two arguments, the second being the width over which it is rounded, as in sign(v, 1e-4[m/s])"
                : name == "abs" ? "one argument, and a width where its corner is to be rounded"
                                : "two arguments, and a width where its corner is to be rounded");
  }

  Expressions& e_;
  Names& names_;
};

}  // namespace

std::vector<std::string> known_functions() {
  std::vector<std::string> names = {"sqrt", "hypot", "abs", "min", "max", "sign", "step", "root"};
  for (const PlainFunction& function : kOfPlainNumbers) names.emplace_back(function.name);
  return names;
}

Result<Formula> understand(const Syntax& syntax, Expressions& expressions, Names& names) {
  return Reader(expressions, names).read(syntax);
}

Result<Formula> understand(const std::string& text, Expressions& expressions, Names& names) {
  const Result<Syntax> syntax = parse(text);
  if (!syntax) return fail(syntax.error());
  return understand(*syntax, expressions, names);
}

Result<Formula> understand(const std::string& text, Expressions& expressions, Names& names,
                           const std::optional<Dimension>& expected) {
  Result<Formula> formula = understand(text, expressions, names);
  if (!formula || !expected || formula->any_unit || formula->dimension == *expected) return formula;
  return wrong(text, "has the unit " + words_of(formula->dimension) + " where " + words_of(*expected) + " is needed");
}

}  // namespace sealwatch::equations
