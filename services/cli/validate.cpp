// `sealwatch validate`: the model's simulation beside recordings (docs/records/verification.md).
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sealwatch/core/file.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/cli/validate_page.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json channel_json(const ChannelValidation& channel) {
  const bool noise_known = channel.noise_std > 0.0;
  return {{"nrmse_percent", number_or_null(channel.fit.nrmse_percent)},
          {"noise_std", noise_known ? Json(channel.noise_std) : Json(nullptr)},
          {"noise_normalised_rms", noise_known ? number_or_null(channel.fit.noise_normalised_rms) : Json(nullptr)},
          {"whiteness_p", number_or_null(channel.fit.whiteness_p)},
          {"independence_p", number_or_null(channel.fit.independence_p)},
          {"unit", channel.unit}};
}

std::string to_json(const AssetConfig& asset, const ModelValidation& validation) {
  Json json = {
      {"schema", "sealwatch.validation/1"}, {"asset_id", asset.asset_id},          {"model", asset.model},
      {"fitted", validation.fitted},        {"valid", validation.reasons.empty()}, {"reasons", validation.reasons},
      {"remarks", validation.remarks},      {"parameters", Json::array()},         {"recordings", Json::array()}};
  for (const EstimatedParameter& parameter : validation.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", number_or_null(parameter.value)},
                                  {"std_error", number_or_null(parameter.std_error)},
                                  {"unit", parameter.unit},
                                  {"at_bound", parameter.at_bound}});
  for (const RecordingValidation& recording : validation.recordings) {
    Json one = {{"recording", recording.recording}, {"channels", Json::object()}};
    for (const ChannelValidation& channel : recording.channels)
      one["channels"][channel.fit.channel] = channel_json(channel);
    json["recordings"].push_back(std::move(one));
  }
  return json.dump(1) + "\n";
}

void print_text(const AssetConfig& asset, const ModelValidation& validation, const std::string& directory) {
  std::printf("%s, model %s, %s: %s\n", asset.asset_id.c_str(), asset.model.c_str(),
              validation.fitted ? "parameters fitted to these recordings" : "parameters as in the asset file",
              verdict_in_words(validation));
  for (const auto* list : {&validation.reasons, &validation.remarks})
    for (const std::string& reason : *list) std::printf("  - %s\n", wrapped(reason, 110, 4).c_str());
  std::printf("  %-34s %-22s %9s %10s   %-13s %s\n", "recording", "channel", "NRMSE %", "rms/noise", "whiteness p",
              "independence p");
  for (const RecordingValidation& recording : validation.recordings)
    for (const ChannelValidation& channel : recording.channels)
      std::printf(
          "  %-34s %-22s %s   %s %s\n", std::filesystem::path(recording.recording).filename().string().c_str(),
          channel.fit.channel.c_str(),
          text::format("{:9.2f} {:>10}", channel.fit.nrmse_percent, text::misfit_text(channel.fit.noise_normalised_rms))
              .c_str(),
          padded(text::p_value_text(channel.fit.whiteness_p), 13).c_str(),
          text::p_value_text(channel.fit.independence_p).c_str());
  if (const std::string next = next_step(validation); !next.empty()) std::printf("%s\n", next.c_str());
  std::printf("wrote report.html and validation.json to %s\n", directory.c_str());
}

Status write_text(const std::filesystem::path& file, const std::string& text) {
  std::error_code problem;
  std::filesystem::create_directories(file.parent_path(), problem);
  return write_file(file.string(), text);
}

}  // namespace

int run_validate(const ValidateOptions& options) {
  if (!options.simulated.empty()) return run_validate_trace(options);
  for (const auto& [option, value] : {std::pair{"--asset", &options.asset_file}, {"--out", &options.directory}})
    if (value->empty()) {
      complain({.file = {},
                .place = option,
                .value = {},
                .rule = "is required",
                .advice = "give --asset FILE and --out DIR (for the report), or --simulated SIM.csv to compare a trace "
                          "of your own "
                          "simulation"});
      return kBadInput;
    }
  const std::optional<AssetConfig> asset = load_asset_of_known_plant(options.asset_file, options.map_file);
  if (!asset) return kBadInput;
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  const auto recordings = read_recordings(options.recordings, *asset, **plant);
  if (!recordings) return kBadInput;
  const std::optional<Runaway> runaway = tell_runaway(*recordings, *asset);
  auto validation = validate_model(*asset, *recordings, names_of(*recordings), options.fit);
  if (!validation) {
    complain(validation.error());
    return kBadInput;
  }
  if (runaway && !validation->reasons.empty()) validation->reasons.push_back(in_words(*runaway));
  const std::string json = to_json(*asset, *validation);
  const std::filesystem::path folder = options.directory;
  for (const auto& [name, text] :
       {std::pair{"validation.json", json}, {"report.html", validation_page(*asset, *validation)}})
    if (const Status written = write_text(folder / name, text); !written) {
      complain(written.error());
      return kBadInput;
    }
  if (options.json)
    std::printf("%s", json.c_str());
  else
    print_text(*asset, *validation, options.directory);
  return validation->reasons.empty() ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli
