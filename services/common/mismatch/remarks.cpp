#include "services/common/mismatch/remarks.hpp"

#include <algorithm>

#include "services/common/mismatch/datasheet.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {

void remark_why_none(const WhyNone& why, Explanation& result) {
  result.location.clear();
  if (!why.element.empty())
    result.location.push_back(
        {.element = why.element, .probability = kNeverCertain, .indistinguishable_from = {}, .evidence = why.summary});
  for (const LawAt& law : result.beside_asset_values)
    result.location.push_back({.element = law.element,
                               .probability = kNeverCertain,
                               .indistinguishable_from = {},
                               .evidence = "Something is missing here, too, beside the value in the asset file: " +
                                           law_in_words(law) + " was fitted."});
  result.rejected.clear();
  if (result.asset_values.empty()) result.prognosis = {};
  result.summary = why.summary;
  result.next_test = why.next_test;
}

void remark_ageing(const std::string& course, Explanation& result) {
  result.summary += " " + course;
  result.notes.push_back(course +
                         " Held-out recordings are simulated with the R_CL that this trend predicts for their dates; "
                         "their misfit contains its error.");
}

void remark_difference(const std::string& course, Explanation& result) {
  result.summary += " " + course;
  result.notes.push_back(course + " In held-out recordings, too, it is fitted, before and after.");
}

void remark_asset_values(Explanation& result) {
  const std::string values = values_in_words(result.asset_values);
  const std::string same = " A wrong value in the asset file would explain it as well: " + values + ".";
  result.summary += same;
  for (FoundEffect& effect : result.effects) effect.evidence += same;
  for (Location& place : result.location)
    if (std::ranges::any_of(result.effects, [&](const auto& one) { return one.what.element == place.element; }))
      place.evidence += same;
  const std::string check = "Check this value in the asset file first: " + values + ".";
  result.next_test = result.next_test.empty() ? check : check + " " + result.next_test;
}

void remark_values_beside(const std::string& instead, bool as_well, Explanation& result) {
  for (const FoundEffect& effect : result.effects) result.beside_asset_values.push_back(effect.what);
  const std::string values = values_in_words(result.asset_values);
  result.summary += " Beside this a value of the asset file is off, which has its share in that: " + values + ".";
  if (!instead.empty())
    result.summary += as_well ? " In its place " + instead + " would do as well, and is not claimed."
                              : " Without it " + instead + " would be needed, which fits less well and is not claimed.";
  const std::string check = "Check this value in the asset file first: " + values + ".";
  result.next_test = result.next_test.empty() ? check : check + " " + result.next_test;
}

void remark_faster_sampling(Explanation& result) {
  result.summary += " The input swings from sample to sample; its course between samples may account for the rest.";
  result.next_test = "Record these tests at five times the sampling rate.";
}

void remark_law_sizes(const std::string& by_size, Explanation& result) {
  result.summary += " But " + by_size + ".";
  result.next_test =
      "Check law_sizes in the plant file, which `sealwatch plant check` shows beside what they come to, "
      "and analyse again.";
}

void remark_disturbed_signal(Explanation& result) {
  result.next_test = "Search the signal of " + element_in_words(result.location.front().element) +
                     " for outliers, and analyse again without them.";
}

std::string values_at_their_end(const FittedModel& model, const AssetConfig& asset) {
  std::vector<std::string> moved;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    const auto given = asset.parameters.find(unknown.name);
    const double at = model.optimum.point.shared[k];
    if (!unknown.is_known() || given == asset.parameters.end() || !at_bound(unknown, at)) continue;
    moved.push_back(unknown.name + " to " + text::with_unit(unknown.to_value(at), unknown.unit) + " from " +
                    number(given->second.value));
  }
  if (moved.empty()) return {};
  return "The fit moved fixed values as far as their tolerances allow, which may imitate what is missing: " +
         joined(moved, ", ") + ". Give smaller tolerances where these values are known better.";
}

std::string gives_no_number(const LawAt& law) {
  return "Not asked: " + law_in_words(law) + " (" + law.law +
         ") gives no finite number somewhere in these recordings. Write the law so that it has a value at standstill "
         "and in both directions, as with abs(speed).";
}

bool asks_within(const PlantDescription& plant) { return !plant.sites.empty(); }

void remark_nothing_asked_within(const PlantDescription& plant, bool has_reason, Explanation& result) {
  const std::string why =
      plant.hides_states
          ? "The plant is a unit for Co-Simulation, which hides its states: only inputs, parameters and sensors were "
            "asked, and physics that is missing within it cannot be named."
          : "The plant file names no place where physics may be missing (elements with sites): only inputs, parameters "
            "and sensors were asked.";
  result.notes.push_back(why);
  if (!result.statistically_significant) return;
  result.summary += " " + why;
  const std::string advice =
      plant.hides_states
          ? "Export the unit for Model Exchange (or take `interface: me`, where it has both) and "
            "analyse again: then laws can be added to its derivatives."
          : "Add elements with sites to the plant file, where physics may be missing, and analyse again.";
  const bool says_more = has_reason || !result.effects.empty() || !result.asset_values.empty();
  result.next_test = says_more && !result.next_test.empty() ? result.next_test + " " + advice : advice;
}

void remark_leak_in_two_parts(Explanation& result) {
  if (std::ranges::none_of(result.effects, [](const FoundEffect& one) { return one.what.element == "piston_seal"; }))
    return;
  result.prognosis = {};
  result.notes.emplace_back(
      "The leakage past the piston is R_CL plus the law found. R_CL alone no longer describes the seal, so no "
      "condition "
      "or remaining life is derived from it.");
}

}  // namespace sealwatch::mismatch
