#include "services/common/report/explanation_html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "services/common/report/actuator_drawing.hpp"
#include "services/common/report/explanation_sections.hpp"
#include "tests/unit/report/example.hpp"
#include "tests/unit/report/well_formed.hpp"

namespace sealwatch::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// For looking at: written where SEALWATCH_EXAMPLE_REPORTS says.
void keep(const std::string& name, const std::string& html) {
  if (const char* directory = std::getenv("SEALWATCH_EXAMPLE_REPORTS"))
    std::ofstream(std::string(directory) + "/" + name) << html;
}

mismatch::Explanation undetermined_example() {
  mismatch::Explanation explanation = consistent_example();
  explanation.model = "eha_switched";
  explanation.verdict = mismatch::Verdict::undetermined;
  explanation.statistically_significant = true;
  explanation.location = {{"accumulator", 0.5, {"pump"}, "e"}, {"pump", 0.45, {"accumulator"}, "e"}};
  explanation.next_test = "Record a stroke under full load.";
  return explanation;
}

TEST(ReportHtml, IsWellFormedAndSelfContained) {
  for (const auto& [name, explanation] : {std::pair{"mismatch.html", example_explanation()},
                                          {"consistent.html", consistent_example()},
                                          {"undetermined.html", undetermined_example()},
                                          {"empty.html", mismatch::Explanation{}}}) {
    const std::string html = explanation_to_html(explanation);
    keep(name, html);
    EXPECT_EQ(what_is_wrong(html), "") << name;
    EXPECT_EQ(html, explanation_to_html(explanation)) << name << ": the same explanation gives the same page";
    for (const char* fetched : {"https:", "src=", "href=", "@import", "url("})
      EXPECT_THAT(html, Not(HasSubstr(fetched))) << name;
    EXPECT_THAT(html, Not(HasSubstr("nan"))) << name;
    EXPECT_LT(html.size(), 3'000'000U) << name;
  }
}

mismatch::Explanation blamed_example() {
  mismatch::Explanation explanation = undetermined_example();
  explanation.model = "eha";
  explanation.asset_values = {
      {{.name = "A_C", .unit = "m2", .in_asset_file = 5.89e-3, .fitted = 6.067e-3, .std_error = 1e-6}},
      {{.name = "V_0", .unit = "m3", .in_asset_file = 5e-5, .fitted = 6e-5, .std_error = 1e-7}}};
  return explanation;
}

TEST(ReportHtml, TellsWhichValueOfTheAssetFileMayBeWrongBeforeWhatCouldHaveBeenSeen) {
  const std::string html = explanation_to_html(blamed_example());
  EXPECT_EQ(what_is_wrong(html), "");
  for (const char* part : {"Undetermined: a value of the asset file may be wrong", "piston area on chamber A",
                           "dead volume of one chamber", "+3.0 %", "+20 %"})
    EXPECT_THAT(html, HasSubstr(part));
  EXPECT_LT(html.find("A value in the asset file may be wrong"), html.find("What these recordings could detect"));
  EXPECT_THAT(html, HasSubstr(" fits; the asset file has "));
  EXPECT_LT(html.find("What to do next"), html.find("A value in the asset file may be wrong"))
      << "on the first screen, with the value";
}

TEST(ReportHtml, TellsAValueBesideTheLawsThatAreClaimed) {
  mismatch::Explanation explanation = example_explanation();
  explanation.model = "eha";
  explanation.asset_values = {blamed_example().asset_values.front()};
  explanation.beside_asset_values = {explanation.effects.front().what};
  const std::string html = explanation_to_html(explanation);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("Mismatch found and explained: missing physics and a wrong value in the asset file"));
  EXPECT_THAT(html, HasSubstr("The model was fitted with this value, beside the laws above."));
  EXPECT_THAT(html, Not(HasSubstr("Something is probably missing there")));
}

TEST(ReportHtml, SaysWhatToDoNextWhateverTheVerdict) {
  mismatch::Explanation cut_off = undetermined_example();
  EXPECT_THAT(explanation_to_html(cut_off), HasSubstr("What to record next"));
  cut_off.not_asked = {"laws"};
  EXPECT_THAT(explanation_to_html(cut_off), HasSubstr("What to do next")) << "no recording is asked for";
  EXPECT_THAT(explanation_to_html(consistent_example()), HasSubstr("What to do next"));
  EXPECT_EQ(steps_of(consistent_example()).size(), 1U);
  EXPECT_THAT(steps_of(consistent_example()).front(), HasSubstr("sealwatch validate --asset asset.explained.yaml"));
}

TEST(ReportHtml, TheFirstScreenSaysAFindingOnce) {
  mismatch::Explanation changed = undetermined_example();
  changed.summary = "R_CL changed between the tests.";
  changed.location.resize(1);
  changed.location.front().evidence = changed.summary;
  const std::string html = explanation_to_html(changed);
  const std::string screen = html.substr(0, html.find("What to record next"));
  EXPECT_EQ(screen.find(changed.summary), screen.rfind(changed.summary));
}

TEST(ReportHtml, NoShareOfAMisfitThatWasAtItsFloor) {
  mismatch::Explanation weak = example_explanation();
  EXPECT_THAT(explanation_to_html(weak), HasSubstr("of the misfit explained</span>"));
  weak.explained_share = 0.0;
  EXPECT_THAT(explanation_to_html(weak), Not(HasSubstr("of the misfit explained</span>")));
}

/// A model with another cause than the true one misses what that cause does otherwise.
TEST(ReportHtml, AFindingThatLeavesAPartIsNotToBeUsedYet) {
  mismatch::Explanation part = example_explanation();
  const auto uses_it = [&] {
    return std::ranges::any_of(steps_of(part),
                               [](const std::string& step) { return step.starts_with("Use asset.explained.yaml"); });
  };
  ASSERT_FALSE(part.holdout.channels.empty());
  EXPECT_TRUE(uses_it());
  part.holdout.channels.front().rms_after = part.holdout.channels.front().weighed_rms_after = 57.7;
  EXPECT_FALSE(uses_it());
  const std::string html = explanation_to_html(part);
  EXPECT_THAT(html, HasSubstr("Mismatch found and partly explained"));
  EXPECT_THAT(html, HasSubstr("Find the rest before you use asset.explained.yaml"));
  EXPECT_THAT(html, HasSubstr("still misses by 57.7 times its noise"));
}

TEST(ReportHtml, ASensorIsNothingThatTheModelLacks) {
  mismatch::Explanation explanation = example_explanation();
  EXPECT_THAT(explanation_to_html(explanation), HasSubstr("What the model lacks"));
  for (mismatch::FoundEffect& effect : explanation.effects) effect.what.element = "sensor:pressure_a";
  EXPECT_THAT(explanation_to_html(explanation), HasSubstr("What explains the difference"));
}

TEST(ReportHtml, TellsWhatWasFound) {
  const std::string html = explanation_to_html(example_explanation());
  for (const char* part : {"Mismatch found and explained",
                           "dry friction of 4.0 kN",
                           "Stribeck friction of the piston",
                           "98 %",
                           ", at its bound",
                           "(F_c + F_x exp(-(v / v_st)^2)) tanh(v / v_s)",
                           "4.010 ± 0.060 kN",
                           "old model",
                           "new model",
                           "holdout_0",
                           "Coulomb friction",
                           "misses the rise near standstill",
                           "fits better only with oil flowing",
                           "had been compensating for it",
                           "13 % more worn",
                           "no size",
                           "Record a stroke at 0.2 mm/s",
                           "Inspect the piston for ",
                           "put it in place of the asset file",
                           "117 laws were tried"})
    EXPECT_THAT(html, HasSubstr(part));
}

TEST(ReportHtml, ShowsWhatWasSeenBesideTheClaimedEffects) {
  mismatch::Explanation explanation = example_explanation();
  EXPECT_THAT(explanation_to_html(explanation), Not(HasSubstr("Other candidates")));
  explanation.candidates = {{{"line_resistance", "laminar", "valve_1", "R q_f", ""}, 0.12, 0.4}};
  const std::string html = explanation_to_html(explanation);
  EXPECT_EQ(what_is_wrong(html), "");
  for (const char* part : {"Other candidates", "line resistance (laminar)", "12 %", "40 %"})
    EXPECT_THAT(html, HasSubstr(part));
}

TEST(ReportHtml, ShowsParametersAtABoundBeforeTheOthers) {
  mismatch::Explanation explanation = example_explanation();
  explanation.parameters.push_back({.name = "R_M",
                                    .unit = "ohm",
                                    .before = 0.05,
                                    .before_std = std::numeric_limits<double>::infinity(),
                                    .after = 0.48,
                                    .after_std = 0.01,
                                    .datasheet = 0.5,
                                    .before_at_bound = true});
  const std::string html = explanation_to_html(explanation);
  EXPECT_THAT(html, HasSubstr(", at its bound"));
  EXPECT_THAT(html, HasSubstr("its range is wrong"));
  const std::size_t table = html.find("What had absorbed the effect");
  const auto at = [&](const char* name) { return html.find(std::string(">").append(name).append("<"), table); };
  EXPECT_LT(at("R_M"), at("f_C"));
  EXPECT_LT(at("f_C"), at("R_CL")) << "moved by more of its error";
  const std::string without = explanation_to_html(example_explanation());
  EXPECT_EQ(without.find("at its bound", without.find("What had absorbed the effect")), std::string::npos);
}

TEST(ReportHtml, SaysHowMuchAForbiddenFitWouldHaveTaken) {
  mismatch::Explanation explanation = example_explanation();
  explanation.rejected.front().share = 0.43;
  explanation.rejected.front().allowed_share = 0.61;
  const std::string html = explanation_to_html(explanation);
  EXPECT_THAT(html, HasSubstr("43 %"));
  EXPECT_THAT(html, HasSubstr("with a possible value would have explained 61 % of the misfit"));
}

TEST(ReportHtml, DrawsNothingWhereWindowsOfTheMissingTermWereLeftOut) {
  mismatch::Explanation explanation = example_explanation();
  const auto lines_of = [&] {
    const std::string html = explanation_to_html(explanation);
    const std::size_t begin = html.find("<title>missing");
    const std::string plot = html.substr(begin, html.find("</svg>", begin) - begin);
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = plot.find("stroke-width=\"1.8\"", at)) != std::string::npos; ++at) ++lines;
    return lines;
  };
  EXPECT_EQ(lines_of(), 1U);
  mismatch::MissingTerm& term = explanation.missing.front();
  for (std::size_t k = 300; k < term.time_s.size(); ++k) term.time_s[k] += 4.0;
  EXPECT_EQ(lines_of(), 2U);
}

TEST(ReportHtml, TellsWhatWouldOnlyChangeFittedValuesFromWhatCouldStayUnseen) {
  const std::string html = explanation_to_html(consistent_example());
  EXPECT_THAT(html, HasSubstr("1 of 3 effects would be seen as soon as they matter, 1 could stay unseen"));
  EXPECT_THAT(html, HasSubstr("1 that would only change the fitted values"));
  EXPECT_LT(html.find("Could stay unseen"), html.find("1 that would only change the fitted values"));
}

TEST(ReportHtml, NamesTheLawOfAMissingTermAndSaysWhereItLeavesTheBand) {
  mismatch::Explanation explanation = example_explanation();
  mismatch::MissingTerm& term = explanation.missing.front();
  term.what = {"sensor_bias", "", "sensor:level_voltage", "channel + b", ""};
  term.element = "sensor:level_voltage";
  std::string html = explanation_to_html(explanation);
  EXPECT_THAT(html, HasSubstr("Sensor bias of level voltage: missing force against +x, recording fit_0"));
  EXPECT_THAT(html, Not(HasSubstr("makes the interval too narrow")));
  for (double& value : term.law) value += 5000.0;
  html = explanation_to_html(explanation);
  EXPECT_THAT(html, HasSubstr("lies within the interval at 0 % of the points"));
  EXPECT_THAT(html, HasSubstr("makes the interval too narrow"));
}

TEST(ReportHtml, NamesElementsAsAnEngineerDoes) {
  mismatch::Explanation explanation = example_explanation();
  explanation.effects.front().what = {"external_leakage", "laminar", "chamber_a", "G (p - p_0)",
                                      "oil that leaves the chamber past the rod seal, through a narrow gap"};
  const std::string html = explanation_to_html(explanation);
  EXPECT_THAT(html, HasSubstr("External leakage (laminar) of chamber A"));
  EXPECT_THAT(html, HasSubstr("Inspect chamber A for external leakage (laminar): oil that leaves the chamber"));
  EXPECT_THAT(html, Not(HasSubstr("the chamber A")));
  EXPECT_EQ(the_element("sensor:pressure_a"), "the sensor of pressure A");
  EXPECT_EQ(the_element("valve_2"), "valve 2");
  EXPECT_EQ(the_element("piston_seal"), "the piston seal");
}

TEST(ReportHtml, PrintsTheProofAndLeavesTheRestClosed) {
  const auto printed = [](const mismatch::Explanation& explanation, const std::string& title) {
    const std::string html = explanation_to_html(explanation);
    return html.find("<details class=\"part paper\"><summary><h2>" + title) != std::string::npos;
  };
  for (const char* title : {"The missing term", "Recording and simulation", "Before and after, in figures"})
    EXPECT_TRUE(printed(example_explanation(), title)) << title;
  for (const char* title : {"Notes", "Alternatives, and why not", "What these recordings could detect"})
    EXPECT_FALSE(printed(example_explanation(), title)) << title;
  EXPECT_TRUE(printed(consistent_example(), "What these recordings could detect"));
}

TEST(ReportHtml, ConsistentClaimsNothing) {
  const std::string html = explanation_to_html(consistent_example());
  EXPECT_THAT(html, HasSubstr("no mismatch was found"));
  EXPECT_THAT(html, Not(HasSubstr("The laws in full")));
  EXPECT_THAT(html, Not(HasSubstr("The missing term")));
}

TEST(ReportHtml, EscapesEveryText) {
  const std::string evil = "<script>alert('x')</script>";
  mismatch::Explanation explanation = example_explanation();
  explanation.asset_id = explanation.summary = explanation.next_test = evil;
  explanation.fit_recordings = explanation.holdout_recordings = explanation.notes = {evil};
  for (auto& place : explanation.location) place = {evil, 0.5, {evil}, evil};
  for (auto& effect : explanation.effects) {
    effect.what = {evil, evil, evil, evil, evil};
    effect.regime = effect.evidence = evil;
    effect.parameters = {{evil, evil, 1.0, 1.0, false}};
    effect.indistinguishable = {effect.what};
    effect.same_elements = {evil};
    effect.alternatives = {{effect.what, 1.0, evil}};
  }
  for (auto& term : explanation.missing)
    term.element = term.quantity = term.unit = term.recording = term.state = term.state_unit = evil;
  for (auto& recording : explanation.recordings) {
    recording.recording = evil;
    for (auto& channel : recording.channels) channel.channel = evil;
    for (auto* samples : {&recording.recorded, &recording.before, &recording.after})
      for (auto& series : samples->channels) series.name = series.unit = evil;
  }
  for (auto& channel : explanation.fit.channels) channel.channel = evil;
  for (auto& shift : explanation.parameters) shift.name = shift.unit = evil;
  for (auto& power : explanation.power) {
    power.what = {evil, evil, evil, evil, evil};
    power.unit = evil;
  }
  for (auto& rejected : explanation.rejected) rejected = {{evil, evil, evil, evil, evil}, evil};
  explanation.prognosis.sentence = evil;
  const std::string html = explanation_to_html(explanation);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert"));
}

TEST(ReportHtml, StaysSmallWithManyLongRecordings) {
  mismatch::Explanation explanation = example_explanation();
  const mismatch::RecordingComparison one = explanation.recordings.back();
  for (int k = 0; k < 60; ++k) explanation.recordings.push_back(one);
  const std::string html = explanation_to_html(explanation);
  EXPECT_LT(html.size(), 3'000'000U);
  EXPECT_THAT(html, HasSubstr("more recordings are omitted"));
}

TEST(Drawing, HasAPlaceForEveryElementOfEveryPlant) {
  for (const PlantDescription& plant : all_plants()) {
    for (const ElementDescription& element : plant.elements) {
      const std::vector<mismatch::Location> location = {{element.name, 0.77, {}, ""}};
      const std::string svg = actuator_drawing(plant, location, {});
      EXPECT_THAT(svg, HasSubstr("77 %</text>")) << plant.name << ": " << element.name;
      EXPECT_THAT(svg, HasSubstr("class=\"hot\"")) << plant.name << ": " << element.name;
      EXPECT_EQ(what_is_wrong(svg), "") << plant.name;
    }
    EXPECT_THAT(actuator_drawing(plant, {}, {}), Not(HasSubstr("class=\"hot")));
  }
}

TEST(Drawing, OfAPlantWithoutAPictureIsAsWideAsItsBoxes) {
  PlantDescription cart;
  cart.name = "cart";
  for (const char* name : {"coil", "cart", "sensor:coil_current"})
    cart.elements.push_back({.name = name, .meaning = ""});
  const std::string svg = actuator_drawing(cart, {}, {"coil_current"});
  EXPECT_THAT(svg, HasSubstr("width=\"360.0\""));
  EXPECT_THAT(svg, HasSubstr(">coil current</text>"));
  EXPECT_EQ(what_is_wrong(svg), "");
}

TEST(Drawing, OutlinesWhatCannotBeToldApart) {
  const auto plant = find_plant("eha");
  ASSERT_TRUE(plant);
  const std::vector<mismatch::Location> location = {{"piston_seal", 0.6, {"pump"}, ""}};
  EXPECT_THAT(actuator_drawing(**plant, location, {}), HasSubstr("class=\"hot same\""));
}

}  // namespace
}  // namespace sealwatch::report
