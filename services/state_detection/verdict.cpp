#include "services/state_detection/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/format.hpp"
#include "services/state_detection/indicators.hpp"
#include "services/state_detection/rules.hpp"

namespace sealwatch {
namespace {

/// Share of the stroke that must be reached, and to which the piston must come back: the ramp's following error and the
/// end of a minimum-energy hold stay well within it.
constexpr double kStrokeTolerance = 0.05;
/// A recording shorter than this share of a whole test has lost its end.
constexpr double kWholeShare = 0.9;

bool has_phase(const TestFeatures& features, PhaseKind kind) {
  return std::any_of(features.phases.begin(), features.phases.end(),
                     [kind](const Phase& phase) { return phase.kind == kind; });
}

bool is_full_stroke(const TestFeatures& features) { return features.test_kind == "full_stroke"; }

bool moved_as_a_test_does(const TestFeatures& features) {
  const bool there = has_phase(features, PhaseKind::out) && has_phase(features, PhaseKind::hold);
  return there && (is_full_stroke(features) || has_phase(features, PhaseKind::back));
}

/// The stroke that the test must reach.
double required_stroke_m(const AssetConfig& asset, const TestFeatures& features) {
  if (const auto full = whole_stroke_m(asset); is_full_stroke(features) && full) return *full;
  return std::abs(asset.pst.stroke_m);
}

/// What the stroke was measured by: the position, or where that is not in order the velocity, integrated, as data
/// manipulation does it.
struct StrokeMeasure {
  const Series* series = nullptr;
  bool is_velocity = false;
  bool none = false;           ///< the plant has neither: it is judged by its model alone
  std::string velocity_fault;  ///< the same of the velocity
  std::string position_fault;  ///< "position is FAILED: frozen for 4.0 s", "position was not recorded"; "" in order
};

/// Why the channel cannot measure, or "".
std::string fault_of(const TestFeatures& features, const TestWindow& window, const std::string& channel) {
  if (channel.empty()) return "the plant has none";
  for (const ChannelStatus& status : features.channel_status)
    if (status.channel == channel && status.state == ChannelState::FAILED)
      return channel + " is FAILED" + (status.reason.empty() ? "" : ": " + status.reason);
  const Series* series = window.samples.find(channel);
  return series == nullptr || series->values.empty() ? channel + " was not recorded" : "";
}

StrokeMeasure measure_of_stroke(const AssetConfig& asset, const TestFeatures& features, const TestWindow& window) {
  const PlantDescription& plant = plant_or_default(asset.model);
  const std::string position = channel_name(plant, ChannelRole::stroke),
                    velocity = channel_name(plant, ChannelRole::speed);
  StrokeMeasure measure;
  measure.none = position.empty() && velocity.empty();
  measure.position_fault = fault_of(features, window, position);
  measure.velocity_fault = fault_of(features, window, velocity);
  measure.is_velocity = !measure.position_fault.empty() && measure.velocity_fault.empty();
  if (measure.is_velocity)
    measure.series = window.samples.find(velocity);
  else if (measure.position_fault.empty())
    measure.series = window.samples.find(position);
  return measure;
}

/// Position over the test: that of the channel, or the sum of the velocity.
std::vector<double> path_m(const StrokeMeasure& measure, const std::vector<double>& time_s) {
  std::vector<double> path = measure.series->values;
  if (!measure.is_velocity) return path;
  double position = 0.0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const double velocity = std::exchange(path[k], position);
    if (k + 1 < path.size()) position += velocity * (time_s[k + 1] - time_s[k]);
  }
  return path;
}

/// Largest distance from the start. A piston that never moved has no feature `travel`, but that must not go unjudged.
std::optional<double> travel_m(const TestFeatures& features, const TestWindow& window, const StrokeMeasure& measure) {
  if (measure.series == nullptr) return std::nullopt;
  if (const auto travel = feature_of(features, "travel")) return travel;
  const std::vector<double> path = path_m(measure, window.samples.time_s);
  const auto [least, largest] = std::minmax_element(path.begin(), path.end());
  return *largest - *least;
}

/// Why nothing can be said, or "".
std::string why_not_judged(const AssetConfig& asset, const TestFeatures& features, const StrokeMeasure& measure) {
  if (!features.test_kind.empty() && features.test_kind != "pst" && !is_full_stroke(features))
    return "the recording is of kind '" + features.test_kind + "', not a stroke test";
  // Neither the way that the piston went nor where it should come back to is known.
  if (!features.phases.empty() && features.phases.front().kind != PhaseKind::rest)
    return "the recording begins inside the stroke";
  const double expected_s = asset.pst.expected_duration_s();
  if (!moved_as_a_test_does(features) && features.duration_s < kWholeShare * expected_s)
    return text::format("the recording was cut after {:.1f} s of about {:.0f} s", features.duration_s, expected_s);
  if (!features.complete)
    return text::format("the end of the test was not recorded ({:.1f} s were)", features.duration_s);
  if (measure.series == nullptr)
    return "nothing measured the stroke: " + measure.position_fault + ", " + measure.velocity_fault;
  return {};
}

void judge_stroke(const AssetConfig& asset, const TestFeatures& features, double travel,
                  std::vector<std::string>& failures) {
  const double stroke_mm = 1e3 * required_stroke_m(asset, features);
  const double travel_mm = 1e3 * travel;
  if (travel_mm < (1.0 - kStrokeTolerance) * stroke_mm)
    failures.push_back(text::format("the piston moved {:.2f} mm of the {:.1f} mm stroke", travel_mm, stroke_mm));
  if (is_full_stroke(features)) return;                  // it stays where it went
  if (travel_mm < kStrokeTolerance * stroke_mm) return;  // it never left
  const auto error = feature_of(features, "return_error");
  if (!error)
    failures.push_back("the piston did not come back to where it started");
  else if (1e3 * std::abs(*error) > kStrokeTolerance * std::max(stroke_mm, travel_mm))
    failures.push_back(
        text::format("the piston came back {:.2f} mm away from where it started", 1e3 * std::abs(*error)));
}

void judge_speed(const AssetConfig& asset, const std::vector<Quantity>& indicators, Verdict& verdict,
                 std::vector<std::string>& failures) {
  const double longest_s = longest_closing_time_s(asset);
  const auto indicator = std::ranges::find(indicators, "closing_time", &Quantity::name);
  if (indicator == indicators.end()) {
    verdict.reasons.push_back("how fast it closes was not measured");
    return;
  }
  const std::string closing =
      text::format("at the speed of this test the full stroke closes in {:.1f} s, {:.1f} s are allowed",
                   indicator->value, longest_s);
  (indicator->value > longest_s ? failures : verdict.reasons).push_back(closing);
}

std::string judged_by(const StrokeMeasure& measure, const TestFeatures& features) {
  if (measure.is_velocity) return "judged by the velocity, integrated: " + measure.position_fault;
  for (const ChannelStatus& status : features.channel_status)
    if (status.channel == measure.series->name && status.state == ChannelState::UNKNOWN)
      return "judged by the position, which is in doubt" + (status.reason.empty() ? "" : ": " + status.reason);
  return "judged by the position";
}

/// Of a plant that has no stroke, whether the test was recorded to its end; how it behaves its model says.
Verdict judge_without_stroke(const TestFeatures& features) {
  if (!features.complete)
    return {PstVerdict::not_judged,
            {text::format("the end of the test was not recorded ({:.1f} s were)", features.duration_s)}};
  return {PstVerdict::passed, {"the plant has no stroke: by its model alone"}};
}

}  // namespace

Verdict judge_test(const AssetConfig& asset, const TestFeatures& features, const TestWindow& window,
                   const std::vector<Quantity>& indicators) {
  if (features.aborted) {
    const std::string why = features.abort_reason.empty() ? "no reason given" : features.abort_reason;
    return {PstVerdict::aborted, {text::format("given up after {:.1f} s: ", features.duration_s) + why}};
  }
  const StrokeMeasure measure = measure_of_stroke(asset, features, window);
  if (measure.none) return judge_without_stroke(features);
  const std::optional<double> travel = travel_m(features, window, measure);
  if (const std::string why = why_not_judged(asset, features, measure); !why.empty())
    return {PstVerdict::not_judged, {why}};

  Verdict verdict{PstVerdict::passed, {}};
  verdict.reasons.push_back(text::format("the piston moved {:.2f} mm", 1e3 * *travel));
  std::vector<std::string> failures;
  judge_stroke(asset, features, *travel, failures);
  judge_speed(asset, indicators, verdict, failures);
  if (!failures.empty()) verdict = {PstVerdict::failed, failures};
  verdict.reasons.push_back(judged_by(measure, features));
  return verdict;
}

}  // namespace sealwatch
