#include "services/common/text/estimates.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "services/common/text/format.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::text {

std::string misfit_text(double value) {
  return std::abs(value) < 9.995 ? format("{:.2f}", value) : number_text(value, 3);
}

double rounded_to_error(double value, double error) {
  constexpr double kGuard = 1e-3, kWithoutError = 1e-6;
  const double step = error > 0.0 && std::isfinite(error) ? kGuard * error : kWithoutError * std::abs(value);
  if (!(step > 0.0) || !std::isfinite(value) || value == 0.0) return value;
  const int digits = std::clamp(
      static_cast<int>(std::floor(std::log10(std::abs(value)))) - static_cast<int>(std::floor(std::log10(step))) + 1, 1,
      17);
  const std::string text = format("{:.{}e}", value, digits - 1);
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

}  // namespace sealwatch::text
