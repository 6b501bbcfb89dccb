#include "services/common/fmi/export/law_formulas.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "services/common/equations/own_law.hpp"
#include "services/common/fmi/export/c_expressions.hpp"

namespace sealwatch::fmi {
namespace {

constexpr std::array kFormulas = {
    LawFormula{"backlash", "", "-p1 * (1.0 - fourth(1.0 - 2.0 * h))",
               "(magnitude(s1, r1) * fourth(1.0 - 2.0 * h) * (1.0 - 2.0 * h) - s1) / p2"},
    LawFormula{"cogging_torque", "", "p1 * sin(p2 * h)", "s1"},
    LawFormula{"constant_force", "", "p1"},
    LawFormula{"coulomb_friction", "", "p1 * tanh(s1 / p2)"},
    LawFormula{"coulomb_friction", "rounded", "p1 * rounded_sign(s1, p2, p3)"},
    LawFormula{"directional_drag", "", "p1 * magnitude(s1, r1)"},
    LawFormula{"driver_dead_time", "voltage_loss", "p1 * tanh(s1 / p2)"},
    LawFormula{"driver_dead_time", "delay", "p1 * s3"},
    LawFormula{"driver_dead_time", "dead_zone", "p1 * tanh(s2 / p2)"},
    LawFormula{"driver_saturation", "", "p1 * beyond(s2, p2, r1)"},
    LawFormula{"entrained_air", "isothermal", "p1 * 101325.0 / square(above_vacuum(s1, r1, r2))"},
    LawFormula{
        "entrained_air", "dissolving",
        "p1 * 101325.0 / square(above_vacuum(s1, r1, r2)) * smooth_step(4.0 * (p2 - above_vacuum(s1, r1, r2)) / p2)"},
    LawFormula{"entrained_air", "polytropic",
               "p1 / (p2 * above_vacuum(s1, r1, r2)) * exp(log(101325.0 / above_vacuum(s1, r1, r2)) / p2)"},
    LawFormula{"external_leakage", "laminar", "p1 * s1"},
    LawFormula{"external_leakage", "opening", "p1 * beyond(s1, p2, r1)"},
    LawFormula{"external_leakage", "power", "p1 * signed_power(s1, p2, r1)"},
    LawFormula{"external_leakage", "turbulent", "p1 * signed_root(s1, r1)"},
    LawFormula{"hose_compliance", "constant", "p1"},
    LawFormula{"hose_compliance", "power", "p1 * exp(-p2 * log(0.02 * above_vacuum(s1, r1, r2) / r3))"},
    LawFormula{"hose_compliance", "stiffening", "p1 / (1.0 + above_vacuum(s1, r1, r2) / p2)"},
    LawFormula{"hysteretic_load", "", "p1 * h", "(s1 - 0.5 * (magnitude(s1, r1) * h + s1 * magnitude(h, 1e-3))) / p2"},
    LawFormula{"line_resistance", "laminar", "p1 * h", "(s1 - h) / 1e-3"},
    LawFormula{"line_resistance", "power", "p1 * signed_power(h, p2, r1)", "(s1 - h) / 1e-3"},
    LawFormula{"line_resistance", "turbulent", "p1 * h * abs(h)", "(s1 - h) / 1e-3"},
    LawFormula{"linear_outflow", "", "p1 * s1"},
    LawFormula{"outflow_exponent", "", "p1 * exp(p2 * log(wetted(s1, r1, r2)))"},
    LawFormula{"outlet_level_offset", "", "p1 * (sqrt(wetted(s1, r1, r2) + p2) - sqrt(wetted(s1, r1, r2)))"},
    LawFormula{"position_dependent_load", "bell", "p1 * exp(-even_power((s2 - p2) / p3, p4, 0.02))"},
    LawFormula{"position_dependent_load", "bump", "p1 * bell((s2 - p2) / p3)"},
    LawFormula{"position_dependent_load", "quadratic", "p1 * square(s2 - p2)"},
    LawFormula{"position_dependent_load", "step", "p1 * smooth_step((s2 - p2) / p3)"},
    LawFormula{"presliding_friction", "dahl", "p1 * h", "(s1 - magnitude(s1, r1) * h) / p2"},
    LawFormula{"presliding_friction", "lugre", "p1 * h + p3 * (s1 - magnitude(s1, r1) * h)",
               "(s1 - magnitude(s1, r1) * h) / p2"},
    LawFormula{"pressure_dependent_friction", "difference", "p1 * smooth_abs(s3 - s4, r1) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_friction", "difference_rounded",
               "p1 * smooth_abs(s3 - s4, r1) * rounded_sign(s1, p2, p3)"},
    LawFormula{"pressure_dependent_friction", "drag", "p1 * s1 * even_power(s3 - s4, p2, r1)"},
    LawFormula{"pressure_dependent_friction", "power", "p1 * tanh(s1 / p3) * even_power(s3 - s4, p2, r1)"},
    LawFormula{"pressure_dependent_friction", "sum", "p1 * smooth_abs(s3 + s4, r1) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_friction", "sum_rounded", "p1 * smooth_abs(s3 + s4, r1) * rounded_sign(s1, p2, p3)"},
    LawFormula{"pressure_dependent_shaft_friction", "", "p1 * smooth_abs(s2, r1) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_shaft_friction", "power", "p1 * s1 * even_power(s2, p2, r1)"},
    LawFormula{"pump_dead_voltage", "", "p1 * tanh(smooth_positive(s2, r1) / p2)"},
    LawFormula{"quadratic_drag", "", "p1 * s1 * abs(s1)"},
    LawFormula{"shaft_coulomb_friction", "", "p1 * tanh(s1 / p2)"},
    LawFormula{"shaft_coulomb_friction", "rounded", "p1 * rounded_sign(s1, p2, p3)"},
    LawFormula{"speed_dependent_pump_slip", "drag", "p1 * s2"},
    LawFormula{"speed_dependent_pump_slip", "fading", "p1 * s1 / (1.0 + even_power(s2 / p2, p3, 0.02))"},
    LawFormula{"speed_dependent_pump_slip", "falling", "p1 * s1 / (1.0 + smooth_abs(s2, r1) / p2)"},
    LawFormula{"speed_dependent_pump_slip", "filling", "p1 * s2 * abs(s2)"},
    LawFormula{"speed_dependent_pump_slip", "power", "p1 * s1 * even_power(s2, p2, r1)"},
    LawFormula{"speed_dependent_pump_slip", "rising", "p1 * smooth_abs(s2, r1) * s1"},
    LawFormula{"spring_load", "", "p1 * s2"},
    LawFormula{"spring_load", "power", "p1 * signed_power(s2, p2, r1)"},
    LawFormula{"stribeck_friction", "", "(p1 + p2 * bell(s1 / p3)) * tanh(s1 / p4)"},
    LawFormula{"tank_overflow", "", "p1 * smooth_positive(s1 - p2, r1)"},
    LawFormula{"torque_saturation", "cubic", "p1 * s3 * s3 * s3"},
    LawFormula{"torque_saturation", "froehlich", "p1 * s3 * abs(s3) / (p2 + abs(s3))"},
    LawFormula{"torque_saturation", "knee", "p1 * beyond(s3, p2, r1)"},
    LawFormula{"torque_saturation", "power", "p1 * signed_power(s3, p2, r1)"},
    LawFormula{"turbulent_pump_slip", "", "p1 * signed_root(s1, r1)"},
    LawFormula{"turbulent_seal_leakage", "", "p1 * signed_root(s1, r1)"},
    LawFormula{"unlisted", "breaking_in", "p1 * (1.0 - h) * tanh(s1 / p3)", "magnitude(s1, r1) * (1.0 - h) / p2"},
    LawFormula{"unlisted", "command_power", "p1 * s2 * even_power(s2, p2, r1)"},
    LawFormula{"unlisted", "decaying_load", "p1 * exp(-smooth_abs(s2, r1) / p2)"},
    LawFormula{"unlisted", "directional_friction",
               "0.5 * tanh(s1 / p3) * (p1 + p2 + (p1 - p2) * tanh(s1 / p3) / magnitude(tanh(s1 / p3), 0.02))"},
    LawFormula{"unlisted", "leakage_opening", "p1 * beyond(s1, p2, r1)"},
    LawFormula{"unlisted", "leakage_power", "p1 * signed_power(s1, p2, r1)"},
    LawFormula{"unlisted", "local_leakage", "p1 * s1 * bell((s3 - p2) / p3)"},
    LawFormula{"unlisted", "moving_leakage", "p1 * s1 * even_power(s2, p2, r1)"},
    LawFormula{"unlisted", "periodic_load",
               "p1 * sin(6.283185307179586 * (s2 - 0.05) / p3) + p2 * cos(6.283185307179586 * (s2 - 0.05) / p3)"},
    LawFormula{"unlisted", "position_drag", "p1 * s1 * even_power(s2, p2, r1)"},
    LawFormula{"unlisted", "resistance_power", "p1 * s1 * even_power(s1, p2, r1)"},
    LawFormula{"unlisted", "slip_opening", "p1 * beyond(s1, p2, r1)"},
    LawFormula{"unlisted", "slip_power", "p1 * signed_power(s1, p2, r1)"},
    LawFormula{"unlisted", "speed_power", "p1 * signed_power(s1, p2, r1)"},
    LawFormula{"unlisted", "tight_spot", "p1 * tanh(s1 / p4) * bell((s2 - p2) / p3)"},
    LawFormula{"unlisted", "torque_power", "p1 * signed_power(s1, p2, r1)"},
    LawFormula{"valve_hysteresis", "open_memory", "p1 * h", "(smooth_step(2.0 * (s1 / p3 - 1.0)) - h) / p2"},
    LawFormula{"valve_hysteresis", "poppet_friction", "p1 * tanh((h - s1) / 5e3)", "(s1 - h) / p2"},
    LawFormula{"viscosity_warm_up", "dissipation", "-p1 * tanh(h)", "(s1 / 100.0 - h) / p2"},
    LawFormula{"viscosity_warm_up", "time", "-p1 * h", "(1.0 - h) / p2"},
    LawFormula{"winding_heating", "", "p1 * h * s1", "(s1 * s1 - h) / p2"}};

struct Helper {
  std::string_view signature;  ///< "smooth_abs(a, s)"
  std::string_view value;
};

// In an order in which each uses earlier ones only.
constexpr std::array kHelpers = {
    Helper{"square(a)", "a * a"},
    Helper{"fourth(a)", "a * a * a * a"},
    Helper{"bell(a)", "exp(-a * a)"},
    Helper{"magnitude(a, s)", "sqrt(a * a + s * s)"},
    Helper{"smooth_abs(a, s)", "sqrt(a * a + s * s) - s"},
    Helper{"smooth_step(a)", "0.5 * (1.0 + tanh(a))"},
    Helper{"smooth_positive(a, s)", "0.5 * (a + abs(a)) + s * log(1.0 + exp(-abs(a) / s))"},
    Helper{"beyond(a, e, s)", "smooth_positive(a - e, s) - smooth_positive(-a - e, s)"},
    Helper{"signed_root(a, e)", "a / sqrt(abs(a) + e)"},
    Helper{"above_vacuum(a, f, s)", "f + smooth_positive(a - f, s)"},
    Helper{"wetted(a, f, s)", "f + smooth_positive(a, s)"},
    Helper{"even_power(a, n, w)", "exp(0.5 * n * log(0.02 * a / w * (0.02 * a / w) + 0.02 * 0.02))"},
    Helper{"signed_power(a, n, w)", "0.02 * a / w * even_power(a, n - 1.0, w)"},
    Helper{"softplus(a)", "0.5 * (a + abs(a)) + log(1.0 + exp(-abs(a)))"},
    Helper{"logistic(a)", "0.5 * (1.0 + tanh(0.5 * a))"},
    Helper{"rounded_sign(a, w, m)", "a / w * exp(-log(1.0 + even_power(a / w, m, 0.02)) / m)"}};

using equations::Expressions;
using equations::Node;
using equations::Operation;

/// "s1".."s4", "h", "p1".."p4": a variable of a law, in the order of LawInput's directions.
std::string name_of_variable(std::size_t variable) {
  if (variable < kSiteSignals) return "s" + std::to_string(variable + 1);
  return variable == kSiteSignals ? "h" : "p" + std::to_string(variable - kSiteSignals);
}

std::string_view function_of(Operation operation) {
  constexpr std::pair<Operation, std::string_view> kFunctions[] = {{Operation::power, "power"},
                                                                   {Operation::exponential, "exp"},
                                                                   {Operation::logarithm, "log"},
                                                                   {Operation::square_root, "sqrt"},
                                                                   {Operation::sine, "sin"},
                                                                   {Operation::cosine, "cos"},
                                                                   {Operation::tangent, "tan"},
                                                                   {Operation::arc_sine, "asin"},
                                                                   {Operation::arc_cosine, "acos"},
                                                                   {Operation::arc_tangent, "atan"},
                                                                   {Operation::hyperbolic_tangent, "tanh"},
                                                                   {Operation::magnitude, "abs"},
                                                                   {Operation::sign, "sign_of"},
                                                                   {Operation::softplus, "softplus"},
                                                                   {Operation::logistic, "logistic"}};
  const auto* found = std::ranges::find(kFunctions, operation, &std::pair<Operation, std::string_view>::first);
  return found == std::end(kFunctions) ? std::string_view() : found->second;
}

std::string text_of_node(const Expressions& expressions, Node node) {
  const Expressions::Entry& entry = expressions.entries()[node];
  const auto with = [&](const char* sign) {
    return "(" + text_of_node(expressions, entry.a) + sign + text_of_node(expressions, entry.b) + ")";
  };
  switch (entry.operation) {
    case Operation::constant:
      return entry.number < 0.0 ? "(" + c_number(entry.number) + ")" : c_number(entry.number);
    case Operation::variable:
      return name_of_variable(entry.a);
    case Operation::add:
      return with(" + ");
    case Operation::subtract:
      return with(" - ");
    case Operation::multiply:
      return with(" * ");
    case Operation::divide:
      return with(" / ");
    case Operation::negate:
      return "(-" + text_of_node(expressions, entry.a) + ")";
    default:
      break;
  }
  std::string text(function_of(entry.operation));
  text.append("(").append(text_of_node(expressions, entry.a));
  if (entry.operation == Operation::power) text.append(", ").append(text_of_node(expressions, entry.b));
  return text.append(")");
}

// What C and Modelica write in different ways.
constexpr std::string_view kOwnC =
    "static inline double power(double a, double b) { return pow(a, b); }\n"
    "static inline double sign_of(double a) { return a < 0.0 ? -1.0 : 1.0; }\n";
constexpr std::string_view kOwnModelica =
    "  function power\n    input Real a, b;\n    output Real y;\n  algorithm\n    y := a ^ b;\n  end power;\n"
    "  function sign_of\n    input Real a;\n    output Real y;\n  algorithm\n"
    "    y := if a < 0.0 then -1.0 else 1.0;\n  end sign_of;\n";

}  // namespace

std::optional<LawText> written(const Law& law) {
  if (const LawFormula* formula = find_formula(law))
    return LawText{std::string(formula->contribution), std::string(formula->rate)};
  if (law.expressions == nullptr) return std::nullopt;
  const LawExpressions& own = *law.expressions;
  return LawText{text_of_node(own.expressions, own.contribution),
                 law.hidden ? text_of_node(own.expressions, own.rate) : std::string()};
}

const LawFormula* find_formula(const Law& law) {
  const auto formula =
      std::ranges::find_if(kFormulas, [&](const LawFormula& row) { return row.id == law.id && row.form == law.form; });
  return formula == kFormulas.end() ? nullptr : &*formula;
}

std::string helper_functions_c() {
  std::string text(kOwnC);
  for (const Helper& helper : kHelpers) {
    std::string signature(helper.signature);
    const auto open = signature.find('(');
    std::string arguments = "double " + signature.substr(open + 1);
    for (auto comma = arguments.find(", "); comma != std::string::npos; comma = arguments.find(", ", comma + 9))
      arguments.insert(comma + 2, "double ");
    text += "static inline double " + signature.substr(0, open + 1) + arguments + " { return " + in_c(helper.value) +
            "; }\n";
  }
  return text;
}

std::string helper_functions_modelica() {
  std::string text(kOwnModelica);
  for (const Helper& helper : kHelpers) {
    const std::string_view name = helper.signature.substr(0, helper.signature.find('('));
    std::string_view arguments = helper.signature.substr(name.size() + 1);
    arguments.remove_suffix(1);
    text += "  function " + std::string(name) + "\n    input Real " + std::string(arguments) +
            ";\n    output Real y;\n  algorithm\n    y := " + std::string(helper.value) + ";\n  end " +
            std::string(name) + ";\n";
  }
  return text;
}

std::string in_c(std::string_view formula) {
  std::string text(formula);
  for (auto at = text.find("abs("); at != std::string::npos; at = text.find("abs(", at + 5)) {
    const bool own = at > 0 && (std::isalnum(static_cast<unsigned char>(text[at - 1])) != 0 || text[at - 1] == '_');
    if (!own) text.insert(at, "f");
  }
  return text;
}

}  // namespace sealwatch::fmi
