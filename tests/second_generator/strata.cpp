#include "tests/second_generator/strata.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string_view>

namespace second_generator {

static constexpr const char* kNone = "none of the catalogue";

// Near to the catalogue's laws, which judge name and strength.
static const std::vector<Kind> kCatalogue = {
    {Form::arctangent_friction, "piston", "coulomb_friction", "stribeck_friction presliding_friction", "F_c", "N", 600,
     20, 2e-5, 1e-4, 0, 0, 0},
    {Form::exponential_stribeck, "piston", "stribeck_friction", "coulomb_friction presliding_friction", "F_c", "N", 600,
     8, 2e-5, 6e-5, 0.3, 1.0, 0},
    {Form::friction_by_difference, "piston", "pressure_dependent_friction", "", "", "m2", 6e-5, 15, 3e-5, 1e-4, 0, 0,
     0},
    {Form::friction_by_sum, "piston", "pressure_dependent_friction", "", "", "m2", 5e-5, 15, 3e-5, 1e-4, 0, 0, 0},
    {Form::lugre, "piston", "presliding_friction", "coulomb_friction stribeck_friction hysteretic_load", "F_c", "N",
     600, 12, 2e-5, 3e-4, 0, 0, 1},
    {Form::rounded_quadratic_drag, "piston", "quadratic_drag", "", "k", "N s2/m2", 3.4e8, 25, 5e-5, 2e-4, 0, 0, 0},
    {Form::softening_spring, "piston", "spring_load", "position_dependent_load", "", "N/m", 3e4, 25, 0.02, 0.1, 0, 0,
     0},
    {Form::cosine_bump, "piston", "position_dependent_load", "", "F_b", "N", 600, 20, 0.047, 0.057, 0.002, 0.004, 0},
    {Form::polynomial_step, "piston", "position_dependent_load", "", "F_s", "N", 600, 20, 0.047, 0.057, 5e-4, 2e-3, 0},
    {Form::bouc_wen, "piston", "hysteretic_load", "presliding_friction", "F_h", "N", 600, 20, 8e-4, 3e-3, 0, 0, 1},
    {Form::trapezoidal_backlash, "piston", "backlash", "", "F_b", "N", 600, 20, 3e-4, 1.5e-3, 0, 0, 1},
    {Form::blended_seal_leakage, "piston_seal", "turbulent_seal_leakage", "", "k", "m3/(s Pa^0.5)", 2.5e-11, 15, 2e4,
     2e5, 0, 0, 0},
    {Form::blended_pump_slip, "pump", "turbulent_pump_slip", "", "k", "m3/(s Pa^0.5)", 2.5e-11, 15, 2e4, 2e5, 0, 0, 0},
    {Form::drag_slip, "pump", "speed_dependent_pump_slip", "", "k_d", "m3/rad", 4e-10, 15, 1, 1, 0, 0, 0},
    {Form::rounded_filling_slip, "pump", "speed_dependent_pump_slip", "", "k_f", "m3 s/rad2", 2e-12, 15, 3, 12, 0, 0,
     0},
    {Form::rounded_rising_slip, "pump", "speed_dependent_pump_slip", "", "k", "m3/(rad Pa)", 4e-17, 15, 3, 12, 0, 0, 0},
    {Form::laminar_line, "valve_1", "line_resistance", "", "R", "Pa s/m3", 1e10, 20, 1, 1, 0, 0, 0},
    {Form::laminar_line, "valve_2", "line_resistance", "", "R", "Pa s/m3", 1e10, 20, 1, 1, 0, 0, 0},
    {Form::turbulent_line, "valve_1", "line_resistance", "", "k", "Pa s2/m6", 1.6e15, 20, 1, 1, 0, 0, 0},
    {Form::flow_held_poppet, "valve_1", "valve_hysteresis", "", "", "Pa", 1e4, 4, 2e-7, 1e-6, 0, 0, 1},
    {Form::thinning_leak, "chamber_a", "external_leakage", "", "G", "m3/(s Pa)", 8e-15, 25, 1.5e8, 4e8, 0, 0, 0},
    {Form::thinning_leak, "chamber_b", "external_leakage", "", "G", "m3/(s Pa)", 8e-15, 25, 1.5e8, 4e8, 0, 0, 0},
    {Form::blended_leak, "chamber_a", "external_leakage", "", "G_t", "m3/(s Pa^0.5)", 2.5e-11, 20, 1e4, 1e5, 0, 0, 0},
    {Form::exponential_hose, "chamber_a", "hose_compliance", "", "", "m3/Pa", 8e-15, 15, 1e7, 1e8, 0, 0, 0},
    {Form::exponential_hose, "chamber_b", "hose_compliance", "", "", "m3/Pa", 8e-15, 15, 1e7, 1e8, 0, 0, 0},
    {Form::mixture_air, "fluid", "entrained_air", "", "", "1", 1e-3, 25, 1.05, 1.35, 0, 0, 0},
    {Form::exponential_warm_up, "fluid", "viscosity_warm_up", "", "", "1", 0.05, 6, 8, 25, 0, 0, 1},
    {Form::rounded_shaft_friction, "shaft", "shaft_coulomb_friction", "", "T_c", "N m", 5e-3, 15, 1, 5, 0, 0, 0},
    {Form::shaft_friction_by_load, "shaft", "pressure_dependent_shaft_friction", "", "k", "m3/rad", 4e-10, 12, 1, 5, 0,
     0, 0},
    {Form::cogging_with_harmonic, "shaft", "cogging_torque", "", "A", "N m", 5e-3, 8, 1, 4, 0, 0, 1},
    {Form::tanh_saturation, "shaft", "torque_saturation", "", "", "N m/A3", 8e-5, 15, 1, 1, 0, 0, 0},
    {Form::rounded_voltage_loss, "driver", "driver_dead_time", "", "V_d", "V", 0.3, 6, 0.03, 0.2, 0, 0, 0},
    {Form::rounded_dead_zone, "driver", "driver_dead_time", "", "V_z", "V", 0.3, 6, 0.1, 0.5, 0, 0, 0},
    {Form::self_heating, "winding", "winding_heating", "", "k", "ohm/A2", 2e-4, 40, 10, 40, 0, 0, 1},
};

// Far from the catalogue, or with corners.
static const std::vector<Kind> kOther = {
    {Form::karnopp, "piston", "coulomb_friction", "stribeck_friction presliding_friction", "F_c", "N", 600, 10, 0, 0,
     1.0, 1.3, 0},
    {Form::direction_friction, "piston", "coulomb_friction", "stribeck_friction presliding_friction", "", "N", 600, 15,
     0.2, 0.7, 0, 0, 0},
    {Form::root_drag, "piston", kNone, "coulomb_friction stribeck_friction", "", "N s^0.5/m^0.5", 2e4, 15, 0, 0, 0, 0,
     0},
    {Form::cubic_spring, "piston", kNone, "position_dependent_load", "", "N/m3", 1.5e8, 25, 0.046, 0.052, 0, 0, 0},
    {Form::triangular_bump, "piston", "position_dependent_load", "", "", "N", 600, 20, 0.047, 0.057, 0.001, 0.004, 0},
    {Form::scratched_bore, "piston_seal", kNone, "", "", "m3/(s Pa)", 8e-15, 20, 0.047, 0.057, 0.002, 0.004, 0},
    {Form::relief_leak, "chamber_a", kNone, "external_leakage", "", "m3/(s Pa)", 8e-14, 10, 9.5e6, 1.1e7, 0, 0, 0},
    {Form::hard_dead_zone, "driver", "driver_dead_time", "", "V_z", "V", 0.3, 6, 0, 0, 0, 0, 0},
    {Form::hard_knee, "shaft", "torque_saturation", "", "k", "N m/A", 5e-3, 15, 1.8, 2.4, 0, 0, 0},
    {Form::tooth_ripple, "pump", kNone, "", "", "m3/rad", 4e-10, 12, 1, 3, 0, 0, 1},
    {Form::reynolds_orifice, "valve_1", kNone, "line_resistance valve_hysteresis", "", "1", 0.1, 7, 1e-6, 4e-6, 0, 0,
     0},
    {Form::speed_limited_delivery, "pump", kNone, "speed_dependent_pump_slip", "", "m3/rad", 1e-9, 10, 90, 140, 0, 0,
     0},
    {Form::lugre, "piston", "presliding_friction", "coulomb_friction stribeck_friction hysteretic_load", "F_c", "N",
     600, 12, 5e-6, 2e-5, 0, 0, 1},
};

const std::vector<std::string>& strata() {
  static const std::vector<std::string> names = {"null",  "null_source",  "catalogue", "other_form",
                                                 "pair",  "several",      "sensor",    "recording",
                                                 "value", "same_element", "change"};
  return names;
}

int index_of(const std::string& value) {
  for (int k = 0; k < kNames; ++k)
    if (kParameters[k].name == value) return k;
  throw std::invalid_argument("no parameter " + value);
}

static Effect size(const Kind& kind, double times, Random& random) {
  Effect e;
  e.kind = kind;
  e.strength = kind.significant * times;
  e.a = kind.a_high > kind.a_low ? random.log_uniform(kind.a_low, kind.a_high) : kind.a_low;
  e.b = kind.b_high > kind.b_low ? random.uniform(kind.b_low, kind.b_high) : kind.b_low;
  if (kind.form == Form::cogging_with_harmonic || kind.form == Form::tooth_ripple) e.a = std::round(e.a);
  if (kind.form == Form::reynolds_orifice) e.strength = std::min(e.strength, 0.7);
  return e;
}

static Effect draw(const std::vector<Kind>& kinds, Random& random) {
  const Kind& kind = kinds[std::size_t(random.below(int(kinds.size())))];
  return size(kind, random.log_uniform(0.7, kind.largest), random);
}

static bool same_place(const Effect& a, const Effect& b) { return std::string_view(a.kind.element) == b.kind.element; }

static bool same_law(const Effect& a, const Effect& b) {
  return std::string_view(a.kind.law) == b.kind.law ||
         std::string_view(a.kind.also).find(b.kind.law) != std::string::npos;
}

// Another effect beside those of the set; at the place of the first where `together`, else nowhere where one is.
static Effect beside(const std::vector<Effect>& others, bool together, Random& random) {
  for (;;) {
    const Effect e = draw(kCatalogue, random);
    const bool there = std::any_of(others.begin(), others.end(), [&](const Effect& o) { return same_place(e, o); });
    const bool twin =
        std::any_of(others.begin(), others.end(), [&](const Effect& o) { return same_law(e, o) || same_law(o, e); });
    if (there == together && !twin) return e;
  }
}

static void draw_sensor_fault(Set& set, Random& random) {
  static const std::array<const char*, 7> elements = {"sensor:motor_current", "sensor:shaft_speed", "sensor:pressure_a",
                                                      "sensor:pressure_b",    "sensor:flow",        "sensor:position",
                                                      "sensor:velocity"};
  const int channel = random.below(7);
  const auto& c = kChannels[channel];
  Effect e;
  switch (random.below(4)) {
    case 0:
      e.kind = {Form::bias, elements[channel], "sensor_bias", "", "b", c.unit, c.noise, 60, 0, 0, 0, 0, 0};
      e.strength = random.sign() * c.noise * random.log_uniform(1.0, 60.0);
      break;
    case 1:
      e.kind = {Form::gain, elements[channel], "sensor_gain", "", "g", "1", 0.01, 15, 0, 0, 0, 0, 0};
      e.strength = random.sign() * random.log_uniform(0.02, 0.15);
      break;
    case 2:
      e.kind = {Form::lag, elements[channel], "sensor_lag", "", "tau", "s", 0.005, 60, 0, 0, 0, 0, 1};
      e.strength = random.log_uniform(0.01, 0.3);
      break;
    default:  // a zero that moves during the test, and settles
      e.kind = {Form::drift, elements[channel], "sensor_drift", "", "D", c.unit, c.noise, 60, 0, 0, 0, 0, 0};
      e.strength = random.sign() * c.noise * random.log_uniform(2.0, 60.0);
      e.a = random.log_uniform(4.0, 15.0);
  }
  e.channel = channel;
  set.effects.push_back(e);
}

static void draw_recording_fault(Set& set, Random& random) {
  static const std::array<Kind, 4> kinds = {{
      {Form::input_gain, "input:motor_voltage", "input_gain", "", "g", "1", 0.01, 12, 0, 0, 0, 0, 0},
      {Form::input_bias, "input:motor_voltage", "input_bias", "driver_dead_time", "b", "V", 0.1, 15, 0, 0, 0, 0, 0},
      {Form::input_delay, "input:motor_voltage", "input_delay", "", "tau", "s", 0.005, 12, 0, 0, 0, 0, 0},
      {Form::clock_rate, "clock", "clock_rate", "", "c", "1", 0.005, 10, 0, 0, 0, 0, 0},
  }};
  Effect e = size(kinds[std::size_t(random.below(4))], 1.0, random);
  e.strength *= random.log_uniform(1.0, e.kind.largest);
  if (e.kind.form != Form::input_delay) e.strength *= random.sign();
  set.effects.push_back(e);
}

static void draw_value(Set& set, Random& random) {
  static const std::array<Name, 8> names = {alpha_P, A_C, T_M, Omega_M, V_0, p_crack, r_pilot, J_M};
  if (random.chance(0.5)) set.effects.push_back(draw(kCatalogue, random));
  Effect e;
  const Name name = names[std::size_t(random.below(int(names.size())))];
  e.kind = {Form::wrong_value, "datasheet", "datasheet_value", "", "", "1", 0.01, 20, 0, 0, 0, 0, 0};
  e.note = kParameters[name].name;
  e.strength = random.sign() * random.log_uniform(0.02, 0.2);
  set.values[name] *= 1.0 + e.strength;
  set.effects.push_back(e);
}

static void draw_change(Set& set, Random& random) {
  static const std::array<Name, 4> names = {R_CL, R_M, f_C, R_PL};
  set.effects.push_back(draw(kCatalogue, random));
  const Name name = random.chance(0.5) ? R_CL : names[std::size_t(random.below(4))];
  Effect e;
  e.kind = {Form::changing_value, "between_tests", "changing_parameter", "", "", "1", 0.01, 20, 0, 0, 0, 0, 0};
  e.note = kParameters[name].name;
  e.strength = random.log_uniform(0.03, 0.3);
  for (int k = 0; k < kTests; ++k)  // R_CL only falls; the others go up and down
    set.changed[k] = name == R_CL ? 1.0 - e.strength * k / 3.0 * random.uniform(0.8, 1.0) / 2.0
                                  : 1.0 + e.strength * random.uniform(-0.5, 0.5);
  set.effects.push_back(e);
}

static void draw_several(Set& set, Random& random) {
  const Kind& large = kCatalogue[std::size_t(random.below(int(kCatalogue.size())))];
  set.effects.push_back(size(large, random.log_uniform(0.5, 1.0) * large.largest, random));
  const int small = 3 + random.below(4);
  for (int k = 0; k < small; ++k) {
    Effect e = beside(set.effects, false, random);
    e.strength *= random.log_uniform(0.3, 1.5) * e.kind.significant / e.strength;
    set.effects.push_back(e);
  }
}

static void draw_values(Set& set, double tolerance, double sensor_tolerance, Random& random) {
  for (int k = 0; k < kNames; ++k)
    set.values[k] = kParameters[k].nominal * (kParameters[k].free ? 1.0 : 1.0 + tolerance * random.uniform(-1.0, 1.0));
  set.values[R_CL] = random.log_uniform(6e12, 3.4e13);
  set.values[R_PL] *= random.uniform(0.7, 1.5);
  set.values[f_C] *= random.uniform(0.7, 1.3);
  set.values[f_M] *= random.uniform(0.75, 1.35);
  set.values[beta] *= random.uniform(0.8, 1.2);
  set.values[R_M] *= random.uniform(0.94, 1.06);
  set.values[phi] *= random.uniform(0.9, 1.1);
  for (int c = 0; c < 7; ++c) {
    set.sensor_gain[c] = 1.0 + sensor_tolerance * random.uniform(-1.0, 1.0);
    set.sensor_offset[c] = sensor_tolerance * random.uniform(-1.0, 1.0) * kChannels[c].usual;
  }
  static const std::array<double, kTests> loads = {-0.17, -0.05, 0.07, 0.18, 0.29, -0.28};
  for (int k = 0; k < kTests; ++k) set.load[k] = loads[k] + random.uniform(-0.025, 0.025);
  set.changed.fill(1.0);
}

Set draw_set(const std::string& stratum, int seed, double tolerance, double sensor_tolerance) {
  const auto found = std::find(strata().begin(), strata().end(), stratum);
  if (found == strata().end()) throw std::invalid_argument("no stratum '" + stratum + "'");
  Random random(std::uint64_t(seed) * 1000003ULL + std::uint64_t(found - strata().begin()) * 7919ULL + 17ULL);
  Set set;
  set.stratum = stratum;
  set.seed = seed;
  draw_values(set, tolerance, sensor_tolerance, random);
  if (stratum == "null_source") {
    set.source_sensors = true;
    set.differential = random.chance(0.5);
  }
  if (stratum == "catalogue") set.effects = {draw(kCatalogue, random)};
  if (stratum == "other_form") set.effects = {draw(kOther, random)};
  if (stratum == "pair") set.effects = {draw(random.chance(0.3) ? kOther : kCatalogue, random)};
  if (stratum == "pair") set.effects.push_back(beside(set.effects, false, random));
  if (stratum == "same_element") {
    static const std::array<std::string_view, 5> shared = {"piston", "pump", "shaft", "chamber_a", "fluid"};
    do set.effects = {draw(kCatalogue, random)};
    while (std::find(shared.begin(), shared.end(), set.effects[0].kind.element) == shared.end());
    set.effects.push_back(beside(set.effects, true, random));
  }
  if (stratum == "several") draw_several(set, random);
  if (stratum == "sensor") draw_sensor_fault(set, random);
  if (stratum == "recording") draw_recording_fault(set, random);
  if (stratum == "value") draw_value(set, random);
  if (stratum == "change") draw_change(set, random);
  return set;
}

static std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

static std::string words(std::string_view text) {  // a JSON list of what blanks separate
  std::string list;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    list += (list.empty() ? "\"" : ", \"") + std::string(text.substr(at, end - at)) + "\"";
    at = end + 1;
  }
  return "[" + list + "]";
}

static std::string describe(const Effect& e) {
  std::string text =
      "  {\"element\": \"" + std::string(e.kind.element) + "\", \"law\": \"" + e.kind.law + "\", \"also\": ";
  text += words(e.kind.also) + ", \"form\": " + std::to_string(int(e.kind.form)) + ",\n   \"parameter\": \"" +
          e.kind.parameter + "\", \"strength\": " + number(e.strength) + ", \"unit\": \"" + e.kind.unit + "\"";
  text += ", \"times_significant\": " + number(std::abs(e.strength) / e.kind.significant);
  text += ", \"shape\": [" + number(e.a) + ", " + number(e.b) + "], \"value\": \"" + e.note + "\"}";
  return text;
}

template <typename Numbers>
static std::string list(const Numbers& values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "" : ", ") + number(v);
  return "[" + text + "]";
}

std::string truth(const Set& set) {
  std::string text =
      "{\n \"stratum\": \"" + set.stratum + "\", \"seed\": " + std::to_string(set.seed) + ",\n \"effects\": [";
  for (std::size_t k = 0; k < set.effects.size(); ++k) text += (k ? ",\n" : "\n") + describe(set.effects[k]);
  text += "],\n \"R_CL\": " + number(set.values[R_CL]) + ",\n \"values\": {";
  for (int k = 0; k < kNames; ++k)
    text += std::string(k ? ", \"" : "\"") + kParameters[k].name + "\": " + number(set.values[k]);
  text += "},\n \"sensor_gain\": " + list(set.sensor_gain) + ",\n \"sensor_offset\": " + list(set.sensor_offset);
  text += ",\n \"load\": " + list(set.load) + ",\n \"changed\": " + list(set.changed) + "\n}\n";
  return text;
}

}  // namespace second_generator
