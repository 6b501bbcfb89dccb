#include "services/health_assessment/ambiguity.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "sealwatch/model/plant_description.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Deviation of `d` advisory widths about a baseline of 100 with a width of 10.
Deviation off_by(const std::string& quantity, double d) {
  RegionJudgement judgement;
  judgement.quantity = quantity;
  judgement.reference = Reference::own_baseline;
  judgement.value = 100 + 10 * d;
  const double side = d < 0 ? -10 : 10;
  judgement.advisory_limit = 100 + side;
  judgement.warning_limit = 100 + 2 * side;
  judgement.alarm_limit = 100 + 3 * side;
  return {judgement, 10.0, d, true};
}

const std::vector<Signature> kTwo = {{FaultKind::friction, "piston", false, {{"friction_pressure", 1.0}}},
                                     {FaultKind::load, "piston", true, {{"load_pressure", 1.0}}}};

double sum_of(const AmbiguityGroup& group) {
  double sum = group.no_fault_likelihood;
  for (const ProposedFault& fault : group.faults) sum += fault.likelihood;
  return sum;
}

TEST(Ambiguity, WithoutDeviationThereIsNoFault) {
  const auto group = find_ambiguity_group({off_by("friction_pressure", 0.1), off_by("load_pressure", -0.1)}, kTwo, {});
  EXPECT_GT(group.no_fault_likelihood, 0.98);
}

TEST(Ambiguity, LikelihoodsAddUpToOne) {
  for (const double d : {-3.0, -1.0, 0.0, 0.5, 1.0, 1.5, 4.0})
    for (const double e : {-2.0, 0.0, 1.2})
      EXPECT_NEAR(sum_of(find_ambiguity_group({off_by("friction_pressure", d), off_by("load_pressure", e)}, kTwo, {})),
                  1.0, 1e-12);
}

TEST(Ambiguity, AFaultOfOneSignDoesNotExplainTheOther) {
  const auto less = find_ambiguity_group({off_by("friction_pressure", -3), off_by("load_pressure", 0)}, kTwo, {});
  EXPECT_GT(less.no_fault_likelihood, 0.98);
  const auto lighter = find_ambiguity_group({off_by("friction_pressure", 0), off_by("load_pressure", -3)}, kTwo, {});
  ASSERT_FALSE(lighter.faults.empty());
  EXPECT_EQ(lighter.faults.front().kind, FaultKind::load);
  EXPECT_GT(lighter.faults.front().likelihood, 0.95);
}

TEST(Ambiguity, TwoFaultsAtOnceAreBothProposed) {
  const auto group = find_ambiguity_group({off_by("friction_pressure", 2), off_by("load_pressure", 2)}, kTwo, {});
  ASSERT_EQ(group.faults.size(), 2U);
  EXPECT_NEAR(group.faults[0].likelihood, 0.5, 0.01);
  EXPECT_NEAR(group.faults[1].likelihood, 0.5, 0.01);
  EXPECT_LT(group.no_fault_likelihood, 0.01);
}

TEST(Ambiguity, TheSameSignatureSharesTheLikelihoodAndSaysSo) {
  const std::vector<Signature> same = {{FaultKind::driver, "driver", false, {{"back_emf", 1.0}}},
                                       {FaultKind::sensor, "sensor:motor_voltage", true, {{"back_emf", 1.0}}}};
  const auto group = find_ambiguity_group({off_by("back_emf", 2)}, same, {});
  ASSERT_EQ(group.faults.size(), 2U);
  EXPECT_NEAR(group.faults[0].likelihood, group.faults[1].likelihood, 1e-12);
  EXPECT_THAT(group.faults[0].evidence, Contains(HasSubstr("cannot be told apart")));
}

TEST(Ambiguity, EvidenceHasNumbersAndWhatSeparates) {
  const auto group = find_ambiguity_group({off_by("friction_pressure", 1.2), off_by("load_pressure", 1.2)}, kTwo, {});
  ASSERT_FALSE(group.faults.empty());
  EXPECT_THAT(group.faults[0].evidence, Contains(HasSubstr("advisory above 110")));
  EXPECT_THAT(group.faults[0].evidence, Contains(HasSubstr("told apart from")));
}

TEST(Ambiguity, AFailedChannelIsASuspectWithoutAnySignature) {
  const auto signatures = fault_signatures(synthetic::asset(), {}, {}, {"sensor:fluid_temperature"});
  ASSERT_EQ(signatures.size(), 1U);
  const auto group = find_ambiguity_group({}, signatures, {{"sensor:fluid_temperature", {8.0, "FAILED"}}});
  ASSERT_EQ(group.faults.size(), 1U);
  EXPECT_NEAR(group.faults[0].likelihood, 1.0 / (1.0 + std::exp(-2.0)), 1e-12);
  EXPECT_EQ(group.faults[0].iso14224_code, "AIR");
}

// By roles and sites: no plant is told of a pump that it does not have.
TEST(Ambiguity, FaultsAreThoseOfThePlant) {
  for (const PlantDescription& plant : all_plants()) {
    AssetConfig asset;
    asset.model = plant.name;
    std::set<std::string> channels, kinds;
    for (const ChannelDescription& channel : plant.channels) channels.insert(channel.name);
    for (const Signature& signature : fault_signatures(asset, {}, channels, {}, true)) {
      EXPECT_NE(std::ranges::find(plant.elements, signature.element, &ElementDescription::name), plant.elements.end())
          << plant.name << " has no " << signature.element;
      kinds.insert(std::string(name_of(signature.kind)));
    }
    if (plant.name == "eha") {
      EXPECT_EQ(kinds, (std::set<std::string>{"internal_leakage", "friction", "pump", "load", "driver"}));
    }
    if (plant.name == "cascaded_tanks") {
      EXPECT_TRUE(kinds.empty() || kinds == std::set<std::string>{"driver"});
    }
  }
}

TEST(Deviation, CentreAndWidthComeFromTheLimits) {
  StateReport report;
  RegionJudgement seal{"leakage_resistance",  Reference::limit,    "Pa s/m3", 8e12, 1e13, 7e12, 4e12,
                       AlertRegion::advisory, AlertRegion::normal, 1};
  report.judgements = {seal};
  EXPECT_NEAR(deviations_of(report).front().value, -5.0 / 3.0, 1e-12);
  report.judgements.front().value = 2e13;  // better than the limits' centre
  EXPECT_EQ(deviations_of(report).front().value, 0.0);
  EXPECT_FALSE(deviations_of(report).front().informative);
}

}  // namespace
}  // namespace sealwatch
