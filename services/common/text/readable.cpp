#include "services/common/text/readable.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::text {
namespace {

/// From `least` (absolute, SI) on, a quantity of `si_unit` is shown in `text`. Largest first within a unit.
struct Everyday {
  std::string_view si_unit;
  double least;
  double factor;
  std::string_view text;
};

constexpr double kRpm = 30.0 / std::numbers::pi;
constexpr auto kEveryday = std::to_array<Everyday>({
    {"Pa", 1e4, 1e-5, "bar"},       {"Pa", 10.0, 1e-2, "mbar"},      {"Pa", 0.0, 1.0, "Pa"},
    {"m", 1.0, 1.0, "m"},           {"m", 5e-4, 1e3, "mm"},          {"m", 0.0, 1e6, "µm"},
    {"m/s", 1.0, 1.0, "m/s"},       {"m/s", 1e-4, 1e3, "mm/s"},      {"m/s", 0.0, 1e6, "µm/s"},
    {"m3/s", 1.6e-6, 6e4, "L/min"}, {"m3/s", 1.6e-9, 6e7, "mL/min"}, {"m3/s", 0.0, 6e10, "µL/min"},
    {"m3", 1e-4, 1e3, "L"},         {"m3", 0.0, 1e6, "mL"},          {"N", 2e3, 1e-3, "kN"},
    {"N", 0.0, 1.0, "N"},           {"N m", 0.1, 1.0, "N·m"},        {"N m", 0.0, 1e3, "mN·m"},
    {"V", 0.1, 1.0, "V"},           {"V", 0.0, 1e3, "mV"},           {"A", 0.1, 1.0, "A"},
    {"A", 0.0, 1e3, "mA"},          {"rad/s", 0.0, kRpm, "rpm"},     {"s", 0.5, 1.0, "s"},
    {"s", 0.0, 1e3, "ms"},
});

std::string superscript(int exponent) {
  constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char letter : std::to_string(exponent)) {
    if (letter == '-')
      text += "⁻";
    else
      text += kDigits.at(static_cast<std::size_t>(letter - '0'));
  }
  return text;
}

// What is rounded to nothing has no sign.
std::string with_minus(const std::string& digits) {
  if (!digits.starts_with("-")) return digits;
  const bool is_nothing = digits.find_first_of("123456789") == std::string::npos;
  return (is_nothing ? std::string() : std::string("−")).append(digits, 1);
}

std::string power_of_ten(int exponent) { return std::string("10").append(superscript(exponent)); }

}  // namespace

std::string unit_text(std::string_view si_unit) {
  if (si_unit == "1") return {};
  std::string text;
  for (std::size_t k = 0; k < si_unit.size(); ++k) {
    const bool after_letter = k > 0 && std::isalpha(static_cast<unsigned char>(si_unit[k - 1])) != 0;
    if (si_unit[k] == ' ')
      text += "·";
    else if (after_letter && std::isdigit(static_cast<unsigned char>(si_unit[k])) != 0)
      text += superscript(si_unit[k] - '0');
    else
      text += si_unit[k];
  }
  return text;
}

DisplayUnit display_unit(std::string_view si_unit, double magnitude) {
  const double size = std::isfinite(magnitude) ? std::abs(magnitude) : 0.0;
  for (const Everyday& unit : kEveryday)
    if (unit.si_unit == si_unit && size >= unit.least) return {unit.factor, std::string(unit.text)};
  std::string text = unit_text(si_unit);
  if (size == 0.0 || (size >= 1e-2 && size < 1e5)) return {1.0, std::move(text)};
  const int exponent = 3 * static_cast<int>(std::floor(std::log10(size) / 3.0));
  std::string scaled = power_of_ten(exponent);
  if (!text.empty()) scaled.append(" ").append(text);
  return {std::pow(10.0, -exponent), std::move(scaled)};
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  // Rounding may carry into the next decade: the exponent is taken afterwards.
  const std::string scientific = format("{:.{}e}", value, digits - 1);
  const std::size_t split = scientific.find('e');
  const int exponent = std::atoi(scientific.c_str() + split + 1);
  if (exponent < -3 || exponent >= 5)
    return with_minus(scientific.substr(0, split)).append("·").append(power_of_ten(exponent));
  return with_minus(format("{:.{}f}", value, std::max(digits - 1 - exponent, 0)));
}

std::string in_sentence(double value, int digits) {
  const std::string text = number(value, digits);
  const std::size_t split = text.find('e');
  if (split == std::string::npos || !std::isfinite(value)) return with_minus(text);
  return with_minus(text.substr(0, split)).append("·").append(power_of_ten(std::atoi(text.c_str() + split + 1)));
}

std::string with_unit(double value, std::string_view si_unit, int digits) {
  std::string text = in_sentence(value, digits);
  const std::string unit = unit_text(si_unit);
  if (!unit.empty()) text.append(" ").append(unit);
  return text;
}

std::string readable(double value, std::string_view si_unit, int digits) {
  const DisplayUnit unit = display_unit(si_unit, value);
  const bool power = unit.text.starts_with("10");  // of ten: the number says it itself
  std::string text = number_text(power ? value : value * unit.factor, digits);
  const std::string name = power ? unit_text(si_unit) : unit.text;
  if (!name.empty()) text.append(" ").append(name);
  return text;
}

std::string readable_with_error(double value, double error, std::string_view si_unit) {
  if (!(error > 0.0) || !std::isfinite(error) || !std::isfinite(value)) return readable(value, si_unit, 4);
  const DisplayUnit unit = si_unit.empty() ? DisplayUnit{} : display_unit(si_unit, std::max(std::abs(value), error));
  const double shown_error = error * unit.factor;
  if (!std::isfinite(shown_error) || !(shown_error > 0.0)) return readable(value, si_unit, 4);
  constexpr int kMostDecimals = 6;
  const int needed = 1 - static_cast<int>(std::floor(std::log10(shown_error))),
            decimals = std::clamp(needed, 0, kMostDecimals);
  std::string text = with_minus(format("{:.{}f}", value * unit.factor, decimals)).append(" ± ");
  text += needed > kMostDecimals ? number_text(shown_error, 2) : format("{:.{}f}", shown_error, decimals);
  if (unit.text.starts_with("10")) return std::string("(").append(text).append(")·").append(unit.text);
  return unit.text.empty() ? text : text.append(" ").append(unit.text);
}

std::string percent_text(double share) {
  if (!std::isfinite(share)) return "–";
  if (share == 0.0 || share == 1.0) return percent(share, 0);
  return share < 0.0 || share > 1.0 ? percent(share) : in_percent(share);
}

std::string p_value_text(double p) {
  if (!std::isfinite(p)) return "–";
  if (p < 1e-9) return "< 10⁻⁹";  // further digits of a tail would mean nothing
  if (p < 1e-3) return std::string("< ").append(power_of_ten(static_cast<int>(std::floor(std::log10(p))) + 1));
  return number_text(p, 2);
}

}  // namespace sealwatch::text
