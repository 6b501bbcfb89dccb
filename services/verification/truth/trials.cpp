#include "services/verification/truth/trials.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sealwatch/core/text.hpp"
#include "services/common/text/format.hpp"
#include "services/verification/truth/conditions.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {
namespace {

constexpr std::array kTimesBarely = {1.0, 3.0, 10.0, 30.0, 100.0, 300.0};

double log_uniform(forecast::UniformRandom& random, const forecast::Range& range) {
  if (!(range.max > range.min)) return range.min;
  return range.min * std::pow(range.max / range.min, random.unit());
}

/// A form at one of its elements.
struct Place {
  const EffectForm* form;
  std::size_t side;
};

std::vector<Place> places_of(std::initializer_list<std::span<const EffectForm>> groups) {
  std::vector<Place> places;
  for (const std::span<const EffectForm> group : groups)
    for (const EffectForm& form : group) {
      places.push_back({&form, 0});
      if (!form.other_element.empty()) places.push_back({&form, 1});
    }
  return places;
}

const std::vector<Place>& listed_places() {
  static const std::vector<Place> places = places_of({piston_effects(), hydraulic_effects(), electric_effects()});
  return places;
}

HiddenEffect draw_effect(const Place& place, double times_barely, forecast::UniformRandom& random) {
  HiddenEffect effect{.form = place.form,
                      .element = std::string(place.side == 0 ? place.form->element : place.form->other_element),
                      .side = place.side};
  effect.size = std::min(place.form->barely * times_barely * log_uniform(random, {0.85, 1.18}), place.form->largest);
  for (std::size_t k = 0; k < kShapes; ++k) effect.shape[k] = log_uniform(random, place.form->shapes[k]);
  return effect;
}

/// Every place in turn, sizes mixed: neighbouring seeds have other places and other sizes.
template <class Sizes>
HiddenEffect nth_effect(const std::vector<Place>& places, std::uint64_t seed, const Sizes& sizes,
                        forecast::UniformRandom& random) {
  const std::uint64_t round = seed / places.size();
  const std::uint64_t place = seed % places.size();
  return draw_effect(places[place], sizes[(place + round) % sizes.size()], random);
}

/// Faults that such tests begin to show, and beyond which a sensor would be replaced unasked.
double barely_fault(const std::string& kind, const std::string& channel) {
  constexpr double kGain = 3e-4, kLag_s = 3e-4, kShareOfNoise = 0.05;
  constexpr double kPosition_m = 5e-5;  // only what depends on the position tells its bias
  if (kind == "sensor_gain") return kGain;
  if (kind == "sensor_lag") return kLag_s;
  return channel == "position" ? kPosition_m : kShareOfNoise * usual_noise(channel);
}

double largest_fault(const std::string& kind, const std::string& channel) {
  constexpr double kGain = 0.1, kLag_s = 0.05, kTimesNoise = 15.0, kPosition_m = 2e-3;
  if (kind == "sensor_gain") return kGain;
  if (kind == "sensor_lag") return kLag_s;
  return channel == "position" ? kPosition_m : kTimesNoise * usual_noise(channel);
}

SensorFault draw_fault(std::uint64_t seed, const std::vector<std::string>& channels) {
  static constexpr std::array<std::string_view, 3> kKinds = {"sensor_bias", "sensor_gain", "sensor_lag"};
  std::vector<std::string> outputs = channels;
  std::erase(outputs, "motor_voltage");
  const std::string& channel = outputs[(seed / kKinds.size()) % outputs.size()];
  const std::string kind(kKinds[seed % kKinds.size()]);
  const double times =
      kTimesBarely[(seed + seed / kTimesBarely.size() + seed / (kKinds.size() * outputs.size())) % kTimesBarely.size()];
  const double sign = kind == "sensor_lag" || (seed / 2) % 2 == 0 ? 1.0 : -1.0;
  return {.kind = kind,
          .channel = channel,
          .size = sign * std::min(barely_fault(kind, channel) * times, largest_fault(kind, channel))};
}

/// The driver's voltage is not what was recorded of it, or the recording's clock is not true. Such tests begin to show
/// the smallest of these.
double barely_recorded(const std::string& kind) {
  constexpr double kGain = 1e-3, kBias_V = 0.02, kDelay_s = 5e-4, kRate = 5e-4;
  if (kind == "input_gain") return kGain;
  if (kind == "input_bias") return kBias_V;
  return kind == "input_delay" ? kDelay_s : kRate;
}

SensorFault draw_recording_fault(std::uint64_t seed) {
  static constexpr std::array<std::string_view, 4> kKinds = {"input_gain", "input_bias", "input_delay", "clock_rate"};
  const std::string kind(kKinds[seed % kKinds.size()]);
  const std::uint64_t round = seed / kKinds.size();
  const double times = kTimesBarely[(round + round / kTimesBarely.size()) % kTimesBarely.size()];
  return {.kind = kind,
          .channel = kind == "clock_rate" ? "" : "motor_voltage",
          .size = (round % 2 == 0 ? 1.0 : -1.0) * times * barely_recorded(kind)};
}

void make_wrong(TrialPlan& plan) {
  static constexpr std::array<std::pair<std::string_view, double TruthParameters::*>, 12> kValues = {
      {{"A_C", &TruthParameters::piston_area},
       {"T_M", &TruthParameters::torque_constant},
       {"V_0", &TruthParameters::dead_volume},
       {"alpha_P", &TruthParameters::displacement},
       {"p_0", &TruthParameters::reservoir_pressure},
       {"J_M", &TruthParameters::shaft_inertia},
       {"Omega_M", &TruthParameters::back_emf},
       {"a_V", &TruthParameters::valve_area},
       {"p_crack", &TruthParameters::cracking_pressure},
       {"V_P", &TruthParameters::port_volume},
       {"x_C", &TruthParameters::stroke},
       {"g_V", &TruthParameters::pilot_steepness}}};
  static constexpr std::array kShares = {0.02, 0.05, 0.10, 0.20};
  const auto& [name, value] = kValues[plan.seed % kValues.size()];
  const std::uint64_t round = plan.seed / kValues.size() + plan.seed;
  const double share = (round % 2 == 0 ? 1.0 : -1.0) * kShares[(round / 2) % kShares.size()];
  plan.parameters.*value *= 1.0 + share;
  plan.wrong_value = {std::string(name), share};
}

void hide(TrialPlan& plan, forecast::UniformRandom& random) {
  const std::uint64_t seed = plan.seed;
  const auto plainly = std::span(kTimesBarely).subspan(3);
  switch (plan.stratum) {
    case TrialStratum::null:
      return;
    case TrialStratum::single:
      plan.effects.push_back(nth_effect(listed_places(), seed, kTimesBarely, random));
      return;
    case TrialStratum::pair: {
      const std::vector<Place>& places = listed_places();
      const std::size_t first = seed % places.size();
      std::size_t second =
          (first + 1 + static_cast<std::size_t>(random.unit() * (static_cast<double>(places.size()) - 1.0))) %
          places.size();
      while (places[second].form->id == places[first].form->id) second = (second + 1) % places.size();
      for (const std::size_t k : {first, second})
        plan.effects.push_back(draw_effect(places[k], plainly[(seed + k) % plainly.size()], random));
      return;
    }
    case TrialStratum::outside: {
      static const std::vector<Place> places = places_of({unlisted_effects()});
      plan.effects.push_back(nth_effect(places, seed, kTimesBarely, random));
      return;
    }
    case TrialStratum::sensor:
      plan.faults.push_back(draw_fault(seed, plan.channels));
      return;
    case TrialStratum::recording:
      plan.faults.push_back(draw_recording_fault(seed));
      return;
    case TrialStratum::source_sensors: {
      static const std::vector<Place> places = [] {
        std::vector<Place> found;
        for (const Place& place : listed_places())
          if (place.form->element == "piston" || place.form->element == "piston_seal" ||
              place.form->element == "chamber_a")
            found.push_back(place);
        return found;
      }();
      if (seed % 4 == 1 || seed % 4 == 2) plan.effects.push_back(nth_effect(places, seed / 2, kTimesBarely, random));
      if (seed % 4 == 3) plan.faults.push_back(draw_fault(seed / 4, plan.channels));
      return;
    }
    case TrialStratum::concealed:
    case TrialStratum::nominal_only:
      hide_swallowed(plan, random);
      return;
    case TrialStratum::inseparable:
      hide_inseparable(plan, random);
      return;
    case TrialStratum::asset_file:
      make_wrong(plan);
      return;
  }
}

TruthParameters draw_parameters(NormalRandom& normal) {
  TruthParameters p;
  const auto scatter = [&](double& value, double share) { value *= std::exp(share * normal.next()); };
  scatter(p.seal_resistance, 0.25);
  scatter(p.piston_viscosity, 0.20);
  scatter(p.pump_resistance, 0.25);
  scatter(p.motor_viscosity, 0.20);
  scatter(p.oil_modulus, 0.15);
  scatter(p.winding_resistance, 0.05);
  scatter(p.load, 0.10);
  return p;
}

// No drawing is exact. Roundings of the model's own corners are no values of the plant.
void draw_fixed_values(TrialPlan& plan, NormalRandom normal) {
  TruthParameters& p = plan.parameters;
  for (double* value :
       {&p.driver_capacitance, &p.winding_inductance,  &p.back_emf,          &p.torque_constant, &p.shaft_inertia,
        &p.pump_viscosity,     &p.displacement,        &p.port_volume,       &p.valve_discharge, &p.valve_area,
        &p.forward_steepness,  &p.pilot_steepness,     &p.cracking_pressure, &p.pilot_ratio,     &p.oil_density,
        &p.reservoir_pressure, &p.make_up_conductance, &p.piston_area,       &p.dead_volume,     &p.stroke,
        &p.moving_mass})
    *value *= std::exp(plan.tolerance * normal.next());
}

}  // namespace

TrialPlan plan_trial(TrialStratum stratum, std::uint64_t seed, double tolerance) {
  TrialPlan plan;
  plan.stratum = stratum;
  plan.seed = seed;
  const std::uint64_t own = sub_seed(seed, std::string("trial ").append(name_of(stratum)));
  NormalRandom normal(sub_seed(own, "parameters"));
  plan.parameters = draw_parameters(normal);
  choose_channels(plan);
  forecast::UniformRandom physics(sub_seed(own, "physics"));
  hide(plan, physics);
  choose_conditions(plan, own);
  choose_noise(plan, own);
  plan.tolerance = tolerance;
  if (tolerance > 0.0) draw_fixed_values(plan, NormalRandom(sub_seed(own, "tolerance")));
  return plan;
}

std::vector<TrialTruth> TrialPlan::truths() const {
  std::vector<TrialTruth> found;
  for (const HiddenEffect& e : effects)
    found.push_back({.id = std::string(e.form->id),
                     .element = e.element,
                     .form = std::string(e.form->form),
                     .size = e.size,
                     .unit = std::string(e.form->unit),
                     .strength = std::string(e.form->strength),
                     .strength_value = e.size * e.form->strength_factor,
                     .times_barely = e.size / e.form->barely});
  for (const SensorFault& f : faults) {
    const bool bias = f.kind.ends_with("_bias"), lag = f.kind == "sensor_lag" || f.kind == "input_delay";
    const bool sensor = f.kind.starts_with("sensor");
    found.push_back(
        {.id = f.kind,
         .element = f.channel.empty() ? "clock" : (sensor ? "sensor:" : "input:") + f.channel,
         .form = "constant",
         .size = f.size,
         .unit = bias  ? "channel"
                 : lag ? "s"
                       : "1",
         .strength = f.channel.empty() ? "c"
                     : bias            ? "b"
                     : lag             ? "tau"
                                       : "g",
         .strength_value = f.size,
         .times_barely = std::abs(f.size) / (sensor ? barely_fault(f.kind, f.channel) : barely_recorded(f.kind))});
  }
  return found;
}

std::string TrialPlan::label() const {
  std::string line = text::format("{} {}", name_of(stratum), seed);
  for (const HiddenEffect& e : effects)
    line += text::format(" | {} {} at {} {:.6g} {} [{:.6g} {:.6g} {:.6g}]", e.form->id, e.form->form, e.element, e.size,
                         e.form->unit, e.shape[0], e.shape[1], e.shape[2]);
  for (const SensorFault& f : faults) line += text::format(" | {} of {} {:.6g}", f.kind, f.channel, f.size);
  if (!wrong_value.name.empty()) line += text::format(" | {} {:+.3g}", wrong_value.name, wrong_value.share);
  if (tolerance > 0.0) line += text::format(" | tolerance {:.3g}", tolerance);
  line += text::format(
      " | R_CL {:.6g} f_C {:.6g} R_PL {:.6g} f_M {:.6g} beta {:.6g} R_M {:.6g} phi {:.6g} | jitter {:.3g}",
      parameters.seal_resistance, parameters.piston_viscosity, parameters.pump_resistance, parameters.motor_viscosity,
      parameters.oil_modulus, parameters.winding_resistance, parameters.load, jitter);
  for (const auto& [channel, own] : noise)
    if (own.correlation > 0.0 || own.quantum > 0.0)
      line += text::format(" | {} {:.3g} {:.6g}", channel, own.correlation, own.quantum);
  return line;
}

std::string label_hash(TrialStratum stratum, std::uint64_t first, int count, double tolerance) {
  std::string lines;
  for (int k = 0; k < count; ++k)
    lines.append(plan_trial(stratum, first + static_cast<std::uint64_t>(k), tolerance).label()).append("\n");
  return content_hash(lines);
}

}  // namespace sealwatch::bench
