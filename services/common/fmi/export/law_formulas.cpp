#include "services/common/fmi/export/law_formulas.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace sealwatch::fmi {
namespace {

constexpr std::array kFormulas = {
    LawFormula{"backlash", "", "-p1 * (1.0 - fourth(1.0 - 2.0 * h))",
               "(magnitude(s1, 1e-9) * fourth(1.0 - 2.0 * h) * (1.0 - 2.0 * h) - s1) / p2"},
    LawFormula{"cogging_torque", "", "p1 * sin(p2 * h)", "s1"},
    LawFormula{"constant_force", "", "p1"},
    LawFormula{"coulomb_friction", "", "p1 * tanh(s1 / p2)"},
    LawFormula{"coulomb_friction", "rounded", "p1 * rounded_sign(s1, p2, p3)"},
    LawFormula{"driver_dead_time", "voltage_loss", "p1 * tanh(s1 / p2)"},
    LawFormula{"driver_dead_time", "delay", "p1 * s3"},
    LawFormula{"driver_dead_time", "dead_zone", "p1 * tanh(s2 / p2)"},
    LawFormula{"entrained_air", "isothermal", "p1 * 101325.0 / square(above_vacuum(s1))"},
    LawFormula{"entrained_air", "dissolving",
               "p1 * 101325.0 / square(above_vacuum(s1)) * smooth_step(4.0 * (p2 - above_vacuum(s1)) / p2)"},
    LawFormula{"entrained_air", "polytropic",
               "p1 / (p2 * above_vacuum(s1)) * exp(log(101325.0 / above_vacuum(s1)) / p2)"},
    LawFormula{"external_leakage", "laminar", "p1 * s1"},
    LawFormula{"external_leakage", "power", "p1 * signed_power(s1, 1e7, p2)"},
    LawFormula{"external_leakage", "turbulent", "p1 * signed_root(s1, 1e3)"},
    LawFormula{"hose_compliance", "constant", "p1"},
    LawFormula{"hose_compliance", "power", "p1 * exp(-p2 * log(above_vacuum(s1) / 1e7))"},
    LawFormula{"hose_compliance", "stiffening", "p1 / (1.0 + above_vacuum(s1) / p2)"},
    LawFormula{"hysteretic_load", "", "p1 * h",
               "(s1 - 0.5 * (magnitude(s1, 1e-9) * h + s1 * magnitude(h, 1e-3))) / p2"},
    LawFormula{"line_resistance", "laminar", "p1 * h", "(s1 - h) / 1e-3"},
    LawFormula{"line_resistance", "power", "p1 * signed_power(h, 1e-5, p2)", "(s1 - h) / 1e-3"},
    LawFormula{"line_resistance", "turbulent", "p1 * h * abs(h)", "(s1 - h) / 1e-3"},
    LawFormula{"linear_outflow", "", "p1 * s1"},
    LawFormula{"outflow_exponent", "", "p1 * exp(p2 * log(wetted(s1)))"},
    LawFormula{"outlet_level_offset", "", "p1 * (sqrt(wetted(s1) + p2) - sqrt(wetted(s1)))"},
    LawFormula{"position_dependent_load", "bell", "p1 * exp(-even_power((s2 - p2) / p3, 1.0, p4))"},
    LawFormula{"position_dependent_load", "bump", "p1 * bell((s2 - p2) / p3)"},
    LawFormula{"position_dependent_load", "quadratic", "p1 * square(s2 - p2)"},
    LawFormula{"position_dependent_load", "step", "p1 * smooth_step((s2 - p2) / p3)"},
    LawFormula{"presliding_friction", "dahl", "p1 * h", "(s1 - magnitude(s1, 1e-9) * h) / p2"},
    LawFormula{"presliding_friction", "lugre", "p1 * h + p3 * (s1 - magnitude(s1, 1e-9) * h)",
               "(s1 - magnitude(s1, 1e-9) * h) / p2"},
    LawFormula{"pressure_dependent_friction", "difference", "p1 * smooth_abs(s3 - s4, 1e4) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_friction", "difference_rounded",
               "p1 * smooth_abs(s3 - s4, 1e4) * rounded_sign(s1, p2, p3)"},
    LawFormula{"pressure_dependent_friction", "drag", "p1 * s1 * even_power(s3 - s4, 1e7, p2)"},
    LawFormula{"pressure_dependent_friction", "power", "p1 * tanh(s1 / p3) * even_power(s3 - s4, 1e7, p2)"},
    LawFormula{"pressure_dependent_friction", "sum", "p1 * smooth_abs(s3 + s4, 1e4) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_friction", "sum_rounded",
               "p1 * smooth_abs(s3 + s4, 1e4) * rounded_sign(s1, p2, p3)"},
    LawFormula{"pressure_dependent_shaft_friction", "", "p1 * smooth_abs(s2, 1e4) * tanh(s1 / p2)"},
    LawFormula{"pressure_dependent_shaft_friction", "power", "p1 * s1 * even_power(s2, 1e7, p2)"},
    LawFormula{"pump_dead_voltage", "", "p1 * tanh(smooth_positive(s2, 0.02) / p2)"},
    LawFormula{"quadratic_drag", "", "p1 * s1 * abs(s1)"},
    LawFormula{"shaft_coulomb_friction", "", "p1 * tanh(s1 / p2)"},
    LawFormula{"shaft_coulomb_friction", "rounded", "p1 * rounded_sign(s1, p2, p3)"},
    LawFormula{"speed_dependent_pump_slip", "drag", "p1 * s2"},
    LawFormula{"speed_dependent_pump_slip", "fading", "p1 * s1 / (1.0 + even_power(s2 / p2, 1.0, p3))"},
    LawFormula{"speed_dependent_pump_slip", "falling", "p1 * s1 / (1.0 + smooth_abs(s2, 1.0) / p2)"},
    LawFormula{"speed_dependent_pump_slip", "filling", "p1 * s2 * abs(s2)"},
    LawFormula{"speed_dependent_pump_slip", "power", "p1 * s1 * even_power(s2, 100.0, p2)"},
    LawFormula{"speed_dependent_pump_slip", "rising", "p1 * smooth_abs(s2, 1.0) * s1"},
    LawFormula{"spring_load", "", "p1 * s2"},
    LawFormula{"spring_load", "power", "p1 * signed_power(s2, 0.05, p2)"},
    LawFormula{"stribeck_friction", "", "(p1 + p2 * bell(s1 / p3)) * tanh(s1 / p4)"},
    LawFormula{"tank_overflow", "", "p1 * smooth_positive(s1 - p2, 0.05)"},
    LawFormula{"torque_saturation", "cubic", "p1 * s3 * s3 * s3"},
    LawFormula{"torque_saturation", "froehlich", "p1 * s3 * abs(s3) / (p2 + abs(s3))"},
    LawFormula{"torque_saturation", "knee", "p1 * (smooth_positive(s3 - p2, 0.2) - smooth_positive(-s3 - p2, 0.2))"},
    LawFormula{"torque_saturation", "power", "p1 * signed_power(s3, 1.0, p2)"},
    LawFormula{"turbulent_pump_slip", "", "p1 * signed_root(s1, 1e3)"},
    LawFormula{"turbulent_seal_leakage", "", "p1 * signed_root(s1, 1e3)"},
    LawFormula{"unlisted", "breaking_in", "p1 * (1.0 - h) * tanh(s1 / p3)", "magnitude(s1, 1e-9) * (1.0 - h) / p2"},
    LawFormula{"unlisted", "command_power", "p1 * s2 * even_power(s2, 10.0, p2)"},
    LawFormula{"unlisted", "decaying_load", "p1 * exp(-smooth_abs(s2, 1e-3) / p2)"},
    LawFormula{"unlisted", "directional_friction",
               "0.5 * tanh(s1 / p3) * (p1 + p2 + (p1 - p2) * tanh(s1 / p3) / magnitude(tanh(s1 / p3), 0.02))"},
    LawFormula{"unlisted", "leakage_power", "p1 * signed_power(s1, 1e7, p2)"},
    LawFormula{"unlisted", "local_leakage", "p1 * s1 * bell((s3 - p2) / p3)"},
    LawFormula{"unlisted", "moving_leakage", "p1 * s1 * even_power(s2, 1e-3, p2)"},
    LawFormula{"unlisted", "periodic_load",
               "p1 * sin(6.283185307179586 * (s2 - 0.05) / p3) + p2 * cos(6.283185307179586 * (s2 - 0.05) / p3)"},
    LawFormula{"unlisted", "position_drag", "p1 * s1 * even_power(s2, 0.05, p2)"},
    LawFormula{"unlisted", "resistance_power", "p1 * s1 * even_power(s1, 1.0, p2)"},
    LawFormula{"unlisted", "slip_power", "p1 * signed_power(s1, 1e7, p2)"},
    LawFormula{"unlisted", "speed_power", "p1 * signed_power(s1, 1e-3, p2)"},
    LawFormula{"unlisted", "tight_spot", "p1 * tanh(s1 / p4) * bell((s2 - p2) / p3)"},
    LawFormula{"unlisted", "torque_power", "p1 * signed_power(s1, 100.0, p2)"},
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
    Helper{"signed_root(a, e)", "a / sqrt(abs(a) + e)"},
    Helper{"above_vacuum(a)", "1e3 + smooth_positive(a - 1e3, 500.0)"},
    Helper{"wetted(a)", "1e-6 + smooth_positive(a, 0.02)"},
    Helper{"even_power(a, r, n)", "exp(0.5 * n * log(a / r * a / r + 0.0004))"},
    Helper{"signed_power(a, r, n)", "a / r * even_power(a, r, n - 1.0)"},
    Helper{"rounded_sign(a, w, m)", "a / w * exp(-log(1.0 + even_power(a, w, m)) / m)"}};

}  // namespace

const LawFormula* find_formula(const Law& law) {
  const auto formula =
      std::ranges::find_if(kFormulas, [&](const LawFormula& row) { return row.id == law.id && row.form == law.form; });
  return formula == kFormulas.end() ? nullptr : &*formula;
}

std::string helper_functions_c() {
  std::string text;
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
  std::string text;
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
