// The analysis ends when its time is up, with what it has, and at once when it is called off.
#include <gmock/gmock.h>

#include <array>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

AssetConfig with_a_leak() {
  AssetConfig truth = actuator();
  truth.physics.push_back({.id = "external_leakage",
                           .element = "chamber_a",
                           .parameters = {{"G", {.value = 1e-13, .min = 0.0, .max = 1e-10}}}});
  return truth;
}

std::shared_ptr<const FittedModel> fitted(const AssetConfig& asset, const Data& data) {
  return std::make_shared<const FittedModel>(fit_model(asset, data, nullptr, 2).value());
}

std::vector<Recording> two_tests() {
  const AssetConfig truth = with_a_leak();
  return {recording_of(truth, 0.8), recording_of(truth, 1.2)};
}

TEST(TimeLimit, TheReportSaysWhatWasNotAsked) {
  const auto found = explain(actuator(), two_tests(), {}, {.time_limit_s = 1e-6});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->verdict, Verdict::undetermined);
  EXPECT_THAT(found->not_asked, Not(IsEmpty()));
  EXPECT_THAT(found->summary, HasSubstr("time limit"));
  EXPECT_THAT(found->effects, IsEmpty());
  EXPECT_THAT(found->fit.channels, Not(IsEmpty())) << "what the model misses is told all the same";
}

// Also while the model is fitted again to what is known of its input.
TEST(TimeLimit, WhereverItCutsThereIsAReport) {
  std::vector<Recording> tests = two_tests();
  for (Recording& test : tests) test.samples.input_hold = false;
  for (double limit_s = 0.05; limit_s < 2.0; limit_s *= 1.35) {
    const auto found = explain(actuator(), tests, {}, {.time_limit_s = limit_s});
    ASSERT_TRUE(found) << limit_s << " s: " << found.error().describe();
    EXPECT_THAT(found->fit.channels, Not(IsEmpty())) << limit_s << " s";
  }
}

TEST(TimeLimit, WhereItCutsNothingItChangesNothing) {
  const std::vector<Recording> one(1, recording_of(with_a_leak(), 1.0));
  const auto limited = explain(actuator(), one, {}, {.maximum_laws = 1, .threads = 1, .time_limit_s = 1e6}),
             unlimited = explain(actuator(), one, {}, {.maximum_laws = 1, .threads = 2});
  ASSERT_TRUE(limited && unlimited);
  EXPECT_THAT(limited->not_asked, IsEmpty());
  EXPECT_EQ(limited->summary, unlimited->summary);
  EXPECT_EQ(limited->p_value, unlimited->p_value);
  ASSERT_THAT(limited->trace, SizeIs(unlimited->trace.size()));
  for (std::size_t k = 0; k < limited->trace.size(); ++k)
    EXPECT_EQ(limited->trace[k].score, unlimited->trace[k].score) << "step " << k;
}

TEST(TimeLimit, CalledOffInTheMiddleItEndsWithoutAnAnswer) {
  std::stop_source stop;
  std::size_t steps_after = 0;
  const auto found =
      explain(actuator(), two_tests(), {}, {.cancel = stop.get_token()}, [&](std::string_view step, double /*share*/) {
        steps_after += stop.stop_requested() ? 1 : 0;
        if (step == "screening all laws") stop.request_stop();
      });
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().describe(), HasSubstr("called off"));
  EXPECT_LE(steps_after, 3U) << "what follows finds its time over";
}

// A law that contains the right one was fitted first, and time was up before the plainer one was asked: it is asked in
// what is left of the time, or stands beside the claim.
TEST(TimeLimit, APlainerLawIsAskedBeforeARicherOneIsClaimed) {
  AssetConfig truth = actuator();
  truth.physics.push_back({.id = "coulomb_friction",
                           .element = "piston",
                           .parameters = {{"F_c", {.value = 900.0, .min = 0.0, .max = 1e5}},
                                          {"v_s", {.value = 1e-5, .min = 1e-7, .max = 1e-3}}}});
  const std::vector<Recording> recordings = {recording_of(truth, 0.8), recording_of(truth, 1.2)};
  Data data = data_of(recordings);
  Deadline deadline;
  data.deadline = &deadline;
  const auto fitted = [&](const AssetConfig& asset) {
    auto model = fit_model(asset, data, nullptr, 2);
    if (!model) ADD_FAILURE() << model.error().describe();
    return std::make_shared<const FittedModel>(std::move(model).value());
  };
  const Law* rich = find_law("stribeck_friction", {"F_c", "F_x", "v_s", "v_st"}).value();
  Naming naming{.baseline = fitted(actuator()), .best = {}, .trials = {}, .first = {}, .last = {}};
  naming.best = {{{rich, "piston"}}, fitted(with_law(actuator(), *rich, "piston", std::array{900.0, 0.0, 2e-4, 1e-5}))};
  naming.first = screen(*naming.baseline, data, {}).value();
  deadline.set_in(-1.0);
  settle(naming, data, {});
  EXPECT_FALSE(naming.settled);
  EXPECT_THAT(naming.not_asked, SizeIs(1));
  const auto effects = describe_effects(naming, naming.best, data, {}, nullptr);
  ASSERT_THAT(effects, SizeIs(1));
  EXPECT_THAT(effects.front().indistinguishable, testing::Contains(testing::Field(&LawAt::id, "coulomb_friction")));
  EXPECT_LE(effects.front().probability, 0.5);
  deadline.set_in(1e6);
  settle(naming, data, {});
  EXPECT_TRUE(naming.settled);
  EXPECT_THAT(naming.not_asked, IsEmpty());
  ASSERT_THAT(naming.best.effects, SizeIs(1));
  EXPECT_EQ(naming.best.effects.front().law->id, "coulomb_friction");
}

// The right law was fitted, and time was up before what it leaves was looked at.
TEST(TimeLimit, ALawThatWasFittedIsKept) {
  const std::vector<Recording> recordings = two_tests();
  Data data = data_of(recordings);
  Deadline deadline;
  data.deadline = &deadline;
  AssetConfig leaking = with_a_leak();
  leaking.physics.front().parameters.at("G").estimate = true;
  const Trial law{{{find_law("external_leakage", {"G"}).value(), "chamber_a"}}, fitted(leaking, data)};
  Naming naming{.baseline = fitted(actuator(), data), .best = {}, .trials = {}, .first = {}, .last = {}};
  naming.best = {{}, naming.baseline};
  ASSERT_LT(law.model->misfit, 0.1 * naming.baseline->misfit);
  deadline.set_in(-1.0);
  EXPECT_TRUE(take(naming, law, data, {}));
  EXPECT_THAT(naming.best.effects, SizeIs(1));
  EXPECT_THAT(naming.not_asked, SizeIs(1));
  EXPECT_THAT(naming.remarks, IsEmpty());
}

// It is asked again beside a value of the asset file, and time is up: that is no search which found nothing.
TEST(TimeLimit, WhatWasFoundBesideAValueIsNotLost) {
  const std::vector<Recording> recordings = two_tests();
  Data data = data_of(recordings);
  Deadline deadline;
  data.deadline = &deadline;
  data.fixed = {{.name = "A_C", .value = actuator().parameters.at("A_C").value, .standard_deviation = 1e-5}};
  const auto baseline = fitted(actuator(), data);
  AssetConfig leaking = with_free_value(with_a_leak(), "A_C");
  leaking.physics.front().parameters.at("G").estimate = true;
  const Trial found{{{find_law("external_leakage", {"G"}).value(), "chamber_a"}}, fitted(leaking, data)};
  const KnownOfBaseline known{screen(*baseline, data, {}).value()};
  deadline.set_in(-1.0);
  EXPECT_FALSE(name_effects(baseline, data, {}, {}, found, &known));
}

// The search sets out from a law that fits, and time is up while it looks at what that leaves.
TEST(TimeLimit, WhatASearchSetsOutFromIsNotLost) {
  const std::vector<Recording> recordings = two_tests();
  Data data = data_of(recordings);
  Deadline deadline;
  data.deadline = &deadline;
  const auto baseline = fitted(actuator(), data);
  AssetConfig leaking = with_a_leak();
  leaking.physics.front().parameters.at("G").estimate = true;
  const Trial found{{{find_law("external_leakage", {"G"}).value(), "chamber_a"}}, fitted(leaking, data)};
  const KnownOfBaseline known{screen(*baseline, data, {}).value()};
  deadline.set_in(1e-2);  // the screening takes longer, what is before it does not
  const auto naming = name_effects(baseline, data, {}, {}, found, &known);
  ASSERT_TRUE(naming) << naming.error().describe();
  EXPECT_THAT(naming->best.effects, SizeIs(1));
  EXPECT_THAT(naming->not_asked, SizeIs(1));
}

TEST(TimeLimit, ASimulationThatRunsIsEnded) {
  const Recording recording = recording_of(actuator(), 1.0);
  const auto simulation = PlantSimulation::create(actuator(), recording.samples).value();
  Deadline deadline;
  EXPECT_TRUE(simulation->run(simulation->start(), {}, {.deadline = &deadline}));
  EXPECT_FALSE(deadline.was_met());
  deadline.set_in(-1.0);
  const auto cut = simulation->run(simulation->start(), {}, {.deadline = &deadline});
  ASSERT_FALSE(cut);
  EXPECT_THAT(cut.error().describe(), HasSubstr("time was up"));
  EXPECT_TRUE(deadline.was_met());
}

}  // namespace
}  // namespace sealwatch::mismatch
