#include "services/health_assessment/health_assessment.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "services/health_assessment/admissibility.hpp"
#include "services/health_assessment/ambiguity.hpp"
#include "services/health_assessment/grade.hpp"
#include "services/health_assessment/sensor_remarks.hpp"

namespace sealwatch {
namespace {

constexpr const char* kProducer = "health_assessment 0.1.0";
constexpr std::string_view kEventPrefix = "maintenance_event/";

void add_source(Header& header, const Header& source) {
  const auto add = [&header](const std::string& id) {
    auto& ids = header.source_ids;
    if (!id.empty() && std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  add(source.message_id);
  for (const std::string& id : source.source_ids) add(id);
}

bool is_first_after_replacement(const Header& header) {
  return std::any_of(header.source_ids.begin(), header.source_ids.end(),
                     [](const std::string& id) { return id.starts_with(kEventPrefix); });
}

HealthReport begin_report(const StateReport& state_report, const TestFeatures& features) {
  HealthReport report;
  report.asset_id = state_report.asset_id;
  report.header = state_report.header;
  report.header.message_id = "health_report/" + state_report.header.pst_id;
  report.header.producer = kProducer;
  report.header.source_ids.clear();
  add_source(report.header, state_report.header);
  add_source(report.header, features.header);
  return report;
}

/// Grade, trend and proposals of the last test that had any.
void carry_over(const std::optional<HealthReport>& last, HealthReport& report) {
  if (!last) return;
  report.health_grade = last->health_grade;
  report.no_fault_likelihood = last->no_fault_likelihood;
  report.ambiguity_group = last->ambiguity_group;
  for (ProposedFault& fault : report.ambiguity_group)
    fault.evidence = {"carried over from " + last->header.message_id + ": this test does not tell"};
}

}  // namespace

Status HealthAssessmentOptions::validate() const {
  if (trend_tests >= 6) return {};
  return fail(Error{{}, "trend_tests", std::to_string(trend_tests), "must be at least 6", "a trend needs half a year"});
}

HealthAssessment::HealthAssessment(std::span<const AssetConfig> assets, const HealthAssessmentOptions& options)
    : options_(options) {
  for (const AssetConfig& asset : assets) assets_.emplace(asset.asset_id, asset);
}

std::span<const Topic> HealthAssessment::inputs() const {
  static constexpr std::array kInputs = {Topic::state_report, Topic::test_features};
  return kInputs;
}

std::span<const Topic> HealthAssessment::outputs() const {
  static constexpr std::array kOutputs = {Topic::health_report};
  return kOutputs;
}

void HealthAssessment::restore(const Message& own_output) {
  if (const auto* report = std::get_if<HealthReport>(&own_output)) learn(states_[report->asset_id], *report);
}

Conclusion HealthAssessment::receive(const Message& input) {
  Conclusion conclusion;
  AssetState& state = states_[asset_of(input)];
  if (const auto* features = std::get_if<TestFeatures>(&input))
    state.features.emplace(features->header.pst_id, *features);
  if (const auto* report = std::get_if<StateReport>(&input)) {
    if (report->header.pst_id.empty())
      conclusion.consumed.push_back(report->header.message_id);
    else
      state.reports.push_back(*report);
  }
  while (!state.reports.empty()) {
    const StateReport& report = state.reports.front();
    const auto features = state.features.find(report.header.pst_id);
    if (features == state.features.end()) break;
    conclusion.outputs.emplace_back(conclude(state, report, features->second));
    conclusion.consumed.push_back(report.header.message_id);
    conclusion.consumed.push_back(features->second.header.message_id);
    state.features.erase(features);
    state.reports.pop_front();
  }
  return conclusion;
}

HealthReport HealthAssessment::conclude(AssetState& state, const StateReport& state_report,
                                        const TestFeatures& features) const {
  HealthReport report = begin_report(state_report, features);
  if (is_first_after_replacement(report.header)) state.last.reset();
  report.inadmissible_reasons = inadmissible_reasons(state_report, features);
  report.admissible_for_prognosis = report.inadmissible_reasons.empty();
  const auto asset = assets_.find(state_report.asset_id);
  if (state_report.judgements.empty() || is_poor_recording(state_report) || asset == assets_.end()) {
    carry_over(state.last, report);
    if (state_report.verdict == PstVerdict::failed) report.health_grade = 0.0;
  } else {
    const std::vector<Deviation> deviations = deviations_of(state_report);
    const double last_grade = state.last ? state.last->health_grade : 1.0;
    report.health_grade = health_grade(asset->second, state_report, deviations, last_grade);
    const bool failed = state_report.verdict == PstVerdict::failed && !state_report.verdict_reasons.empty();
    const SensorRemarks remarks = sensor_remarks(state_report, features);
    const std::vector<Signature> signatures =
        fault_signatures(asset->second, deviations, recorded_channels(features), suspects_of(remarks), failed);
    AmbiguityGroup group = find_ambiguity_group(deviations, signatures, remarks,
                                                failed ? state_report.verdict_reasons.front() : std::string());
    report.no_fault_likelihood = group.no_fault_likelihood;
    report.ambiguity_group = std::move(group.faults);
  }
  learn(state, report);
  if (const auto trend = trend_of(state.grades)) {
    report.trend_known = true;
    report.health_trend_per_year = trend->slope_per_year;
    report.health_trend_std_per_year = trend->std_per_year;
  }
  return report;
}

void HealthAssessment::learn(AssetState& state, const HealthReport& report) const {
  if (is_first_after_replacement(report.header)) state.grades.clear();
  state.last = report;
  if (!report.admissible_for_prognosis || !report.header.event_time_known) return;
  state.grades.push_back({UtcTime{report.header.event_time_ns}, report.health_grade});
  if (state.grades.size() > static_cast<std::size_t>(options_.trend_tests)) state.grades.erase(state.grades.begin());
}

}  // namespace sealwatch
