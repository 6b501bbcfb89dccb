// The screening against the plain way: every column of all recordings is kept, and the unknowns' columns are taken off.
#include "services/common/mismatch/screening.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/common/mismatch/baseline.hpp"
#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/sensitivity_pass.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/windows.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig with_free_parameters() {
  AssetConfig asset = nominal_asset("eha");
  for (const char* name : {"R_PL", "f_M", "R_CL"}) asset.parameters.at(name).estimate = true;
  return asset;
}

// Two loads, coloured noise, weights, one value known within its tolerance.
Data two_recordings(const AssetConfig& asset) {
  Data data;
  for (const double load : {0.8, 1.2}) {
    AssetConfig loaded = asset;
    loaded.parameters.at("phi").value *= load;
    data.names.push_back(number(load));
    data.samples.push_back(simulated(loaded, standard_pst(loaded, 20.0), 1.0));
    const auto rows =
        static_cast<Eigen::Index>(data.samples.back().time_s.size() * data.samples.back().channels.size());
    data.colour.push_back(
        NoiseColour(data.samples.back().channels.size(), {.coefficients = {0.5, 0.1}, .innovation_std = 0.8}));
    data.weight.push_back(Eigen::VectorXd::LinSpaced(rows, 0.5, 1.0));
  }
  const double area = asset.parameters.at("A_C").value;
  data.known = {{.name = "A_C", .value = area, .standard_deviation = 0.005 * area}};
  return data;
}

// [shared unknowns, laws, residual] of all recordings one below the other, without what the recordings' own unknowns
// do; what is known last.
struct Rows {
  RowMatrix shared, laws;
  Eigen::VectorXd residual;
};

// `laws`: columns of all recordings.
Rows rows_of(const FittedModel& model, std::size_t recording, const Screening& screening) {
  const std::vector<PassColumn> columns = pass_columns(screening.candidates);
  const std::size_t recordings = model.problem.recordings.size();
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  const Result<Pass> pass = sensitivity_pass(model, recording, screening.candidates, columns);
  EXPECT_TRUE(pass);
  Rows rows{.shared = pass->free.leftCols(shared),
            .laws = RowMatrix::Zero(pass->free.rows(), screening.gram.cols()),
            .residual = pass->residual};
  std::vector<double> row(columns.size());
  for (Eigen::Index r = 0; r < rows.laws.rows(); ++r) {
    pass->law_row(r, std::ssize(columns), row.data());
    Eigen::Index at = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      rows.laws(r, at + (columns[c].own ? static_cast<Eigen::Index>(recording) : 0)) = row[c];
      at += columns[c].own ? static_cast<Eigen::Index>(recordings) : 1;
    }
  }
  const RowMatrix own = pass->free.rightCols(pass->free.cols() - shared);
  const Projection projection(own);
  projection.remove_from(rows.shared);
  projection.remove_from(rows.laws);
  projection.remove_from(rows.residual);
  return rows;
}

Rows known_rows(const FittedModel& model, Eigen::Index laws) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Rows rows{.shared = RowMatrix::Zero(shared, shared),
            .laws = RowMatrix::Zero(shared, laws),
            .residual = Eigen::VectorXd::Zero(shared)};
  for (Eigen::Index k = 0; k < shared; ++k) {
    const Unknown& unknown = model.problem.shared[static_cast<std::size_t>(k)];
    if (!unknown.is_known()) continue;
    rows.shared(k, k) = 1.0 / unknown.prior_std;
    rows.residual(k) = unknown.prior_residual(model.optimum.point.shared[static_cast<std::size_t>(k)]);
  }
  return rows;
}

TEST(Screening, TakesOffWhatTheUnknownsDo) {
  constexpr double kRounding = 1e-9;  // of the sizes before
  const AssetConfig asset = with_free_parameters();
  const Data data = two_recordings(asset);
  const Result<FittedModel> model = fit_model(asset, data, nullptr, 2);
  ASSERT_TRUE(model) << model.error().describe();
  const Result<Screening> screening = screen(*model, data, {});
  ASSERT_TRUE(screening) << screening.error().describe();
  std::vector<Rows> parts = {rows_of(*model, 0, *screening), rows_of(*model, 1, *screening),
                             known_rows(*model, screening->gram.cols())};
  const auto sum = [&](const auto& product) {
    Eigen::MatrixXd all = product(parts.front());
    for (std::size_t k = 1; k < parts.size(); ++k) all += product(parts[k]);
    return all;
  };
  const NormalMatrix normal(
      sum([](const Rows& rows) -> Eigen::MatrixXd { return rows.shared.transpose() * rows.shared; }));
  const Eigen::MatrixXd of_laws =
      normal.solve(sum([](const Rows& rows) -> Eigen::MatrixXd { return rows.shared.transpose() * rows.laws; }));
  const Eigen::MatrixXd of_residual =
      normal.solve(sum([](const Rows& rows) -> Eigen::MatrixXd { return rows.shared.transpose() * rows.residual; }));
  const auto squares = [](const Rows& rows) -> Eigen::MatrixXd {
    return rows.laws.colwise().squaredNorm().transpose();
  };
  const Eigen::VectorXd size = sum(squares).cwiseMax(1e-300).cwiseSqrt();
  for (Rows& rows : parts) {
    rows.laws -= rows.shared * of_laws;
    rows.residual -= rows.shared * of_residual;
  }
  const Eigen::MatrixXd gram =
      sum([](const Rows& rows) -> Eigen::MatrixXd { return rows.laws.transpose() * rows.laws; });
  const Eigen::VectorXd gradient =
      sum([](const Rows& rows) -> Eigen::MatrixXd { return rows.laws.transpose() * rows.residual; });
  const double left = std::sqrt(model->misfit);
  ASSERT_GT(size.size(), 100);
  for (Eigen::Index j = 0; j < size.size(); ++j) {
    EXPECT_NEAR(screening->gradient(j) / (size(j) * left), gradient(j) / (size(j) * left), kRounding) << j;
    for (Eigen::Index k = 0; k < size.size(); ++k)
      EXPECT_NEAR(screening->gram(j, k) / (size(j) * size(k)), gram(j, k) / (size(j) * size(k)), kRounding)
          << j << ' ' << k;
  }
}

// Of the law at the element: what it promises, and what its refit brings.
std::pair<double, double> promised_and_brought(const Law& law, const std::string& element, const AssetConfig& asset,
                                               const Data& data) {
  Result<FittedModel> fitted = fit_model(asset, data, nullptr, 2);
  EXPECT_TRUE(fitted) << fitted.error().describe();
  const auto model = std::make_shared<const FittedModel>(std::move(*fitted));
  const Result<Screening> screening = screen(*model, data, {});
  EXPECT_TRUE(screening) << screening.error().describe();
  for (const LawStart& start : ranked_laws(*screening, screening->candidates.size())) {
    if (start.effect.law != &law || start.effect.element != element) continue;
    double most = 0.0;
    for (const Variant& variant : screening->variants) {
      const Candidate& candidate = screening->candidates[variant.candidate];
      if (candidate.law == &law && candidate.element == element) most = std::max(most, variant.gain);
    }
    const std::vector<Trial> trials = refit({{}, model}, {{start}}, data, 2);
    EXPECT_EQ(trials.size(), 1U);
    return {most, model->misfit - trials.front().model->misfit};
  }
  ADD_FAILURE() << "not asked";
  return {};
}

// Fixed values move within their tolerances to do what a law would, which pays their priors, and come back beside it;
// also from the ends of their ranges.
TEST(Screening, PromisesWhatALawBringsBesideValuesThatMoved) {
  const AssetConfig asset = with_free_parameters();
  const auto asks = [&](const Law& law, const std::string& element, double strength) {
    Data data = two_recordings(with_law(asset, law, element, std::vector<double>{strength}));
    data.colour.clear();
    data.weight.clear();
    data.known = known_values(asset, **find_plant(asset.model));
    const auto [promised, brought] = promised_and_brought(law, element, asset, data);
    EXPECT_NEAR(promised / brought, 1.0, 0.1) << element << ' ' << strength;
  };
  for (const double strength : {4e-17, 4e-16, 4e-15})
    asks(**find_law("external_leakage", {"G"}), "chamber_a", strength);
  for (const double strength : {0.01, 0.03, 0.1}) asks(**find_law("sensor_gain", {"g"}), "sensor:pressure_a", strength);
}

// A drift counts from a recording's begin, which a window does not know.
TEST(Screening, AsksForADriftInWholeRecordingsAlone) {
  const AssetConfig asset = with_free_parameters();
  Data whole = two_recordings(asset);
  whole.colour.clear();
  whole.weight.clear();
  const auto asks = [&](const Data& data) {
    const Result<FittedModel> model = fit_model(asset, data, nullptr, 2, 0);
    EXPECT_TRUE(model) << model.error().describe();
    return std::ranges::any_of(screen(*model, data, {}).value().candidates, [](const Candidate& candidate) {
      return candidate.law->kind == SiteKind::sensor_drift;
    });
  };
  EXPECT_TRUE(asks(whole));
  EXPECT_FALSE(asks(cut_into_windows(whole, 10.0)));
}

// Moves that begin and end within 0.6 s: of a sharper corner it is mostly the smoothing of the flow that asks for
// friction.
std::vector<double> with_round_corners(const std::vector<double>& sharp) {
  constexpr std::size_t kReach = 15;
  std::vector<double> values = sharp;
  for (std::size_t k = kReach; k + kReach < values.size(); ++k) {
    double sum = 0.0;
    for (std::size_t j = k - kReach; j <= k + kReach; ++j) sum += sharp[j];
    values[k] = sum / static_cast<double>(2 * kReach + 1);
  }
  return values;
}

// A test of which flow, pressures, position and velocity are recorded: what the model does that is driven by the flow
// as it was, and the sensors' noise.
TimeSeries driven_by_flow(const AssetConfig& asset, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  TimeSeries samples;
  TimeSeries course = standard_pst(asset, 100.0);
  course.channels.front().values = with_round_corners(with_round_corners(course.channels.front().values));
  static_cast<void>(simulated(asset, std::move(course), 0.0, &samples));
  std::erase_if(samples.channels, [](const Series& channel) {
    return channel.name.starts_with("motor") || channel.name == "shaft_speed";
  });
  const auto driven = PlantSimulation::create(asset, samples).value();
  const RowMatrix outputs = driven->run(driven->start(), {}, {}).value().values;
  for (Series& channel : samples.channels) {
    const auto output = std::ranges::find(driven->channels(), channel.name) - driven->channels().begin();
    channel.noise_std = asset.sensors.at(channel.name).noise_std;
    for (std::size_t row = 0; row < channel.values.size(); ++row) {
      if (output < outputs.cols()) channel.values[row] = outputs(static_cast<Eigen::Index>(row), output);
      channel.values[row] += channel.noise_std * normal(random);
    }
  }
  return samples;
}

// Noise of a recorded flow that drives the simulation moves the simulated piston at rest; friction would hold it. So
// the residuals that this noise makes ask for friction that is not there.
TEST(Screening, TakesOffWhatTheNoiseOfAMeasuredInputFeigns) {
  AssetConfig asset = nominal_asset("eha");
  for (const char* name : {"R_CL", "f_C", "beta"}) asset.parameters.at(name).estimate = true;
  Data data, none;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    data.names.push_back(std::to_string(seed));
    data.samples.push_back(driven_by_flow(asset, seed));
  }
  TimeBudget time(1e3, {});
  const Baseline baseline = fit_baseline(asset, data, none, {}, time).value();
  const Data windows = in_windows(data, baseline.window_s);
  // Standard errors of the friction that is asked for most.
  const auto friction = [&](const Data& of) {
    const Screening screening = screen(*baseline.model, of, {}).value();
    double most = 0.0;
    for (const Variant& variant : screening.variants) {
      const Eigen::Index column = variant.columns.front();
      if (screening.candidates[variant.candidate].law->id != "coulomb_friction") continue;
      if (screening.candidates[variant.candidate].element != "piston") continue;
      most = std::max(most, screening.gradient(column) / std::sqrt(screening.gram(column, column)));
    }
    return most;
  };
  Data exact = windows;
  exact.of_inputs.clear();
  const double feigned = friction(exact), left = friction(windows);
  EXPECT_GT(feigned, 5.0);
  EXPECT_LT(left, 0.7 * feigned);
}

}  // namespace
}  // namespace sealwatch::mismatch
