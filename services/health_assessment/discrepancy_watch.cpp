#include "services/health_assessment/discrepancy_watch.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sealwatch/config/judged_quantities.hpp"
#include "sealwatch/message/provenance.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"
#include "services/health_assessment/deviations.hpp"

namespace sealwatch {
namespace {

constexpr const char* kProducer = "health_assessment 0.1.0";

/// Whose windows are waited for: what is further behind will not come.
constexpr std::size_t kMostDeviating = 256;
constexpr std::size_t kMostSettled = 4096;

using Work = std::function<Conclusion(const std::stop_token&)>;

/// Both, one after the other, as one piece of work.
void add_later(Conclusion& conclusion, Work work) {
  if (!conclusion.later) {
    conclusion.later = std::move(work);
    return;
  }
  conclusion.later = [first = std::move(conclusion.later), second = std::move(work)](const std::stop_token& stop) {
    Conclusion both = completed(first(stop), stop);
    Conclusion rest = completed(second(stop), stop);
    std::ranges::move(rest.outputs, std::back_inserter(both.outputs));
    std::ranges::move(rest.consumed, std::back_inserter(both.consumed));
    return both;
  };
}

std::string residual_words(const RegionJudgement& judgement) {
  return text::format("difference from the simulation in {} is {}, in region {} against {}",
                      text::in_words(std::string_view(judgement.quantity).substr(kResidualQuantity.size())),
                      text::with_unit(judgement.value, judgement.unit), name_of(judgement.raw_region),
                      text::in_words(name_of(judgement.reference)));
}

/// The test as the analysis takes it: channels that the test's own status calls OK.
Recording recording_of(const TestWindow& window) {
  Recording recording;
  recording.file = recording.recording_id = window.header.pst_id;
  recording.asset_id = window.asset_id;
  recording.content_hash = window.header.pst_id;
  if (window.header.event_time_known) recording.start_time = UtcTime{window.header.event_time_ns};
  recording.samples = window.samples;
  for (const ChannelStatus& status : window.channel_status)
    if (status.state != ChannelState::OK)
      std::erase_if(recording.samples.channels, [&](const Series& series) { return series.name == status.channel; });
  return recording;
}

}  // namespace

std::vector<std::string> persistent_residuals(const StateReport& report) {
  const bool accepted = std::ranges::any_of(
      report.judgements, [](const RegionJudgement& j) { return j.reference == Reference::accepted_model; });
  std::vector<std::string> found;
  for (const RegionJudgement& judgement : report.judgements)
    if (judgement.quantity.starts_with(kResidualQuantity) && judgement.raw_region >= AlertRegion::warning &&
        (!accepted || judgement.reference == Reference::accepted_model))
      found.push_back(residual_words(judgement));
  return found;
}

void DiscrepancyWatch::restore(const HealthReport& own_output, bool first_after_replacement) {
  note_concluded(own_output.header.pst_id, own_output.admissible_for_prognosis, first_after_replacement);
}

void DiscrepancyWatch::restore(const ModelDiscrepancy& own_output) {
  // It may have been stored after the replacement that ended its era.
  const auto test = own_output.fit_tests.empty() ? concluded_.end() : concluded_.find(own_output.fit_tests.front());
  if (test == concluded_.end()) return;
  Era& era = eras_[test->second.era];
  era.version = own_output.version;
  era.analysed = {own_output.fit_tests.begin(), own_output.fit_tests.end()};
  era.analysed.insert(own_output.holdout_tests.begin(), own_output.holdout_tests.end());
}

/// With another actuator versions count anew.
void DiscrepancyWatch::note_concluded(const std::string& pst_id, bool admissible, bool first_after_replacement) {
  if (concluded_.contains(pst_id)) return;
  if (first_after_replacement) eras_.emplace_back();
  concluded_[pst_id] = {.admissible = admissible, .era = eras_.size() - 1};
}

std::optional<bool> DiscrepancyWatch::concluded(const std::string& pst_id) const {
  const auto found = concluded_.find(pst_id);
  if (found == concluded_.end()) return std::nullopt;
  return found->second.admissible;
}

void DiscrepancyWatch::take(const TestWindow& window, const AssetConfig& asset, const Explainer& explainer,
                            Conclusion& conclusion) {
  const std::string& pst_id = window.header.pst_id;
  if (std::erase(settled_, pst_id) > 0) {
    no_longer_needed_.push_back(window.header.message_id);
  } else {
    windows_.add(window, conclusion);
    keep_complete_test(pst_id, asset, explainer, conclusion);
  }
  release(conclusion);
}

void DiscrepancyWatch::take(const StateReport& report, bool admissible, bool first_after_replacement,
                            const AssetConfig& asset, const Explainer& explainer, Conclusion& conclusion) {
  if (!concluded_.contains(report.header.pst_id)) forget_windows_of_settled_tests();
  note_concluded(report.header.pst_id, admissible, first_after_replacement);
  if (first_after_replacement) end_row(conclusion);
  if (!admissible) {
    settle(report, conclusion);
  } else if (persistent_residuals(report).empty()) {
    end_row(conclusion);
    settle(report, conclusion);
  } else {
    deviating_.push_back(report);
    keep_complete_test(report.header.pst_id, asset, explainer, conclusion);
    if (deviating_.size() > kMostDeviating) {
      settle(deviating_.front(), conclusion);
      deviating_.pop_front();
    }
  }
  release(conclusion);
}

void DiscrepancyWatch::forget(const std::function<bool(const std::string& pst_id)>& is_retracted,
                              Conclusion& conclusion) {
  for (Era& era : eras_)
    if (std::ranges::any_of(era.analysed, is_retracted)) era.analysed.clear();
  for (const StoredTest& test : row_) {
    if (!is_retracted(test.report.header.pst_id)) continue;
    no_longer_needed_.push_back(test.report.header.message_id);
    no_longer_needed_.push_back(test.window->header.message_id);
  }
  std::erase_if(row_, [&](const StoredTest& test) { return is_retracted(test.report.header.pst_id); });
  for (const StateReport& report : deviating_)
    if (is_retracted(report.header.pst_id)) settle(report, conclusion);
  std::erase_if(deviating_, [&](const StateReport& report) { return is_retracted(report.header.pst_id); });
  release(conclusion);
}

void DiscrepancyWatch::end_row(Conclusion& conclusion) {
  for (const StoredTest& test : row_) {
    no_longer_needed_.push_back(test.report.header.message_id);
    no_longer_needed_.push_back(test.window->header.message_id);
  }
  row_.clear();
  for (const StateReport& report : std::exchange(deviating_, {})) settle(report, conclusion);
}

void DiscrepancyWatch::settle(const StateReport& report, Conclusion& conclusion) {
  no_longer_needed_.push_back(report.header.message_id);
  const std::string& pst_id = report.header.pst_id;
  if (windows_.has(pst_id)) {
    no_longer_needed_.push_back(windows_.drop(pst_id, conclusion));
    return;
  }
  settled_.push_back(pst_id);
  if (settled_.size() > kMostSettled) settled_.pop_front();
}

bool DiscrepancyWatch::seems_settled(const std::string& pst_id) const {
  return concluded_.contains(pst_id) &&
         std::ranges::none_of(deviating_, [&](const StateReport& report) { return report.header.pst_id == pst_id; });
}

std::size_t DiscrepancyWatch::held() const {
  return 2 * row_.size() + windows_.overtaken_or([this](const std::string& pst_id) { return seems_settled(pst_id); });
}

/// Windows that came, after this process was started again, of tests that had been settled before. Kept tests have all
/// come back by the first new report.
void DiscrepancyWatch::forget_windows_of_settled_tests() {
  std::ranges::move(windows_.drop_if([this](const std::string& pst_id) { return seems_settled(pst_id); }),
                    std::back_inserter(no_longer_needed_));
}

/// A test that deviates and whose window is there joins the row; those before it, whose windows did not come, do not.
void DiscrepancyWatch::keep_complete_test(const std::string& pst_id, const AssetConfig& asset,
                                          const Explainer& explainer, Conclusion& conclusion) {
  const auto its = std::ranges::find(deviating_, pst_id, [](const StateReport& one) { return one.header.pst_id; });
  if (its == deviating_.end() || !windows_.has(pst_id) || !windows_.is_here(pst_id, conclusion)) return;
  row_.push_back({std::move(*its), std::make_shared<const TestWindow>(windows_.take(pst_id, conclusion))});
  const auto overtaken = std::vector<StateReport>(deviating_.begin(), its);
  deviating_.erase(deviating_.begin(), its + 1);
  for (const StateReport& report : overtaken) settle(report, conclusion);
  if (row_.size() > kTestsOfAnalysis) {
    no_longer_needed_.push_back(row_.front().report.header.message_id);
    no_longer_needed_.push_back(row_.front().window->header.message_id);
    row_.pop_front();
  }
  if (!due()) return;
  add_later(conclusion, analysis(asset, explainer));
  analysis_begun_ = true;
}

bool DiscrepancyWatch::due() {
  const std::set<std::string>& analysed = era_of_row().analysed;
  const auto is_new = [&](const StoredTest& test) { return !analysed.contains(test.report.header.pst_id); };
  const auto unseen = static_cast<std::size_t>(std::ranges::count_if(row_, is_new));
  if (row_.size() == kTestsOfFirstAnalysis) return unseen == kTestsOfFirstAnalysis;
  if (row_.size() < kTestsOfAnalysis) return false;
  return unseen == kTestsOfAnalysis || (analysed.size() < kTestsOfAnalysis && unseen >= kTestsOfFirstAnalysis);
}

std::function<Conclusion(const std::stop_token&)> DiscrepancyWatch::analysis(const AssetConfig& asset,
                                                                             const Explainer& explainer) {
  Era& era = era_of_row();
  era.analysed.clear();
  std::vector<Window> windows;
  ModelDiscrepancy known;
  known.version = ++era.version;
  known.asset_id = asset.asset_id;
  known.reasons = persistent_residuals(row_.back().report);
  known.header = concluded_from(row_.back().report.header, "model_discrepancy", kProducer);
  const std::size_t fitted = row_.size() - row_.size() / 3;
  for (const StoredTest& test : row_) {
    (windows.size() < fitted ? known.fit_tests : known.holdout_tests).push_back(test.report.header.pst_id);
    known.header.source_ids.push_back(test.report.header.message_id);
    known.header.source_ids.push_back(test.window->header.message_id);
    era.analysed.insert(test.report.header.pst_id);
    windows.push_back(test.window);
  }
  return
      [windows = std::move(windows), known = std::move(known), asset, fitted, &explainer](const std::stop_token& stop) {
        std::vector<Recording> recordings;
        for (const Window& window : windows) recordings.push_back(recording_of(*window));
        const std::span<const Recording> all(recordings);
        ModelDiscrepancy found = explainer.explain(asset, all.first(fitted), all.subspan(fitted), stop);
        found.asset_id = known.asset_id;
        found.header = known.header;
        found.version = known.version;
        found.reasons = known.reasons;
        found.fit_tests = known.fit_tests;
        found.holdout_tests = known.holdout_tests;
        Conclusion conclusion;
        conclusion.outputs.emplace_back(std::move(found));
        return conclusion;
      };
}

/// Behind the analyses that are still running, so that they can be made again until they are stored.
void DiscrepancyWatch::release(Conclusion& conclusion) {
  std::vector<std::string> ids = std::exchange(no_longer_needed_, {});
  if (ids.empty()) return;
  if (!analysis_begun_) {
    std::ranges::move(ids, std::back_inserter(conclusion.consumed));
    return;
  }
  add_later(conclusion,
            [ids = std::move(ids)](const std::stop_token&) { return Conclusion{.outputs = {}, .consumed = ids}; });
}

}  // namespace sealwatch
