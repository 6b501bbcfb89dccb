#include "services/verification/trial/mismatch_trial.hpp"

#include <chrono>
#include <cmath>
#include <exception>

#include "sealwatch/mismatch/explain.hpp"
#include "services/verification/trial/mismatch_controls.hpp"

namespace sealwatch::verification {
namespace {

using bench::TrialPlan;

double rms_of(const mismatch::PooledFit& fit, double mismatch::ChannelComparison::*rms) {
  double squares = 0.0;
  for (const mismatch::ChannelComparison& channel : fit.channels) squares += std::pow(channel.*rms, 2);
  return fit.channels.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(fit.channels.size()));
}

std::string place_of(const mismatch::LawAt& law) { return law.id + " " + law.element; }

LawRecord found_law(const mismatch::FoundEffect& effect) {
  LawRecord law{.id = effect.what.id, .element = effect.what.element, .form = effect.what.form};
  if (!effect.parameters.empty()) {
    law.strength = effect.parameters.front().name;
    law.value = effect.parameters.front().value;
    law.std_error = effect.parameters.front().std_error;
  }
  law.probability = effect.probability;
  law.delta_bic = effect.delta_bic;
  for (const mismatch::LawAt& other : effect.indistinguishable)
    if (place_of(other) != place_of(effect.what)) law.same.push_back(place_of(other));
  law.same_places = effect.same_elements;
  return law;
}

AnswerRecord answer_of(const mismatch::Explanation& explanation) {
  AnswerRecord answer{.verdict = std::string(name_of(explanation.verdict)),
                      .p_value = explanation.p_value,
                      .explained_share = explanation.explained_share};
  for (const mismatch::FoundEffect& effect : explanation.effects) answer.found.push_back(found_law(effect));
  for (const mismatch::Location& location : explanation.location) answer.places.push_back(location.element);
  answer.next_test = !explanation.next_test.empty();
  answer.held_before = rms_of(explanation.holdout, &mismatch::ChannelComparison::rms_before);
  answer.held_after = rms_of(explanation.holdout, &mismatch::ChannelComparison::rms_after);
  for (const mismatch::ChannelComparison& channel : explanation.holdout.channels)
    answer.held_out.push_back({channel.channel, channel.rms_before, channel.rms_after});
  for (const std::vector<mismatch::AssetValue>& entry : explanation.asset_values) {
    std::string& names = answer.asset_values.emplace_back();
    for (const mismatch::AssetValue& value : entry) names.append(names.empty() ? "" : " ").append(value.name);
  }
  for (const mismatch::Rejected& rejected : explanation.rejected) answer.rejected.push_back(place_of(rejected.what));
  return answer;
}

MismatchRecord record_of(const TrialPlan& plan) {
  MismatchRecord record{.stratum = std::string(name_of(plan.stratum)), .seed = plan.seed};
  record.label = plan.label();
  record.twin = plan.twin;
  record.wrong_value = plan.wrong_value.name;
  record.wrong_share = plan.wrong_value.share;
  record.jittered = plan.jitter > 0.0;
  for (const auto& [channel, noise] : plan.noise) {
    record.coloured = record.coloured || noise.correlation > 0.0;
    record.rounded = record.rounded || noise.quantum > 0.0;
  }
  for (const bench::TrialTruth& truth : plan.truths())
    record.hidden.push_back({.id = truth.id,
                             .element = truth.element,
                             .form = truth.form,
                             .size = truth.size,
                             .times_barely = truth.times_barely,
                             .strength = truth.strength,
                             .value = truth.strength_value});
  return record;
}

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void analyse(const TrialPlan& plan, const TrialOptions& options, MismatchRecord& record) {
  const auto recordings = bench::record_trial(plan);
  if (!recordings) {
    record.error = recordings.error().describe();
    return;
  }
  const AssetConfig asset = bench::trial_asset();
  const Stopwatch analysis;
  mismatch::ExplainOptions settings;
  settings.threads = options.threads;
  const auto explanation = mismatch::explain(asset, recordings->fit, recordings->holdout, settings);
  if (explanation) record.answer = answer_of(*explanation);
  if (!explanation) record.error = explanation.error().describe();
  record.answer.seconds = analysis.seconds();
  if (!options.controls) return;
  const Stopwatch controls;
  record.control = run_controls(asset, *recordings, plan, options.threads);
  record.control.seconds = controls.seconds();
}

}  // namespace

MismatchRecord run_trial(const TrialPlan& plan, const TrialOptions& options) {
  MismatchRecord record = record_of(plan);
  try {
    analyse(plan, options, record);
  } catch (const std::exception& problem) {  // the campaign goes on; the set counts as failed
    record.error = std::string("exception: ") + problem.what();
  }
  return record;
}

}  // namespace sealwatch::verification
