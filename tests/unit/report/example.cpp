#include "tests/unit/report/example.hpp"

#include <cmath>
#include <limits>
#include <random>

namespace sealwatch::report {
namespace {

using namespace mismatch;

constexpr double kFriction_N = 4000.0;

const LawAt kStribeck = {.id = "stribeck_friction",
                         .form = "",
                         .element = "piston",
                         .law = "(F_c + F_x exp(-(v / v_st)^2)) tanh(v / v_s)",
                         .meaning = "dry friction that is larger near standstill"};
const LawAt kCoulomb = {.id = "coulomb_friction",
                        .form = "",
                        .element = "piston",
                        .law = "F_c tanh(v / v_s)",
                        .meaning = "dry friction of seals and guides"};
const LawAt kLeakage = {.id = "turbulent_seal_leakage",
                        .form = "",
                        .element = "piston_seal",
                        .law = "k (p_A - p_B) / sqrt(abs(p_A - p_B) + 1 kPa)",
                        .meaning = "leakage past the piston through a nick"};

/// Speed of a stroke out, a hold and a stroke back.
double speed(double t, double stroke_speed) {
  if (t > 1.0 && t < 13.0) return -stroke_speed;
  if (t > 16.0 && t < 28.0) return stroke_speed;
  return 0.0;
}

double friction(double v) { return kFriction_N * (1.0 + 0.6 * std::exp(-(v * v) / 2.5e-7)) * std::tanh(v / 5e-5); }

Series series(const char* name, const char* unit, double noise, std::vector<double> values) {
  return {.name = name, .unit = unit, .noise_std = noise, .values = std::move(values)};
}

/// Recorded, simulated without and simulated with the friction.
void add_samples(double stroke_speed, unsigned seed, RecordingComparison& comparison) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  std::vector<double> time, position[3], pressure[3], flow[3];
  double x = 0.06;
  for (int k = 0; k <= 6000; ++k) {
    const double t = 0.005 * k;
    const double v = speed(t, stroke_speed);
    x += 0.005 * v;
    time.push_back(t);
    for (int which = 0; which < 3; ++which) {  // recorded, before, after
      const double rattle = which == 0 ? 1.0 : 0.0;
      const double loss = which == 1 ? 0.0 : friction(v) / 5.89e-3;
      position[which].push_back(x + (which == 1 ? 1.2e-4 * std::sin(t / 5.0) : 0.0) + rattle * 5e-6 * noise(random));
      pressure[which].push_back(1.02e7 + 9e8 * v + loss + rattle * 1e4 * noise(random));
      flow[which].push_back(5.89e-3 * v + rattle * 4e-8 * noise(random));
    }
  }
  TimeSeries* targets[3] = {&comparison.recorded, &comparison.before, &comparison.after};
  for (int which = 0; which < 3; ++which) {
    targets[which]->time_s = time;
    targets[which]->channels = {series("pressure_a", "Pa", 1e4, pressure[which]),
                                series("flow", "m3/s", 4e-8, flow[which]),
                                series("position", "m", 5e-6, position[which])};
  }
}

RecordingComparison recording(const std::string& name, bool holdout, double stroke_speed, unsigned seed) {
  RecordingComparison comparison;
  comparison.recording = name;
  comparison.holdout = holdout;
  comparison.channels = {{"pressure_a", 71.0, 1.02, 31.4, 98.2, 1e-30, 0.3, 1e-12, 0.5},
                         {"flow", 1.4, 1.01, 95.1, 96.9, 1e-5, 0.2, 0.02, 0.6},
                         {"position", 6.1, 1.0, 98.8, 99.8, 1e-20, 0.4, 1e-3, 0.7}};
  comparison.likelihood_gain = 5120.0;
  comparison.gain_low = 4870.0;
  comparison.gain_high = 5360.0;
  add_samples(stroke_speed, seed, comparison);
  return comparison;
}

MissingTerm missing_term() {
  MissingTerm term;
  term.element = "piston";
  term.quantity = "force against +x";
  term.unit = "N";
  term.recording = "fit_0";
  term.state = "piston velocity";
  term.state_unit = "m/s";
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  for (int k = 0; k <= 600; ++k) {
    const double t = 0.05 * k;
    const double v = speed(t, 1.33e-3) * std::min(1.0, std::abs(std::sin(t * 0.9)) + 0.05);
    term.time_s.push_back(t);
    term.state_value.push_back(v);
    term.law.push_back(friction(v));
    term.demanded.push_back(friction(v) + 250.0 * noise(random));
    term.band.push_back(500.0);
  }
  term.path_state = term.state_value;
  term.path_law = term.law;
  return term;
}

FoundEffect effect() {
  return {
      .what = kStribeck,
      .parameters = {{"F_c", "N", 4010.0, 60.0, false},
                     {"F_x", "N", 2400.0, 180.0, false},
                     {"v_st", "m/s", 5.1e-4, std::numeric_limits<double>::infinity(), true}},
      .probability = 0.97,
      .element_probability = 0.98,
      .indistinguishable = {kCoulomb},
      .same_elements = {},
      .delta_bic = -812.0,
      .engineering_share = 6.7,
      .regime = "moving, both directions, strongest below 0.5 mm/s",
      .evidence = "The missing force changes sign with the direction of motion and falls with speed.",
      .alternatives = {{.what = kCoulomb, .misfit_above_best = 5.2, .why_not = "misses the rise near standstill"},
                       {.what = kLeakage, .misfit_above_best = 880.0, .why_not = "leaves the pressures unexplained"}}};
}

void add_power(Explanation& explanation) {
  explanation.power = {
      {.what = kCoulomb, .minimum_detectable = 55.0, .unit = "N", .absorbed_share = 0.61, .significant = 600.0},
      {.what = kLeakage,
       .minimum_detectable = 6e-11,
       .unit = "m3/(s Pa^0.5)",
       .absorbed_share = 0.996,
       .significant = 2.5e-11},
      {.what = {.id = "entrained_air", .form = "", .element = "fluid", .law = "a", .meaning = "air"},
       .minimum_detectable = std::numeric_limits<double>::infinity(),
       .unit = "1",
       .absorbed_share = 1.0,
       .significant = 0.002}};
}

}  // namespace

Explanation example_explanation() {
  Explanation explanation;
  explanation.asset_id = "XT03-MV2";
  explanation.model = "eha";
  explanation.fit_recordings = {"fit_0", "fit_1"};
  explanation.holdout_recordings = {"holdout_0"};
  explanation.verdict = Verdict::mismatch;
  explanation.p_value = 1e-9;
  explanation.statistically_significant = true;
  explanation.explained_share = 0.998;
  explanation.location = {{"piston", 0.98, {}, "A force that opposes the motion explains 99.8 % of the misfit."},
                          {"piston_seal", 0.015, {"chamber_a"}, "A flow would need the wrong sign when retracting."},
                          {"sensor:pressure_a", 0.005, {}, "A bias does not change with direction."}};
  explanation.effects = {effect()};
  explanation.missing = {missing_term()};
  explanation.recordings = {recording("fit_0", false, 1.33e-3, 1), recording("holdout_0", true, 0.7e-3, 2)};
  explanation.fit.channels = explanation.recordings[0].channels;
  explanation.holdout.channels = explanation.recordings[1].channels;
  explanation.parameters = {{"f_C", "N s/m", 4.9e6, 2e4, 2.02e6, 3e4, 2e6},
                            {"R_CL", "Pa s/m3", 1.9e13, 4e11, 2.58e13, 3e11, 2.6e13}};
  add_power(explanation);
  explanation.rejected = {{.what = kLeakage, .why = "fits better only with oil flowing from low to high pressure"}};
  explanation.prognosis = {.known = true,
                           .part = "piston seal",
                           .parameter = "R_CL",
                           .unit = "Pa s/m3",
                           .R_CL_before = 1.9e13,
                           .R_CL_after = 2.58e13,
                           .theta_before = 0.869,
                           .theta_after = 0.996,
                           .months_before = 79.0,
                           .months_after = 157.0,
                           .sentence = "Without the friction the seal looked 13 % more worn than it is."};
  explanation.next_test = "Record a stroke at 0.2 mm/s: it separates Stribeck from Coulomb friction.";
  explanation.summary =
      "The piston meets dry friction of 4.0 kN that the model lacked, larger near standstill. With it, the simulation "
      "agrees with the recordings that were held out.";
  explanation.notes = {"Noise was taken from rest segments.", "117 laws were tried."};
  return explanation;
}

Explanation consistent_example() {
  Explanation explanation;
  explanation.asset_id = "XT03-MV2";
  explanation.model = "emps";
  explanation.fit_recordings = {"a", "b"};
  explanation.verdict = Verdict::consistent;
  explanation.p_value = 0.41;
  explanation.summary = "Simulation and recordings agree within the noise.";
  add_power(explanation);
  return explanation;
}

}  // namespace sealwatch::report
