#include "services/cli/summary.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/retraction.hpp"
#include "sealwatch/message/worn_words.hpp"
#include "services/cli/forecast_text.hpp"
#include "services/cli/message_words.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// Keeps the word on the latest test: a test that is replayed late does not take its place, nor does one without a
/// date. What is concluded anew after a retraction does.
template <typename T>
void keep_latest(std::optional<T>& kept, const T& next) {
  const bool earlier = kept && kept->header.event_time_known &&
                       (!next.header.event_time_known || next.header.event_time_ns < kept->header.event_time_ns);
  if (!earlier || answers_retraction(next.header)) kept = next;
}

}  // namespace

void AssetView::take(const Message& message) {
  asset_id_ = asset_of(message);
  if (const auto* estimate = std::get_if<LeakageEstimate>(&message)) estimates_[estimate->header.pst_id] = *estimate;
  if (const auto* life = std::get_if<RemainingLife>(&message)) {
    keep_latest(life_, *life);
    if (life->replacement_known) replaced_ns_ = std::max(replaced_ns_.value_or(life->replaced_ns), life->replaced_ns);
  }
  if (const auto* health = std::get_if<HealthReport>(&message)) keep_latest(health_, *health);
  if (const auto* state = std::get_if<StateReport>(&message)) keep_latest(state_, *state);
  if (const auto* advisory = std::get_if<Advisory>(&message))
    if (advisory->state != AdvisoryState::superseded) advisory_ = *advisory;
  if (const auto* found = std::get_if<ModelDiscrepancy>(&message)) keep_latest(discrepancy_, *found);
  if (const auto* acceptance = std::get_if<ModelAcceptance>(&message)) keep_latest(acceptance_, *acceptance);
}

bool AssetView::is_of_now(const Header& header) const {
  return !replaced_ns_ || !header.event_time_known || header.event_time_ns >= *replaced_ns_;
}

std::vector<const LeakageEstimate*> AssetView::estimates_of_now() const {
  std::vector<const LeakageEstimate*> estimates;
  for (const auto& [id, estimate] : estimates_)
    if (is_of_now(estimate.header)) estimates.push_back(&estimate);
  return estimates;
}

std::string AssetView::seal_lines() const {
  std::string text;
  const LeakageEstimate* latest = nullptr;
  const bool life_has_time = life_ && life_->header.event_time_known;
  // The remaining life speaks of the last test that counts: a later estimate is of a test that was retracted.
  for (const LeakageEstimate* estimate : estimates_of_now())
    if (estimate->estimated && (!life_has_time || estimate->header.event_time_ns <= life_->header.event_time_ns) &&
        (latest == nullptr || estimate->header.event_time_ns >= latest->header.event_time_ns))
      latest = estimate;
  const bool of_seal = latest == nullptr || is_of_seal(*latest);
  if (life_ && life_->condition_known)
    text += (of_seal ? "  seal condition   " : "  condition        ") + percent(life_->condition) + " (index from " +
            (of_seal ? "the leakage" : worn_parameter(*latest)) + ": 100 % is new, fails at " +
            percent(life_->threshold, 0) + ")\n";
  if (latest != nullptr)
    text += (is_of_seal(*latest) ? "  leakage          " : "  wear             ") + worn_parameter(*latest) + " " +
            text::readable_with_error(latest->resistance_Pa_s_m3, latest->resistance_std_Pa_s_m3, worn_unit(*latest)) +
            " by sensor noise alone, from the " + latest->chosen_model + " model\n";
  if (health_ && is_of_now(health_->header)) {
    text += "  health           ";
    text += health_->health_grade_known ? "grade " + number(health_->health_grade, 2) + " (1 as new, 0 failed)"
                                        : "no grade: no test has measured the wear";
    if (health_->trend_known) text += ", " + number(health_->health_trend_per_year, 2) + " a year";
    if (!health_->ambiguity_group.empty()) text += "; " + fault_words(health_->ambiguity_group);
    text += "\n";
  }
  return text;
}

std::string AssetView::history_chart() const {
  std::vector<ChartPoint> points;
  std::int64_t first = 0;
  std::int64_t last = 0;
  double lowest = 1.0;
  double highest = 0.0;
  for (const LeakageEstimate* one : estimates_of_now()) {
    const LeakageEstimate& estimate = *one;
    if (!estimate.used_for_forecast || !estimate.condition_known || !estimate.header.event_time_known) continue;
    const std::int64_t time = estimate.header.event_time_ns;
    if (points.empty() || time < first) first = time;
    if (points.empty() || time > last) last = time;
    points.push_back({static_cast<double>(time), 100.0 * estimate.condition});
    lowest = std::min(lowest, estimate.condition);
    highest = std::max(highest, estimate.condition);
  }
  if (points.size() < 3 || !life_) return {};
  ChartOptions options;
  if (life_->threshold > 0.0) {  // a word without forecast does not say at which condition the seal fails
    options.threshold = 100.0 * life_->threshold;
    options.threshold_label = "fails";
    lowest = std::min(lowest, life_->threshold);
  }
  options.y_low = 5.0 * std::floor(20.0 * lowest) - 5.0;
  options.y_high = 5.0 * std::ceil(20.0 * highest);
  options.height = 1 + static_cast<int>(std::lround((options.y_high - options.y_low) / 2.5));
  options.x_low_label = date(first);
  options.x_high_label = date(last);
  const std::string of = is_of_seal(*estimates_of_now().back()) ? "seal condition" : "condition";
  return "\n  " + of + " in % over " + count_of(points.size(), "test") + "\n" + chart(points, options) + "\n";
}

std::string AssetView::forecast_lines() const {
  if (!life_ || life_->forecasts.empty()) return {};
  if (replaced_ns_ && life_->tests_since_replacement == 0)
    return "  remaining life   " + life_->forecasts.front().explanation + "\n";
  // The primary forecaster and the straight lines beside it; the others are in the message.
  std::vector<Forecast> shown = {life_->forecasts.front()};
  for (std::size_t k = 1; k < life_->forecasts.size(); ++k)
    if (life_->forecasts[k].method == "ols") shown.push_back(life_->forecasts[k]);
  std::string text = forecast_table(shown);
  return text + scored_line(*life_) + decision_chart(life_->decision);
}

namespace {

std::string in_one_line(const Advisory& advisory) {
  std::string text = upper(name_of(advisory.priority)) + ", " + text::in_words(name_of(advisory.action));
  if (advisory.latest_by_known) text += ", latest by " + date(advisory.latest_by_ns);
  if (advisory.state == AdvisoryState::acknowledged) text += ", acknowledged by " + advisory.acknowledged_by;
  return text;
}

}  // namespace

std::string AssetView::call() const {
  return advisory_ && advisory_->action != AdvisoryAction::none ? in_one_line(*advisory_) : "";
}

std::string AssetView::advisory_lines(bool services_run) const {
  if (!advisory_) return {};
  std::string text = "  advisory         " + in_one_line(*advisory_);
  text += "\n                   " + wrapped(advisory_->recommendation, 100, 19) + "\n";
  for (const std::string& reason : advisory_->reasons)
    text += "                   - " + wrapped(reason, 100, 21) + "\n";
  const bool seen = advisory_->state == AdvisoryState::acknowledged;
  if (!services_run || seen || advisory_->action == AdvisoryAction::none) return text;
  return text + "                   (sealwatch acknowledge " + shell_word(asset_id_) + " " +
         shell_word(advisory_->advisory_id) + " --by NAME)\n";
}

std::string AssetView::model_lines() const {
  std::string text;
  if (discrepancy_ && is_of_now(discrepancy_->header)) {
    const ModelDiscrepancy& found = *discrepancy_;
    text += "  model            ";
    text += wrapped(found.analysed ? found.summary : "residuals persist, not analysed: " + found.failure, 100, 19);
    const bool spoken_of = acceptance_ && acceptance_->discrepancy_id == found.header.message_id;
    const bool accepted =
        spoken_of ? !acceptance_->revoked : state_ && state_->accepted_discrepancy == found.header.message_id;
    text += "\n                   (version " + std::to_string(found.version);
    const bool can_be = found.analysed && found.verdict == DiscrepancyVerdict::mismatch && !found.physics.empty();
    if (can_be && !accepted)
      text += ": sealwatch accept --asset-id " + shell_word(asset_id_) + " --discrepancy " +
              shell_word(found.header.message_id) + " --by NAME";
    text += ")\n";
  }
  return text + acceptance_line();
}

std::string AssetView::acceptance_line() const {
  constexpr const char* kIndent = "                   ";
  const std::string in_force = state_ && is_of_now(state_->header) ? state_->accepted_discrepancy : "";
  const bool of_now = acceptance_ && (!discrepancy_ || is_of_now(discrepancy_->header)) &&
                      (acceptance_->revoked || !replaced_ns_ || acceptance_->discrepancy_time_ns >= *replaced_ns_);
  if (!of_now) return in_force.empty() ? "" : kIndent + in_force + " is accepted: tests are simulated with it\n";
  const bool simulated_with_it = in_force == acceptance_->discrepancy_id;
  std::string text = kIndent;
  if (!acceptance_->revoked) text += "version " + std::to_string(acceptance_->version) + ": ";
  text += acceptance_words(*acceptance_);
  if (text.ends_with(' ')) text.pop_back();
  if (acceptance_->revoked)
    return text + (simulated_with_it ? ": from the next test on its file's model again\n"
                                     : ": tests are simulated with its file's model\n");
  return text + (simulated_with_it ? ": tests are simulated with it\n" : ": takes effect from the next test on\n");
}

std::string AssetView::left_out_lines() const {
  std::string text;
  for (const LeakageEstimate* one : estimates_of_now()) {
    const LeakageEstimate& estimate = *one;
    const std::string& id = estimate.header.pst_id;
    if (estimate.used_for_forecast || estimate.reasons.empty()) continue;
    const std::size_t more = estimate.reasons.size() - 1;
    const std::string rest =
        more == 0 ? "" : " (and " + std::to_string(more) + " more: sealwatch watch leakage_estimate)";
    text += "                   " + id + ": " + wrapped(estimate.reasons.front() + rest, 100, 21) + "\n";
  }
  return text.empty() ? text : "  left out         of the forecast, kept in the record:\n" + text;
}

std::string AssetView::json() const {
  std::string text = "{\"schema\":\"sealwatch.asset/1\",\"asset_id\":\"" + asset_id_ + "\"";
  const auto add = [&text](const auto& last) {
    if (last) text += ",\"" + std::string(name_of(topic_of(Message(*last)))) + "\":" + to_json(Message(*last));
  };
  add(state_);
  add(health_);
  add(life_);
  add(advisory_);
  add(discrepancy_);
  add(acceptance_);
  return text + "}";
}

std::string AssetView::screen(bool services_run) const {
  std::string text = "== " + asset_id_;
  const std::size_t tests = estimates_of_now().size();
  const bool tested = life_ && life_->header.event_time_known && !(replaced_ns_ && life_->tests_since_replacement == 0);
  if (replaced_ns_) text += ", replaced on " + date(*replaced_ns_);
  if (tested) text += ", last test " + date(life_->header.event_time_ns);
  if (tests == 0 && replaced_ns_ && !tested) text += ", no test since";
  if (tests > 0 || !replaced_ns_) text += ", " + count_of(tests, "test") + " shown";
  const std::size_t used =
      life_ && !life_->forecasts.empty() ? static_cast<std::size_t>(life_->forecasts.front().tests_used) : 0;
  if (used > tests) text += ", " + std::to_string(used) + " usable in the forecast";
  text += "\n";
  return text + seal_lines() + history_chart() + forecast_lines() + advisory_lines(services_run) + model_lines() +
         left_out_lines();
}

}  // namespace sealwatch::cli
