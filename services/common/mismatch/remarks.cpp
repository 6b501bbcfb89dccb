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
                               .evidence = "Something is missing here too, beside the value of the asset file: " +
                                           law_in_words(law) + " was fitted."});
  result.rejected.clear();
  if (result.asset_values.empty()) result.prognosis = {};
  result.summary = why.summary;
  result.next_test = why.next_test;
}

void remark_ageing(const std::string& course, Explanation& result) {
  result.summary += " " + course;
  result.notes.push_back(course +
                         " Recordings that took no part have the R_CL that this course predicts for their dates, and "
                         "their misfit contains its error.");
}

void remark_asset_values(Explanation& result) {
  const std::string values = values_in_words(result.asset_values);
  const std::string same = " A wrong value in the asset file would do the same: " + values + ".";
  result.summary += same;
  for (FoundEffect& effect : result.effects) effect.evidence += same;
  for (Location& place : result.location)
    if (std::ranges::any_of(result.effects, [&](const auto& one) { return one.what.element == place.element; }))
      place.evidence += same;
  const std::string check = "Check this value of the asset file first: " + values + ".";
  result.next_test = result.next_test.empty() ? check : check + " " + result.next_test;
}

void remark_faster_sampling(Explanation& result) {
  result.summary += " The input swings from sample to sample, and its unrecorded course may account for what is left.";
  result.next_test = "Record these tests with five times as many samples a second.";
}

void remark_disturbed_signal(Explanation& result) {
  result.next_test = "Look at the signal of " + element_in_words(result.location.front().element) +
                     " for single samples that are far off, and analyse again without them.";
}

void remark_leak_in_two_parts(Explanation& result) {
  if (std::ranges::none_of(result.effects, [](const FoundEffect& one) { return one.what.element == "piston_seal"; }))
    return;
  result.prognosis = {};
  result.notes.emplace_back(
      "The leak past the piston is R_CL and the law found together: R_CL alone no longer tells how the seal is, and no "
      "condition or remaining life is derived from it.");
}

}  // namespace sealwatch::mismatch
