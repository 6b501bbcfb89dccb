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

void add_source(Header& header, const Header& source) {
  const auto add = [&header](const std::string& id) {
    auto& ids = header.source_ids;
    if (!id.empty() && std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  add(source.message_id);
  for (const std::string& id : source.source_ids) add(id);
}

bool is_first_after_replacement(const Header& header) {
  return std::ranges::any_of(header.source_ids, is_replacement_id);
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

void take_grade(std::optional<double> grade, HealthReport& report) {
  report.health_grade_known = grade.has_value();
  report.health_grade = grade.value_or(0.0);
}

void add_trend(const std::vector<GradeAt>& grades, HealthReport& report) {
  const auto trend = trend_of(grades);
  report.trend_known = trend.has_value();
  report.health_trend_per_year = trend ? trend->slope_per_year : 0.0;
  report.health_trend_std_per_year = trend ? trend->std_per_year : 0.0;
}

}  // namespace

Status HealthAssessmentOptions::validate() const {
  if (trend_tests >= 6) return {};
  return fail(Error{{}, "trend_tests", std::to_string(trend_tests), "must be at least 6", "a trend needs half a year"});
}

HealthAssessment::HealthAssessment(std::span<const AssetConfig> assets, const HealthAssessmentOptions& options,
                                   std::shared_ptr<const Explainer> explainer)
    : options_(options), explainer_(std::move(explainer)) {
  for (const AssetConfig& asset : assets) assets_.emplace(asset.asset_id, asset);
}

std::span<const Topic> HealthAssessment::inputs() const {
  static constexpr std::array kInputs = {Topic::state_report, Topic::test_features, Topic::test_window};
  return std::span(kInputs).first(explainer_ ? 3 : 2);
}

std::span<const Topic> HealthAssessment::outputs() const {
  static constexpr std::array kOutputs = {Topic::health_report, Topic::model_discrepancy};
  return std::span(kOutputs).first(explainer_ ? 2 : 1);
}

HealthAssessment::AssetState& HealthAssessment::state_of(const std::string& asset_id) {
  const auto trend_tests = static_cast<std::size_t>(options_.trend_tests);
  return states_.try_emplace(asset_id, AssetState{{}, {}, {}, PastHealth(trend_tests), {}}).first->second;
}

void HealthAssessment::restore(const Message& own_output) {
  AssetState& state = state_of(asset_of(own_output));
  if (const auto* found = std::get_if<ModelDiscrepancy>(&own_output)) state.discrepancies.restore(*found);
  const auto* report = std::get_if<HealthReport>(&own_output);
  if (!report) return;
  if (const auto retraction = retraction_answered_by(*report)) {
    state.past.apply(*retraction);
    Conclusion released;  // what it frees is consumed already
    forget_uncounted(state, released);
    return;
  }
  Conclusion released;  // what it frees is consumed already
  meet(state, report->header.pst_id, released);
  state.past.add(*report);
  state.discrepancies.restore(*report, is_first_after_replacement(report->header));
}

void HealthAssessment::forget_uncounted(AssetState& state, Conclusion& conclusion) {
  state.discrepancies.forget([&](const std::string& pst_id) { return !state.past.counts(pst_id); }, conclusion);
}

void HealthAssessment::meet(AssetState& state, const std::string& pst_id, Conclusion& conclusion) {
  if (state.past.meet(pst_id)) forget_uncounted(state, conclusion);
}

std::size_t HealthAssessment::held() const {
  std::size_t held = 0;
  for (const auto& [asset_id, state] : states_)
    held += state.discrepancies.held() + state.reports.overtaken() + state.features.overtaken();
  return held;
}

Conclusion HealthAssessment::receive(const Message& input) {
  Conclusion conclusion;
  AssetState& state = state_of(asset_of(input));
  if (const auto* features = std::get_if<TestFeatures>(&input)) state.features.add(*features, conclusion);
  if (const auto* report = std::get_if<StateReport>(&input)) take_report(state, *report, conclusion);
  if (const auto* window = std::get_if<TestWindow>(&input)) {
    const auto asset = assets_.find(window->asset_id);
    if (!explainer_ || asset == assets_.end())
      conclusion.consumed.push_back(window->header.message_id);
    else
      state.discrepancies.take(*window, asset->second, *explainer_, conclusion);
  }
  if (const std::string& pst_id = header_of(input).pst_id; state.reports.has(pst_id) && state.features.has(pst_id))
    state.complete = pst_id;
  while (const std::optional<std::string> next = next_report(state)) {
    if (!state.reports.is_here(*next, conclusion)) return conclusion;
    const bool is_test = *next == state.complete;
    if (is_test && !state.features.is_here(*next, conclusion)) return conclusion;
    const StateReport report = state.reports.take(*next, conclusion);
    if (!is_test) {
      retract(state, report, conclusion);
      continue;
    }
    state.complete.clear();
    const TestFeatures features = state.features.take(report.header.pst_id, conclusion);
    meet(state, report.header.pst_id, conclusion);
    const HealthReport health = conclude(state, report, features);
    conclusion.outputs.emplace_back(health);
    conclusion.consumed.push_back(features.header.message_id);
    settle(state, report, health.admissible_for_prognosis, conclusion);
  }
  return conclusion;
}

/// An answer to a retraction speaks of the tests before it, which may wait for their features.
std::optional<std::string> HealthAssessment::next_report(const AssetState& state) {
  auto answer = state.reports.first_of_no_test(state.complete);
  if (answer && (!state.complete.empty() || state.reports.is_next(*answer))) return answer;
  return state.complete.empty() ? std::nullopt : std::optional(state.complete);
}

/// One whose health is concluded already comes again after a restart because its test was kept.
void HealthAssessment::take_report(AssetState& state, const StateReport& report, Conclusion& conclusion) const {
  const std::optional<bool> admissible = state.discrepancies.concluded(report.header.pst_id);
  const bool is_answer = retraction_answered_by(report).has_value();
  if (!is_answer && report.header.pst_id.empty())
    conclusion.consumed.push_back(report.header.message_id);
  else if (!is_answer && admissible && explainer_)
    settle(state, report, *admissible, conclusion);
  else
    state.reports.add(report, conclusion);
}

void HealthAssessment::settle(AssetState& state, const StateReport& report, bool admissible,
                              Conclusion& conclusion) const {
  const auto asset = assets_.find(report.asset_id);
  const bool counts = state.past.counts(report.header.pst_id);
  if (explainer_ && asset != assets_.end())
    state.discrepancies.take(report, admissible && counts, is_first_after_replacement(report.header), asset->second,
                             *explainer_, conclusion);
  else
    conclusion.consumed.push_back(report.header.message_id);
}

HealthReport HealthAssessment::conclude(AssetState& state, const StateReport& state_report,
                                        const TestFeatures& features) const {
  HealthReport report = begin_report(state_report, features);
  const auto asset = assets_.find(state_report.asset_id);
  const AssetConfig unknown;
  report.inadmissible_reasons =
      inadmissible_reasons(asset == assets_.end() ? unknown : asset->second, state_report, features);
  const bool is_first = is_first_after_replacement(report.header);
  const std::optional<HealthReport> last = is_first ? std::nullopt : state.past.last();
  report.admissible_for_prognosis = report.inadmissible_reasons.empty();
  if (state_report.judgements.empty() || is_poor_recording(state_report) || asset == assets_.end()) {
    carry_over(last, report);
    if (state_report.verdict == PstVerdict::failed) take_grade(0.0, report);
  } else {
    const std::vector<Deviation> deviations = deviations_of(state_report);
    const bool graded = last && last->health_grade_known;
    const std::optional<double> last_grade = graded ? std::optional(last->health_grade) : std::nullopt;
    take_grade(health_grade(asset->second, state_report, deviations, last_grade), report);
    const bool failed = state_report.verdict == PstVerdict::failed && !state_report.verdict_reasons.empty();
    const SensorRemarks remarks = sensor_remarks(state_report, features);
    const std::vector<Signature> signatures =
        fault_signatures(asset->second, deviations, recorded_channels(features), suspects_of(remarks), failed);
    AmbiguityGroup group = find_ambiguity_group(deviations, signatures, remarks,
                                                failed ? state_report.verdict_reasons.front() : std::string());
    report.no_fault_likelihood = group.no_fault_likelihood;
    report.ambiguity_group = std::move(group.faults);
    for (ProposedFault& fault : report.ambiguity_group)
      if (!state_report.accepted_discrepancy.empty())
        fault.evidence.push_back("what " + state_report.accepted_discrepancy +
                                 " found may be the cause as well: these are measured quantities, which an accepted "
                                 "model explains but does not change");
  }
  state.past.add(report);
  add_trend(state.past.grades(), report);
  return report;
}

void HealthAssessment::retract(AssetState& state, const StateReport& answer, Conclusion& conclusion) {
  const auto retraction = retraction_answered_by(answer);
  conclusion.consumed.push_back(answer.header.message_id);
  state.past.apply(*retraction);
  forget_uncounted(state, conclusion);
  const std::optional<HealthReport> last = state.past.last();
  HealthReport report = last.value_or(HealthReport{});
  report.asset_id = answer.asset_id;
  report.header = answer.header;
  report.header.message_id = "health_report/" + retraction->id;
  report.header.producer = kProducer;
  name_tests(retraction->tests, report);
  report.header.source_ids = {retraction->id, answer.header.message_id};
  if (last) report.header.source_ids.push_back(last->header.message_id);
  add_trend(state.past.grades(), report);
  conclusion.outputs.emplace_back(std::move(report));
}

}  // namespace sealwatch
