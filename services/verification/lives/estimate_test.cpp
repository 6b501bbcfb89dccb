#include "services/verification/lives/estimate_test.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "sealwatch/signal/test_record.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "services/data_manipulation/asset_view.hpp"
#include "services/data_manipulation/data_manipulation.hpp"
#include "services/prognostic_assessment/judge_estimate.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"

namespace sealwatch::verification {
namespace {

constexpr std::size_t kFewestSamples = 16;  // as data manipulation has it

std::vector<Phase> phases_of(const AssetConfig& asset, const TimeSeries& samples) {
  const AssetView view{.asset = &asset};
  const signal::TestRecord record(samples, view.cylinder(), view.described());
  std::vector<Phase> phases;
  for (const signal::MotionPhase& phase : record.phases())
    phases.push_back({static_cast<PhaseKind>(phase.kind), phase.begin_s, phase.end_s});
  return phases;
}

std::optional<forecast::ConditionSample> judged(const AssetConfig& asset, FitReport fit, UtcTime when) {
  HealthReport health;
  health.admissible_for_prognosis = true;
  health.header.event_time_known = true;
  const LeakageEstimate estimate = prognostic_assessment::judge_estimate(
      asset, health, {std::move(fit)}, prognostic_assessment::Options{}.largest_condition_std);
  if (!estimate.used_for_forecast) return std::nullopt;
  return forecast::ConditionSample{when, estimate.condition, estimate.condition_std};
}

}  // namespace

std::optional<forecast::ConditionSample> estimate_condition(const AssetConfig& asset, const TimeSeries& samples,
                                                            UtcTime when) {
  if (samples.time_s.size() < kFewestSamples) return std::nullopt;
  return judged(asset, fit_cylinder_circuit(asset, samples, phases_of(asset, samples)), when);
}

std::optional<forecast::ConditionSample> estimate_through_layers(const AssetConfig& asset, const TimeSeries& samples,
                                                                 UtcTime when) {
  const std::vector<AssetConfig> assets = {asset};
  const std::vector<LayerMaker> layers = {
      [&assets](const std::string&) { return std::make_unique<DataAcquisition>(assets); },
      [&assets](const std::string&) { return std::make_unique<DataManipulation>(assets); }};
  TestWindow window;
  InProcessPipeline pipeline(layers, [&window](const Message& message) {
    if (const auto* concluded = std::get_if<TestWindow>(&message)) window = *concluded;
  });
  Recording recording;
  recording.recording_id = format_utc(when);
  recording.asset_id = asset.asset_id;
  recording.start_time = when;
  recording.samples = samples;
  for (RawSamples& block : blocks_of(recording)) pipeline.push(Message(std::move(block)));
  return judged(asset, fit_cylinder_circuit(asset, window.samples, window.phases), when);
}

}  // namespace sealwatch::verification
