#include "services/common/mismatch/averaged_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/model/measured_input.hpp"

namespace sealwatch::mismatch {

std::optional<Data> with_averaged_inputs(const AssetConfig& asset, const Data& data) {
  const auto plant = find_plant(asset.model);
  if (!plant) return std::nullopt;
  Data averaged = data;
  bool any = false;
  for (TimeSeries& samples : averaged.samples) {
    if (!std::exchange(samples.input_hold, false)) continue;
    for (Series& series : samples.channels) {
      const ChannelDescription* channel = (*plant)->find_channel(series.name);
      if (channel == nullptr || !channel->input || channel->hold) continue;
      series.values = means_of_neighbours(series.values);
      any = true;
    }
  }
  if (!any) return std::nullopt;
  return averaged;
}

Result<FittedModel> fit_by_averaged_inputs(const AssetConfig& asset, const Data& data, const FittedModel* start,
                                           int threads) {
  if (start == nullptr || excess(*start) > kGross) {
    const std::optional<Data> averaged = with_averaged_inputs(asset, data);
    const Result<FittedModel> near = averaged ? fit_model(asset, *averaged, start, threads) : fail("");
    if (near) return fit_model(near->asset, data, &*near, threads);
  }
  return fit_model(asset, data, start, threads);
}

namespace {

// Mean square, in the noise, of what averages change in the outputs.
double change(const FittedModel& averaged, const FittedModel& held) {
  double sum = 0.0;
  for (std::size_t k = 0; k < held.problem.recordings.size(); ++k) {
    const RowMatrix difference = held.optimum.at_optimum[k].simulated - averaged.optimum.at_optimum[k].simulated;
    for (Eigen::Index c = 0; c < difference.cols(); ++c)
      sum += difference.col(c).squaredNorm() / std::pow(held.problem.recordings[k].noise_std(c), 2);
  }
  return sum / held.residuals;
}

}  // namespace

std::optional<Averaged> averaged(const FittedModel& model, const Data& held, int threads) {
  constexpr double kNothing = 0.05;  // of the mean square that is missed
  std::optional<Data> data = with_averaged_inputs(model.asset, held);
  if (!data) return std::nullopt;
  const Result<FittedModel> there = fit_model(model.asset, *data, &model, threads, 0);
  if (!there) return std::nullopt;
  data->least_excess = std::max(kGross, change(*there, model) / kNothing);
  if (excess(model) < data->least_excess) return std::nullopt;
  Result<FittedModel> fitted = fit_model(model.asset, *data, &*there, threads);
  if (!fitted) return std::nullopt;
  return Averaged{std::move(*data), std::make_shared<const FittedModel>(std::move(*fitted))};
}

}  // namespace sealwatch::mismatch
