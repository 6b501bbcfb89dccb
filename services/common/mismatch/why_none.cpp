#include "services/common/mismatch/why_none.hpp"

#include <algorithm>
#include <cctype>

#include "services/common/mismatch/recorded_units.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/text/estimates.hpp"

namespace sealwatch::mismatch {
namespace {

std::string as_a_sentence(std::string words) {
  words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words + ".";
}

constexpr const char* kTestsOfOneTime =
    "Analyse tests of one time together: several loads, speeds and strokes within a few days.";

}  // namespace

WhyNone cannot_be_asked(const Error& why) {
  return {.summary = "The model was fitted, but the search for what is missing failed (" + reason_in_words(why) +
                     "): nothing can be said of these recordings.",
          .next_test = why.advice.empty()
                           ? "Check the recorded input around that time, or analyse without this recording."
                           : as_a_sentence(why.advice)};
}

std::string more_time_than(double limit_s) {
  constexpr double kMore = 4.0;  // times the limit: few searches take longer
  return "Give the analysis more time (--time-limit " + number(kMore * limit_s, 2) + ")";
}

WhyNone time_was_up(double limit_s) {
  return {.summary = "The time limit ended the analysis before the search for what is missing.",
          .next_test = more_time_than(limit_s) + ", or fewer and shorter recordings."};
}

WhyNone nothing_moves() {
  return {.summary = "The actuator does not move in these recordings: there is nothing to analyse.",
          .next_test =
              "Record tests in which the piston moves out, holds and comes back, under several loads "
              "and speeds."};
}

WhyNone drives_unseen(const PlantPart& part) {
  return {.summary = "Simulation and recordings differ beyond the noise. They do not show " + part.not_recorded +
                     ", which may be all that is missing: no law was tried.",
          .next_test = "Record " + part.record + "."};
}

WhyNone something_changed(const ChangeBetweenTests& change) {
  return {.summary = change.sentence, .next_test = kTestsOfOneTime, .element = change.element};
}

WhyNone part_changed_but_not_by_wear(const std::string& course, const std::string& part, const std::string& element) {
  return {.summary = course + " This is not wear: the " + part +
                     " was changed, or something else changed between these "
                     "tests. One law for all of them cannot be identified.",
          .next_test = kTestsOfOneTime,
          .element = element};
}

WhyNone part_aged_and_no_more(const std::string& course, const std::string& part, const std::string& element) {
  return {.summary = course + " The " + part + " aged; nothing else shows.",
          .next_test = kTestsOfOneTime,
          .element = element};
}

WhyNone differed_and_no_more(const std::string& course) {
  return {.summary = course + " The asset changed between these tests; nothing else shows.",
          .next_test = kTestsOfOneTime};
}

WhyNone runs_away(const std::string& runaway, const std::string& advice) {
  return {.summary = runaway + " No physics is named.",
          .next_test = advice + " window_s in the plant file makes explain look at short pieces."};
}

std::string missed_by_trend(const ChannelComparison& worst) {
  return " On held-out recordings, with what the trend predicts for them, " + in_words(worst.channel) + " misses by " +
         text::misfit_text(worst.rms_after) +
         " times the noise: the prediction's error, or what the fitted tests do not show.";
}

WhyNone value_of_the_asset_file(const std::string& values, bool several, const std::string& beside,
                                const std::string& instead_of, const PooledFit& holdout) {
  const std::string proof = proof_in_words(holdout);
  const std::string start =
      several ? "Values that the asset file fixes may be wrong: " : "A value that the asset file fixes may be wrong: ";
  const std::string with = (several ? "With them" : "With it") + (beside.empty() ? ", " : " and " + beside + ", ");
  const std::string explains = several || !beside.empty() ? " Together they explain" : " It explains";
  const std::string against =
      instead_of.empty() ? ", and no law that was asked does" : " as well as " + instead_of + " would, or better";
  return {
      .summary = start + values + "." + (proof.empty() ? "" : " " + with + proof + ".") + left_in_words(holdout) +
                 (proof.empty() ? " No recording was left for a proof." : "") + explains + " these recordings" +
                 against + ". No physics is named" + (beside.empty() ? "." : " before that is checked."),
      .next_test =
          "Check this against the drawing or the datasheet. Only if neither gives it, estimate it (estimate: true in "
          "the asset file) and analyse again: the estimate would hide a fault with the same effect."};
}

WhyNone values_not_asked(const std::string& laws, double limit_s) {
  return {.summary = "These recordings would be explained by " + laws +
                     ", or by a value that the asset file fixes, which there was no time to ask. Neither is claimed.",
          .next_test = more_time_than(limit_s) + "."};
}

WhyNone nowhere_near(const ChannelComparison& far, const Data& fit, const PooledFit& before) {
  std::string check =
      "Check the units, signs and wiring of the recorded channels, then the parameters in the asset file.";
  if (const std::string unit = hardly_moves(before); !unit.empty()) check += " First: " + unit + ".";
  const bool several_days = are_of_several_days(fit);
  return {.summary =
              "The simulation is far from these recordings, whatever law is added: with the best law it still misses " +
              in_words(far.channel) + " by " + text::misfit_text(far.rms_after) +
              " times the noise, more than half of the signal (the tables are without that law). No physics is named." +
              (several_days ? " What is missing may also differ from test to test." : ""),
          .next_test = several_days ? "These tests are from different days: analyse each alone, or those of one "
                                      "period together. If even a single one misfits: " +
                                          check
                                    : check};
}

std::string does_not_carry_over(const ChannelComparison& worse) {
  return "The better fit does not carry over: on held-out recordings it takes " + in_words(worse.channel) + " from " +
         text::misfit_text(worse.rms_before) + " to " + text::misfit_text(worse.rms_after) +
         " times its noise. It is not claimed.";
}

WhyNone those_kept_aside_differ(const ChannelComparison& worst) {
  return {
      .summary = "The fitted recordings agree with the model, the held-out ones do not: " + in_words(worst.channel) +
                 " misses by " + text::misfit_text(worst.rms_after) +
                 " times the noise. The asset changed between them, or what is missing acts in these alone.",
      .next_test = "Fit some of the held-out recordings together with the others, and hold out others of each kind."};
}

}  // namespace sealwatch::mismatch
