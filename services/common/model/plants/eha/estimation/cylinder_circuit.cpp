#include "sealwatch/estimation/cylinder_circuit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "sealwatch/estimation/covariance.hpp"
#include "sealwatch/estimation/residual_statistics.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/estimation/cannot_fit.hpp"
#include "services/common/model/plants/eha/estimation/chamber_pressure.hpp"
#include "services/common/model/plants/eha/estimation/volume_balance.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch {
namespace {

constexpr double kLevelOfSignificance = 0.01;  // Ljung-Box below it: standard errors are taken from the sandwich
constexpr double kPastInput_s = 1.0;           // how far back the residual may depend on the input

// Least squares of the innovations, coefficients c_1 = 1/R_CL and c_2 = 1/beta.
struct BalanceFit {
  Eigen::VectorXd coefficients;
  std::vector<bool> at_bound;
  Covariance covariance;       // of the coefficients
  Eigen::VectorXd residual;    // whitened, only samples that took part
  std::vector<double> padded;  // the same with zeros where no sample took part
  double inflation = 1.0;
};

struct Bounds {
  Eigen::VectorXd lower, upper;
};

Bounds reciprocal_bounds(const AssetConfig& asset, Eigen::Index size) {
  Bounds bounds{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Constant(size, std::numeric_limits<double>::infinity())};
  const std::array names = {"R_CL", "beta"};
  for (Eigen::Index j = 0; j < size; ++j) {
    const auto setting = asset.parameters.find(names.at(static_cast<std::size_t>(j)));
    if (setting == asset.parameters.end() || !(setting->second.min > 0.0)) continue;
    bounds.lower(j) = 1.0 / setting->second.max;
    bounds.upper(j) = 1.0 / setting->second.min;
  }
  return bounds;
}

// Minimises |y - X c| over the box. At most two unknowns: the free optimum, else the best with some held at a bound.
Eigen::VectorXd solve_in_box(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, const Bounds& bounds) {
  Eigen::VectorXd c = dense::Symmetric(normal).solve(right);
  // Coordinate descent on a convex quadratic in a box converges; two coordinates need few sweeps.
  const auto inside = [&] {
    return (c.array() >= bounds.lower.array()).all() && (c.array() <= bounds.upper.array()).all();
  };
  if (c.allFinite() && inside()) return c;
  c = c.array().isFinite().select(c, bounds.lower).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  constexpr int kSweeps = 200;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (Eigen::Index j = 0; j < c.size(); ++j) {
      if (!(normal(j, j) > 0.0)) continue;
      const double rest = right(j) - normal.row(j).dot(c) + normal(j, j) * c(j);
      c(j) = std::clamp(rest / normal(j, j), bounds.lower(j), bounds.upper(j));
    }
  return c;
}

// Rows where the level started anew carry no prediction error.
Eigen::MatrixXd rows_that_count(const Eigen::MatrixXd& innovations, const std::vector<bool>& restart) {
  Eigen::MatrixXd kept(innovations.rows(), innovations.cols());
  Eigen::Index count = 0;
  for (Eigen::Index k = 1; k < innovations.rows(); ++k)
    if (!restart[static_cast<std::size_t>(k)]) kept.row(count++) = innovations.row(k);
  return kept.topRows(count);
}

BalanceFit fit_balance(const VolumeBalance& balance, const AssetConfig& asset) {
  const WhitenedBalance whitened = whiten(balance);
  const Eigen::MatrixXd& innovations = whitened.innovations;
  const Eigen::MatrixXd rows = rows_that_count(innovations, balance.restart);
  const Eigen::Index unknowns = rows.cols() - 1;
  const Eigen::VectorXd scale = rows.rightCols(unknowns).colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd regressors = rows.rightCols(unknowns) * scale.cwiseInverse().asDiagonal();
  Bounds bounds = reciprocal_bounds(asset, unknowns);
  bounds.lower = bounds.lower.cwiseProduct(scale);
  bounds.upper = bounds.upper.cwiseProduct(scale);
  BalanceFit fit;
  Eigen::MatrixXd normal = regressors.transpose() * regressors;
  if (unknowns > 1) normal(1, 1) -= std::min(0.5, whitened.noise_in_g2 / (scale(1) * scale(1)));
  const Eigen::VectorXd scaled = solve_in_box(normal, regressors.transpose() * rows.col(0), bounds);
  for (Eigen::Index j = 0; j < unknowns; ++j)
    fit.at_bound.push_back(scaled(j) <= bounds.lower(j) || scaled(j) >= bounds.upper(j));
  fit.coefficients = scaled.cwiseQuotient(scale);
  fit.residual = rows.col(0) - regressors * scaled;
  const Eigen::VectorXd all = innovations.col(0) - innovations.rightCols(unknowns) * fit.coefficients;
  fit.padded.assign(all.data(), all.data() + all.size());
  fit.covariance = covariance_of(rows.rightCols(unknowns));
  const std::span<const double> residual(fit.residual.data(), static_cast<std::size_t>(fit.residual.size()));
  if (whiteness_p(residual) < kLevelOfSignificance)
    fit.inflation = inflate_for_coloured_residuals(fit.covariance,
                                                   rows.rightCols(unknowns).array().colwise() * fit.residual.array());
  return fit;
}

// True while the flow changes and for the settling time after.
std::vector<bool> find_transients(const CylinderSignals& signals, const CylinderCircuitOptions& options) {
  const std::size_t n = signals.time_s.size();
  const std::vector<double> volume = integrate(signals.time_s, signals.flow_m3_s);
  const auto [least, most] = std::minmax_element(signals.flow_m3_s.begin(), signals.flow_m3_s.end());
  const double limit = options.steady_flow_share * (*most - *least);
  const auto mean_flow = [&](std::size_t from, std::size_t to) {
    return (volume[to] - volume[from]) / (signals.time_s[to] - signals.time_s[from]);
  };
  std::vector<bool> transient(n, false);
  std::size_t before = 0, after = 0;
  double settled_at_s = signals.time_s.front();
  for (std::size_t k = 0; k < n; ++k) {
    while (signals.time_s[before] < signals.time_s[k] - options.steady_window_s) ++before;
    while (after + 1 < n && signals.time_s[after] < signals.time_s[k] + options.steady_window_s) ++after;
    if (before < k && k < after && std::abs(mean_flow(k, after) - mean_flow(before, k)) > limit)
      settled_at_s = signals.time_s[k] + options.settling_time_s;
    transient[k] = signals.time_s[k] < settled_at_s;
  }
  return transient;
}

std::vector<bool> outside_holds(std::span<const double> time_s, std::span<const Phase> phases) {
  std::vector<bool> outside(time_s.size(), true);
  for (const Phase& phase : phases)
    if (phase.kind == PhaseKind::hold)
      for (std::size_t k = 0; k < time_s.size(); ++k)
        if (time_s[k] >= phase.begin_s && time_s[k] < phase.end_s) outside[k] = false;
  return outside;
}

// R_CL from holds alone must agree with the one from the whole test.
void control_by_holds(const VolumeBalance& balance, const CylinderSignals& signals, const std::vector<bool>& transient,
                      std::span<const Phase> phases, const AssetConfig& asset, const CylinderCircuitOptions& options,
                      FitReport& report) {
  VolumeBalance held = balance;
  held.columns = Eigen::MatrixXd(balance.columns.leftCols(2));
  held.restart = outside_holds(signals.time_s, phases);
  for (std::size_t k = 0; k < held.restart.size(); ++k) held.restart[k] = held.restart[k] || transient[k];
  constexpr std::ptrdiff_t kFewestSamples = 20;
  if (std::count(held.restart.begin(), held.restart.end(), false) < kFewestSamples) return;
  const BalanceFit fit = fit_balance(held, asset);
  const EstimatedParameter& whole = report.parameters.front();
  const double conductance_std = std::sqrt(fit.covariance.matrix(0, 0));
  const double whole_std = whole.std_error / (whole.value * whole.value);
  const double difference = std::abs(fit.coefficients(0) - 1.0 / whole.value);
  if (difference > options.hold_control_sigmas * std::hypot(conductance_std, whole_std) &&
      difference > options.hold_control_share / whole.value)
    report.reasons.push_back("the hold phases alone give R_CL = " + text::significant(1.0 / fit.coefficients(0)) +
                             " Pa s/m3, the whole test " + text::significant(whole.value));
}

EstimatedParameter reciprocal_parameter(const char* name, const char* unit, const BalanceFit& fit, Eigen::Index j,
                                        const AssetConfig& asset) {
  const double value = 1.0 / fit.coefficients(j);
  EstimatedParameter parameter{.name = name, .unit = unit, .value = value};
  parameter.at_bound = fit.at_bound[static_cast<std::size_t>(j)];
  // At a bound the estimate's distribution is not the linear one: no number is better than a false one.
  parameter.std_error = parameter.at_bound ? std::numeric_limits<double>::infinity()
                                           : std::sqrt(fit.covariance.matrix(j, j)) * value * value;
  if (const auto setting = asset.parameters.find(name); setting != asset.parameters.end()) {
    parameter.min = setting->second.min;
    parameter.max = setting->second.max;
  }
  return parameter;
}

void report_parameters(const BalanceFit& fit, const AssetConfig& asset, FitReport& report) {
  report.parameters.push_back(reciprocal_parameter("R_CL", "Pa s/m3", fit, 0, asset));
  if (fit.coefficients.size() > 1) report.parameters.push_back(reciprocal_parameter("beta", "Pa", fit, 1, asset));
  for (Eigen::Index j = 0; j < fit.coefficients.size(); ++j)
    for (Eigen::Index k = 0; k < fit.coefficients.size(); ++k) {
      const EstimatedParameter& row = report.parameters[static_cast<std::size_t>(j)];
      const EstimatedParameter& column = report.parameters[static_cast<std::size_t>(k)];
      const double chain = std::pow(row.value * column.value, 2);  // d(1/c)/dc = -1/c^2
      report.covariance.push_back(j == k ? row.std_error * row.std_error : chain * fit.covariance.matrix(j, k));
    }
}

// Position simulated from flow and pressures alone, its constant fitted.
std::vector<double> simulate_position(const CylinderSignals& signals, const VolumeBalance& balance,
                                      const BalanceFit& fit) {
  const Eigen::Map<const Eigen::VectorXd> x(signals.position_m.data(),
                                            static_cast<Eigen::Index>(signals.position_m.size()));
  Eigen::VectorXd error =
      balance.columns.col(0) - balance.columns.rightCols(fit.coefficients.size()) * fit.coefficients;
  error.array() -= error.mean();
  const Eigen::VectorXd simulated = x + error / signals.area_m2;
  return {simulated.data(), simulated.data() + simulated.size()};
}

ChannelFit pressure_fit(const CylinderSignals& signals, const BalanceFit& fit, const ChannelFit& position) {
  const SimulatedPressure simulated = simulate_pressure_a(signals, fit.coefficients(0), fit.coefficients(1));
  std::vector<double> normalised(simulated.pressure_a_Pa.size());
  for (std::size_t k = 0; k < normalised.size(); ++k)
    normalised[k] = (signals.pressure_a_Pa[k] - simulated.pressure_a_Pa[k]) / simulated.standard_deviation_Pa[k];
  return {.channel = "pressure_a",
          .noise_normalised_rms = root_mean_square(normalised),
          .nrmse_percent = nrmse_percent(signals.pressure_a_Pa, simulated.pressure_a_Pa),
          .whiteness_p = position.whiteness_p,
          .independence_p = position.independence_p};
}

void report_channels(const TimeSeries& samples, const CylinderSignals& signals, const VolumeBalance& balance,
                     const BalanceFit& fit, FitReport& report) {
  const std::span<const double> residual(fit.residual.data(), static_cast<std::size_t>(fit.residual.size()));
  const Series* voltage = samples.find("motor_voltage");
  const std::span<const double> input =
      voltage != nullptr ? std::span<const double>(voltage->values) : signals.flow_m3_s;
  const double duration_s = signals.time_s.back() - signals.time_s.front();
  const auto span = static_cast<std::size_t>(kPastInput_s / duration_s * static_cast<double>(signals.time_s.size()));
  ChannelFit position{.channel = signals.position_recorded ? "position" : "velocity",
                      .noise_normalised_rms = root_mean_square(residual),
                      .nrmse_percent = nrmse_percent(signals.position_m, simulate_position(signals, balance, fit)),
                      .whiteness_p = whiteness_p(residual),
                      .independence_p = PastInput(input, span).independence_p(fit.padded)};
  report.channels.push_back(position);
  if (!signals.pressure_a_Pa.empty() && fit.coefficients(1) > 0.0)
    report.channels.push_back(pressure_fit(signals, fit, position));
}

FitReport fit_signals(const AssetConfig& asset, const TimeSeries& samples, std::span<const Phase> phases,
                      const CylinderSignals& signals, const CylinderCircuitOptions& options) {
  VolumeBalance balance = make_volume_balance(signals);
  const std::vector<bool> transient = find_transients(signals, options);
  const bool both_pressures = !signals.pressure_a_Pa.empty();
  if (!both_pressures) balance.restart = transient;
  constexpr std::ptrdiff_t kFewestSamples = 20;
  if (std::count(balance.restart.begin(), balance.restart.end(), false) < kFewestSamples)
    return cannot_fit("cylinder_circuit",
                      "no steady run or hold longer than a moment, and pressure_a and pressure_b are not recorded");
  const BalanceFit fit = fit_balance(balance, asset);
  FitReport report;
  report.model = "cylinder_circuit";
  report.converged = true;
  report.iterations = 1;
  report.cost = 0.5 * fit.residual.squaredNorm();
  report.termination = "linear least squares: the optimum in one step";
  if (!both_pressures)
    report.termination += "; steady runs and holds only, as the chambers' mean pressure is not recorded";
  if (fit.inflation > 1.0)
    report.termination +=
        "; residuals are coloured, standard errors raised by a factor of up to " + text::in_sentence(fit.inflation);
  report_parameters(fit, asset, report);
  report_channels(samples, signals, balance, fit, report);
  control_by_holds(balance, signals, transient, phases, asset, options, report);
  judge_admissibility(report, options.admissibility);
  return report;
}

}  // namespace

bool has_cylinder_circuit(const AssetConfig& asset) { return asset.parameters.contains("A_C"); }

Status CylinderCircuitOptions::validate() const {
  if (!(steady_window_s > 0.0 && settling_time_s >= 0.0))
    return fail("steady_window_s must be positive, settling_time_s not negative");
  if (!(steady_flow_share > 0.0 && steady_flow_share < 1.0)) return fail("steady_flow_share must be between 0 and 1");
  if (!(hold_control_sigmas > 0.0 && hold_control_share > 0.0))
    return fail("hold_control_sigmas and hold_control_share must be positive");
  return admissibility.validate();
}

FitReport fit_cylinder_circuit(const AssetConfig& asset, const TimeSeries& samples, std::span<const Phase> phases,
                               const CylinderCircuitOptions& options) {
  if (const Status valid = options.validate(); !valid) return cannot_fit("cylinder_circuit", valid.error().describe());
  const Result<CylinderSignals> signals = gather_cylinder_signals(asset, samples);
  if (!signals) return cannot_fit("cylinder_circuit", signals.error().describe());
  return fit_signals(asset, samples, phases, *signals, options);
}

}  // namespace sealwatch
