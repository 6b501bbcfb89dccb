#include "services/common/estimation/fit_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/estimation/covariance.hpp"
#include "sealwatch/estimation/residual_statistics.hpp"
#include "services/common/estimation/interpolation_error.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLevelOfSignificance =
    0.01;                             // of Ljung-Box over all channels: below it standard errors come from the sandwich
constexpr double kPastInput_s = 1.0;  // how far back a residual may depend on the input
constexpr double kAtBound = 1e-6;     // of an unknown: nearer than this to its bound is at it

bool at_bound(const Unknown& unknown, double at) {
  if (!(unknown.max > unknown.min)) return false;
  return at - unknown.to_unknown(unknown.min) < kAtBound || unknown.to_unknown(unknown.max) - at < kAtBound;
}

std::vector<double> column(const RowMatrix& matrix, Eigen::Index c) {
  const Eigen::VectorXd values = matrix.col(c);
  return {values.data(), values.data() + values.size()};
}

// The recorded input that drives the simulation.
std::vector<double> driving_input(const PemRecording& recording, const TimeSeries& recorded) {
  for (const ChannelDescription& channel : recording.simulation->plant().channels)
    if (const Series* series = channel.input ? recorded.find(channel.name) : nullptr; series != nullptr)
      return series->values;
  return {};
}

std::vector<ChannelFit> channel_fits(const PemRecording& recording, const Linearisation& at,
                                     const TimeSeries& recorded) {
  const std::span<const std::string> channels = recording.simulation->channels();
  const Eigen::Map<const RowMatrix> residual(at.residual.data(), at.simulated.rows(), at.simulated.cols());
  const double duration_s = recorded.time_s.back() - recorded.time_s.front();
  const auto samples = static_cast<double>(recorded.time_s.size());
  const PastInput past(driving_input(recording, recorded),
                       static_cast<std::size_t>(kPastInput_s / duration_s * samples));
  std::vector<ChannelFit> fits;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto index = static_cast<Eigen::Index>(c);
    if (!std::isfinite(recording.noise_std(index))) continue;  // nothing known of its noise: it took no part
    const std::vector<double> whitened = column(residual, index);
    fits.push_back({.channel = channels[c],
                    .noise_normalised_rms = root_mean_square(whitened),
                    .nrmse_percent = nrmse_percent(recorded.find(channels[c])->values, column(at.simulated, index)),
                    .whiteness_p = whiteness_p(whitened),
                    .independence_p = past.independence_p(whitened)});
  }
  return fits;
}

// Several recordings' fits of one channel as one: p-values by Bonferroni, the others by their mean squares.
std::vector<ChannelFit> pooled(const std::vector<RecordingFit>& recordings) {
  if (recordings.size() == 1) return recordings.front().channels;
  std::vector<ChannelFit> result;
  for (const RecordingFit& recording : recordings)
    for (const ChannelFit& channel : recording.channels)
      if (std::none_of(result.begin(), result.end(),
                       [&](const ChannelFit& known) { return known.channel == channel.channel; }))
        result.push_back({.channel = channel.channel, .whiteness_p = 1.0, .independence_p = 1.0});
  for (ChannelFit& pool : result) {
    double count = 0.0, squares = 0.0, misfit = 0.0;
    for (const RecordingFit& recording : recordings)
      for (const ChannelFit& channel : recording.channels) {
        if (channel.channel != pool.channel) continue;
        count += 1.0;
        squares += channel.noise_normalised_rms * channel.noise_normalised_rms;
        misfit += std::pow(1.0 - channel.nrmse_percent / 100.0, 2);
        pool.whiteness_p = std::min(pool.whiteness_p, channel.whiteness_p);
        pool.independence_p = std::min(pool.independence_p, channel.independence_p);
      }
    pool.noise_normalised_rms = std::sqrt(squares / count);
    pool.nrmse_percent = 100.0 * (1.0 - std::sqrt(misfit / count));
    pool.whiteness_p = std::min(1.0, count * pool.whiteness_p);
    pool.independence_p = std::min(1.0, count * pool.independence_p);
  }
  return result;
}

bool is_coloured(const std::vector<RecordingFit>& recordings) {
  double smallest = 1.0, tests = 0.0;
  for (const RecordingFit& recording : recordings)
    for (const ChannelFit& channel : recording.channels) {
      smallest = std::min(smallest, channel.whiteness_p);
      tests += 1.0;
    }
  return smallest * tests < kLevelOfSignificance;
}

// All unknowns of the problem in one row: shared, then each recording's own.
struct Layout {
  std::vector<Eigen::Index> own_begin;
  Eigen::Index size = 0;
};

Layout lay_out(const PemProblem& problem) {
  Layout layout{.own_begin = {}, .size = static_cast<Eigen::Index>(problem.shared.size())};
  for (const PemRecording& recording : problem.recordings) {
    layout.own_begin.push_back(layout.size);
    layout.size += static_cast<Eigen::Index>(recording.own.size());
  }
  return layout;
}

// Rows that stand for one recording, spread over all unknowns. Unknowns held at a bound do not vary.
Eigen::MatrixXd spread(const Eigen::MatrixXd& rows, const Layout& layout, std::size_t recording,
                       const std::vector<bool>& held) {
  const auto shared = layout.own_begin.front();
  const Eigen::Index own = rows.cols() - shared;
  Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(rows.rows(), layout.size);
  wide.leftCols(shared) = rows.leftCols(shared);
  wide.middleCols(layout.own_begin[recording], own) = rows.rightCols(own);
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k]) wide.col(static_cast<Eigen::Index>(k)).setZero();
  return wide;
}

// Row t: sum over the channels of J' r at sample t.
Eigen::MatrixXd scores_of(const Linearisation& at) {
  const Eigen::Index channels = at.simulated.cols();
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(at.simulated.rows(), at.jacobian.cols());
  for (Eigen::Index row = 0; row < at.jacobian.rows(); ++row)
    scores.row(row / channels) += at.residual(row) * at.jacobian.row(row);
  return scores;
}

struct Uncertainty {
  Covariance covariance;  // of the unknowns
  double inflation = 1.0;
  double by_input = 1.0;  // largest factor by which the input's unrecorded course raised a standard error
};

// Rows of J' d_b / noise of all pieces of all recordings (interpolation_error.hpp).
Eigen::MatrixXd input_scores(const AssetConfig& asset, const PemProblem& problem, const PemOptimum& optimum,
                             std::span<const TimeSeries> recordings, const Layout& layout,
                             const std::vector<bool>& held) {
  std::vector<Eigen::RowVectorXd> rows;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const PemRecording& part = problem.recordings[k];
    for (const RowMatrix& change : changes_by_pieces(problem, k, optimum, asset, recordings[k])) {
      Linearisation at{
          .simulated = {}, .residual = Eigen::VectorXd(change.size()), .jacobian = optimum.at_optimum[k].jacobian};
      for (Eigen::Index row = 0; row < change.size(); ++row)
        at.residual(row) = change(row / change.cols(), row % change.cols()) / part.noise_std(row % change.cols());
      rows.emplace_back(spread(at.residual.transpose() * at.jacobian, layout, k, held));
    }
  }
  Eigen::MatrixXd scores(static_cast<Eigen::Index>(rows.size()), layout.size);
  for (std::size_t row = 0; row < rows.size(); ++row) scores.row(static_cast<Eigen::Index>(row)) = rows[row];
  return scores;
}

// Adds to the covariance of white noise what the input's course between samples does; residuals that are coloured may
// have told more.
void add_input(const Covariance& white, const Eigen::MatrixXd& scores, Uncertainty& uncertainty) {
  constexpr double kShare = 1.0 / 3.0;
  const Eigen::Index n = white.matrix.rows();
  Eigen::MatrixXd finite = white.matrix;
  for (Eigen::Index j = 0; j < n; ++j)
    if (!white.identified[static_cast<std::size_t>(j)]) finite(j, j) = 0.0;
  const Eigen::MatrixXd moved = scores * finite;
  const Eigen::MatrixXd both = finite + kShare * moved.transpose() * moved;
  Eigen::MatrixXd& matrix = uncertainty.covariance.matrix;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!(finite(j, j) > 0.0)) continue;
    uncertainty.by_input = std::max(uncertainty.by_input, std::sqrt(std::max(1.0, both(j, j) / matrix(j, j))));
    factor(j) = std::sqrt(std::max(1.0, matrix(j, j) / both(j, j)));
  }
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index k = 0; k < n; ++k)
      if (finite(j, j) > 0.0 && finite(k, k) > 0.0) matrix(j, k) = factor(j) * factor(k) * both(j, k);
}

Uncertainty uncertainty_of(const AssetConfig& asset, const PemProblem& problem, const PemOptimum& optimum,
                           std::span<const TimeSeries> recordings, bool coloured, bool input_matters) {
  const Layout layout = lay_out(problem);
  std::vector<bool> held;
  for (std::size_t k = 0; k < problem.shared.size(); ++k)
    held.push_back(at_bound(problem.shared[k], optimum.point.shared[k]));
  std::vector<Eigen::MatrixXd> roots, scores;
  Eigen::Index rows = 0, samples = 0;
  for (std::size_t k = 0; k < optimum.at_optimum.size(); ++k) {
    const Eigen::MatrixXd root = compress(optimum.at_optimum[k]);
    roots.push_back(spread(root.leftCols(root.cols() - 1), layout, k, held));
    rows += root.rows();
    if (coloured) scores.push_back(spread(scores_of(optimum.at_optimum[k]), layout, k, held));
    samples += optimum.at_optimum[k].simulated.rows();
  }
  const auto stack = [&](const std::vector<Eigen::MatrixXd>& parts, Eigen::Index height) {
    Eigen::MatrixXd all(height, layout.size);
    Eigen::Index at = 0;
    for (const Eigen::MatrixXd& part : parts) {
      all.middleRows(at, part.rows()) = part;
      at += part.rows();
    }
    return all;
  };
  Uncertainty result{.covariance = covariance_of(stack(roots, rows))};
  const Covariance white = result.covariance;
  if (coloured) result.inflation = inflate_for_coloured_residuals(result.covariance, stack(scores, samples));
  if (input_matters) add_input(white, input_scores(asset, problem, optimum, recordings, layout, held), result);
  return result;
}

EstimatedParameter to_parameter(const Unknown& unknown, double at, double variance) {
  EstimatedParameter parameter{.name = unknown.name, .unit = unknown.unit, .value = unknown.to_value(at)};
  parameter.min = unknown.min;
  parameter.max = unknown.max;
  parameter.at_bound = at_bound(unknown, at);
  parameter.std_error = parameter.at_bound ? kInfinity : std::sqrt(variance) * std::abs(unknown.slope(at));
  return parameter;
}

// Load, initial state and simulated channels of one recording.
void complete(RecordingFit& fit, const PemRecording& recording, const Linearisation& at, const TimeSeries& recorded,
              const std::vector<double>& own, const Eigen::VectorXd& variance) {
  for (std::size_t k = 0; k < own.size(); ++k) {
    EstimatedParameter parameter = to_parameter(recording.own[k], own[k], variance(static_cast<Eigen::Index>(k)));
    if (k == 0 && recording.simulation->plant().has_load())
      fit.load = std::move(parameter);
    else
      fit.initial_state.push_back(std::move(parameter));
  }
  fit.simulated.time_s = recorded.time_s;
  fit.simulated.input_hold = recorded.input_hold;
  const std::span<const std::string> channels = recording.simulation->channels();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto index = static_cast<Eigen::Index>(c);
    fit.simulated.channels.push_back(
        {.name = channels[c],
         .unit = recorded.find(channels[c])->unit,
         .noise_std = std::isfinite(recording.noise_std(index)) ? recording.noise_std(index) : 0.0,
         .values = column(at.simulated, index)});
  }
}

// Shared parameters, and with a single recording its load and initial state too, with the covariance of exactly these.
void report_parameters(const PemProblem& problem, const PemOptimum& optimum, const Covariance& covariance,
                       JointFit& fit) {
  std::vector<double> slope;
  const auto add = [&](const Unknown& unknown, double at) {
    const auto k = static_cast<Eigen::Index>(slope.size());
    fit.report.parameters.push_back(to_parameter(unknown, at, covariance.matrix(k, k)));
    slope.push_back(unknown.slope(at));
  };
  for (std::size_t k = 0; k < problem.shared.size(); ++k) add(problem.shared[k], optimum.point.shared[k]);
  if (problem.recordings.size() == 1)
    for (std::size_t k = 0; k < optimum.point.own.front().size(); ++k)
      add(problem.recordings.front().own[k], optimum.point.own.front()[k]);
  for (std::size_t j = 0; j < slope.size(); ++j)
    for (std::size_t k = 0; k < slope.size(); ++k) {
      const double variance = covariance.matrix(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
      const EstimatedParameter& parameter = fit.report.parameters[j];
      fit.report.covariance.push_back(j == k ? parameter.std_error * parameter.std_error
                                             : variance * slope[j] * slope[k]);
    }
}

std::string unidentified(const std::vector<EstimatedParameter>& parameters) {
  std::string names;
  for (const EstimatedParameter& parameter : parameters)
    if (!std::isfinite(parameter.std_error) && !parameter.at_bound) text::add_to_list(names, parameter.name);
  return names;
}

}  // namespace

JointFit report_fit(const AssetConfig& asset, const PemProblem& problem, const PemOptimum& optimum,
                    std::span<const TimeSeries> recordings, bool input_matters) {
  JointFit fit;
  fit.report.model = asset.model;
  fit.report.converged = optimum.converged;
  fit.report.iterations = optimum.iterations;
  fit.report.cost = optimum.cost;
  fit.report.termination = optimum.termination;
  const Layout layout = lay_out(problem);
  for (std::size_t k = 0; k < recordings.size(); ++k)
    fit.recordings.emplace_back().channels = channel_fits(problem.recordings[k], optimum.at_optimum[k], recordings[k]);
  const Uncertainty uncertainty =
      uncertainty_of(asset, problem, optimum, recordings, is_coloured(fit.recordings), input_matters);
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const auto own = static_cast<Eigen::Index>(optimum.point.own[k].size());
    complete(fit.recordings[k], problem.recordings[k], optimum.at_optimum[k], recordings[k], optimum.point.own[k],
             uncertainty.covariance.matrix.diagonal().segment(layout.own_begin[k], own));
  }
  report_parameters(problem, optimum, uncertainty.covariance, fit);
  fit.report.channels = pooled(fit.recordings);
  if (fit.recordings.size() == 1 && fit.recordings.front().load.name == "load_factor")
    fit.report.load_factor = fit.recordings.front().load.value;
  constexpr double kTold = 1.005;  // less reads as "a factor of up to 1"
  if (uncertainty.inflation > kTold)
    fit.report.termination += "; residuals are coloured, standard errors raised by a factor of up to " +
                              text::in_sentence(uncertainty.inflation);
  if (uncertainty.by_input > kTold)
    fit.report.termination +=
        "; what the input does between its samples is not recorded, standard errors raised by a factor of up to " +
        text::in_sentence(uncertainty.by_input);
  if (const std::string names = unidentified(fit.report.parameters); !names.empty())
    fit.report.termination += "; not identifiable from these channels: " + names;
  return fit;
}

}  // namespace sealwatch
