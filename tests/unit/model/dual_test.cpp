// Dual numbers against central differences, and the chain rule through a longer expression.
#include "sealwatch/model/dual.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace sealwatch {
namespace {

constexpr double kDifferenceError = 1e-8;  // of central differences with a step of 1e-6 on functions of size one

struct Function {
  const char* name;
  std::function<Dual<2>(Dual<2>, Dual<2>)> dual;
  std::function<double(double, double)> plain;
};

std::vector<Function> functions() {
  return {
      {"sum", [](auto a, auto b) { return a + b; }, [](double a, double b) { return a + b; }},
      {"difference", [](auto a, auto b) { return a - b; }, [](double a, double b) { return a - b; }},
      {"product", [](auto a, auto b) { return a * b; }, [](double a, double b) { return a * b; }},
      {"quotient", [](auto a, auto b) { return a / b; }, [](double a, double b) { return a / b; }},
      {"minus", [](auto a, auto) { return -a; }, [](double a, double) { return -a; }},
      {"with numbers on the right", [](auto a, auto b) { return (a + 2.0) * 3.0 - b / 4.0 - 1.0; },
       [](double a, double b) { return (a + 2.0) * 3.0 - b / 4.0 - 1.0; }},
      {"with numbers on the left", [](auto a, auto b) { return 2.0 + 3.0 * a - (1.0 - 5.0 / b); },
       [](double a, double b) { return 2.0 + 3.0 * a - (1.0 - 5.0 / b); }},
      {"exp", [](auto a, auto) { return exp(a); }, [](double a, double) { return std::exp(a); }},
      {"log", [](auto a, auto) { return log(a); }, [](double a, double) { return std::log(a); }},
      {"log1p", [](auto a, auto) { return log1p(a); }, [](double a, double) { return std::log1p(a); }},
      {"sqrt", [](auto a, auto) { return sqrt(a); }, [](double a, double) { return std::sqrt(a); }},
      {"tanh", [](auto a, auto) { return tanh(a); }, [](double a, double) { return std::tanh(a); }},
      {"abs of negative", [](auto a, auto) { return abs(-a); }, [](double a, double) { return std::abs(-a); }},
      {"pow", [](auto a, auto) { return pow(a, 0.7); }, [](double a, double) { return std::pow(a, 0.7); }},
      {"composition", [](auto a, auto b) { return sqrt(a * b + exp(-a)) / (1.0 + tanh(b)); },
       [](double a, double b) { return std::sqrt(a * b + std::exp(-a)) / (1.0 + std::tanh(b)); }},
  };
}

TEST(Dual, AgreesWithCentralDifferences) {
  constexpr double a = 0.8, b = 1.7, step = 1e-6;
  for (const Function& f : functions()) {
    const Dual<2> result = f.dual(Dual<2>::variable(a, 0), Dual<2>::variable(b, 1));
    EXPECT_DOUBLE_EQ(result.value, f.plain(a, b)) << f.name;
    EXPECT_NEAR(result.derivative[0], (f.plain(a + step, b) - f.plain(a - step, b)) / (2.0 * step), kDifferenceError)
        << f.name;
    EXPECT_NEAR(result.derivative[1], (f.plain(a, b + step) - f.plain(a, b - step)) / (2.0 * step), kDifferenceError)
        << f.name;
  }
}

TEST(Dual, ConstantsHaveNoDerivative) {
  const Dual<3> constant = 4.0;
  for (const double slope : (constant * constant).derivative) EXPECT_EQ(slope, 0.0);
}

}  // namespace
}  // namespace sealwatch
