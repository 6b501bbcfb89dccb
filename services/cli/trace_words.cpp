#include "services/cli/trace_words.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;
using trace::Alteration;
using trace::AlteredParameter;
using trace::ChannelComparison;

std::string parameter_text(const AlteredParameter& parameter) {
  const std::string name = parameter.name + " ";
  if (parameter.std_error > 0.0)
    return name +
           text::readable_with_error(parameter.value, parameter.std_error, parameter.unit == "1" ? "" : parameter.unit);
  return name + text::readable(parameter.value, parameter.unit);
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json alteration_json(const Alteration& alteration) {
  Json json = {{"id", alteration.id},
               {"element", alteration.where},
               {"parameters", Json::array()},
               {"removed_share", number_or_null(alteration.removed_share)},
               {"would_do", alteration.would_do}};
  for (const AlteredParameter& parameter : alteration.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", number_or_null(parameter.value)},
                                  {"std_error", number_or_null(parameter.std_error)},
                                  {"unit", parameter.unit}});
  return json;
}

Json channel_json(const ChannelComparison& channel) {
  Json json = {{"channel", channel.name},
               {"unit", channel.unit},
               {"input", channel.input},
               {"differs", channel.differs},
               {"stands_still", channel.stands_still},
               {"sign_reversed", channel.sign_reversed},
               {"p_value", number_or_null(channel.p_value)},
               {"rms", number_or_null(channel.rms)},
               {"noise_std", number_or_null(channel.noise_std)},
               {"effective_samples", number_or_null(channel.effective_samples)},
               {"nrmse_percent", number_or_null(channel.nrmse_percent)},
               {"by", channel.by},
               {"regimes", Json::array()},
               {"intervals", Json::array()},
               {"alterations", Json::array()}};
  for (const trace::RegimeMisfit& regime : channel.regimes)
    json["regimes"].push_back({{"name", regime.name},
                               {"time_share", regime.time_share},
                               {"rms", number_or_null(regime.rms)},
                               {"misfit_share", number_or_null(regime.misfit_share)}});
  for (const trace::MisfitInterval& interval : channel.intervals)
    json["intervals"].push_back(
        {{"begin_s", interval.begin_s}, {"end_s", interval.end_s}, {"misfit_share", interval.misfit_share}});
  for (const Alteration& alteration : channel.alterations) json["alterations"].push_back(alteration_json(alteration));
  return json;
}

}  // namespace

std::string alteration_text(const Alteration& alteration) {
  std::string text = text::in_words(alteration.id);
  if (const std::size_t colon = alteration.where.find(':'); colon != std::string::npos)
    text += " of " + text::in_words(alteration.where.substr(colon + 1));
  for (const AlteredParameter& parameter : alteration.parameters)
    text.append(&parameter == alteration.parameters.data() ? ": " : ", ").append(parameter_text(parameter));
  return text;
}

namespace {

/// What is not to be explained by an alteration: another input (unless the recording's clock alone moved it), a dead
/// channel.
std::string faults_text(const trace::TraceComparison& comparison) {
  std::vector<std::string> inputs, still;
  const bool clock = comparison.answer.size() == 1 && comparison.answer.front().where == "clock";
  for (const ChannelComparison& channel : comparison.channels) {
    if (channel.differs && channel.input && !clock) inputs.push_back(text::in_words(channel.name));
    if (channel.stands_still) still.push_back(text::in_words(channel.name));
  }
  std::string text;
  if (!inputs.empty())
    text += "The input itself differs (" + text::joined(inputs) +
            "): simulation and recording had different inputs, so comparing outputs proves nothing; simulate with the "
            "recorded input. ";
  if (!still.empty())
    text += "Recorded " + text::joined(still) + (still.size() > 1 ? " do" : " does") +
            " not move, but simulated it does: check the sensor and its cable. ";
  return text;
}

/// What no other alteration is worth a look before: channels whose sign is the other one.
std::string signs_text(const trace::TraceComparison& comparison) {
  std::vector<std::string> reversed;
  std::size_t driven = 0, reversed_driven = 0;
  for (const ChannelComparison& channel : comparison.channels) {
    driven += channel.input ? 0 : 1;
    reversed_driven += channel.sign_reversed && !channel.input ? 1 : 0;
    if (channel.sign_reversed) reversed.push_back(text::in_words(channel.name));
  }
  if (reversed.empty()) return "";
  const bool all = driven > 1 && reversed_driven == driven;
  return "The sign of " + text::joined(reversed) + " is reversed" +
         (all ? ", as if the input's were: check both against the wiring of the rig. " : ". ");
}

std::string listed(const std::vector<Alteration>& alterations) {
  std::string text;
  for (const Alteration& alteration : alterations) text::add_to_list(text, alteration_text(alteration), "; ");
  return text;
}

}  // namespace

std::string trace_summary(const trace::TraceComparison& comparison) {
  if (comparison.consistent) return "The simulation agrees with the recording: only noise is left.";
  std::vector<std::string> channels;
  for (const ChannelComparison& channel : comparison.channels)
    if (channel.differs) channels.push_back(text::in_words(channel.name));
  const auto still = std::ranges::count(comparison.channels, true, &ChannelComparison::stands_still);
  const std::string signs = signs_text(comparison);
  std::string text = signs + "They differ beyond noise in " + text::joined(channels) + ". " + faults_text(comparison);
  if (!comparison.answer.empty())
    text += (still > 0 ? "This explains the rest: " : "This explains it: ") + listed(comparison.answer) + ".";
  else if (static_cast<std::size_t>(still) < channels.size())
    text += signs.empty() ? "No gain, offset, delay, clock rate or sign of a channel or of the input explains it."
                          : "No gain, offset, delay or clock rate of a channel or of the input explains the rest.";
  if (!comparison.equally.empty())
    text += " So does " + listed(comparison.equally) + "; a trace cannot tell them apart.";
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string trace_limit() {
  return "A trace has only outputs, so it cannot name missing physics. For that, give the equations as a text "
         "plant or an FMU (sealwatch plant), and run sealwatch explain on the same recordings.";
}

std::string trace_json(const trace::TraceComparison& comparison, const std::string& recorded,
                       const std::string& simulated) {
  Json json = {{"schema", "sealwatch.trace/1"},
               {"recorded", recorded},
               {"simulated", simulated},
               {"consistent", comparison.consistent},
               {"motion", comparison.motion},
               {"channels", Json::array()},
               {"common", Json::array()},
               {"answer", Json::array()},
               {"equally", Json::array()},
               {"only_recorded", comparison.only_recorded},
               {"only_simulated", comparison.only_simulated},
               {"summary", trace_summary(comparison)},
               {"limit", trace_limit()}};
  for (const ChannelComparison& channel : comparison.channels) json["channels"].push_back(channel_json(channel));
  for (const Alteration& alteration : comparison.common) json["common"].push_back(alteration_json(alteration));
  for (const Alteration& alteration : comparison.answer) json["answer"].push_back(alteration_json(alteration));
  for (const Alteration& alteration : comparison.equally) json["equally"].push_back(alteration_json(alteration));
  return json.dump(1) + "\n";
}

}  // namespace sealwatch::cli
