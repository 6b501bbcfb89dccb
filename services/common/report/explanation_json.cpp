#include "services/common/report/explanation_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

namespace sealwatch::report {
namespace {

using Json = nlohmann::ordered_json;
using mismatch::ChannelComparison;
using mismatch::Explanation;
using mismatch::FoundEffect;
using mismatch::LawAt;
using mismatch::MissingTerm;
using mismatch::RecordingComparison;

constexpr std::size_t kMostPoints = 1000;  ///< of a missing term: what a drawing needs

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Every n-th of the values, at most kMostPoints.
Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  const std::size_t step = values.empty() ? 1 : (values.size() - 1) / kMostPoints + 1;
  for (std::size_t k = 0; k < values.size(); k += step) list.push_back(number(values[k]));
  return list;
}

Json law_at(const LawAt& what) {
  return {
      {"id", what.id}, {"form", what.form}, {"element", what.element}, {"law", what.law}, {"meaning", what.meaning}};
}

/// Ids of other laws, each once and without the effect's own: the same law at another element is told by the element.
Json other_ids(const FoundEffect& effect) {
  std::vector<std::string> ids;
  for (const LawAt& other : effect.indistinguishable)
    if (other.id != effect.what.id && std::ranges::find(ids, other.id) == ids.end()) ids.push_back(other.id);
  return ids;
}

Json effect_json(const FoundEffect& effect) {
  Json json = {{"id", effect.what.id},
               {"element", effect.what.element},
               {"law", effect.what.law},
               {"parameters", Json::array()},
               {"probability", number(effect.probability)},
               {"indistinguishable_from", other_ids(effect)},
               {"delta_bic", number(effect.delta_bic)},
               {"form", effect.what.form},
               {"meaning", effect.what.meaning},
               {"element_probability", number(effect.element_probability)},
               {"indistinguishable_laws", Json::array()},
               {"indistinguishable_elements", effect.same_elements},
               {"engineering_share", number(effect.engineering_share)},
               {"regime", effect.regime},
               {"evidence", effect.evidence},
               {"alternatives", Json::array()}};
  for (const mismatch::FoundParameter& parameter : effect.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", number(parameter.value)},
                                  {"std_error", number(parameter.std_error)},
                                  {"unit", parameter.unit},
                                  {"at_bound", parameter.at_bound}});
  for (const LawAt& other : effect.indistinguishable) json["indistinguishable_laws"].push_back(law_at(other));
  for (const mismatch::Alternative& alternative : effect.alternatives) {
    Json one = law_at(alternative.what);
    one["misfit_above_best"] = number(alternative.misfit_above_best);
    one["why_not"] = alternative.why_not;
    json["alternatives"].push_back(std::move(one));
  }
  return json;
}

/// {"before": {"noise_normalised_rms": {channel: value}, "nrmse_percent": {...}, ...}, "after": {...}}
Json fit_json(std::span<const ChannelComparison> channels) {
  Json before = {{"noise_normalised_rms", Json::object()},
                 {"nrmse_percent", Json::object()},
                 {"whiteness_p", Json::object()},
                 {"independence_p", Json::object()}};
  Json after = before;
  for (const ChannelComparison& channel : channels) {
    const std::string& name = channel.channel;
    before["noise_normalised_rms"][name] = number(channel.rms_before);
    after["noise_normalised_rms"][name] = number(channel.rms_after);
    before["nrmse_percent"][name] = number(channel.nrmse_before);
    after["nrmse_percent"][name] = number(channel.nrmse_after);
    before["whiteness_p"][name] = number(channel.whiteness_before);
    after["whiteness_p"][name] = number(channel.whiteness_after);
    before["independence_p"][name] = number(channel.independence_before);
    after["independence_p"][name] = number(channel.independence_after);
  }
  return {{"before", std::move(before)}, {"after", std::move(after)}};
}

Json recording_json(const RecordingComparison& recording) {
  Json json = {{"recording", recording.recording},       {"holdout", recording.holdout},
               {"left_out", recording.left_out},         {"likelihood_gain", number(recording.likelihood_gain)},
               {"gain_low", number(recording.gain_low)}, {"gain_high", number(recording.gain_high)}};
  json.update(fit_json(recording.channels));
  return json;
}

Json missing_json(const MissingTerm& term) {
  return {{"id", term.what.id},
          {"form", term.what.form},
          {"element", term.element},
          {"equation", term.what.law},
          {"meaning", term.what.meaning},
          {"quantity", term.quantity},
          {"unit", term.unit},
          {"recording", term.recording},
          {"state", term.state},
          {"state_unit", term.state_unit},
          {"time_s", numbers(term.time_s)},
          {"state_value", numbers(term.state_value)},
          {"demanded", numbers(term.demanded)},
          {"band", numbers(term.band)},
          {"law", numbers(term.law)}};
}

Json location_json(const mismatch::Location& location) {
  return {{"element", location.element},
          {"probability", number(location.probability)},
          {"indistinguishable_from", location.indistinguishable_from},
          {"evidence", location.evidence}};
}

Json power_json(const mismatch::Power& power) {
  return {{"id", power.what.id},
          {"minimum_detectable", number(power.minimum_detectable)},
          {"unit", power.unit},
          {"absorbed_share", number(power.absorbed_share)},
          {"element", power.what.element},
          {"form", power.what.form},
          {"law", power.what.law},
          {"meaning", power.what.meaning},
          {"significant", number(power.significant)}};
}

template <class T, class Write>
Json list(const std::vector<T>& values, Write write) {
  Json json = Json::array();
  for (const T& value : values) json.push_back(write(value));
  return json;
}

void add_parameters(const Explanation& explanation, Json& json) {
  Json before = Json::object();
  Json after = Json::object();
  Json details = Json::array();
  for (const mismatch::ParameterShift& shift : explanation.parameters) {
    before[shift.name] = number(shift.before);
    after[shift.name] = number(shift.after);
    details.push_back({{"name", shift.name},
                       {"unit", shift.unit},
                       {"before", number(shift.before)},
                       {"before_std", number(shift.before_std)},
                       {"after", number(shift.after)},
                       {"after_std", number(shift.after_std)},
                       {"datasheet", number(shift.datasheet)},
                       {"before_at_bound", shift.before_at_bound},
                       {"after_at_bound", shift.after_at_bound}});
  }
  json["parameters"] = {{"before", std::move(before)}, {"after", std::move(after)}};
  json["parameter_details"] = std::move(details);
}

Json prognosis_json(const mismatch::PrognosisShift& prognosis) {
  if (!prognosis.known) return nullptr;
  return {{"part", prognosis.part},
          {"parameter", prognosis.parameter},
          {"unit", prognosis.unit},
          {"R_CL_before", number(prognosis.R_CL_before)},
          {"R_CL_after", number(prognosis.R_CL_after)},
          {"theta_before", number(prognosis.theta_before)},
          {"theta_after", number(prognosis.theta_after)},
          {"months_before", number(prognosis.months_before)},
          {"months_after", number(prognosis.months_after)},
          {"sentence", prognosis.sentence}};
}

Json asked_json(const mismatch::Asked& asked) {
  return {{"laws", list(asked.laws, law_at)}, {"values", asked.values}, {"score", number(asked.score)}};
}

Json candidate_json(const mismatch::CandidateCause& cause) {
  Json json = law_at(cause.what);
  json["share"] = number(cause.share);
  json["probability"] = number(cause.probability);
  return json;
}

/// Keys beyond those of the schema.
void add_details(const Explanation& explanation, Json& json) {
  json["model"] = explanation.model;
  json["statistically_significant"] = explanation.statistically_significant;
  json["explained_share"] = number(explanation.explained_share);
  json["candidates"] = list(explanation.candidates, candidate_json);
  json["trace"] = list(explanation.trace, asked_json);
  json["not_asked"] = explanation.not_asked;
  json["recording_details"] = list(explanation.recordings, recording_json);
  json["missing"] = list(explanation.missing, missing_json);
  json["rejected"] = list(explanation.rejected, [](const mismatch::Rejected& rejected) {
    Json one = law_at(rejected.what);
    one["why"] = rejected.why;
    one["share"] = number(rejected.share);
    one["allowed_share"] = number(rejected.allowed_share);
    return one;
  });
  json["asset_values"] = list(explanation.asset_values, [](const std::vector<mismatch::AssetValue>& entry) {
    return list(entry, [](const mismatch::AssetValue& value) {
      return Json{{"name", value.name},
                  {"unit", value.unit},
                  {"in_asset_file", number(value.in_asset_file)},
                  {"fitted", number(value.fitted)},
                  {"std_error", number(value.std_error)}};
    });
  });
  json["asset_values_beside"] = list(explanation.beside_asset_values, law_at);
  json["prognosis"] = prognosis_json(explanation.prognosis);
  json["notes"] = explanation.notes;
}

}  // namespace

std::string explanation_to_json(const Explanation& explanation) {
  Json json = {
      {"schema", "sealwatch.mismatch/1"},
      {"asset_id", explanation.asset_id},
      {"recordings", {{"fit", explanation.fit_recordings}, {"holdout", explanation.holdout_recordings}}},
      {"verdict", std::string(name_of(explanation.verdict))},
      {"p_value", number(explanation.p_value)},
      {"location", list(explanation.location, location_json)},
      {"physics", list(explanation.effects, effect_json)},
      {"fit", {{"fit", fit_json(explanation.fit.channels)}, {"holdout", fit_json(explanation.holdout.channels)}}}};
  add_parameters(explanation, json);
  json["power"] = list(explanation.power, power_json);
  json["next_test"] = explanation.next_test;
  json["summary"] = explanation.summary;
  add_details(explanation, json);
  return json.dump(1, ' ', false, Json::error_handler_t::replace).append("\n");
}

}  // namespace sealwatch::report
