// Which of the laws found are claimed: those that help on recordings that took no part, and that are more than what a
// sensor may be off by, or takes up of what is missing elsewhere.
#include "services/common/mismatch/proven_laws.hpp"

#include <gmock/gmock.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

struct Found {
  std::string law, element, strength;
  double value = 0.0;
};

PhysicsTerm term(const Found& law, bool estimate) {
  return {.id = law.law,
          .element = law.element,
          .parameters = {{law.strength, {.value = law.value, .min = -1e6, .max = 1e6, .estimate = estimate}}}};
}

constexpr const char* kSpeedSensor = "sensor:shaft_speed";
const Found kLeak{"external_leakage", "chamber_a", "G", 1e-13};
const Found kDrag{"quadratic_drag", "piston", "k", 3e8};

// The laws of the plant that is recorded; those of the explanation, in this order; and the proof of it.
struct Case {
  std::vector<Found> truth;
  std::vector<Found> explanation;
  bool fitted = true;  ///< the explanation's strengths, or as they are given
  double left_p_value = 1.0;

  ProvenLaws proof(const std::vector<std::string>& inexact_sensors = {}) const {
    AssetConfig plant = actuator(), asset = actuator();
    for (const Found& law : truth) plant.physics.push_back(term(law, false));
    std::vector<Effect> effects;
    for (const Found& law : explanation) {
      asset.physics.push_back(term(law, fitted));
      effects.push_back({find_law(law.law, {law.strength}).value(), law.element});
    }
    const std::vector<Recording> fitted_tests = {recording_of(plant, 0.8), recording_of(plant, 1.2)},
                                 others = {recording_of(plant, 1.0)};
    const Data fit = data_of(fitted_tests), held_out = data_of(others);
    const auto fitted_model = [&](const AssetConfig& of) {
      return std::make_shared<const FittedModel>(fit_model(of, fit, nullptr, 2).value());
    };
    Naming naming{.baseline = fitted_model(actuator()), .best = {}, .trials = {}, .first = {}, .last = {}};
    naming.best = {effects, fitted_model(asset)};
    naming.last.p_value = left_p_value;
    const ExplainOptions options;
    ToProve of{{fit, held_out, 0.0, options}, naming, naming.baseline};
    for (const KnownValue& sensor : known_sensors(asset, naming.baseline->problem))
      if (std::ranges::find(inexact_sensors, sensor.name) != inexact_sensors.end()) of.sensors.push_back(sensor);
    TimeBudget time(1e6, {});
    return prove(of, naming.best, time);
  }
};

std::vector<std::string> laws_of(const ProvenLaws& proven) {
  std::vector<std::string> laws;
  for (const Effect& effect : proven.best.effects) laws.emplace_back(effect.law->id);
  return laws;
}

TEST(ProvenLaws, LawsThatHelpAreClaimed) {
  const ProvenLaws proven = Case{.truth = {kLeak, kDrag}, .explanation = {kDrag, kLeak}}.proof();
  EXPECT_TRUE(proven.proven);
  EXPECT_THAT(laws_of(proven), ElementsAre("quadratic_drag", "external_leakage"));
}

// It stands before one that helps, and was never asked for that.
TEST(ProvenLaws, OneThatMakesItWorseIsTakenBackWhereverItStands) {
  const Case both{.truth = {kLeak}, .explanation = {kDrag, kLeak}, .fitted = false};
  const ProvenLaws proven = both.proof();
  EXPECT_TRUE(proven.proven);
  EXPECT_THAT(laws_of(proven), ElementsAre("external_leakage"));
  EXPECT_THAT(proven.notes, ElementsAre(HasSubstr("quadratic drag at the piston) does not improve")));
}

TEST(ProvenLaws, ASensorWithinItsToleranceIsNoFault) {
  const Found bias{"sensor_bias", kSpeedSensor, "b", 0.3};
  const Case both{.truth = {kLeak, bias}, .explanation = {kLeak, bias}};
  EXPECT_THAT(laws_of(both.proof()), ElementsAre("external_leakage", "sensor_bias")) << "where sensors are exact";
  const ProvenLaws proven = both.proof({sensor_offset_name("shaft_speed")});
  EXPECT_THAT(laws_of(proven), ElementsAre("external_leakage"));
  EXPECT_THAT(proven.notes, ElementsAre(HasSubstr("within that sensor's tolerance")));
}

// Drag is not among the laws found, and a sensor's zero takes up some of what it leaves.
TEST(ProvenLaws, ASensorThatTakesUpLittleOfWhatIsMissingIsNotClaimed) {
  const Found bias{"sensor_bias", "sensor:pressure_a", "b", 1e3};
  Case both{.truth = {kLeak, kDrag}, .explanation = {kLeak, bias}, .left_p_value = 1e-9};
  const ProvenLaws proven = both.proof();
  EXPECT_THAT(laws_of(proven), ElementsAre("external_leakage"));
  EXPECT_THAT(proven.notes, Contains(HasSubstr("takes up some of whatever is missing")));
}

}  // namespace
}  // namespace sealwatch::mismatch
