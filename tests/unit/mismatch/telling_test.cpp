#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/remarks.hpp"

namespace sealwatch::mismatch {
namespace {

TEST(Summary, NamesWhichLawCannotBeToldFromWhich) {
  Explanation found;
  found.verdict = Verdict::mismatch;
  found.statistically_significant = true;
  FoundEffect load, friction;
  load.what = {"position_dependent_load", "", "piston", "k_q (x - x_q)^2", ""};
  load.indistinguishable = {{"position_dependent_load", "edge", "piston", "k_q |x - x_q|", ""}};
  friction.what = {"coulomb_friction", "", "piston", "F_c tanh(v / v_s)", ""};
  friction.indistinguishable = {{"presliding_friction", "", "piston", "sigma_0 z", ""}};
  found.effects = {load, friction};
  const std::string text = summary_of(found);
  EXPECT_NE(
      text.find("cannot distinguish position-dependent load at the piston from another form of it (k_q |x - x_q|)."),
      std::string::npos)
      << text;
  EXPECT_NE(
      text.find("Nor can they distinguish Coulomb friction at the piston from presliding friction at the piston."),
      std::string::npos)
      << text;
}

TEST(Summary, ShowsTheChannelThatImproved) {
  Explanation found;
  found.verdict = Verdict::mismatch;
  found.effects.resize(1);
  found.effects[0].what = {"sensor_bias", "", "sensor:position", "b", ""};
  found.holdout.channels = {{.channel = "motor_current", .rms_before = 1.03, .rms_after = 1.03},
                            {.channel = "pressure_a", .rms_before = 1.02, .rms_after = 0.98}};
  EXPECT_NE(summary_of(found).find("the misfit of pressure A on held-out recordings falls from 1.02 to 0.98"),
            std::string::npos)
      << summary_of(found);
}

TEST(Summary, SaysOfASensorThatTheRecordingsShowIt) {
  Explanation found;
  found.verdict = Verdict::mismatch;
  found.effects.resize(1);
  found.effects[0].what = {"sensor_gain", "", "sensor:pressure_a", "g y", ""};
  EXPECT_EQ(summary_of(found).find("The recordings show sensor gain of pressure A."), 0U) << summary_of(found);
  found.effects.resize(2);
  found.effects[1].what = {"coulomb_friction", "", "piston", "F_c tanh(v / v_s)", ""};
  EXPECT_EQ(
      summary_of(found).find("The simulation lacks Coulomb friction at the piston, and the recordings show sensor "
                             "gain of pressure A."),
      0U)
      << summary_of(found);
}

TEST(NextTest, SpeaksOfStrokesWhereThePlantHasThem) {
  Explanation found;
  found.verdict = Verdict::undetermined;
  found.statistically_significant = true;
  found.fit_recordings = {"one", "two"};
  found.model = "eha";
  EXPECT_NE(next_test_of(found).find("loads and speeds"), std::string::npos) << next_test_of(found);
  found.model = "cascaded_tanks";
  for (const bool significant : {true, false})
    for (const std::size_t recordings : {1, 2}) {
      found.statistically_significant = significant;
      found.fit_recordings.resize(recordings);
      for (const char* word : {"load", "ramp", "stroke"})
        EXPECT_EQ(next_test_of(found).find(word), std::string::npos) << next_test_of(found);
    }
}

TEST(Location, OfAnElementIsWhereItComesNearest) {
  FoundEffect overflow, saturation;
  overflow.what.element = "upper_outlet";
  overflow.probability = saturation.probability = 0.65;
  saturation.what.element = "sensor:level_voltage";
  overflow.alternatives = {
      {.what = {"tank_overflow", "", "lower_tank", "", ""}, .misfit_above_best = 60.0, .why_not = ""}};
  saturation.alternatives = {
      {.what = {"tank_overflow", "", "lower_tank", "", ""}, .misfit_above_best = 1.2, .why_not = ""}};
  const std::vector<Location> places = locate({overflow, saturation});
  const auto lower = std::ranges::find(places, "lower_tank", &Location::element);
  ASSERT_NE(lower, places.end());
  EXPECT_NEAR(lower->probability, 0.65 * std::exp(-0.6), 1e-9);
}

TEST(Evidence, OfSeveralLawsIsSaidOfAllTogether) {
  FoundEffect drag;
  drag.what = {"quadratic_drag", "", "piston", "k v abs(v)", ""};
  EXPECT_EQ(evidence_of(drag, 1, 12.0, 1.02).find("Adding quadratic drag at the piston takes"), 0U);
  EXPECT_EQ(evidence_of(drag, 2, 12.0, 1.02).find("With the other laws found, quadratic drag at the piston takes"), 0U);
}

TEST(Summary, SaysWhatTheInputMayHide) {
  Explanation found;
  found.verdict = Verdict::consistent;
  found.fit.channels = {{.channel = "motor_current", .rms_before = 1.6, .weighed_rms_after = 1.0},
                        {.channel = "pressure_a", .rms_before = 1.02, .weighed_rms_after = 1.0}};
  EXPECT_NE(summary_of(found).find("may account for the misfit of motor current (1.60 times the noise)"),
            std::string::npos)
      << summary_of(found);
  found.fit.channels.front().weighed_rms_after = 1.6;
  EXPECT_EQ(summary_of(found).find("input"), std::string::npos)
      << "samples that count miss as much: " << summary_of(found);
  found.fit.channels.front() = {.channel = "motor_current", .rms_before = 1.03, .weighed_rms_after = 1.0};
  EXPECT_EQ(summary_of(found).find("input"), std::string::npos) << summary_of(found);
}

TEST(Summary, SaysWhereMuchIsLeft) {
  Explanation found;
  found.verdict = Verdict::mismatch;
  found.effects.emplace_back().what = {"coulomb_friction", "", "piston", "F_c tanh(v/v_s)", ""};
  ChannelComparison& position = found.holdout.channels.emplace_back();
  position.channel = "position";
  position.rms_before = 9000.0;
  position.rms_after = position.weighed_rms_after = 1700.0;
  EXPECT_NE(summary_of(found).find("A part remains unexplained: position still misses by 1700 times the noise."),
            std::string::npos)
      << summary_of(found);
  position.rms_after = position.weighed_rms_after = 1.02;
  EXPECT_EQ(summary_of(found).find("Not all"), std::string::npos);
  position.rms_after = 14.5;  // of the samples that count next to nothing is left
  EXPECT_NE(summary_of(found).find("What the input did between samples may account for the rest: position still "
                                   "misses by 14.5 times the noise"),
            std::string::npos)
      << summary_of(found);
}

TEST(FarthestOff, IsAChannelOfWhichLessThanHalfIsReproducedFarAboveTheNoise) {
  const auto channel = [](const char* name, double rms, double nrmse) {
    ChannelComparison one;
    one.channel = name;
    one.rms_after = rms;
    one.nrmse_after = nrmse;
    return one;
  };
  PooledFit fit;
  fit.channels = {channel("flow", 200.0, 60.0), channel("velocity", 2.0, 10.0)};
  EXPECT_EQ(farthest_off(fit), nullptr) << "a course that is there, and one that drowns in its noise";
  fit.channels.push_back(channel("pressure_a", 30.0, 40.0));
  fit.channels.push_back(channel("position", 7000.0, -550.0));
  ASSERT_NE(farthest_off(fit), nullptr);
  EXPECT_EQ(farthest_off(fit)->channel, "position");
}

TEST(Remarks, APlantWithoutSitesIsSaidToBeAskedForNoPhysics) {
  PlantDescription unit, text;
  unit.hides_states = true;
  EXPECT_FALSE(asks_within(unit));
  Explanation found;
  found.statistically_significant = true;
  found.next_test = "Record further tests.";
  remark_nothing_asked_within(unit, false, found);
  EXPECT_NE(found.summary.find("Co-Simulation"), std::string::npos) << found.summary;
  EXPECT_EQ(found.next_test.find("Export the unit for Model Exchange"), 0U) << found.next_test;
  found.next_test = "Check this value in the asset file first.";
  remark_nothing_asked_within(text, true, found);
  EXPECT_EQ(found.next_test.find("Check this value"), 0U) << found.next_test;
  EXPECT_NE(found.next_test.find("Add elements with sites"), std::string::npos) << found.next_test;
  ASSERT_EQ(found.notes.size(), 2U);
}

TEST(Remarks, WhereNothingDiffersTheyAreANoteAlone) {
  Explanation found;
  remark_nothing_asked_within({}, false, found);
  EXPECT_EQ(found.notes.size(), 1U);
  EXPECT_TRUE(found.summary.empty()) << found.summary;
  EXPECT_TRUE(found.next_test.empty()) << found.next_test;
}

}  // namespace
}  // namespace sealwatch::mismatch
