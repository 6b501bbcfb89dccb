#include "sealwatch/signal/features.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/statistics.hpp"
#include "sealwatch/signal/test_record.hpp"
#include "services/common/signal/feature_parts.hpp"
#include "services/common/signal/mass_balance.hpp"

namespace sealwatch::signal {
namespace {

constexpr double kStrokeShare = 0.05;  // stroke times run from 5 % to 95 %
constexpr double kPressureRise_s = 0.3;

class FeatureList {
 public:
  explicit FeatureList(const TestRecord& test) : test_(test) {}

  std::vector<Feature> compute() {
    add_motion();
    add_pressures();
    add_leakage();
    add_electrics();
    if (const auto* temperature = test_.raw(ChannelRole::temperature)) add("fluid_temperature", mean(*temperature));
    return std::move(features_);
  }

 private:
  void add(std::string_view name, const std::optional<Estimate>& estimate) {
    if (!estimate || !std::isfinite(estimate->value) || !std::isfinite(estimate->std_error)) return;
    const FeatureDescription* description = find_feature(name);
    features_.push_back({std::string(name), std::string(description->unit), estimate->value, estimate->std_error});
  }
  void add_motion();
  void add_pressures();
  void add_leakage();
  void add_electrics();

  [[nodiscard]] std::vector<Range> ranges(MotionKind kind) const;
  [[nodiscard]] std::optional<Estimate> mean_over(MotionKind kind, const std::vector<double>* values) const;
  [[nodiscard]] std::optional<Estimate> speed(MotionKind kind) const;
  [[nodiscard]] std::optional<Estimate> stroke_time(MotionKind kind) const;
  [[nodiscard]] double standstill_position(const MotionPhase& phase) const;
  [[nodiscard]] std::optional<Estimate> hold_decay() const;
  [[nodiscard]] std::optional<Estimate> breakaway_pressure() const;
  [[nodiscard]] std::optional<Estimate> efficiency(MotionKind kind) const;
  [[nodiscard]] const MotionPhase* first(MotionKind kind) const;
  [[nodiscard]] std::vector<Range> holds_after_out() const;
  [[nodiscard]] double out_direction() const;

  const TestRecord& test_;
  std::vector<Feature> features_;
};

bool is_stroke(MotionKind kind) { return kind == MotionKind::out || kind == MotionKind::back; }

/// The usable middles of all strokes, or settled parts of all standstills, of one kind.
std::vector<Range> FeatureList::ranges(MotionKind kind) const {
  std::vector<Range> result;
  for (const MotionPhase& phase : test_.phases()) {
    if (phase.kind != kind) continue;
    const std::optional<Range> range = is_stroke(kind) ? test_.middle(phase) : test_.settled(phase);
    if (range) result.push_back(*range);
  }
  return result;
}

std::optional<Estimate> FeatureList::mean_over(MotionKind kind, const std::vector<double>* values) const {
  if (!values || values->empty()) return std::nullopt;
  return pooled_mean(*values, ranges(kind));
}

const MotionPhase* FeatureList::first(MotionKind kind) const {
  for (const MotionPhase& phase : test_.phases())
    if (phase.kind == kind) return &phase;
  return nullptr;
}

std::vector<Range> FeatureList::holds_after_out() const {
  std::vector<Range> result;
  const std::vector<MotionPhase>& phases = test_.phases();
  for (std::size_t i = 1; i < phases.size(); ++i) {
    if (phases[i].kind != MotionKind::hold || phases[i - 1].kind != MotionKind::out) continue;
    if (const std::optional<Range> range = test_.settled(phases[i])) result.push_back(*range);
  }
  return result;
}

/// +1 when the stroke out goes towards +x.
double FeatureList::out_direction() const {
  const MotionPhase* out = first(MotionKind::out);
  const Range range = test_.range(*out);
  return test_.position()[range.end - 1] >= test_.position()[range.begin] ? 1.0 : -1.0;
}

std::optional<Estimate> FeatureList::speed(MotionKind kind) const {
  std::optional<Estimate> result = mean_over(kind, &test_.velocity());
  if (result) result->value = std::abs(result->value);
  return result;
}

/// From 5 % to 95 % of the way between the standstills before and after the stroke; both must have been recorded.
std::optional<Estimate> FeatureList::stroke_time(MotionKind kind) const {
  const std::vector<MotionPhase>& phases = test_.phases();
  auto stroke = std::find_if(phases.begin(), phases.end(), [kind](const MotionPhase& p) { return p.kind == kind; });
  if (stroke == phases.end() || std::next(stroke) == phases.end()) return std::nullopt;  // cut before it ended
  const MotionPhase& after = *std::next(stroke);
  if (stroke != phases.begin() && std::prev(stroke)->kind == MotionKind::breakaway) --stroke;
  if (stroke == phases.begin()) return std::nullopt;  // began before the recording
  const MotionPhase& before = *std::prev(stroke);
  const std::optional<Estimate> run = speed(kind);
  if (!run || run->value <= 0.0) return std::nullopt;
  const double from = standstill_position(before);
  const double to = standstill_position(after);
  const double direction = to >= from ? 1.0 : -1.0;
  const Range range{test_.range(before).begin, test_.range(after).end};
  const auto begin = crossing_s(test_, range, from + kStrokeShare * (to - from), direction);
  const auto end = crossing_s(test_, range, to - kStrokeShare * (to - from), direction);
  if (!begin || !end) return std::nullopt;
  return Estimate{*end - *begin, std::sqrt(2.0) * test_.smooth_noise_std(ChannelRole::stroke) / run->value};
}

/// Where the piston stands: the mean of the settled part, the last value where that is too short.
double FeatureList::standstill_position(const MotionPhase& phase) const {
  const std::optional<Range> settled = test_.settled(phase);
  return settled ? mean(part(test_.position(), *settled)).value : test_.position()[test_.range(phase).end - 1];
}

void FeatureList::add_motion() {
  const MotionPhase* out = first(MotionKind::out);
  if (!out) return;
  const std::vector<double>& x = test_.position();
  const MotionPhase& front = test_.phases().front();
  const double start = front.kind == MotionKind::rest ? standstill_position(front) : x.front();
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const double noise = test_.smooth_noise_std(ChannelRole::stroke);
  add("travel", Estimate{std::max(*most - start, start - *least), std::sqrt(2.0) * noise});
  const MotionPhase& last = test_.phases().back();
  const std::vector<Range> rests = ranges(MotionKind::rest);
  if (last.kind == MotionKind::hold && first(MotionKind::back) && !rests.empty() && test_.settled(last)) {
    const Estimate before = mean(part(x, rests.front()));
    const Estimate after = mean(part(x, *test_.settled(last)));
    add("return_error", Estimate{after.value - before.value, std::hypot(before.std_error, after.std_error)});
  }
  add("stroke_time_out", stroke_time(MotionKind::out));
  add("stroke_time_back", stroke_time(MotionKind::back));
  add("speed_out", speed(MotionKind::out));
  add("speed_back", speed(MotionKind::back));
  if (const MotionPhase* breakaway = first(MotionKind::breakaway))
    add("breakaway_time", Estimate{breakaway->duration_s(), test_.interval_s() * std::sqrt(2.0 / 12.0)});
}

/// Until shortly after breakaway: a pressure sensor and the smoothing come late.
std::optional<Estimate> FeatureList::breakaway_pressure() const {
  const MotionPhase* breakaway = first(MotionKind::breakaway);
  const std::optional<Estimate> rest = mean_over(MotionKind::rest, &test_.smooth_load_pressure());
  if (!breakaway || !rest || !first(MotionKind::out)) return std::nullopt;
  const std::vector<double>& pressure = test_.smooth_load_pressure();
  Range range = test_.range(*breakaway);
  range.end = std::min(range.end + static_cast<std::size_t>(kPressureRise_s / test_.interval_s()), pressure.size());
  double largest = 0.0;
  for (std::size_t i = range.begin; i < range.end; ++i)
    largest = std::max(largest, out_direction() * (pressure[i] - rest->value));
  const double noise =
      test_.raw(ChannelRole::pressure_difference) && !test_.raw(ChannelRole::pressure_up)
          ? test_.smooth_noise_std(ChannelRole::pressure_difference)
          : std::hypot(test_.smooth_noise_std(ChannelRole::pressure_up),
                       test_.cylinder().area_ratio * test_.smooth_noise_std(ChannelRole::pressure_down));
  return Estimate{largest, std::hypot(noise, rest->std_error)};
}

std::optional<Estimate> FeatureList::hold_decay() const {
  std::vector<Estimate> decays;
  for (const Range& range : holds_after_out()) {
    const std::span<const double> pressure = part(test_.load_pressure(), range);
    const double sign = mean(pressure).value >= 0.0 ? 1.0 : -1.0;
    const Estimate rate = slope(pressure, test_.interval_s());
    decays.push_back({-sign * rate.value, rate.std_error});
  }
  if (decays.empty()) return std::nullopt;
  return weighted_mean(decays);
}

void FeatureList::add_pressures() {
  const std::vector<double>& pressure = test_.load_pressure();
  if (pressure.empty()) return;
  add("breakaway_pressure", breakaway_pressure());
  add("rest_pressure", mean_over(MotionKind::rest, &pressure));
  const std::optional<Estimate> out = mean_over(MotionKind::out, &pressure);
  const std::optional<Estimate> back = mean_over(MotionKind::back, &pressure);
  add("running_pressure_out", out);
  add("running_pressure_back", back);
  if (out && back)
    add("friction_pressure", Estimate{0.5 * out_direction() * (out->value - back->value),
                                      0.5 * std::hypot(out->std_error, back->std_error)});
  add("hold_pressure", pooled_mean(pressure, holds_after_out()));
  add("hold_decay", hold_decay());
}

void FeatureList::add_leakage() {
  const MassBalance balance(test_);
  if (!balance.possible()) return;
  const std::vector<Range> rests = ranges(MotionKind::rest);
  const std::vector<Range> holds = ranges(MotionKind::hold);
  std::vector<Range> standstills = rests;
  standstills.insert(standstills.end(), holds.begin(), holds.end());
  add("leakage_flow", balance.leakage(standstills));
  add("leakage_flow_rest", balance.leakage(rests));
  add("leakage_flow_hold", balance.leakage(holds));
  add("leakage_flow_out", balance.leakage(ranges(MotionKind::out)));
  add("leakage_flow_back", balance.leakage(ranges(MotionKind::back)));
  add("leakage_resistance", balance.resistance(standstills));
}

std::optional<Estimate> FeatureList::efficiency(MotionKind kind) const {
  const std::optional<Estimate> velocity = mean_over(kind, &test_.velocity());
  const std::optional<Estimate> shaft = mean_over(kind, test_.raw(ChannelRole::shaft_speed));
  const Cylinder& cylinder = test_.cylinder();
  if (!velocity || !shaft || !cylinder.area_a_m2 || !cylinder.displacement_m3_rad) return std::nullopt;
  if (std::abs(shaft->value) < 3.0 * shaft->std_error || velocity->value == 0.0) return std::nullopt;
  // The pump drives the chamber on the side that the piston leaves: A while x grows, B while it falls.
  const double area = *cylinder.area_a_m2 * (velocity->value > 0.0 ? 1.0 : cylinder.area_ratio);
  const double ratio = area * velocity->value / (*cylinder.displacement_m3_rad * shaft->value);
  return Estimate{ratio,
                  std::abs(ratio) * std::hypot(velocity->std_error / velocity->value, shaft->std_error / shaft->value)};
}

void FeatureList::add_electrics() {
  const std::vector<double>* current = test_.raw(ChannelRole::current);
  const Series* drive = test_.drive();
  const std::vector<double>* voltage = drive != nullptr && drive->unit == "V" ? &drive->values : nullptr;
  const std::vector<double>* shaft = test_.raw(ChannelRole::shaft_speed);
  if (current)
    add("peak_current", peak(*test_.smooth(ChannelRole::current), test_.smooth_noise_std(ChannelRole::current)));
  add("running_current_out", mean_over(MotionKind::out, current));
  add("running_current_back", mean_over(MotionKind::back, current));
  if (voltage) add("peak_voltage", peak(*voltage, drive->noise_std));
  add("running_voltage_out", mean_over(MotionKind::out, voltage));
  add("running_voltage_back", mean_over(MotionKind::back, voltage));
  add("running_shaft_speed_out", mean_over(MotionKind::out, shaft));
  add("running_shaft_speed_back", mean_over(MotionKind::back, shaft));
  add("volumetric_efficiency_out", efficiency(MotionKind::out));
  add("volumetric_efficiency_back", efficiency(MotionKind::back));
  if (drive) add("drive_saturation", Estimate{saturation(drive->values), 0.0});
}

}  // namespace

const FeatureDescription* find_feature(std::string_view name) {
  const auto* found = std::find_if(std::begin(kFeatures), std::end(kFeatures),
                                   [name](const FeatureDescription& feature) { return feature.name == name; });
  return found == std::end(kFeatures) ? nullptr : found;
}

std::vector<Feature> compute_features(const TestRecord& test) { return FeatureList(test).compute(); }

}  // namespace sealwatch::signal
