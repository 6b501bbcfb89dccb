// A heater that switches at moments that its log does not have: what the estimates are off by is what their standard
// errors say, and where it switches with the samples the log is all that there is to know.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr double kCapacity = 18000.0, kLoss = 9.0, kAmbient = 293.15, kPower = 1000.0, kEvery_s = 60.0;

/// `own_name`: that of a course, with or without more behind it, so that each test has a plant of its own.
std::string heater(const std::string& own_name) {
  const std::string course = own_name.starts_with("held") ? "held" : "as_recorded";
  const std::string name = "heater_" + own_name, file = testing::TempDir() + name + ".yaml";
  std::ofstream(file) << "name: " << name << "\nmeaning: a heated block\ninputs:\n  power: {unit: W, course: " << course
                      << R"yaml(}
outputs:
  temperature: {value: T, unit: K}
parameters:
  C: {value: 15000.0, unit: J/K, estimate: true}
  h: {value: 10.0, unit: W/K, estimate: true}
  T_0: {value: 293.15, unit: K}
states:
  T: {der: (power - h*(T - T_0))/C, unit: K, start: temperature, size: 10.0}
)yaml";
  const auto plant = load_plant(file);
  EXPECT_TRUE(plant) << plant.error().front().describe();
  return name;
}

/// Six hours; the block's temperature is exact, with noise of 0.02 K.
TimeSeries log_of(unsigned seed, bool switches_with_samples) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> lasts(400.0, 1500.0);
  std::normal_distribution<double> noise(0.0, 0.02);
  constexpr int kSamples = 361;
  std::vector<double> switches = {0.0};
  while (switches.back() < kSamples * kEvery_s) {
    const double until = switches.back() + lasts(random);
    switches.push_back(switches_with_samples ? std::round(until / kEvery_s) * kEvery_s : until);
  }
  TimeSeries log;
  log.channels = {{"power", "W", 0.0, {}}, {"temperature", "K", 0.0, {}}};
  double temperature = kAmbient;
  std::size_t next = 1;
  for (int row = 0; row < kSamples; ++row) {
    const double now = row * kEvery_s;
    for (double t = std::max(0.0, now - kEvery_s); t < now;) {
      if (switches[next] <= t) ++next;
      const double until = std::min(now, switches[next]), rest = kAmbient + (next % 2 == 1 ? kPower : 0.0) / kLoss;
      temperature = rest + (temperature - rest) * std::exp(-kLoss / kCapacity * (until - t));
      t = until;
    }
    const auto begun = std::ranges::upper_bound(switches, now) - switches.begin();
    log.time_s.push_back(now);
    log.channels[0].values.push_back(begun % 2 == 1 ? kPower : 0.0);
    log.channels[1].values.push_back(temperature + noise(random));
  }
  return log;
}

struct Errors {
  double squares = 0.0, largest = 0.0;  ///< of the estimates, in their standard errors: mean square, largest
};

Errors errors_of(const std::string& plant, bool switches_with_samples) {
  constexpr unsigned kLogs = 12;
  Errors errors;
  for (unsigned seed = 1; seed <= kLogs; ++seed) {
    const TimeSeries log = log_of(seed, switches_with_samples);
    const JointFit fit = fit_actuator(nominal_asset(plant), {&log, 1}, {});
    for (const EstimatedParameter& parameter : fit.report.parameters) {
      if (parameter.name != "C" && parameter.name != "h") continue;
      const double error = (parameter.value - (parameter.name == "C" ? kCapacity : kLoss)) / parameter.std_error;
      errors.squares += error * error / (2.0 * kLogs);
      errors.largest = std::max(errors.largest, std::abs(error));
    }
  }
  return errors;
}

TEST(InputBetweenSamples, IsInTheStandardErrors) {
  const Errors errors = errors_of(heater("as_recorded"), false);
  EXPECT_LT(errors.largest, 3.5);
  EXPECT_LT(errors.squares, 1.7);  // 24 squares of 1, of which one is off by 2.4 times its spread
  EXPECT_GT(errors.squares, 0.4);
}

// A logger that writes one sample more than it should does not make a plant of hours step by quarters of a second.
TEST(InputBetweenSamples, OneShortDistanceDoesNotShortenAllSteps) {
  const std::string plant = heater("held_too");
  const auto steps = [&](const TimeSeries& log) {
    const auto simulation = PlantSimulation::create(nominal_asset(plant), log);
    const auto outputs = (*simulation)->run((*simulation)->start(), {});
    return outputs ? outputs->steps : 0;
  };
  TimeSeries log = log_of(1, true);
  const auto before = steps(log);
  log.time_s.insert(log.time_s.begin() + 100, log.time_s[100] - 0.5);
  for (Series& channel : log.channels) channel.values.insert(channel.values.begin() + 100, channel.values[100]);
  EXPECT_LT(steps(log), 2 * before);
}

// A slow log that was triggered: what the input did within the burst is not stepped over.
TEST(InputBetweenSamples, ABurstInASlowLogIsNotSteppedOver) {
  const std::string plant = heater("as_recorded_burst");
  TimeSeries log;
  log.channels = {{"power", "W", 0.0, {}}, {"temperature", "K", 0.02, {}}};
  double energy_J = 0.0;
  const auto add = [&](double t, double power) {
    if (!log.time_s.empty()) energy_J += 0.5 * (power + log.channels[0].values.back()) * (t - log.time_s.back());
    log.time_s.push_back(t);
    log.channels[0].values.push_back(power);
    log.channels[1].values.push_back(kAmbient);
  };
  for (int row = 0; row <= 60; ++row) add(60.0 * row, 0.0);
  for (int row = 1; row <= 40; ++row) add(3630.0 + 0.1 * row, row > 15 && row < 25 ? 1e5 : 0.0);
  for (int row = 61; row <= 63; ++row) add(60.0 * row, 0.0);
  const auto simulation = PlantSimulation::create(nominal_asset(plant), log);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {});
  ASSERT_TRUE(outputs) << outputs.error().describe();
  const double rise = outputs->values.col(outputs->values.cols() - 1).maxCoeff() - kAmbient;
  EXPECT_NEAR(rise, energy_J / 15000.0, 0.02 * energy_J / 15000.0);
}

TEST(InputBetweenSamples, IsNothingWhereItIsHeld) {
  const Errors errors = errors_of(heater("held"), true);
  EXPECT_LT(errors.largest, 3.5);
  EXPECT_LT(errors.squares, 1.7);
  EXPECT_GT(errors.squares, 0.4);
}

}  // namespace
}  // namespace sealwatch
