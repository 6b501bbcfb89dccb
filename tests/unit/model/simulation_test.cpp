// What a simulation makes of a recording: quasi-steady start, held and coarse inputs, sensors' filters, errors, and the
// port Simulator, which estimates the load and the initial state.
#include "sealwatch/model/simulation.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <set>
#include <thread>

#include "services/common/model/model_simulator.hpp"
#include "services/common/model/plants/eha/model.hpp"
#include "services/common/model/recorded_input.hpp"
#include "services/common/model/sensor_filter.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch {
namespace {

std::unique_ptr<PlantSimulation> simulation_of(const AssetConfig& asset, const TimeSeries& recorded) {
  auto simulation = PlantSimulation::create(asset, recorded);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  return std::move(*simulation);
}

SimulatedOutputs run(const PlantSimulation& simulation, const ModelValues& values) {
  auto outputs = simulation.run(values, {});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  return std::move(*outputs);
}

Eigen::Index column(const PlantSimulation& simulation, const std::string& channel) {
  const auto names = simulation.channels();
  return std::find(names.begin(), names.end(), channel) - names.begin();
}

TEST(Simulation, StartsAtRestAndFollowsThePst) {
  const AssetConfig asset = nominal_asset("eha");
  const auto simulation = simulation_of(asset, standard_pst(asset));
  ModelValues values = simulation->start();
  values.load_factor = 0.0;
  const auto outputs = run(*simulation, values);
  const auto channel = [&](const char* name) { return outputs.values.col(column(*simulation, name)); };
  EXPECT_NEAR(channel("position")(0), 0.060, 1e-12);
  EXPECT_NEAR(channel("position").minCoeff(), 0.044, 1.5e-3) << "16 mm, driven open loop";
  EXPECT_NEAR(channel("velocity")(7 * 200), -1.33e-3, 1.5e-4);
  EXPECT_NEAR(channel("motor_current")(0), channel("motor_current")(100), 0.05) << "no transient before the test";
  const double dp = channel("pressure_a")(100) - channel("pressure_b")(100);
  EXPECT_NEAR(dp * asset.parameter("A_C"), asset.parameter("phi"), 0.01 * asset.parameter("phi"));
}

/// A winding of little resistance swings with the shaft and dies away slowly. Steps that would follow it ran out.
TEST(Simulation, StartsAtRestWhereWhatSettlesSwings) {
  AssetConfig asset = nominal_asset("eha");
  for (const double resistance_ohm : {0.05, 0.1045, 0.2}) {
    asset.parameters.at("R_M").value = resistance_ohm;
    const auto simulation = simulation_of(asset, standard_pst(asset, 200.0, 2.0));
    const auto outputs = simulation->run(simulation->start(), {});
    EXPECT_TRUE(outputs) << resistance_ohm << ": " << (outputs ? "" : outputs.error().describe());
  }
}

/// With a constant pressure in chamber B, x was 0.1 mm off from where the piston turned back, and 18 um where oil
/// that filled a port came from nowhere.
TEST(Simulation, ByTheFlowAloneFollowsThePressureOfTheOtherChamber) {
  const AssetConfig asset = nominal_asset("eha");
  const TimeSeries driven = standard_pst(asset);
  const auto whole = simulation_of(asset, driven);
  ModelValues values = whole->start();
  const SimulatedOutputs truth = run(*whole, values);
  TimeSeries recorded{.time_s = driven.time_s, .channels = {}};
  for (const char* channel : {"flow", "position", "velocity"}) {
    const Eigen::VectorXd of = truth.values.col(column(*whole, channel));
    recorded.channels.push_back(
        {channel, find_plant("eha").value()->find_channel(channel)->unit, 0.0, {of.begin(), of.end()}});
  }
  const Eigen::VectorXd difference =
      truth.values.col(column(*whole, "pressure_a")) - truth.values.col(column(*whole, "pressure_b"));
  recorded.channels.push_back({"pressure_differential", "Pa", 0.0, {difference.begin(), difference.end()}});

  const auto part = simulation_of(asset, recorded);
  ModelValues start = part->start();
  start.load_factor = values.load_factor;
  const SimulatedOutputs outputs = run(*part, start);
  const Eigen::VectorXd position = outputs.values.col(column(*part, "position"));
  const Eigen::VectorXd off = position - truth.values.col(column(*whole, "position"));
  EXPECT_LT(off.segment(400, 2000).cwiseAbs().maxCoeff(), 20e-6) << "on the way, from a second after it set out";
  EXPECT_LT(off.tail(400).cwiseAbs().maxCoeff(), 4e-6);
}

TEST(Simulation, TakesTheInputAsHeldWhenTheRecordingSaysSo) {
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries linear = standard_pst(asset, 200.0, 3.0), held = linear, shifted = linear;
  held.input_hold = true;
  // A held input lags the linear one by half a sample: the piston moves later by just that.
  auto& u = shifted.channels.front().values;
  for (std::size_t k = u.size() - 1; k > 0; --k) u[k] = 0.5 * (u[k] + u[k - 1]);
  const auto position_of = [&](const TimeSeries& samples) {
    const auto simulation = simulation_of(asset, samples);
    const auto outputs = run(*simulation, simulation->start());
    return Eigen::VectorXd(outputs.values.col(column(*simulation, "position")));
  };
  const Eigen::VectorXd at_linear = position_of(linear), at_held = position_of(held), at_shifted = position_of(shifted);
  constexpr double kResolved_m = 2e-7;  // the held input's saw-tooth moves the piston by less
  EXPECT_GT((at_held - at_linear).cwiseAbs().maxCoeff(), 5.0 * kResolved_m);
  EXPECT_LT((at_held - at_shifted).cwiseAbs().maxCoeff(), kResolved_m);
}

TEST(Simulation, DoesNotDependOnTheRecordingsRateOrGaps) {
  const AssetConfig asset = nominal_asset("eha");
  const TimeSeries fine = standard_pst(asset, 200.0, 20.0);
  TimeSeries gappy = fine;
  for (Series& series : gappy.channels) series.values.clear();
  gappy.time_s.clear();
  std::vector<std::size_t> kept;
  for (std::size_t row = 0; row < fine.time_s.size(); ++row) {
    const double t = fine.time_s[row];
    if (row % 4 != 0 && !(t > 0.8 && t < 1.4)) continue;  // 50 Hz, but for the corner that a coarse input cannot show
    if (t > 5.0 && t < 5.5 && row % 20 != 0) continue;
    kept.push_back(row);
    gappy.time_s.push_back(t);
    for (std::size_t c = 0; c < fine.channels.size(); ++c)
      gappy.channels[c].values.push_back(fine.channels[c].values[row]);
  }
  const auto one = simulation_of(asset, fine), other = simulation_of(asset, gappy);
  const auto a = run(*one, one->start());
  ModelValues values = one->start();
  const auto b = run(*other, values);
  for (const char* name : {"pressure_a", "position", "velocity", "flow"}) {
    const double sigma = asset.sensors.at(name).noise_std;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const double time = gappy.time_s[k];
      if (time > 12.9) break;
      EXPECT_NEAR(a.values(static_cast<Eigen::Index>(kept[k]), column(*one, name)),
                  b.values(static_cast<Eigen::Index>(k), column(*other, name)), 0.3 * sigma)
          << name << " at " << time;
    }
  }
}

// A logger that loses rows does not say what the input was held at meanwhile: as it was moving, on the line between.
TEST(Simulation, TakesAHeldInputAlongTheLineWhereRowsWereLost) {
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries all = standard_pst(asset, 100.0, 8.0);
  all.input_hold = true;
  std::vector<double>& voltage = all.channels.front().values;
  for (std::size_t row = 0; row < voltage.size(); ++row)
    voltage[row] = voltage.front() - 2.0 * std::sin(std::numbers::pi * all.time_s[row]);  // V
  TimeSeries lost{.time_s = {}, .channels = all.channels, .input_hold = true};
  for (Series& series : lost.channels) series.values.clear();
  std::vector<Eigen::Index> kept;
  for (std::size_t row = 0; row < all.time_s.size(); ++row) {
    if (row == 200 || row == 305 || row == 306) continue;  // where it is fastest, and beside
    kept.push_back(static_cast<Eigen::Index>(row));
    lost.time_s.push_back(all.time_s[row]);
    for (std::size_t c = 0; c < all.channels.size(); ++c)
      lost.channels[c].values.push_back(all.channels[c].values[row]);
  }
  const auto whole = simulation_of(asset, all), gappy = simulation_of(asset, lost);
  const auto a = run(*whole, whole->start()), b = run(*gappy, gappy->start());
  for (const char* name : {"motor_current", "pressure_a", "position"}) {
    const Eigen::VectorXd there = a.values.col(column(*whole, name))(kept);
    const double far = (there - b.values.col(column(*gappy, name))).cwiseAbs().maxCoeff();
    EXPECT_LT(far, 0.3 * asset.sensors.at(name).noise_std) << name;
  }
}

TEST(RecordedInput, StepsWhereAMovingInputLostRowsAndKeepsASwitchAsItWas) {
  const std::vector<double> times{0.0, 0.1, 0.2, 0.5, 0.6, 0.7};
  const RecordedInput input(times, {{{0.0, 1.0, 2.0, 5.0, 6.0, 7.0}, true}, {{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}, true}});
  const auto at = [&](std::size_t channel, double t) {
    std::size_t segment = 0, cursor = 0;
    while (segment + 1 < input.segment_count() && input.segment_begin(segment + 1) <= t) ++segment;
    return input.value(channel, t, segment, cursor);
  };
  EXPECT_DOUBLE_EQ(at(0, 0.25), 2.0);
  EXPECT_NEAR(at(0, 0.35), 3.0, 1e-12);
  EXPECT_NEAR(at(0, 0.45), 4.0, 1e-12);
  EXPECT_DOUBLE_EQ(at(0, 0.55), 5.0);
  EXPECT_DOUBLE_EQ(at(1, 0.45), 0.0);
  EXPECT_DOUBLE_EQ(at(1, 0.55), 1.0);
}

// Rows further apart than any filter remembers: what is simulated between them is needed by no later row.
TEST(Simulation, PassesSensorsOnlyWhatTheyRememberBetweenRowsFarApart) {
  constexpr std::size_t kApart = 500;  // of 200 Hz: 2.5 s
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries fine = standard_pst(asset, 200.0, 31.0), coarse = fine;
  coarse.time_s.clear();
  for (Series& series : coarse.channels) series.values.clear();
  for (std::size_t row = 0; row < fine.time_s.size(); row += kApart) {
    coarse.time_s.push_back(fine.time_s[row]);
    for (std::size_t c = 0; c < fine.channels.size(); ++c)
      coarse.channels[c].values.push_back(fine.channels[c].values[row]);
  }
  std::vector<double>& voltage = fine.channels.front().values;  // of both the same course, linear between the rows
  for (std::size_t row = 0; row + kApart < voltage.size(); ++row) {
    const std::size_t before = row / kApart * kApart;
    const double share = static_cast<double>(row - before) / static_cast<double>(kApart);
    voltage[row] = (1.0 - share) * voltage[before] + share * voltage[before + kApart];
  }
  const auto every_point = simulation_of(asset, fine), far_apart = simulation_of(asset, coarse);
  const auto a = run(*every_point, every_point->start()), b = run(*far_apart, every_point->start());
  const std::size_t distances = coarse.time_s.size() - 1;
  EXPECT_LT(b.points, 100 * distances) << "of 490 at the usual distance";
  for (const char* name : {"pressure_a", "position", "velocity", "flow"})
    for (std::size_t k = 0; k < distances; ++k)
      EXPECT_NEAR(a.values(static_cast<Eigen::Index>(kApart * k), column(*every_point, name)),
                  b.values(static_cast<Eigen::Index>(k), column(*far_apart, name)),
                  0.1 * asset.sensors.at(name).noise_std)
          << name << " at " << coarse.time_s[k];
}

TEST(SensorFilter, IsExactForARampAndPassesDirectlyWithoutALag) {
  constexpr double tau = 0.05, h = 0.02;
  SensorFilter filter(tau, 1), direct(0.0, 1);
  for (int k = 0; k <= 20; ++k) {
    const double t = k * h, ramp = 3.0 * t;
    filter.advance(h, &ramp);
    direct.advance(h, &ramp);
    EXPECT_NEAR(filter.output()[0], 3.0 * (t - tau * (1.0 - std::exp(-t / tau))), 1e-14);
    EXPECT_EQ(direct.output()[0], ramp);
  }
}

// Outputs are simulated without the laws where none acts at a site that they see: no other must be seen, at any opening of
// the valve.
TEST(Simulation, EhaNamesTheSitesThatItsOutputsSee) {
  constexpr std::size_t kSites = Eha::kSites.size();
  using Seen = Dual<static_cast<int>(kSites)>;
  const AssetConfig asset = nominal_asset("eha");
  EhaParameters<double> parameters{};
  parameters.visit(
      [&](std::string_view name, double& value) {
        value = asset.parameters.contains(std::string(name)) ? asset.parameter(std::string(name)) : 0.0;
      },
      parameters);
  std::array<Seen, kSites> extra;
  for (std::size_t site = 0; site < kSites; ++site) extra[site] = Seen::variable(0.0, static_cast<int>(site));
  std::set<std::size_t> seen;
  for (const double above_Pa : {-5e6, -1e5, 1e4, 1e5, 5e5, 5e6})
    for (std::size_t k = 0; k < EhaModel::kOutputs.size(); ++k) {
      if (EhaModel::kOutputs[k].state >= 0) continue;
      const std::array<double, Eha::kStates> state = {4.0, 2.0, 15.0, 1.1e7 + above_Pa, 2e6, 1.1e7, 1e6, 1e-3, 0.06};
      const auto output = EhaModel::output(static_cast<int>(k), state, {}, parameters, extra);
      for (std::size_t site = 0; site < kSites; ++site)
        if (output.derivative[site] != 0.0) seen.insert(site);
    }
  EXPECT_EQ(seen, std::set<std::size_t>(EhaModel::kOutputSites.begin(), EhaModel::kOutputSites.end()));
}

// A parabola, at points as far apart as steps of different sizes, and small against the time constant or not; from its
// first two points the filter knows a line alone.
TEST(SensorFilter, IsExactForAParabolaBehindItsSecondPoint) {
  constexpr double tau = 0.05;
  const auto parabola = [](double t) { return 1.0 + 2.0 * t - 30.0 * t * t; };
  // y = s - tau s' + tau^2 s'' + c exp(-t / tau)
  const auto settled = [&](double t) { return parabola(t) - tau * (2.0 - 60.0 * t) - 60.0 * tau * tau; };
  SensorFilter filter(tau, 1);
  double t = 0.0, from = 0.0, left = 0.0;
  for (const double step : {0.01, 0.01, 0.0001, 0.02, 0.0004, 0.0006, 0.3, 0.001}) {
    t += step;
    const double signal = parabola(t);
    filter.advance(step, &signal);
    const double output = filter.output()[0];
    if (t > 0.0201) {
      EXPECT_NEAR(output, settled(t) + left * std::exp(-(t - from) / tau), 1e-12) << t;
    }
    from = t;
    left = output - settled(t);
  }
}

// What came before a jump says nothing of what comes behind it.
TEST(SensorFilter, TakesNoParabolaAcrossAJump) {
  constexpr double tau = 0.05, h = 0.01;
  SensorFilter jumped(tau, 1);
  const auto pass = [](SensorFilter& filter, double step, double value) { filter.advance(step, &value); };
  pass(jumped, h, 0.0);
  pass(jumped, h, 0.0);
  pass(jumped, 0.0, 1.0);
  pass(jumped, h, 1.0);
  EXPECT_NEAR(jumped.output()[0], 1.0 - std::exp(-h / tau), 1e-14);
}

TEST(Simulation, NamesWhatIsMissingOrMisspelt) {
  AssetConfig asset = nominal_asset("eha");
  TimeSeries samples = standard_pst(asset, 50.0, 1.0);
  const auto simulation = simulation_of(asset, samples);
  const auto wrong = simulation->find("initial:p_a");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().describe().find("initial:p_A"), std::string::npos) << wrong.error().describe();
  std::erase_if(samples.channels,
                [](const Series& series) { return series.name == "motor_voltage" || series.name == "flow"; });
  const auto without_input = PlantSimulation::create(asset, samples);
  ASSERT_FALSE(without_input);
  EXPECT_NE(without_input.error().describe().find("motor_voltage"), std::string::npos);
  asset.model = "eha_swiched";
  const auto misspelt = PlantSimulation::create(asset, samples);
  ASSERT_FALSE(misspelt);
  EXPECT_NE(misspelt.error().describe().find("eha_switched"), std::string::npos);
}

TEST(Simulation, ReportsFailureInsteadOfNonsense) {
  const AssetConfig asset = nominal_asset("eha");
  const auto simulation = simulation_of(asset, standard_pst(asset, 50.0, 2.0));
  ModelValues values = simulation->start();
  simulation->find("beta")->in(values) = std::nan("");
  EXPECT_FALSE(simulation->run(values, {}));
}

// The source document's own sensors: flow drives the cylinder circuit, which then moves like the whole actuator.
TEST(Simulation, TakesTheFlowWhereTheVoltageIsNotRecorded) {
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries recorded = standard_pst(asset);
  const auto whole = simulation_of(asset, recorded);
  ModelValues values = whole->start();
  values.load_factor = 0.0;
  const auto outputs = run(*whole, values);
  std::erase_if(recorded.channels, [](const Series& series) {
    return series.name == "motor_voltage" || series.name == "motor_current" || series.name == "shaft_speed";
  });
  for (Series& series : recorded.channels) {
    const auto simulated = outputs.values.col(column(*whole, series.name));
    series.values.assign(simulated.begin(), simulated.end());
  }
  const auto predicted = ModelSimulator().simulate(asset, recorded, {});
  ASSERT_TRUE(predicted) << predicted.error().describe();
  ASSERT_EQ(predicted->channels.size(), 3u) << "pressure_a, position, velocity; pressure_b drives";
  // The flow sensor lags by 50 ms, which moves the corners at 1.33 mm/s; between them both agree.
  constexpr double kLag_m = 0.050 * 1.33e-3;
  for (std::size_t row = 0; row < recorded.time_s.size(); ++row)
    EXPECT_NEAR(predicted->find("position")->values[row], recorded.find("position")->values[row], 1.5 * kLag_m);
  const std::size_t halfway = 7 * 200;
  EXPECT_NEAR(predicted->find("velocity")->values[halfway], recorded.find("velocity")->values[halfway], 1e-6);
}

TEST(PlantSimulation, RefusesLawsThatDoNotFitThePlant) {
  const TimeSeries recorded = standard_pst(nominal_asset("eha"), 100.0);
  const auto refusal = [&](const PhysicsTerm& term) {
    AssetConfig asset = nominal_asset("eha");
    asset.physics = {term};
    const auto refused = PlantSimulation::create(asset, recorded);
    return refused ? std::string("simulated") : refused.error().rule;
  };
  const std::map<std::string, ParameterSetting> friction = {{"F_c", {4000.0}}, {"v_s", {1e-4}}};
  EXPECT_EQ(refusal({"coulomb_friction", "piston", friction}), "simulated");
  EXPECT_EQ(refusal({"coulomb_friction", "shaft", friction}), "does not fit this element of eha");
  EXPECT_EQ(refusal({"coulomb_friction", "piston", {{"F", {4000.0}}}}),
            "needs exactly the parameters F_c, v_s or F_c, v_s, m");
  EXPECT_EQ(refusal({"coulomb_frictio", "piston", friction}), "is not a law of the catalogue");
}

TEST(ModelSimulator, EstimatesTheLoadAndTheInitialStateOnly) {
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries recorded = standard_pst(asset, 100.0);
  const auto truth = simulation_of(asset, recorded);
  ModelValues values = truth->start();
  values.load_factor = 0.12;
  values.initial_state[5] = 1.16e7;
  const auto outputs = run(*truth, values);
  std::mt19937 random(11);
  for (std::size_t c = 0; c < truth->channels().size(); ++c) {
    std::normal_distribution<double> noise(0.0, asset.sensors.at(truth->channels()[c]).noise_std);
    for (Series& series : recorded.channels)
      if (series.name == truth->channels()[c])
        for (std::size_t row = 0; row < series.values.size(); ++row)
          series.values[row] =
              outputs.values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) + noise(random);
  }
  const auto fitted = fit_operating_point(*simulation_of(asset, recorded), asset);
  ASSERT_TRUE(fitted) << fitted.error().describe();
  EXPECT_NEAR(fitted->load_factor, 0.12, 1e-4);
  EXPECT_EQ(fitted->parameters, values.parameters);
  const auto predicted = ModelSimulator().simulate(asset, recorded, {});
  ASSERT_TRUE(predicted) << predicted.error().describe();
  ASSERT_EQ(predicted->channels.size(), truth->channels().size());
  constexpr double kNoiseFloor = 0.06;  // the noise's own scatter over 3100 samples is 0.013, four estimates on top
  for (const Series& channel : predicted->channels) {
    double sum = 0.0;
    for (std::size_t row = 0; row < channel.values.size(); ++row)
      sum += std::pow(recorded.find(channel.name)->values[row] - channel.values[row], 2);
    const double rms = std::sqrt(sum / static_cast<double>(channel.values.size()));
    EXPECT_NEAR(rms / asset.sensors.at(channel.name).noise_std, 1.0, kNoiseFloor) << channel.name;
  }
}

/// A log of twelve hours takes a minute or more: its service was ended for it, and started again.
TEST(ModelSimulator, EndsSoonWhenItIsCalledOff) {
  const AssetConfig asset = nominal_asset("eha");
  TimeSeries recorded = standard_pst(asset, 200.0, 54.0);
  for (std::size_t row = 0; row < recorded.time_s.size(); ++row) recorded.time_s[row] = 4.0 * static_cast<double>(row);
  std::stop_source stop;
  const std::jthread caller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop.request_stop();
  });
  const auto begin = std::chrono::steady_clock::now();
  const auto predicted = ModelSimulator().simulate(asset, recorded, stop.get_token());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  ASSERT_FALSE(predicted) << "after " << took.count() << " s";
  EXPECT_NE(predicted.error().describe().find("its time was up"), std::string::npos) << predicted.error().describe();
}

}  // namespace
}  // namespace sealwatch
