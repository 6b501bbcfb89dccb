#include "services/common/mismatch/explain_input.hpp"

#include <algorithm>

namespace sealwatch::mismatch {
namespace {

constexpr double kRest = 5.0;  // a channel moves if it spans more than this many noise standard deviations

}  // namespace

Data data_of(std::span<const Recording> recordings) {
  Data data;
  for (const Recording& recording : recordings) {
    data.names.push_back(recording.recording_id.empty() ? recording.file : recording.recording_id);
    data.samples.push_back(recording.samples);
  }
  return data;
}

Data without(const Data& data, std::size_t left_out) {
  Data rest = data;
  const auto at = static_cast<std::ptrdiff_t>(left_out);
  rest.names.erase(rest.names.begin() + at);
  rest.samples.erase(rest.samples.begin() + at);
  if (!rest.colour.empty()) rest.colour.erase(rest.colour.begin() + at);
  return rest;
}

Data only(const Data& data, std::size_t one) {
  Data single{.names = {data.names[one]},
              .samples = {data.samples[one]},
              .colour = {},
              .groups = {},
              .resolution = data.resolution};
  if (!data.colour.empty()) single.colour = {data.colour[one]};
  return single;
}

Status check(const AssetConfig& asset, std::span<const Recording> fit, std::span<const Recording> holdout) {
  if (fit.empty()) return fail("there is no recording to fit", "give at least one");
  for (const auto& list : {fit, holdout})
    for (const Recording& recording : list) {
      if (!recording.asset_id.empty() && recording.asset_id != asset.asset_id)
        return fail(Error{.file = recording.file,
                          .place = "asset_id",
                          .value = recording.asset_id,
                          .rule = "is not the asset " + asset.asset_id,
                          .advice = "one analysis is about one asset"});
      const auto simulation = PlantSimulation::create(asset, recording.samples);
      if (!simulation) {
        Error error = simulation.error();
        if (error.file.empty()) error.file = recording.file;
        return fail(std::move(error));
      }
    }
  for (const Recording& one : holdout)
    for (const Recording& other : fit)
      if (!one.content_hash.empty() && one.content_hash == other.content_hash)
        return fail(Error{.file = one.file,
                          .place = {},
                          .value = {},
                          .rule = "is held out and fitted at once: it has the same content as " + other.file,
                          .advice = "a recording that took part in the fit proves nothing"});
  return {};
}

bool at_rest(const FittedModel& model, const Data& data) {
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    for (Eigen::Index c = 0; c < part.noise_std.size(); ++c) {
      const std::string& name = part.simulation->channels()[static_cast<std::size_t>(c)];
      if (name != "position" && name != "level_voltage") continue;
      const auto column = part.simulation->recorded().col(c);
      if (column.maxCoeff() - column.minCoeff() > 2.0 * kRest * part.noise_std(c)) return false;
    }
  }
  return std::ranges::any_of(model.problem.recordings.front().simulation->channels(),
                             [](const std::string& name) { return name == "position" || name == "level_voltage"; });
}

}  // namespace sealwatch::mismatch
