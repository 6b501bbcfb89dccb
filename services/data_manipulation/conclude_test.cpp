#include "services/data_manipulation/conclude_test.hpp"

#include <algorithm>

#include "sealwatch/message/provenance.hpp"
#include "sealwatch/signal/features.hpp"
#include "sealwatch/signal/test_record.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"
#include "services/data_manipulation/alignment_check.hpp"
#include "services/data_manipulation/refused_tests.hpp"
#include "services/data_manipulation/window.hpp"

namespace sealwatch {
namespace {

constexpr const char* kProducer = "data_manipulation 0.1.0";

bool has_begin(const std::vector<SampleBlock>& blocks) {
  return std::any_of(blocks.begin(), blocks.end(), [](const SampleBlock& block) {
    return block.boundary == BlockBoundary::begin || block.boundary == BlockBoundary::whole;
  });
}

void note(std::string& reasons, const std::string& reason) {
  if (!reason.empty()) text::add_to_list(reasons, reason, "; ");
}

TestWindow describe(const std::vector<SampleBlock>& blocks) {
  const SampleBlock& last = blocks.back();
  TestWindow window;
  window.asset_id = last.asset_id;
  window.header = concluded_from(last.header, "test_window", kProducer);
  for (const SampleBlock& block : blocks) {
    window.header.source_ids.push_back(block.header.message_id);
    window.aborted = window.aborted || block.aborted;
  }
  window.recording_id = last.recording_id;
  window.test_kind = last.test_kind;
  window.abort_reason = last.abort_reason;
  window.channel_status = last.channel_status;
  window.filter = "none";
  return window;
}

std::vector<Phase> to_message(const std::vector<signal::MotionPhase>& phases) {
  std::vector<Phase> result;
  result.reserve(phases.size());
  for (const signal::MotionPhase& phase : phases)
    result.push_back({static_cast<PhaseKind>(phase.kind), phase.begin_s, phase.end_s});
  return result;
}
static_assert(static_cast<int>(PhaseKind::rest) == static_cast<int>(signal::MotionKind::rest) &&
              static_cast<int>(PhaseKind::breakaway) == static_cast<int>(signal::MotionKind::breakaway) &&
              static_cast<int>(PhaseKind::out) == static_cast<int>(signal::MotionKind::out) &&
              static_cast<int>(PhaseKind::hold) == static_cast<int>(signal::MotionKind::hold) &&
              static_cast<int>(PhaseKind::back) == static_cast<int>(signal::MotionKind::back));

/// A partial stroke test that is much shorter than it should be and did not come to rest after its return was cut.
std::string cut_reason(const TestWindow& window, double duration_s, const AssetView& asset,
                       const DataManipulationOptions& options) {
  if (!asset.asset || window.test_kind != "pst" || window.phases.empty()) return {};
  const double expected_s = asset.asset->pst.expected_duration_s();
  const std::size_t count = window.phases.size();
  const bool returned = count >= 2 && window.phases[count - 1].kind == PhaseKind::hold &&
                        window.phases[count - 2].kind == PhaseKind::back;
  if (returned || duration_s >= options.complete_share * expected_s) return {};
  return text::format("cut after {:.1f} s of about {:.0f} s, in phase {}", duration_s, expected_s,
                      name_of(window.phases.back().kind));
}

/// A stroke test begins at rest. Without it neither the way that the piston went nor where it should come back to is
/// known.
bool begins_inside_the_stroke(const TestWindow& window) {
  const bool stroke_test = window.test_kind == "pst" || window.test_kind == "full_stroke";
  return stroke_test && !window.phases.empty() && window.phases.front().kind != PhaseKind::rest;
}

TestFeatures features_of(const TestWindow& window, double duration_s) {
  TestFeatures features;
  features.asset_id = window.asset_id;
  features.header = window.header;
  features.header.message_id = "test_features/" + window.header.pst_id;
  features.header.source_ids = {window.header.message_id};
  features.recording_id = window.recording_id;
  features.test_kind = window.test_kind;
  features.complete = window.complete;
  features.aborted = window.aborted;
  features.abort_reason = window.abort_reason;
  features.duration_s = duration_s;
  features.channel_status = window.channel_status;
  features.alignment = window.alignment;
  features.phases = window.phases;
  return features;
}

/// Fills the samples, and what was found while resampling and aligning.
void cut_window(const TimeSeries& recorded, const AssetView& asset, const DataManipulationOptions& options,
                TestWindow& window) {
  UniformWindow uniform = make_uniform(recorded, asset, {});
  Alignment alignment = check_alignment(uniform.samples, asset, options);
  if (!alignment.corrections.empty()) uniform = make_uniform(recorded, asset, alignment.corrections);
  window.alignment = std::move(alignment.remarks);
  window.sample_rate_Hz = uniform.sample_rate_Hz;
  window.jitter_std_s = uniform.jitter_std_s;
  window.missing_share = uniform.missing_share;
  window.samples = std::move(uniform.samples);
}

}  // namespace

TestConclusion conclude_test(const std::vector<SampleBlock>& blocks, const AssetView& asset,
                             const DataManipulationOptions& options) {
  TestWindow window = describe(blocks);
  TimeSeries recorded = assemble(blocks, window.channel_status);
  if (!has_begin(blocks)) note(window.abort_reason, "the begin of the test was not recorded");
  note(window.abort_reason, cut_at_gap(recorded, options.longest_gap_s));
  const std::size_t rows = recorded.time_s.size();
  if (rows < options.least_samples)
    note(window.abort_reason,
         rows == 0 ? "no sample was recorded"
                   : "only " + std::to_string(rows) + (rows == 1 ? " sample was" : " samples were") + " recorded");
  else if (const auto beyond = beyond_window(recorded))
    note(window.abort_reason, kRefused + *beyond);
  else
    cut_window(recorded, asset, options, window);

  const double duration_s = rows < 2 ? 0.0 : recorded.time_s.back() - recorded.time_s.front();
  std::vector<Quantity> quantities;
  if (window.samples.time_s.size() >= options.least_samples) {
    const signal::TestRecord test(window.samples, asset.cylinder(), asset.described());
    window.phases = to_message(test.phases());
    window.filter = test.filter_description();
    if (has_begin(blocks) && begins_inside_the_stroke(window))
      note(window.abort_reason, "the recording begins inside the stroke");
    note(window.abort_reason, cut_reason(window, duration_s, asset, options));
    for (signal::Feature& feature : signal::compute_features(test))
      quantities.push_back({feature.name, feature.unit, feature.value, true, feature.std_error});
  }
  window.complete = !window.aborted && window.abort_reason.empty();
  TestFeatures features = features_of(window, duration_s);
  features.features = std::move(quantities);
  return {std::move(window), std::move(features)};
}

}  // namespace sealwatch
