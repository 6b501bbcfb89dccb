// Expressions: values, exact derivatives against differences, units, what a wrong text is told.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/common/equations/formula.hpp"
#include "services/common/equations/tape.hpp"

namespace sealwatch::equations {
namespace {

/// x [m], v [m/s], a [1], p [1] and a table `curve` of plain numbers.
class SomeNames final : public Names {
 public:
  explicit SomeNames(Expressions& expressions) : e_(expressions) {
    table_ = e_.add_table(Table({-2.0, -0.5, 0.0, 1.0, 3.0}, {1.0, 0.2, 0.0, 0.3, 2.0}));
  }
  Result<Formula> quantity(const std::string& name) override {
    const std::array<std::pair<const char*, const char*>, 4> known = {
        {{"x", "m"}, {"v", "m/s"}, {"a", "1"}, {"p", "1"}}};
    for (std::size_t k = 0; k < known.size(); ++k)
      if (name == known[k].first) return Formula{e_.variable(k), *find_dimension(known[k].second), false};
    return fail("unknown " + name);
  }
  std::optional<Result<Formula>> call(const std::string& name, const std::vector<Syntax>& arguments) override {
    if (name != "curve") return std::nullopt;
    const auto at = understand(arguments.at(0), e_, *this);
    return Formula{e_.table(table_, at->node), Dimension{}, false};
  }
  std::vector<std::string> functions() const override { return {"curve"}; }

 private:
  Expressions& e_;
  std::size_t table_ = 0;
};

constexpr std::size_t kVariables = 4;

double value_of(const Expressions& e, Node node, const std::vector<double>& at, bool fixed = false) {
  const std::array<Node, 1> wanted = {node};
  const Tape tape(e, wanted, {fixed, false, false, fixed});
  std::vector<double> registers = tape.registers();
  std::ranges::copy(at, registers.begin());
  tape.prepare(registers);
  tape.run(registers);
  return tape.result(registers, 0);
}

TEST(Expressions, HaveTheValuesOfTheirText) {
  Expressions e;
  SomeNames names(e);
  const std::vector<double> at = {0.7, -0.3, 0.4, 2.0};
  const std::pair<const char*, double> cases[] = {
      {"1 + 2*3 - 4/2", 5.0},
      {"-2^2", -4.0},
      {"2^-1", 0.5},
      {"2^3^2", 512.0},
      {"(1 + a)*(1 - a)", 1.0 - 0.16},
      {"8/4/2", 1.0},
      {"x/1[m] + v/2[mm/s]", 0.7 - 150.0},
      {"abs(v, 0.4[m/s])/1[m/s]", 0.1},
      {"abs(v)/1[m/s]", 0.3},
      {"max(a, p)", 2.0},
      {"min(a, p)", 0.4},
      {"max(a, p, 1e-3)", 2.0},
      {"sign(v, 0.1[m/s])", std::tanh(-3.0)},
      {"step(a, 0.2)", 0.5 * (1.0 + std::tanh(2.0))},
      {"root(x, 0[m])/1[m^0.5]", std::sqrt(0.7)},
      {"hypot(3, 4)", 5.0},
      {"sqrt(x*x)/1[m]", 0.7},
      {"exp(log(a)) + sin(a)^2 + cos(a)^2", 1.4},
      {"tan(atan(a)) + asin(sin(a)) + acos(cos(a)) - tanh(0)", 1.2},
      {"curve(1)", 0.3},
      {"curve(5)", 2.0 + 2.0 * 0.85},
      {"p^a", std::pow(2.0, 0.4)},
  };
  for (const auto& [text, expected] : cases) {
    const auto formula = understand(text, e, names);
    ASSERT_TRUE(formula) << text << ": " << formula.error().describe();
    EXPECT_NEAR(value_of(e, formula->node, at), expected, 1e-12 * std::max(1.0, std::abs(expected))) << text;
    EXPECT_EQ(value_of(e, formula->node, at), value_of(e, formula->node, at, true)) << text << ", some of it once only";
  }
}

TEST(Expressions, HaveExactDerivatives) {
  Expressions e;
  SomeNames names(e);
  const char* texts[] = {"x*v/1[m]/1[m]*1[s] + x/1[m]",
                         "a/p + p/a",
                         "p^a",
                         "a^3 + a^0.5 + a^p",
                         "exp(a*p) + log(p) + sqrt(p + a)",
                         "sin(a) + cos(p) + tan(a*p/3)",
                         "asin(a) + acos(a) + atan(a*p)",
                         "tanh(a/p)",
                         "abs(v, 0.1[m/s])/1[m/s] + abs(v)/1[m/s]",
                         "max(a, p, 0.7) + min(a, p, 0.5)",
                         "max(a, p) + min(a, p)",
                         "sign(v, 0.2[m/s]) + step(a, 0.3)",
                         "root(v, 0.01[m/s])/1[m^0.5/s^0.5]",
                         "hypot(a, p)",
                         "curve(a) + curve(-p) + curve(a*10)",
                         "(a + p)^2*exp(-(a - p)^2)"};
  const std::vector<double> at = {0.7, -0.3, 0.4, 1.9};
  constexpr double kStep = 1e-5, kOfDifferences = 1e-7;
  for (const char* text : texts) {
    const auto formula = understand(text, e, names);
    ASSERT_TRUE(formula) << text << ": " << formula.error().describe();
    bool moves = false;
    for (std::size_t variable = 0; variable < kVariables; ++variable) {
      const Node slope = e.derivative(formula->node, variable);
      std::vector<double> up = at, down = at;
      up[variable] += kStep, down[variable] -= kStep;
      const double difference = (value_of(e, formula->node, up) - value_of(e, formula->node, down)) / (2.0 * kStep);
      const double exact = value_of(e, slope, at);
      EXPECT_NEAR(exact, difference, kOfDifferences * std::max(1.0, std::abs(exact))) << text << " by " << variable;
      moves = moves || exact != 0.0;
      // The second derivative too: rates of what laws see need it.
      const Node second = e.derivative(slope, variable);
      const double of_slopes = (value_of(e, slope, up) - value_of(e, slope, down)) / (2.0 * kStep);
      EXPECT_NEAR(value_of(e, second, at), of_slopes, 1e-5 * std::max(1.0, std::abs(of_slopes))) << text;
    }
    EXPECT_TRUE(moves) << text;
  }
}

TEST(Expressions, ShareWhatIsEqual) {
  Expressions e;
  SomeNames names(e);
  const auto a = understand("exp(a*p) + p", e, names), b = understand("p + exp(p*a)", e, names);
  EXPECT_EQ(a->node, b->node);
  const std::array<Node, 2> wanted = {a->node, e.derivative(a->node, 2)};
  const Tape both(e, wanted, std::vector<bool>(kVariables, false));
  EXPECT_EQ(both.instructions(), 4U) << "a*p, exp, + p, times p";
}

TEST(Expressions, StayFiniteFarOut) {
  Expressions e;
  SomeNames names(e);
  for (const char* text : {"max(a, p, 1e-6)", "min(a, p, 1e-6)", "step(a, 1e-9)", "sign(v, 1e-12[m/s])"}) {
    const auto formula = understand(text, e, names);
    for (const double far : {-1e9, 1e9})
      for (std::size_t k = 0; k < kVariables; ++k)
        EXPECT_TRUE(std::isfinite(value_of(e, e.derivative(formula->node, k), {far, far, far, -far}))) << text;
  }
}

TEST(Tables, AreSmoothAndKeepTheRiseOfTheirPoints) {
  const Table table({0.0, 1.0, 2.0, 4.0}, {0.0, 0.0, 5.0, 6.0});
  double last = -1e-12;
  for (double x = 0.0; x <= 4.0; x += 0.01) {
    EXPECT_GE(table.value(x, 0), last - 1e-12) << x;
    last = table.value(x, 0);
  }
  for (const double knot : {1.0, 2.0, 4.0}) EXPECT_NEAR(table.value(knot - 1e-9, 1), table.value(knot + 1e-9, 1), 1e-6);
  EXPECT_DOUBLE_EQ(table.value(2.0, 0), 5.0);
  EXPECT_TRUE(std::isnan(table.value(std::nan(""), 0)));
}

TEST(Units, AreProductsOfPowers) {
  const auto same = [](const char* a, const char* b) { return find_dimension(a).value() == find_dimension(b).value(); };
  EXPECT_TRUE(same("N", "kg m/s2"));
  EXPECT_TRUE(same("N s/m", "kg/s"));
  EXPECT_TRUE(same("m3/(s Pa^0.5)", "m^3.5 kg^-0.5"));
  EXPECT_TRUE(same("N m s/rad", "J s"));
  EXPECT_TRUE(same("ohm/A2", "V/A3"));
  EXPECT_TRUE(same("kOhm", "kohm"));
  EXPECT_TRUE(same("V^0.5/s", "V^0.5 Hz"));
  EXPECT_FALSE(same("N/m", "N m"));
  EXPECT_DOUBLE_EQ(find_dimension("bar")->scale, 1e5);
  EXPECT_NEAR(find_dimension("L/min")->scale, 1e-3 / 60.0, 1e-18);
  EXPECT_NEAR(find_dimension("mm2")->scale, 1e-6, 1e-18);
  for (const char* wrong : {"", "N/", "Nm2x", "(m", "m)", "m^", "metre", "m//s"})
    EXPECT_FALSE(find_dimension(wrong)) << wrong;
}

TEST(Faults, NameThePlaceAndWhatWouldMendIt) {
  Expressions e;
  SomeNames names(e);
  const std::pair<const char*, const char*> cases[] = {
      {"1 +", "character 4"},
      {"a b", "operator"},
      {"(a", ")"},
      {"a**2", "a^b"},
      {"3 $ 4", "$ 4"},
      {"x + v", "joins m (x) and m/s (v)"},
      {"x + 1e-3", "1e-3[m]"},
      {"tanh(v)", "not m/s"},
      {"cosh(a)", "did you mean 'cos'"},
      {"sign(v)", "width"},
      {"x^a", "not a fixed number"},
      {"a^x", "exponent in m"},
      {"a/0", "divides by zero"},
      {"2[metre]", "is not a unit"},
      {"2[m2.5/s]", "with ^: m^2.5"},
      {"2[m", "unit without its end"},
      {"sqrt(a, p)", "one argument"},
      {"1e999", "is not a number"},
      {"a^(2^2^2^2^2^2^2)", "is a constant that is not finite"},
      {"x + 1e300[m]*1e300", "is a constant that is not finite"},
      {"a*(x > 0)", "a choice is made with step(a, width)"},
      {"a <= 2", "a choice is made"},
      {"min(a, 2, 1 ? 2 : 3)", "a choice is made"},
      {"log(0)", "is a constant that is not finite"},
  };
  for (const auto& [text, expected] : cases) {
    const auto formula = understand(text, e, names);
    ASSERT_FALSE(formula) << text;
    EXPECT_NE(formula.error().describe().find(expected), std::string::npos)
        << text << ": " << formula.error().describe();
  }
  EXPECT_FALSE(understand(std::string(100000, '('), e, names)) << "no stack is so deep";
  EXPECT_FALSE(understand(std::string(100000, '-') + "1", e, names));
}

}  // namespace
}  // namespace sealwatch::equations
