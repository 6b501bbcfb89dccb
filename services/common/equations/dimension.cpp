#include "services/common/equations/dimension.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "sealwatch/core/text.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::equations {
namespace {

struct KnownUnit {
  std::string_view name;
  std::array<double, 7> power;
  double scale = 1.0;
  bool prefixed = true;
};

constexpr double kDegree = std::numbers::pi / 180.0;

//                                  m   kg    s    A   K mol cd
constexpr std::array kUnits = {
    KnownUnit{"m", {1, 0, 0, 0, 0, 0, 0}},
    KnownUnit{"g", {0, 1, 0, 0, 0, 0, 0}, 1e-3},
    KnownUnit{"s", {0, 0, 1, 0, 0, 0, 0}},
    KnownUnit{"A", {0, 0, 0, 1, 0, 0, 0}},
    KnownUnit{"K", {0, 0, 0, 0, 1, 0, 0}},
    KnownUnit{"mol", {0, 0, 0, 0, 0, 1, 0}},
    KnownUnit{"cd", {0, 0, 0, 0, 0, 0, 1}},
    KnownUnit{"N", {1, 1, -2, 0, 0, 0, 0}},
    KnownUnit{"Pa", {-1, 1, -2, 0, 0, 0, 0}},
    KnownUnit{"J", {2, 1, -2, 0, 0, 0, 0}},
    KnownUnit{"W", {2, 1, -3, 0, 0, 0, 0}},
    KnownUnit{"V", {2, 1, -3, -1, 0, 0, 0}},
    KnownUnit{"ohm", {2, 1, -3, -2, 0, 0, 0}},
    KnownUnit{"C", {0, 0, 1, 1, 0, 0, 0}},
    KnownUnit{"F", {-2, -1, 4, 2, 0, 0, 0}},
    KnownUnit{"H", {2, 1, -2, -2, 0, 0, 0}},
    KnownUnit{"Wb", {2, 1, -2, -1, 0, 0, 0}},
    KnownUnit{"T", {0, 1, -2, -1, 0, 0, 0}},
    KnownUnit{"S", {-2, -1, 3, 2, 0, 0, 0}},
    KnownUnit{"Hz", {0, 0, -1, 0, 0, 0, 0}},
    KnownUnit{"rad", {0, 0, 0, 0, 0, 0, 0}, 1.0, false},
    KnownUnit{"rev", {0, 0, 0, 0, 0, 0, 0}, 2.0 * std::numbers::pi, false},
    KnownUnit{"deg", {0, 0, 0, 0, 0, 0, 0}, kDegree, false},
    KnownUnit{"rpm", {0, 0, -1, 0, 0, 0, 0}, 6.0 * kDegree, false},
    KnownUnit{"bar", {-1, 1, -2, 0, 0, 0, 0}, 1e5},
    KnownUnit{"psi", {-1, 1, -2, 0, 0, 0, 0}, 6894.757293168361, false},
    KnownUnit{"L", {3, 0, 0, 0, 0, 0, 0}, 1e-3},
    KnownUnit{"min", {0, 0, 1, 0, 0, 0, 0}, 60.0, false},
    KnownUnit{"h", {0, 0, 1, 0, 0, 0, 0}, 3600.0, false},
    KnownUnit{"%", {0, 0, 0, 0, 0, 0, 0}, 0.01, false},
};

struct Prefix {
  char letter;
  double scale;
};
constexpr std::array kPrefixes = {Prefix{'G', 1e9},  Prefix{'M', 1e6},  Prefix{'k', 1e3},
                                  Prefix{'h', 1e2},  Prefix{'d', 1e-1}, Prefix{'c', 1e-2},
                                  Prefix{'m', 1e-3}, Prefix{'u', 1e-6}, Prefix{'n', 1e-9}};

std::optional<Dimension> unit_named(std::string_view name) {
  if (name.ends_with("Ohm")) return unit_named(std::string(name.substr(0, name.size() - 3)) + "ohm");
  for (const KnownUnit& unit : kUnits)
    if (unit.name == name) return Dimension{unit.power, unit.scale};
  for (const KnownUnit& unit : kUnits)
    for (const Prefix& prefix : kPrefixes)
      if (unit.prefixed && name.size() == unit.name.size() + 1 && name.front() == prefix.letter &&
          name.substr(1) == unit.name)
        return Dimension{unit.power, prefix.scale * unit.scale};
  return std::nullopt;
}

/// "Nms" as "N m s"; nothing where it is no product of units, or longer than such a slip is.
std::optional<std::string> split(std::string_view name) {
  constexpr std::size_t kLongest = 10;
  if (name.size() > kLongest) return std::nullopt;
  for (std::size_t length = 1; length <= name.size(); ++length) {
    if (!unit_named(name.substr(0, length))) continue;
    const std::string first(name.substr(0, length));
    if (length == name.size()) return first;
    if (const std::optional<std::string> rest = split(name.substr(length))) return first + " " + *rest;
  }
  return std::nullopt;
}

/// product = factor {[* . blank] factor | / factor};  factor = (product) | name[[^]number] | 1
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  Result<Dimension> read() {
    const Dimension all = product(0);
    skip();
    if (wrong_.empty() && at_ < text_.size()) wrong_ = std::string(text_.substr(at_));
    if (!wrong_.empty() || text_.empty()) return refused();
    return all;
  }

 private:
  [[nodiscard]] tl::unexpected<Error> refused() const {
    std::vector<std::string> names;
    for (const KnownUnit& unit : kUnits) names.emplace_back(unit.name);
    const std::optional<std::string> apart = split(wrong_);
    const bool temperature = wrong_ == "degC" || wrong_ == "degF" || wrong_ == "celsius" || wrong_ == "fahrenheit";
    return fail(Error{.file = {},
                      .place = {},
                      .value = std::string(text_),
                      .rule = wrong_ == text_ || wrong_.empty() ? "is not a unit" : "is not a unit: '" + wrong_ + "'",
                      .advice = wrong_.find_first_of("0123456789") == 0
                                    ? "write a power that is not whole with ^: m^2.5"
                                : temperature ? "write temperatures in K: 20 degrees Celsius are 293.15[K]"
                                : apart       ? "write a product with blanks: " + *apart
                                              : suggest(wrong_, names)});
  }

  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '*' || text_[at_] == '.')) ++at_;
  }

  Dimension product(int depth) {
    Dimension all = factor(depth);
    for (skip(); wrong_.empty() && at_ < text_.size() && text_[at_] != ')'; skip()) {
      const bool divides = text_[at_] == '/';
      if (divides) ++at_, skip();
      all = multiply(all, factor(depth), divides ? -1.0 : 1.0);
    }
    return all;
  }

  Dimension factor(int depth) {
    constexpr int kDeepest = 20;
    skip();
    if (at_ < text_.size() && text_[at_] == '(' && depth < kDeepest) {
      ++at_;
      const Dimension inner = product(depth + 1);
      if (at_ < text_.size() && text_[at_] == ')')
        ++at_;
      else if (wrong_.empty())
        wrong_ = "bracket without its end";
      return raised(inner, power());
    }
    const std::size_t begin = at_;
    if (at_ < text_.size() && text_[at_] == '1') return ++at_, Dimension{};
    while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '%'))
      ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    const std::optional<Dimension> unit = unit_named(name);
    if (!unit) {
      const std::string_view rest = name.empty() ? text_.substr(begin) : name;
      if (wrong_.empty()) wrong_ = rest.empty() ? "its end" : std::string(rest);
      return {};
    }
    return raised(*unit, power());
  }

  double power() {
    const bool marked = at_ < text_.size() && text_[at_] == '^';
    const std::size_t begin = at_ + (marked ? 1U : 0U);
    std::size_t end = begin;
    if (end < text_.size() && text_[end] == '-') ++end;
    while (end < text_.size() &&
           (std::isdigit(static_cast<unsigned char>(text_[end])) != 0 || (marked && text_[end] == '.')))
      ++end;
    double number = 1.0;
    const auto read = std::from_chars(text_.data() + begin, text_.data() + end, number);
    if (read.ec != std::errc{}) {
      if (marked && wrong_.empty()) wrong_ = "^ without a number";
      return 1.0;
    }
    at_ = end;
    return number;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string wrong_;
};

}  // namespace

Dimension multiply(const Dimension& a, const Dimension& b, double power_of_b) {
  Dimension product = a;
  for (std::size_t k = 0; k < product.power.size(); ++k) product.power[k] += power_of_b * b.power[k];
  product.scale *= std::pow(b.scale, power_of_b);
  return product;
}

Dimension raised(const Dimension& a, double power) { return power == 1.0 ? a : multiply(Dimension{}, a, power); }

Result<Dimension> find_dimension(std::string_view unit) { return UnitReader(unit).read(); }

std::string words_of(const Dimension& dimension) {
  constexpr std::array kNames = {"m", "kg", "s", "A", "K", "mol", "cd"};
  constexpr std::array kUsual = {"1/s", "N m", "N/m"};  // a torque is no work, a shaft's speed no frequency
  for (const char* usual : kUsual)
    if (*find_dimension(usual) == dimension) return usual;
  for (const KnownUnit& unit : kUnits)
    if (unit.scale == 1.0 && unit.prefixed && unit.power == dimension.power) return std::string(unit.name);
  std::string above, below;
  for (const std::size_t k : {1U, 0U, 2U, 3U, 4U, 5U, 6U}) {
    const double power = dimension.power[k];
    if (power == 0.0) continue;
    std::string& side = power > 0.0 ? above : below;
    if (!side.empty()) side += ' ';
    side += kNames[k];
    if (std::abs(power) == 1.0) continue;
    if (std::abs(power) != std::floor(std::abs(power))) side += '^';
    side += text::significant(std::abs(power), 6);
  }
  if (below.empty()) return above.empty() ? "1" : above;
  const bool several = below.find(' ') != std::string::npos;
  return (above.empty() ? std::string("1") : above)
      .append(several ? "/(" : "/")
      .append(below)
      .append(several ? ")" : "");
}

}  // namespace sealwatch::equations
