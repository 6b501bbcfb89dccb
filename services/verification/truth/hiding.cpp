// What the strata hide that are about what tests cannot show. The sizes come from the linearised generator: each is
// where the free parameters, or the twin, leave a noncentrality of about 2 (a test recomputes it for the sets,
// tests/unit/verification/truth_rival_test.cpp).
#include <array>
#include <cmath>
#include <numbers>

#include "services/verification/truth/conditions.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {
namespace {

using Channels = std::vector<std::string>;

/// One form or fault with the most of it that stays hidden, in multiples of what wide tests begin to show.
struct Hidden {
  std::string_view id, form;
  std::size_t side = 0;
  double times_barely = 0.0;
  std::string_view channel = {};  ///< of a sensor's gain; the sign of `times_barely` counts
};

const EffectForm* form_of(const Hidden& hidden) {
  for (const auto group : {piston_effects(), hydraulic_effects(), electric_effects(), twin_effects()})
    for (const EffectForm& form : group)
      if (form.id == hidden.id && form.form == hidden.form) return &form;
  return nullptr;
}

/// Shapes near the middle of their ranges: the sizes hold there.
void hide_one(const Hidden& hidden, double share, forecast::UniformRandom& random, TruthRival& into) {
  constexpr double kGainBarely = 3e-4, kNearMiddle = 0.1;
  if (!hidden.channel.empty()) {
    into.faults.push_back({.kind = "sensor_gain",
                           .channel = std::string(hidden.channel),
                           .size = share * hidden.times_barely * kGainBarely});
    return;
  }
  const EffectForm* form = form_of(hidden);
  HiddenEffect effect{.form = form,
                      .element = std::string(hidden.side == 0 ? form->element : form->other_element),
                      .side = hidden.side,
                      .size = share * hidden.times_barely * form->barely};
  for (std::size_t k = 0; k < kShapes; ++k)
    effect.shape[k] =
        std::sqrt(form->shapes[k].min * form->shapes[k].max) * random.between(1.0 - kNearMiddle, 1.0 + kNearMiddle);
  into.effects.push_back(std::move(effect));
}

struct Pair {
  Channels channels;
  Hidden truth, twin;
};

constexpr std::string_view kLeak = "external_leakage", kSlip = "speed_dependent_pump_slip";

// No pressure recorded: nobody sees which chamber loses the oil. Speed or flow behind the pump recorded once: a pump
// that delivers less in each turn and a sensor that shows less are one and the same. Recorded twice: either sensor may
// be off.
const std::vector<Pair>& pairs() {
  static const Channels kPosition = {"motor_voltage", "motor_current", "shaft_speed", "position"};
  static const Channels kVelocity = {"motor_voltage", "motor_current", "shaft_speed", "velocity"};
  static const Channels kFlow = {"motor_voltage", "motor_current", "shaft_speed", "flow"};
  static const Channels kMotion = {"motor_voltage", "pressure_b", "flow", "velocity"};
  static const std::vector<Pair> pairs = {
      {kPosition, {kLeak, "fitting", 0, 4.8}, {kLeak, "fitting", 1, 10.0}},
      {kVelocity, {kSlip, "carry_back", 0, 22.0}, {"sensor_gain", "", 0, -7.4, "velocity"}},
      {kFlow, {kSlip, "carry_back", 0, 23.0}, {"sensor_gain", "", 0, -7.6, "flow"}},
      {kPosition, {kLeak, "fitting", 1, 10.0}, {kLeak, "fitting", 0, 4.8}},
      {kVelocity, {"sensor_gain", "", 0, -7.4, "velocity"}, {kSlip, "carry_back", 0, 22.0}},
      {kFlow, {"sensor_gain", "", 0, -7.6, "flow"}, {kSlip, "carry_back", 0, 23.0}},
      {kMotion, {"sensor_gain", "", 0, 8.0, "flow"}, {"sensor_gain", "", 0, -8.0, "velocity"}},
      {kPosition, {kLeak, "rod_seal", 1, 3.9}, {kLeak, "fitting", 0, 2.9}}};
  return pairs;
}

struct Swallowed {
  Channels channels;
  Hidden truth;
};

// What one load and one speed do not show, as far as these channels go. All but the first where only some of the
// channels are recorded, as on an installed actuator.
const std::vector<Swallowed>& swallowed() {
  static const Channels kAll = {"motor_voltage", "motor_current", "shaft_speed", "pressure_a",
                                "pressure_b",    "flow",          "position",    "velocity"};
  static const Channels kInstalled = {"motor_voltage", "motor_current", "shaft_speed", "position"};
  static const Channels kPressures = {"motor_voltage", "motor_current", "pressure_a", "pressure_b", "position"};
  static const std::vector<Swallowed> swallowed = {{kAll, {"turbulent_seal_leakage", "transition", 0, 6.0}},
                                                   {kPressures, {"turbulent_pump_slip", "transition", 0, 2.9}},
                                                   {kInstalled, {"line_resistance", "entrance", 1, 1.1}},
                                                   {kPressures, {"driver_dead_time", "bridge_loss", 0, 1.6}},
                                                   {kInstalled, {"external_leakage", "rod_seal", 0, 0.55}},
                                                   {kInstalled, {"turbulent_seal_leakage", "transition", 0, 15.0}},
                                                   {kInstalled, {"backlash", "clearance", 0, 3.1}},
                                                   {kInstalled, {"turbulent_pump_slip", "transition", 0, 3.1}},
                                                   {kInstalled, {"valve_hysteresis", "relay", 1, 0.66}},
                                                   {kInstalled, {"line_resistance", "blasius", 1, 0.75}}};
  return swallowed;
}

// The voltage and the position alone, as where nothing but the position loop is wired: sizes about those
// that matter to an engineer stay hidden in nominal tests.
const std::vector<Swallowed>& unseen() {
  static const Channels kPosition = {"motor_voltage", "position"};
  static const std::vector<Swallowed> unseen = {{kPosition, {"turbulent_seal_leakage", "transition", 0, 40.0}},
                                                {kPosition, {"shaft_coulomb_friction", "arctangent", 0, 35.0}},
                                                {kPosition, {"line_resistance", "blasius", 0, 60.0}},
                                                {kPosition, {"torque_saturation", "arctangent", 0, 90.0}},
                                                {kPosition, {"turbulent_pump_slip", "transition", 0, 14.0}},
                                                {kPosition, {"pressure_dependent_shaft_friction", "plates", 0, 45.0}},
                                                {kPosition, {"quadratic_drag", "transition", 0, 11.0}},
                                                {kPosition, {"coulomb_friction", "arctangent", 0, 9.0}},
                                                {kPosition, {"hose_compliance", "braided", 0, 11.0}},
                                                {kPosition, {"cogging_torque", "two_harmonics", 0, 35.0}}};
  return unseen;
}

std::string place_of(const TruthRival& physics) {
  if (!physics.effects.empty())
    return std::string(physics.effects.front().form->id).append(" ").append(physics.effects.front().element);
  return physics.faults.front().kind + " sensor:" + physics.faults.front().channel;
}

}  // namespace

void hide_inseparable(TrialPlan& plan, forecast::UniformRandom& random) {
  const Pair& pair = pairs()[plan.seed % pairs().size()];
  const double share = random.between(0.7, 1.0);
  TruthRival truth;
  hide_one(pair.truth, share, random, truth);
  hide_one(pair.twin, share, random, plan.twin_physics);
  plan.channels = pair.channels;
  plan.effects = std::move(truth.effects);
  plan.faults = std::move(truth.faults);
  plan.twin = place_of(plan.twin_physics);
}

void hide_swallowed(TrialPlan& plan, forecast::UniformRandom& random) {
  const bool nominal_only = plan.stratum == TrialStratum::nominal_only;
  const std::vector<Swallowed>& places = nominal_only ? unseen() : swallowed();
  const Swallowed& place = places[plan.seed % places.size()];
  // Sizes are for four nominal tests; concealed sets have two.
  const double most = nominal_only ? 1.0 : std::numbers::sqrt2;
  TruthRival truth;
  hide_one(place.truth, most * random.between(0.7, 1.0), random, truth);
  plan.channels = place.channels;
  plan.effects = std::move(truth.effects);
}

}  // namespace sealwatch::bench
