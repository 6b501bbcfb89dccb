// `sealwatch fit`: gray-box prediction-error minimisation of recorded tests.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sealwatch/core/text.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/fit_table.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/estimation/model_validation.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/common/runtime/large_blocks.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "services/data_manipulation/data_manipulation.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCylinderCircuit = "cylinder_circuit";

/// A fit of one or several recordings, whichever model it was made with.
struct FitResult {
  FitReport report;
  std::vector<EstimatedParameter> loads;
};

bool inputs_recorded(const PlantDescription& plant, const std::vector<Recording>& recordings) {
  return std::all_of(recordings.begin(), recordings.end(), [&plant](const Recording& recording) {
    return std::all_of(plant.channels.begin(), plant.channels.end(), [&recording](const ChannelDescription& channel) {
      return !channel.input || recording.samples.has(channel.name);
    });
  });
}

FitResult fit_whole(const AssetConfig& asset, const std::vector<Recording>& recordings, int threads,
                    const Deadline& deadline) {
  std::vector<TimeSeries> samples;
  samples.reserve(recordings.size());
  for (const Recording& recording : recordings) samples.push_back(recording.samples);
  ActuatorFitOptions search = search_of(asset);
  search.threads = threads;
  search.deadline = &deadline;
  Progress progress("fit", 100, "%");
  static constexpr std::chrono::seconds kLong{5};  // one that takes less is told by its result alone
  const auto begin = Deadline::Clock::now();
  search.progress = [&progress, begin](std::string_view step, double share) {
    if (Deadline::Clock::now() - begin < kLong) return;
    progress.show(static_cast<std::size_t>(std::lround(100.0 * share)), step);
  };
  JointFit joint = fit_actuator(asset, samples, search);
  FitResult result{.report = std::move(joint.report), .loads = {}};
  for (const RecordingFit& recording : joint.recordings)
    if (!recording.load.name.empty()) result.loads.push_back(recording.load);
  return result;
}

/// Whether it is admissible, with every channel nearer to its recording than the recording's mean is.
bool follows(const FitReport& fit) {
  return fit.admissible &&
         std::ranges::all_of(fit.channels, [](const ChannelFit& channel) { return channel.nrmse_percent > 0.0; });
}

/// The cylinder circuit wants the test as the services see it: cut, aligned, with its phases.
FitReport fit_cylinder(const AssetConfig& asset, const Recording& recording) {
  const std::vector<AssetConfig> assets = {asset};
  const std::vector<LayerMaker> layers = {
      [&assets](const std::string&) { return std::make_unique<DataAcquisition>(assets); },
      [&assets](const std::string&) { return std::make_unique<DataManipulation>(assets); }};
  TestWindow window;
  InProcessPipeline pipeline(layers, [&window](const Message& message) {
    if (const auto* concluded = std::get_if<TestWindow>(&message)) window = *concluded;
  });
  for (RawSamples& block : blocks_of(recording)) pipeline.push(Message(std::move(block)));
  return fit_cylinder_circuit(asset, window.samples, window.phases);
}

/// Fits that share no recording, as one: parameters weighted by 1/std_error^2, channels by their mean square.
FitReport pooled(std::vector<FitReport> fits) {
  FitReport whole = fits.front();
  if (fits.size() == 1) return whole;
  whole.covariance.clear();
  whole.termination = "weighted mean of " + std::to_string(fits.size()) + " fits; the first: " + whole.termination;
  for (EstimatedParameter& parameter : whole.parameters) {
    double weights = 0.0;
    double sum = 0.0;
    for (const FitReport& fit : fits)
      for (const EstimatedParameter& other : fit.parameters) {
        if (other.name != parameter.name || !(other.std_error > 0.0) || !std::isfinite(other.std_error)) continue;
        const double weight = 1.0 / (other.std_error * other.std_error);
        weights += weight;
        sum += weight * other.value;
      }
    if (weights <= 0.0) continue;
    parameter.value = sum / weights;
    parameter.std_error = std::sqrt(1.0 / weights);
  }
  for (ChannelFit& channel : whole.channels) {
    double squares = 0.0;
    for (const FitReport& fit : fits)
      for (const ChannelFit& other : fit.channels)
        if (other.channel == channel.channel) squares += other.noise_normalised_rms * other.noise_normalised_rms;
    channel.noise_normalised_rms = std::sqrt(squares / static_cast<double>(fits.size()));
  }
  for (std::size_t k = 1; k < fits.size(); ++k) {
    whole.converged = whole.converged && fits[k].converged;
    whole.admissible = whole.admissible && fits[k].admissible;
    whole.reasons.insert(whole.reasons.end(), fits[k].reasons.begin(), fits[k].reasons.end());
  }
  return whole;
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json parameter_json(const EstimatedParameter& parameter) {
  return {{"name", parameter.name},
          {"value", number_or_null(parameter.value)},
          {"std_error", number_or_null(parameter.std_error)},
          {"unit", parameter.unit},
          {"at_bound", parameter.at_bound},
          {"free", parameter.free},
          {"min", number_or_null(parameter.min)},
          {"max", number_or_null(parameter.max)}};
}

void print_json(const AssetConfig& asset, const std::vector<std::string>& recordings, const FitResult& fit) {
  Json json = {{"schema", "sealwatch.fit/1"}, {"asset_id", asset.asset_id},  {"model", fit.report.model},
               {"recordings", recordings},    {"parameters", Json::array()}, {"loads", Json::array()},
               {"channels", Json::object()}};
  for (const EstimatedParameter& parameter : fit.report.parameters)
    json["parameters"].push_back(parameter_json(parameter));
  for (std::size_t k = 0; k < fit.loads.size(); ++k) {
    Json load = parameter_json(fit.loads[k]);
    load["recording"] = recordings[k];
    json["loads"].push_back(load);
  }
  for (const ChannelFit& channel : fit.report.channels)
    json["channels"][channel.channel] = {{"noise_normalised_rms", number_or_null(channel.noise_normalised_rms)},
                                         {"nrmse_percent", number_or_null(channel.nrmse_percent)},
                                         {"whiteness_p", number_or_null(channel.whiteness_p)},
                                         {"independence_p", number_or_null(channel.independence_p)}};
  json["termination"] = fit.report.termination;
  json["converged"] = fit.report.converged;
  json["admissible"] = fit.report.admissible;
  json["reasons"] = fit.report.reasons;
  std::printf("%s\n", json.dump(1).c_str());
}

void print_text(const AssetConfig& asset, const std::vector<std::string>& recordings, const FitResult& fit) {
  std::printf("%s, model %s, %s: %s\n", asset.asset_id.c_str(), fit.report.model.c_str(),
              count_of(recordings.size(), "recording").c_str(),
              fit.report.admissible ? "admissible" : "NOT admissible");
  for (const std::string& reason : fit.report.reasons) std::printf("  - %s\n", wrapped(reason, 110, 4).c_str());
  if (fit.report.channels.empty()) return;  // no simulation came to its end: there is nothing to show
  std::vector<EstimateRow> rows;
  for (const EstimatedParameter& parameter : fit.report.parameters)
    if (parameter.free) rows.push_back({parameter});
  for (std::size_t k = 0; k < fit.loads.size(); ++k)
    if (fit.loads.size() > 1) rows.push_back({fit.loads[k], std::filesystem::path(recordings[k]).filename().string()});
  if (!fit.report.admissible && !rows.empty()) std::printf("\n  Values at the end of the search; do not use them:\n");
  std::printf("\n%s", estimates_table(rows).c_str());
  std::printf("\n%s", channels_table(fit.report.channels).c_str());
  std::printf("\n  %s\n", wrapped(fit.report.termination, 110, 2).c_str());
  if (!fit.report.admissible)
    std::printf("\n  If other tests also end like this, the model lacks something: run sealwatch explain.\n");
}

std::optional<FitResult> fit_as_asked(const FitOptions& options, const AssetConfig& asset,
                                      const PlantDescription& plant, const std::vector<Recording>& recordings,
                                      const Deadline& deadline) {
  std::vector<std::string> known = {asset.model};
  if (has_cylinder_circuit(asset)) known.emplace_back(kCylinderCircuit);
  if (!options.model.empty() && std::find(known.begin(), known.end(), options.model) == known.end()) {
    complain(Error{.file = {},
                   .place = "--model",
                   .value = options.model,
                   .rule = "is not a model of this asset",
                   .advice = suggest(options.model, known)});
    return std::nullopt;
  }
  const bool cylinder = options.model.empty() ? has_cylinder_circuit(asset) && !inputs_recorded(plant, recordings)
                                              : options.model == kCylinderCircuit;
  if (!cylinder) return fit_whole(asset, recordings, options.threads, deadline);
  std::vector<FitReport> fits;
  fits.reserve(recordings.size());
  for (const Recording& recording : recordings) fits.push_back(fit_cylinder(asset, recording));
  return FitResult{.report = pooled(std::move(fits)), .loads = {}};
}

}  // namespace

int run_fit(const FitOptions& options) {
  keep_blocks_of_a_search();
  const std::optional<AssetConfig> asset = load_asset_of_known_plant(options.asset_file, options.map_file);
  if (!asset) return kBadInput;
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  const auto recordings = read_recordings(options.recordings, *asset, **plant);
  if (!recordings) return kBadInput;
  Deadline deadline;
  deadline.set_in(options.time_limit_s);
  const std::optional<Runaway> runaway = tell_runaway(*recordings, *asset, &deadline);
  std::optional<FitResult> fit = fit_as_asked(options, *asset, **plant, *recordings, deadline);
  if (!fit) return kBadInput;
  if (runaway && !follows(fit->report)) {
    fit->report.admissible = false;
    fit->report.reasons.push_back(in_words(*runaway));
  }
  const std::vector<std::string> names = names_of(*recordings);
  options.json ? print_json(*asset, names, *fit) : print_text(*asset, names, *fit);
  return fit->report.admissible ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli
