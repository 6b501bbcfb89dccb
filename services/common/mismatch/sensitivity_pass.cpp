#include "services/common/mismatch/sensitivity_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/common/model/law_columns.hpp"

namespace sealwatch::mismatch {
namespace {

// A hidden state (a bristle, a shaft's angle) follows the plant's signals as linear from step to step: these steps have
// to resolve it.
constexpr double kHiddenStep_s = 0.02;

// Candidates without a finite value somewhere, by their columns, which are the last ones.
std::vector<std::size_t> not_finite(const RowMatrix& sensitivities, const std::vector<Candidate>& candidates,
                                    const std::vector<PassColumn>& columns) {
  std::vector<std::size_t> acting, found;
  for (const PassColumn& column : columns)
    if (!candidates[column.candidate].sites.empty()) acting.push_back(column.candidate);
  const Eigen::Index first = sensitivities.cols() - std::ssize(acting);
  for (std::size_t k = 0; k < acting.size(); ++k)
    if (!std::isfinite(sensitivities(0, first + static_cast<Eigen::Index>(k)))) found.push_back(acting[k]);
  return found;
}

std::vector<LawColumn> law_columns(const std::vector<Candidate>& candidates, const std::vector<PassColumn>& columns) {
  std::vector<LawColumn> laws;
  for (const PassColumn& column : columns) {
    const Candidate& candidate = candidates[column.candidate];
    if (candidate.sites.empty()) continue;
    laws.push_back({.law = candidate.law,
                    .sites = candidate.sites,
                    .parameters = candidate.grid[column.point],
                    .strength = column.strength,
                    .unit = column.unit,
                    .hidden = column.hidden});
  }
  return laws;
}

// d(channel)/d(strength) of a sensor's law: 1, the channel, minus its slope, the share of a drift that is done, or minus
// what exceeds the end of the range.
Eigen::VectorXd sensor_column(const Candidate& candidate, const PassColumn& column, const RowMatrix& simulated,
                              const std::vector<double>& time_s, Eigen::Index channel) {
  const Eigen::Index last = simulated.rows() - 1;
  Eigen::VectorXd result(simulated.rows());
  for (Eigen::Index row = 0; row <= last; ++row) {
    double slope = 1.0;
    if (candidate.law->kind == SiteKind::sensor_gain) slope = simulated(row, channel);
    if (candidate.law->kind == SiteKind::sensor_saturation)
      slope = -std::max(simulated(row, channel) - candidate.grid[column.point][1], 0.0);
    if (candidate.law->kind == SiteKind::sensor_drift) {
      const double age_s = time_s[static_cast<std::size_t>(row)] - time_s.front();
      slope = -std::expm1(-age_s / candidate.grid[column.point][1]);
    }
    if (candidate.law->kind == SiteKind::sensor_lag) {
      const Eigen::Index before = std::max<Eigen::Index>(row - 1, 0), after = std::min(row + 1, last);
      slope = -(simulated(after, channel) - simulated(before, channel)) /
              (time_s[static_cast<std::size_t>(after)] - time_s[static_cast<std::size_t>(before)]);
    }
    result(row) = column.unit * slope;
  }
  return result;
}

// d(channels)/d(strength) of laws of the recording, a column each. Zero, so that the law is not asked, where another
// channel drives this recording or these simulations fail.
RowMatrix recording_columns(const PemRecording& part, const ModelValues& values,
                            const std::vector<const Candidate*>& candidates, const SimulationOptions& options) {
  const auto inputs = part.simulation->inputs();
  std::vector<PlantSimulation::RecordingLaw> laws;
  std::vector<Eigen::Index> place;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto input = std::ranges::find(inputs, candidates[k]->channel) - inputs.begin();
    if (candidates[k]->law->kind != SiteKind::clock_rate && input == std::ssize(inputs)) continue;
    laws.push_back({candidates[k]->law->kind, static_cast<std::size_t>(input)});
    place.push_back(static_cast<Eigen::Index>(k));
  }
  RowMatrix all = RowMatrix::Zero(part.simulation->recorded().size(), std::ssize(candidates));
  if (const auto columns = part.simulation->recording_columns(values, laws, options); columns)
    all(Eigen::all, place) = *columns;
  return all;
}

}  // namespace

std::vector<PassColumn> pass_columns(const std::vector<Candidate>& candidates) {
  std::vector<PassColumn> columns;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    for (std::size_t point = 0; point < candidates[c].grid.size(); ++point)
      for (const std::size_t strength : strengths_of(*candidates[c].law)) {
        PassColumn column{.candidate = c,
                          .point = point,
                          .strength = strength,
                          .unit = candidates[c].strength_scale * candidates[c].grid[point][strength]};
        if (candidates[c].law->hidden && candidates[c].law->hidden->shaft_angle) {
          column.own = true;
          columns.push_back(column);
          column.hidden = std::numbers::pi / (2.0 * candidates[c].grid[point][1]);  // a quarter of a period further
        }
        columns.push_back(column);
      }
  return columns;
}

Result<Pass> sensitivity_pass(const FittedModel& model, std::size_t recording, const std::vector<Candidate>& candidates,
                              const std::vector<PassColumn>& columns) {
  const PemRecording& part = model.problem.recordings[recording];
  const std::vector<double>&shared = model.optimum.point.shared, &own = model.optimum.point.own[recording];
  const FreeOfRecording free = free_of(model.problem, recording, shared, own);
  LawColumns injected(law_columns(candidates, columns), part.simulation->plant());
  SimulationOptions options = model.problem.simulation_options;
  if (std::ranges::any_of(candidates, [](const Candidate& candidate) { return candidate.law->hidden.has_value(); }))
    options.maximum_step_s = std::min(options.maximum_step_s, kHiddenStep_s);
  const ModelValues values = values_at(model.problem, recording, shared, own);
  auto outputs = part.simulation->run(values, free.quantity, options, &injected);
  if (!outputs) return fail(outputs.error());
  injected.mark_not_finite(outputs->sensitivities);

  const Eigen::Index samples = outputs->values.rows(), channels = outputs->values.cols();
  const auto unknowns = static_cast<Eigen::Index>(shared.size() + own.size()),
             frees = static_cast<Eigen::Index>(free.slope.size());
  Linearisation known{.simulated = std::move(outputs->values),
                      .residual = Eigen::VectorXd(samples * channels),
                      .jacobian = RowMatrix::Zero(samples * channels, unknowns)};
  for (Eigen::Index row = 0; row < samples * channels; ++row) {
    const Eigen::Index channel = row % channels, sample = row / channels;
    known.residual(row) = part.simulation->recorded()(sample, channel) - known.simulated(sample, channel);
    for (std::size_t k = 0; k < free.slope.size(); ++k)
      known.jacobian(row, free.column[k]) = free.slope[k] * outputs->sensitivities(row, static_cast<Eigen::Index>(k));
  }
  Pass pass;
  pass.part_ = &part;
  pass.not_finite = not_finite(outputs->sensitivities, candidates, columns);
  pass.channels = channels;
  const auto is_recorded = [&](const Candidate& candidate) {
    return is_of_recording(candidate.law->kind) ||
           std::ranges::find(part.simulation->inputs(), candidate.channel) != part.simulation->inputs().end();
  };
  std::vector<const Candidate*> of_recording;
  for (const PassColumn& column : columns)
    if (const Candidate& candidate = candidates[column.candidate]; candidate.sites.empty() && is_recorded(candidate))
      of_recording.push_back(&candidate);
  const auto recorded =
      std::make_shared<RowMatrix>(recording_columns(part, values, of_recording, model.problem.simulation_options));
  pass.simulated_ = std::make_shared<const RowMatrix>(std::move(outputs->sensitivities));
  pass.of_recording_ = recorded;
  pass.of_sensor_.resize(static_cast<std::size_t>(channels));
  Eigen::Index next_simulated = frees, next_recorded = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const PassColumn& column = columns[k];
    const Candidate& candidate = candidates[column.candidate];
    if (!candidate.sites.empty()) {
      pass.add_column(*pass.simulated_, next_simulated++, k);
    } else if (is_recorded(candidate)) {
      recorded->col(next_recorded) *= column.unit;
      pass.add_column(*recorded, next_recorded++, k);
    } else {
      const auto& names = part.simulation->channels();
      const auto channel = std::ranges::find(names, candidate.channel) - names.begin();
      if (channel < channels)
        pass.of_sensor_[static_cast<std::size_t>(channel)].push_back(
            {static_cast<Eigen::Index>(k),
             sensor_column(candidate, column, known.simulated, part.time_s, static_cast<Eigen::Index>(channel))});
    }
  }
  if (!whiten_and_weigh({part.noise_std, part.colour, part.weight, Eigen::RowVectorXd::Ones(unknowns)}, known))
    return fail("the simulation overflows");
  pass.free = std::move(known.jacobian);
  pass.residual = std::move(known.residual);
  return pass;
}

void Pass::add_column(const RowMatrix& from, Eigen::Index column, std::size_t place) {
  const auto at = static_cast<Eigen::Index>(place);
  if (!runs_.empty()) {
    Run& last = runs_.back();
    if (last.from == &from && last.first + last.count == column && last.place + last.count == at) {
      ++last.count;
      return;
    }
  }
  runs_.push_back({&from, column, at, 1});
}

void Pass::add_law_row(Eigen::Index row, double factor, double* columns) const {
  for (const Run& run : runs_) {
    const double* from = run.from->data() + row * run.from->cols() + run.first;
    double* to = columns + run.place;
    for (Eigen::Index k = 0; k < run.count; ++k) to[k] += factor * from[k];
  }
  for (const SensorColumn& sensor : of_sensor_[static_cast<std::size_t>(row % channels)])
    columns[sensor.place] += factor * sensor.values(row / channels);
}

void Pass::law_row(Eigen::Index row, Eigen::Index columns, double* values) const {
  const Eigen::Index channel = row % channels, sample = row / channels;
  double scale = 1.0 / part_->noise_std(channel);
  if (part_->weight.size() > 0) scale *= part_->weight(row);
  std::fill_n(values, columns, 0.0);
  if (scale == 0.0) return;
  const ChannelColour white, &colour = part_->colour.empty() ? white : part_->colour[static_cast<std::size_t>(channel)];
  const auto order = static_cast<Eigen::Index>(colour.coefficients.size());
  if (order == 0 || sample < order) return add_law_row(row, scale, values);
  scale /= colour.innovation_std;
  add_law_row(row, scale, values);
  for (Eigen::Index j = 1; j <= order; ++j)
    add_law_row(row - j * channels, -scale * colour.coefficients[static_cast<std::size_t>(j - 1)], values);
}

}  // namespace sealwatch::mismatch
