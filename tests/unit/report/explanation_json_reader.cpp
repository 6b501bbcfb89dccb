#include "tests/unit/report/explanation_json_reader.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "sealwatch/core/json_depth.hpp"

namespace sealwatch::report {
namespace {

using Json = nlohmann::ordered_json;
using namespace mismatch;

/// Thrown inside this file only: reading goes through a tree, and the first key that is wrong ends it.
struct WrongKey {
  std::string key;
  std::string rule;
};

const Json& member(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key)) throw WrongKey{key, "is missing"};
  return json.at(key);
}

double number(const Json& json, const char* key) {
  const Json& value = member(json, key);
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) throw WrongKey{key, "must be a number or null"};
  return value.get<double>();
}

std::string text(const Json& json, const char* key) {
  const Json& value = member(json, key);
  if (!value.is_string()) throw WrongKey{key, "must be a text"};
  return value.get<std::string>();
}

bool truth(const Json& json, const char* key) {
  const Json& value = member(json, key);
  if (!value.is_boolean()) throw WrongKey{key, "must be true or false"};
  return value.get<bool>();
}

const Json& array(const Json& json, const char* key) {
  const Json& value = member(json, key);
  if (!value.is_array()) throw WrongKey{key, "must be a list"};
  return value;
}

std::vector<std::string> texts(const Json& json, const char* key) {
  std::vector<std::string> values;
  for (const Json& value : array(json, key)) {
    if (!value.is_string()) throw WrongKey{key, "must be a list of texts"};
    values.push_back(value.get<std::string>());
  }
  return values;
}

std::vector<double> numbers(const Json& json, const char* key) {
  std::vector<double> values;
  for (const Json& value : array(json, key)) {
    if (!value.is_null() && !value.is_number()) throw WrongKey{key, "must be a list of numbers"};
    values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  }
  return values;
}

template <class Read>
auto list(const Json& json, const char* key, Read read) {
  std::vector<decltype(read(json))> values;
  for (const Json& value : array(json, key)) values.push_back(read(value));
  return values;
}

LawAt read_law(const Json& json) {
  return {.id = text(json, "id"),
          .form = text(json, "form"),
          .element = text(json, "element"),
          .law = text(json, "law"),
          .meaning = text(json, "meaning")};
}

FoundParameter read_parameter(const Json& json) {
  return {.name = text(json, "name"),
          .unit = text(json, "unit"),
          .value = number(json, "value"),
          .std_error = number(json, "std_error"),
          .at_bound = truth(json, "at_bound")};
}

Alternative read_alternative(const Json& json) {
  return {
      .what = read_law(json), .misfit_above_best = number(json, "misfit_above_best"), .why_not = text(json, "why_not")};
}

FoundEffect read_effect(const Json& json) {
  return {.what = read_law(json),
          .parameters = list(json, "parameters", read_parameter),
          .probability = number(json, "probability"),
          .element_probability = number(json, "element_probability"),
          .indistinguishable = list(json, "indistinguishable_laws", read_law),
          .same_elements = texts(json, "indistinguishable_elements"),
          .delta_bic = number(json, "delta_bic"),
          .engineering_share = number(json, "engineering_share"),
          .regime = text(json, "regime"),
          .evidence = text(json, "evidence"),
          .alternatives = list(json, "alternatives", read_alternative)};
}

std::vector<ChannelComparison> read_fit(const Json& json) {
  const Json& before = member(json, "before");
  const Json& after = member(json, "after");
  std::vector<ChannelComparison> channels;
  for (const auto& [channel, value] : member(before, "noise_normalised_rms").items()) {
    const auto of = [&name = channel](const Json& side, const char* key) {
      return number(member(side, key), name.c_str());
    };
    channels.push_back({.channel = channel,
                        .rms_before = of(before, "noise_normalised_rms"),
                        .rms_after = of(after, "noise_normalised_rms"),
                        .nrmse_before = of(before, "nrmse_percent"),
                        .nrmse_after = of(after, "nrmse_percent"),
                        .whiteness_before = of(before, "whiteness_p"),
                        .whiteness_after = of(after, "whiteness_p"),
                        .independence_before = of(before, "independence_p"),
                        .independence_after = of(after, "independence_p")});
  }
  return channels;
}

RecordingComparison read_recording(const Json& json) {
  RecordingComparison recording;
  recording.recording = text(json, "recording");
  recording.holdout = truth(json, "holdout");
  recording.left_out = truth(json, "left_out");
  recording.channels = read_fit(json);
  recording.likelihood_gain = number(json, "likelihood_gain");
  recording.gain_low = number(json, "gain_low");
  recording.gain_high = number(json, "gain_high");
  return recording;
}

MissingTerm read_missing(const Json& json) {
  return {.element = text(json, "element"),
          .quantity = text(json, "quantity"),
          .unit = text(json, "unit"),
          .recording = text(json, "recording"),
          .state = text(json, "state"),
          .state_unit = text(json, "state_unit"),
          .what = {.id = text(json, "id"),
                   .form = text(json, "form"),
                   .element = text(json, "element"),
                   .law = text(json, "equation"),
                   .meaning = text(json, "meaning")},
          .time_s = numbers(json, "time_s"),
          .state_value = numbers(json, "state_value"),
          .demanded = numbers(json, "demanded"),
          .band = numbers(json, "band"),
          .law = numbers(json, "law"),
          .path_state = {},  // of the page alone
          .path_law = {}};
}

Location read_location(const Json& json) {
  return {.element = text(json, "element"),
          .probability = number(json, "probability"),
          .indistinguishable_from = texts(json, "indistinguishable_from"),
          .evidence = text(json, "evidence")};
}

Power read_power(const Json& json) {
  return {.what = read_law(json),
          .minimum_detectable = number(json, "minimum_detectable"),
          .unit = text(json, "unit"),
          .absorbed_share = number(json, "absorbed_share"),
          .significant = number(json, "significant")};
}

CandidateCause read_candidate(const Json& json) {
  return {.what = read_law(json), .share = number(json, "share"), .probability = number(json, "probability")};
}

Asked read_asked(const Json& json) {
  return {.laws = list(json, "laws", read_law), .values = texts(json, "values"), .score = number(json, "score")};
}

ParameterShift read_shift(const Json& json) {
  return {.name = text(json, "name"),
          .unit = text(json, "unit"),
          .before = number(json, "before"),
          .before_std = number(json, "before_std"),
          .after = number(json, "after"),
          .after_std = number(json, "after_std"),
          .datasheet = number(json, "datasheet"),
          .before_at_bound = truth(json, "before_at_bound"),
          .after_at_bound = truth(json, "after_at_bound")};
}

// Absent in reports of before it was asked.
std::vector<std::vector<AssetValue>> read_asset_values(const Json& json) {
  std::vector<std::vector<AssetValue>> values;
  if (!json.contains("asset_values")) return values;
  for (const Json& entry : array(json, "asset_values")) {
    if (!entry.is_array()) throw WrongKey{"asset_values", "must be a list of lists"};
    values.emplace_back();
    for (const Json& value : entry)
      values.back().push_back({.name = text(value, "name"),
                               .unit = text(value, "unit"),
                               .in_asset_file = number(value, "in_asset_file"),
                               .fitted = number(value, "fitted"),
                               .std_error = number(value, "std_error")});
  }
  return values;
}

PrognosisShift read_prognosis(const Json& json) {
  if (json.is_null()) return {};
  // Reports of earlier versions do not say what wears.
  const auto told = [&](const char* key) { return json.contains(key) ? text(json, key) : std::string(); };
  return {.known = true,
          .part = told("part"),
          .parameter = told("parameter"),
          .unit = told("unit"),
          .R_CL_before = number(json, "R_CL_before"),
          .R_CL_after = number(json, "R_CL_after"),
          .theta_before = number(json, "theta_before"),
          .theta_after = number(json, "theta_after"),
          .months_before = number(json, "months_before"),
          .months_after = number(json, "months_after"),
          .sentence = text(json, "sentence")};
}

Explanation read(const Json& json) {
  if (text(json, "schema") != "sealwatch.mismatch/1") throw WrongKey{"schema", "must be sealwatch.mismatch/1"};
  Explanation explanation;
  explanation.asset_id = text(json, "asset_id");
  explanation.model = text(json, "model");
  explanation.fit_recordings = texts(member(json, "recordings"), "fit");
  explanation.holdout_recordings = texts(member(json, "recordings"), "holdout");
  const std::optional<Verdict> verdict = value_of<Verdict>(text(json, "verdict"));
  if (!verdict) throw WrongKey{"verdict", "must be consistent, mismatch or undetermined"};
  explanation.verdict = *verdict;
  explanation.p_value = number(json, "p_value");
  explanation.statistically_significant = truth(json, "statistically_significant");
  explanation.explained_share = number(json, "explained_share");
  explanation.location = list(json, "location", read_location);
  explanation.effects = list(json, "physics", read_effect);
  explanation.missing = list(json, "missing", read_missing);
  explanation.recordings = list(json, "recording_details", read_recording);
  explanation.fit.channels = read_fit(member(member(json, "fit"), "fit"));
  explanation.holdout.channels = read_fit(member(member(json, "fit"), "holdout"));
  explanation.parameters = list(json, "parameter_details", read_shift);
  explanation.power = list(json, "power", read_power);
  explanation.rejected = list(json, "rejected", [](const Json& one) {
    return Rejected{.what = read_law(one),
                    .why = text(one, "why"),
                    .share = number(one, "share"),
                    .allowed_share = number(one, "allowed_share")};
  });
  explanation.asset_values = read_asset_values(json);
  if (json.contains("asset_values_beside"))
    explanation.beside_asset_values = list(json, "asset_values_beside", read_law);
  if (json.contains("candidates")) explanation.candidates = list(json, "candidates", read_candidate);
  if (json.contains("trace")) explanation.trace = list(json, "trace", read_asked);
  if (json.contains("not_asked")) explanation.not_asked = texts(json, "not_asked");
  explanation.prognosis = read_prognosis(member(json, "prognosis"));
  explanation.next_test = text(json, "next_test");
  explanation.summary = text(json, "summary");
  explanation.notes = texts(json, "notes");
  return explanation;
}

}  // namespace

Result<Explanation> explanation_from_json(std::string_view text) {
  if (is_nested_too_deeply(text)) return fail(kNestedTooDeeply);
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail("is not JSON");
  try {
    return read(json);
  } catch (const WrongKey& wrong) {
    return fail(Error{.file = {}, .place = wrong.key, .value = {}, .rule = wrong.rule, .advice = {}});
  }
}

}  // namespace sealwatch::report
