// The blind trial's actuator: with nothing hidden it is the reference model, in other code; with an effect it is not.
#include <algorithm>
#include <cmath>
#include <set>

#include "services/verification/truth/trials.hpp"
#include "services/virtual_bench/closed_loop.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

EhaParameters<double> reference_parameters() {
  EhaParameters<double> p{};
  EhaParameters<double>::visit(
      [](std::string_view name, double& value) {
        if (const ParameterDescription* described = find_plant("eha").value()->find_parameter(name))
          value = described->value;
      },
      p);
  return p;
}

TEST(Truth, RatesAreThoseOfTheReferenceModel) {
  constexpr double kRounding = 1e-9;  // of the terms' size: the two add in another order
  const EhaParameters<double> p = reference_parameters();
  forecast::UniformRandom random(7);
  for (int k = 0; k < 500; ++k) {
    const TruthState y = {random.between(-50, 50),  random.between(-10, 10),     random.between(-250, 250),
                          random.between(5e5, 2e7), random.between(5e5, 2e7),    random.between(5e5, 2e7),
                          random.between(5e5, 2e7), random.between(-3e-3, 3e-3), random.between(0.01, 0.07)};
    const double command = random.between(-60, 60);
    const TruthState ours = truth_rates(y, command, {});
    const Eha::State<double> theirs = Eha::derivatives(y, Eha::Input{command}, p);
    const std::array<double, 9> size = {1e4, 1e4, 1e4, 1e9, 1e9, 1e8, 1e8, 1e3, 1e-3};
    for (std::size_t state = 0; state < y.size(); ++state)
      EXPECT_NEAR(ours[state], theirs[state], kRounding * (size[state] + std::abs(theirs[state]))) << state;
  }
}

TEST(Truth, AWholeTestIsThatOfTheReferenceModelButForTheIntegrationError) {
  const std::vector<std::string> channels = {"motor_voltage", "motor_current", "shaft_speed", "pressure_a",
                                             "pressure_b",    "flow",          "position",    "velocity"};
  const Profile profile = pst_profile({});
  std::vector<double> times;
  for (int k = 0; k <= 3100; ++k) times.push_back(0.01 * k);
  const ClosedLoop loop{.parameters = reference_parameters(),
                        .sensors = find_sensors(quiet_asset(), *find_plant("eha").value(), channels).value()};
  TruthTest test;
  for (const Sensor& sensor : loop.sensors)
    test.sensors.push_back({.channel = sensor.channel, .time_constant_s = sensor.setting.time_constant_s});
  const auto theirs = integrate(loop, profile, times);
  const auto ours = run_truth(test, profile, times);
  ASSERT_TRUE(theirs);
  ASSERT_TRUE(ours) << ours.error().describe();
  constexpr double kShareOfNoise = 0.1;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const ChannelDescription* channel = find_plant("eha").value()->find_channel(channels[c]);
    const double noise = channels[c] == "motor_voltage" ? 0.05 : channel->noise_std;
    double worst = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) worst = std::max(worst, std::abs((*ours)[c][k] - (*theirs)[c][k]));
    EXPECT_LT(worst, kShareOfNoise * noise) << channels[c];
  }
}

TEST(Truth, EveryEffectShowsWhenItIsLarge) {
  const Profile profile = pst_profile({});
  std::vector<double> times;
  for (int k = 0; k <= 3100; ++k) times.push_back(0.01 * k);
  TruthTest test;
  for (const char* channel : {"motor_voltage", "shaft_speed", "motor_current", "pressure_a", "pressure_b", "position"})
    test.sensors.push_back({.channel = channel});
  const std::vector<double> noise = {0.05, 0.5, 0.02, 1e4, 1e4, 5e-6};
  const auto nothing = run_truth(test, profile, times);
  ASSERT_TRUE(nothing);
  for (const auto group : {piston_effects(), hydraulic_effects(), electric_effects(), unlisted_effects()})
    for (const EffectForm& form : group) {
      HiddenEffect effect{.form = &form, .element = std::string(form.element), .size = form.largest};
      for (std::size_t k = 0; k < kShapes; ++k) effect.shape[k] = std::sqrt(form.shapes[k].min * form.shapes[k].max);
      test.effects = {effect};
      const auto values = run_truth(test, profile, times);
      ASSERT_TRUE(values) << form.id << " " << form.form << ": " << values.error().describe();
      double noncentrality = 0.0;  // of the difference in white noise
      for (std::size_t c = 0; c < noise.size(); ++c)
        for (std::size_t k = 0; k < times.size(); ++k)
          noncentrality += std::pow(((*values)[c][k] - (*nothing)[c][k]) / noise[c], 2);
      EXPECT_GT(noncentrality, 25.0) << form.id << " " << form.form;
    }
}

TEST(Truth, ALineTakesThePressureThatItsFlowCosts) {
  const TruthParameters p;
  const LineLoss line{.laminar = 2e10, .power = 3e15, .exponent = 2.0};
  for (const double port : {1.2e7, 1.05e7, 0.9e7}) {
    const double flow = truth_valve_flow(port, 1e7, 1e7, p, line);
    const double lost = line.laminar * flow + std::copysign(line.power * flow * flow, flow);
    const double drop = port - 1e7 - lost;
    EXPECT_NEAR(truth_valve_flow(1e7 + drop, 1e7, 1e7, p), flow, 1e-9 * std::abs(flow)) << port;
    EXPECT_LT(std::abs(flow), std::abs(truth_valve_flow(port, 1e7, 1e7, p)));
  }
}

TEST(Trials, AreMadeFromStratumAndSeedAlone) {
  const TrialPlan plan = plan_trial(TrialStratum::single, 3);
  EXPECT_EQ(plan.label(), plan_trial(TrialStratum::single, 3).label());
  EXPECT_NE(plan.label(), plan_trial(TrialStratum::single, 4).label());
  EXPECT_EQ(label_hash(TrialStratum::pair, 1, 20), label_hash(TrialStratum::pair, 1, 20));
  EXPECT_NE(label_hash(TrialStratum::pair, 1, 20), label_hash(TrialStratum::pair, 2, 20));
}

TEST(Trials, SinglesHoldEveryListedPlaceInEverySize) {
  std::map<std::string, std::set<int>> sizes;
  std::set<std::string> ids;
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    for (const TrialTruth& truth : plan_trial(TrialStratum::single, seed).truths()) {
      sizes[truth.id + " " + truth.form + " " + truth.element].insert(
          static_cast<int>(std::lround(std::log2(truth.times_barely))));
      ids.insert(truth.id);
    }
  EXPECT_EQ(ids.size(), 24U);  // the interface's list but for the three of sensors
  for (const auto& [place, steps] : sizes) EXPECT_GE(steps.size(), 4U) << place;
}

TEST(Trials, AWrongValueIsThePlantsAndNotTheDatasheets) {
  const AssetConfig datasheet = trial_asset();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const TrialPlan plan = plan_trial(TrialStratum::asset_file, seed);
    EXPECT_TRUE(plan.effects.empty() && plan.faults.empty());
    const ParameterSetting& setting = datasheet.parameters.at(plan.wrong_value.name);
    EXPECT_FALSE(setting.estimate) << plan.wrong_value.name;
    EXPECT_GE(std::abs(plan.wrong_value.share), 0.02);
    EXPECT_NE(plan.label().find(plan.wrong_value.name + " "), std::string::npos);
  }
  EXPECT_NEAR(plan_trial(TrialStratum::asset_file, 0).parameters.piston_area, 1.02 * TruthParameters{}.piston_area,
              1e-12);
}

TEST(Trials, ARecordMayErrOfWhatActed) {
  const auto first_of = [](TrialPlan plan, std::vector<SensorFault> faults) {
    plan.faults = std::move(faults);
    plan.noise.clear();
    plan.jitter = 0.0;
    plan.fit.resize(1);
    plan.holdout.clear();
    return record_trial(plan)->fit[0].samples;
  };
  const TrialPlan plan = plan_trial(TrialStratum::null, 11);
  const TimeSeries acted = first_of(plan, {});
  const TimeSeries recorded =
      first_of(plan, {{"input_gain", "motor_voltage", 0.02}, {"input_bias", "motor_voltage", 0.5}});
  const TimeSeries late = first_of(plan, {{"input_delay", "motor_voltage", 0.01}});
  const TimeSeries fast = first_of(plan, {{"clock_rate", "", 0.01}});
  const std::vector<double>& volts = acted.find("motor_voltage")->values;
  for (std::size_t row = 10; row + 10 < volts.size(); ++row) {
    EXPECT_NEAR(1.02 * recorded.find("motor_voltage")->values[row] + 0.5, volts[row], 1e-9) << row;
    EXPECT_NEAR(late.find("motor_voltage")->values[row], volts[row + 1], 1e-3) << row << ": it acts a sample later";
    EXPECT_DOUBLE_EQ(late.find("position")->values[row], acted.find("position")->values[row]);
    EXPECT_NEAR(fast.time_s[row], 1.01 * acted.time_s[row], 1e-12);
  }
  EXPECT_EQ(fast.find("position")->values, acted.find("position")->values);
}

TEST(Trials, ARecordingHasItsNoiseAndItsFault) {
  TrialPlan plan = plan_trial(TrialStratum::null, 11);
  plan.fit.resize(1);
  plan.holdout.clear();
  plan.jitter = 0.2;
  plan.noise = {{"pressure_a", {.standard_deviation = 1e4, .correlation = 0.6, .quantum = 0.0}},
                {"position", {.standard_deviation = 5e-6, .correlation = 0.0, .quantum = 1e-5}}};
  const auto noisy = record_trial(plan);
  plan.noise.clear();
  plan.faults = {{.kind = "sensor_bias", .channel = "shaft_speed", .size = 2.0}};
  const auto faulty = record_trial(plan);
  plan.faults.clear();
  const auto clean = record_trial(plan);
  ASSERT_TRUE(noisy && faulty && clean);
  const auto difference = [](const TrialRecordings& a, const TrialRecordings& b, const char* channel) {
    std::vector<double> out = a.fit[0].samples.find(channel)->values;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] -= b.fit[0].samples.find(channel)->values[k];
    return out;
  };
  const std::vector<double> error = difference(*noisy, *clean, "pressure_a");
  double lagged = 0.0, square = 0.0;
  for (std::size_t k = 1; k < error.size(); ++k) {
    lagged += error[k] * error[k - 1];
    square += error[k] * error[k];
  }
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(error.size())), 1e4, 1e3);
  EXPECT_NEAR(lagged / square, 0.6, 0.06);
  for (const double value : noisy->fit[0].samples.find("position")->values)
    EXPECT_NEAR(value / 1e-5, std::round(value / 1e-5), 1e-6);
  for (const double off : difference(*faulty, *clean, "shaft_speed")) EXPECT_NEAR(off, 2.0, 1e-9);
  const std::vector<double>& time = clean->fit[0].samples.time_s;
  for (std::size_t k = 1; k < time.size(); ++k) EXPECT_GT(time[k], time[k - 1]);
}

}  // namespace
}  // namespace sealwatch::bench
