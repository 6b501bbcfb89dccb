#include "services/cli/message_words.hpp"

#include <algorithm>

#include "sealwatch/message/outside.hpp"
#include "sealwatch/message/worn_words.hpp"
#include "services/cli/summary.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// Below this a fault is proposed only because some fault must come first.
constexpr double kWorthNaming = 0.10;
constexpr std::string_view kSensor = "sensor:";  ///< which one is worth knowing

}  // namespace

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

std::string fault_words(const std::vector<ProposedFault>& group) {
  const ProposedFault& first = group.front();
  if (first.likelihood < kWorthNaming) return "no fault stands out";
  std::string text = first.likelihood > 0.5 ? "most likely " : "possibly ";
  text += text::in_words(name_of(first.kind));
  if (first.element.starts_with(kSensor)) text.append(" ").append(text::in_words(first.element.substr(kSensor.size())));
  return text.append(" (").append(text::in_percent(first.likelihood)).append(")");
}

std::string acceptance_words(const ModelAcceptance& m) {
  std::string text = m.discrepancy_id;
  return text.append(m.revoked ? " revoked by " : " accepted by ").append(m.accepted_by).append(" ").append(m.remark);
}

namespace {

std::string event_date(const Header& header) {
  return header.event_time_known ? date(header.event_time_ns) : "(no date) ";
}

std::string samples_words(std::size_t count) { return count == 0 ? "no samples" : count_of(count, "sample"); }

std::string forecast_words(const Forecast& forecast) {
  if (forecast.state != ForecastState::ok) return text::in_words(name_of(forecast.state));
  return number(forecast.rul_months, 3) + " months, 95 % within " + number(forecast.interval_95_low_months, 3) +
         " to " + number(forecast.interval_95_high_months, 3);
}

std::string content(const RawSamples& m) {
  return m.source_id + " block " + std::to_string(m.block_number) + " (" + std::string(name_of(m.boundary)) + "), " +
         samples_words(m.samples.time_s.size()) + " of " + count_of(m.samples.channels.size(), "channel");
}
std::string content(const SampleBlock& m) {
  return "block " + std::to_string(m.block_number) + " (" + std::string(name_of(m.boundary)) + "), " +
         samples_words(m.samples.time_s.size());
}
std::string content(const TestWindow& m) {
  if (m.samples.time_s.empty()) return "no samples" + (m.abort_reason.empty() ? "" : ": " + m.abort_reason);
  return samples_words(m.samples.time_s.size()) + " at " + number(m.sample_rate_Hz, 3) + " Hz, " +
         count_of(m.samples.channels.size(), "channel") + (m.complete ? "" : ", incomplete");
}
std::string content(const TestFeatures& m) {
  std::string text;
  for (const Quantity& feature : m.features)
    text::add_to_list(text, text::in_words(feature.name) + " " + text::readable(feature.value, feature.unit));
  return text;
}
std::string content(const StateReport& m) {
  std::string text = "PST " + text::in_words(name_of(m.verdict));
  if (m.header.pst_id.empty()) text = m.pst_overdue ? "test overdue" : "judged anew";
  if (!m.verdict_reasons.empty()) text += " (" + text::separated(m.verdict_reasons) + ")";
  text += ", region " + std::string(name_of(m.region));
  if (m.pst_overdue) text += ", " + number(m.overdue_days, 2) + " days overdue";
  return text;
}
std::string content(const HealthReport& m) {
  std::string text = m.health_grade_known ? "grade " + number(m.health_grade, 2) : "no grade yet";
  if (m.trend_known) text += " (" + number(m.health_trend_per_year, 2) + " a year)";
  if (!m.ambiguity_group.empty()) text += ", " + fault_words(m.ambiguity_group);
  if (!m.admissible_for_prognosis) text += ", not for prognosis: " + text::separated(m.inadmissible_reasons);
  return text;
}
std::string content(const LeakageEstimate& m) {
  if (!m.estimated) return "no estimate: " + text::separated(m.reasons);
  std::string text =
      worn_parameter(m) + " " + text::readable_with_error(m.resistance_Pa_s_m3, m.resistance_std_Pa_s_m3, worn_unit(m));
  if (m.condition_known) text += ", " + worn_condition(m) + " " + percent(m.condition);
  if (!m.used_for_forecast) text += ", left out: " + text::separated(m.reasons);
  return text;
}
std::string content(const RemainingLife& m) {
  if (m.forecasts.empty()) return "no forecast";
  return "remaining life " + forecast_words(m.forecasts.front()) + (m.windows_disagree ? ", windows disagree" : "");
}
std::string content(const PstRequest& m) { return "test due " + date(m.due_time_ns) + ": " + m.reason; }
std::string content(const Advisory& m) {
  std::string text = upper(name_of(m.priority)) + " " + text::in_words(name_of(m.action));
  if (m.latest_by_known) text += ", latest by " + date(m.latest_by_ns);
  if (m.state != AdvisoryState::active) text += " [" + std::string(name_of(m.state)) + "]";
  return text + ": " + m.recommendation;
}
std::string content(const Acknowledgement& m) { return m.advisory_id + " by " + m.acknowledged_by + " " + m.remark; }
std::string content(const MaintenanceEvent& m) {
  return text::in_words(m.kind) + " by " + m.reported_by + " " + m.remark;
}
std::string content(const ModelDiscrepancy& m) {
  std::string text = "version " + std::to_string(m.version) + ", ";
  if (!m.analysed) return text.append("not analysed: ").append(m.failure);
  text.append(name_of(m.verdict)).append(": ").append(m.summary);
  return text;
}
std::string content(const ModelAcceptance& m) { return acceptance_words(m); }
std::string content(const ActRecord& m) {
  std::string text = "kept by " + m.header.producer + ": ";
  if (!m.events.empty()) text += content(m.events.front());
  if (!m.acceptances.empty()) text += content(m.acceptances.front());
  if (!m.acknowledgements.empty()) text += content(m.acknowledgements.front());
  return text;
}

std::string samples_words(const Header& header) {
  return is_expired(header.producer) ? " [its samples are kept no more]" : "";
}

/// Nothing where the sender's clock is kept, or nobody knows, or the recording gave the time: its replay's clock is none.
std::string clock_words(const Header& header) {
  const bool is_kept =
      header.clock_quality == ClockQuality::synchronised || header.clock_quality == ClockQuality::unknown;
  return is_kept || header.replay ? "" : " [clock of its sender: " + std::string(name_of(header.clock_quality)) + "]";
}

}  // namespace

std::string one_line(const Message& message) {
  return event_date(header_of(message)) + "  " + asset_of(message) + "  " + std::string(name_of(topic_of(message))) +
         "  " + std::visit([](const auto& m) { return content(m); }, message) + samples_words(header_of(message)) +
         clock_words(header_of(message));
}

std::string one_line(const ServiceStatus& status) {
  std::uint64_t written = 0;
  for (const StreamPosition& stream : status.written) written += stream.sequence;
  return status.service + "  " + status.state + "  pid " + std::to_string(status.process_id) + "  " +
         count_of(written, "message") + " written, " + count_of(status.pending_inputs, "input") + " waiting" +
         (status.last_error.empty() ? "" : "  last error: " + status.last_error);
}

}  // namespace sealwatch::cli
