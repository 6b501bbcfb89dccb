#include "services/common/estimation/model_validation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "sealwatch/estimation/residual_statistics.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/estimation/channel_noise.hpp"
#include "services/common/model/model_simulator.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

constexpr double kPastInput_s = 1.0;  // how far back a residual may depend on the input

std::vector<double> autocorrelation(const std::vector<double>& residual) {
  const std::size_t lags = std::min(kAutocorrelationLags, residual.size() / 4);
  std::vector<double> rho;
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    double sum = 0.0;
    for (std::size_t k = lag; k < residual.size(); ++k) sum += residual[k] * residual[k - lag];
    rho.push_back(sum);
  }
  const double variance = rho.empty() ? 0.0 : rho.front();
  for (double& value : rho) value = variance > 0.0 ? value / variance : 0.0;
  return rho;
}

/// The input that drives the simulation, for the test of independence.
std::vector<double> driving_input(const AssetConfig& asset, const TimeSeries& recorded) {
  if (const auto plant = find_plant(asset.model))
    for (const ChannelDescription& channel : (*plant)->channels)
      if (const Series* series = channel.input ? recorded.find(channel.name) : nullptr) return series->values;
  const std::vector<std::string> measured = simulated_part(asset, recorded).inputs;
  return measured.empty() ? std::vector<double>{} : recorded.find(measured.front())->values;
}

ChannelValidation compare(const Series& recorded, const Series& simulated, double noise_std, const PastInput& past) {
  ChannelValidation channel{.fit = {.channel = recorded.name},
                            .unit = recorded.unit,
                            .noise_std = noise_std,
                            .recorded = recorded.values,
                            .simulated = simulated.values,
                            .autocorrelation = {}};
  std::vector<double> residual(recorded.values.size());
  for (std::size_t k = 0; k < residual.size(); ++k)
    residual[k] = (recorded.values[k] - simulated.values[k]) / (noise_std > 0.0 ? noise_std : 1.0);
  channel.fit.nrmse_percent = nrmse_percent(recorded.values, simulated.values);
  channel.fit.noise_normalised_rms = noise_std > 0.0 ? root_mean_square(residual) : 0.0;
  channel.fit.whiteness_p = whiteness_p(residual);
  channel.fit.independence_p = past.independence_p(residual);
  channel.autocorrelation = autocorrelation(residual);
  return channel;
}

RecordingValidation compare(const AssetConfig& asset, const Recording& recording, const TimeSeries& simulated,
                            const std::string& name) {
  const TimeSeries& samples = recording.samples;
  RecordingValidation result{.recording = name, .time_s = samples.time_s, .channels = {}};
  const double duration_s = samples.time_s.back() - samples.time_s.front();
  const PastInput past(
      driving_input(asset, samples),
      static_cast<std::size_t>(kPastInput_s / duration_s * static_cast<double>(samples.time_s.size())));
  for (const Series& channel : simulated.channels) {
    const Series* recorded = samples.find(channel.name);
    if (recorded == nullptr) continue;
    const double noise_std =
        channel.noise_std > 0.0 ? channel.noise_std : noise_std_of(asset, *recorded, samples.time_s);
    result.channels.push_back(compare(*recorded, channel, noise_std, past));
  }
  return result;
}

/// Each recording's operating point estimated, parameters as they stand in the asset.
Result<std::vector<TimeSeries>> simulate(const AssetConfig& asset, const std::vector<Recording>& recordings,
                                         const std::vector<std::string>& names) {
  std::vector<TimeSeries> simulated;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    auto one = ModelSimulator().simulate(asset, recordings[k].samples, {});
    if (!one) {
      one.error().file = names[k];
      return fail(one.error());
    }
    for (Series& channel : one->channels) channel.noise_std = 0.0;  // judged by what the recording shows
    simulated.push_back(std::move(*one));
  }
  return simulated;
}

Result<std::vector<TimeSeries>> fit_and_simulate(const AssetConfig& asset, const std::vector<Recording>& recordings,
                                                 ModelValidation& validation) {
  std::vector<TimeSeries> samples;
  for (const Recording& recording : recordings) samples.push_back(recording.samples);
  JointFit joint = fit_actuator(asset, samples, search_of(asset));
  validation.fitted = true;
  validation.parameters = joint.report.parameters;
  validation.termination = joint.report.termination;
  if (joint.recordings.size() != recordings.size())
    return fail(joint.report.reasons.empty() ? "no fit could be made" : joint.report.reasons.front());
  validation.reasons = joint.report.reasons;
  for (const ChannelFit& channel : joint.report.channels)  // judge() says it of each recording
    for (const std::string& reason : reasons_of_channel(channel)) std::erase(validation.reasons, reason);
  std::vector<TimeSeries> simulated;
  for (RecordingFit& fit : joint.recordings) simulated.push_back(std::move(fit.simulated));
  return simulated;
}

constexpr double kMoreThanNoise = 1.3;  // times it: noise of 1000 samples is known to a few per cent
constexpr double kSignificance = 0.01;

/// Of one channel over all recordings.
struct Misfit {
  std::string channel, worst;
  double largest = 0.0;
  int beyond = 0, coloured = 0, dependent = 0, recordings = 0;
};

std::string remark_on(const Misfit& misfit) {
  std::vector<std::string> parts;
  if (misfit.largest > kMoreThanNoise)
    parts.push_back(text::format("misfits by up to {:.3g} times its noise", misfit.largest));
  if (misfit.coloured > 0)
    parts.push_back(text::format("residuals are coloured in {} of {} recordings", misfit.coloured, misfit.recordings));
  if (misfit.dependent > 0)
    parts.push_back(text::format("follow the past input in {} of {}", misfit.dependent, misfit.recordings));
  return parts.empty() ? "" : misfit.channel + ": " + text::joined(parts);
}

void judge(ModelValidation& validation) {
  const double limit = AdmissibilityOptions{}.largest_noise_normalised_rms;
  std::vector<Misfit> misfits;
  std::size_t tests = 0;
  for (const RecordingValidation& recording : validation.recordings) tests += recording.channels.size();
  const double improbable = kSignificance / std::max(1.0, static_cast<double>(tests));
  for (const RecordingValidation& recording : validation.recordings)
    for (const ChannelValidation& channel : recording.channels) {
      const std::string& name = channel.fit.channel;
      auto found = std::find_if(misfits.begin(), misfits.end(), [&](const Misfit& one) { return one.channel == name; });
      if (found == misfits.end()) found = misfits.insert(found, Misfit{.channel = name, .worst = {}});
      ++found->recordings;
      found->beyond += channel.fit.noise_normalised_rms > limit ? 1 : 0;
      found->coloured += channel.fit.whiteness_p < improbable ? 1 : 0;
      found->dependent += channel.fit.independence_p < improbable ? 1 : 0;
      if (channel.fit.noise_normalised_rms <= found->largest) continue;
      found->largest = channel.fit.noise_normalised_rms;
      found->worst = recording.recording;
    }
  std::ranges::stable_sort(misfits, std::greater{}, &Misfit::largest);
  for (const Misfit& misfit : misfits) {
    if (misfit.beyond == 0) {
      if (std::string remark = remark_on(misfit); !remark.empty()) validation.remarks.push_back(std::move(remark));
      continue;
    }
    if (misfit.recordings == 1) {
      validation.reasons.push_back(text::format("{} misfits by {:.3g} noise standard deviations; at most {:.3g} pass",
                                                misfit.channel, misfit.largest, limit));
      continue;
    }
    validation.reasons.push_back(text::format(
        "{} misfits by more than {:.3g} noise standard deviations in {} of {} recordings, most by {:.3g} in {}",
        misfit.channel, limit, misfit.beyond, misfit.recordings, misfit.largest, misfit.worst));
  }
}

}  // namespace

ActuatorFitOptions search_of(const AssetConfig& asset) {
  ActuatorFitOptions search;
  if (!plant_or_default(asset.model).condition) search.hopeless_rms = std::numeric_limits<double>::infinity();
  return search;
}

Result<ModelValidation> validate_model(const AssetConfig& asset, const std::vector<Recording>& recordings,
                                       const std::vector<std::string>& names, bool fit) {
  if (recordings.empty() || names.size() != recordings.size()) return fail("there is no recording to compare with");
  ModelValidation validation;
  const auto simulated = fit ? fit_and_simulate(asset, recordings, validation) : simulate(asset, recordings, names);
  if (!simulated) return sealwatch::fail(simulated.error());
  for (std::size_t k = 0; k < recordings.size(); ++k)
    validation.recordings.push_back(compare(asset, recordings[k], (*simulated)[k], names[k]));
  judge(validation);
  return validation;
}

}  // namespace sealwatch
