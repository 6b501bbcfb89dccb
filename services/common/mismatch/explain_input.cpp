#include "services/common/mismatch/explain_input.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sealwatch/estimation/noise_floor.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kRest = 5.0;  // a channel moves if it spans more than this many noise standard deviations

// Whether these are the same samples, written twice: as other text, in other units, with rows left out. Two tests never
// have the same noise in every channel.
bool same_samples(const TimeSeries& a, const TimeSeries& b) {
  constexpr double kSameTime_s = 1e-6, kSameValue = 1e-6, kMost = 0.9;
  constexpr std::size_t kEnough = 50;
  std::vector<std::pair<std::size_t, std::size_t>> rows;  // of the same time
  for (std::size_t j = 0, k = 0; j < a.time_s.size() && k < b.time_s.size();) {
    const double later_s = a.time_s[j] - b.time_s[k];
    if (std::abs(later_s) <= kSameTime_s) rows.emplace_back(j, k);
    if (later_s >= -kSameTime_s) ++k;
    if (later_s <= kSameTime_s) ++j;
  }
  if (rows.size() < kEnough) return false;
  bool shared = false;
  for (const Series& channel : a.channels) {
    const Series* other = b.find(channel.name);
    if (other == nullptr) continue;
    shared = true;
    const auto equal = std::ranges::count_if(rows, [&](const auto& row) {
      const double x = channel.values[row.first], y = other->values[row.second];
      return std::abs(x - y) <= kSameValue * std::max(std::abs(x), std::abs(y)) || (std::isnan(x) && std::isnan(y));
    });
    if (static_cast<double>(equal) < kMost * static_cast<double>(rows.size())) return false;
  }
  return shared;
}

double span_of(const Series& channel) {
  const auto [least, most] = std::ranges::minmax(channel.values);
  return most - least;
}

// An output that is one number from beginning to end while another moves far beyond its noise: a dead sensor, which
// gains of healthy ones would be bent to explain. At rest every output may be.
const Series* stuck_channel(const PlantSimulation& simulation, const TimeSeries& samples) {
  constexpr double kMoves = 50.0;
  const Series* stuck = nullptr;
  bool moves = false;
  for (const std::string_view name : simulation.channels()) {
    const Series* channel = samples.find(std::string(name));
    if (channel == nullptr || channel->values.empty()) continue;
    if (span_of(*channel) == 0.0) stuck = channel;
    const double noise = estimate_noise_floor(channel->values).standard_deviation;
    moves = moves || (noise > 0.0 && span_of(*channel) > kMoves * noise);
  }
  return moves ? stuck : nullptr;
}

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
      if (const Series* stuck = stuck_channel(**simulation, recording.samples))
        return fail(Error{.file = recording.file,
                          .place = "column " + stuck->name,
                          .value = "never changes",
                          .rule = "while other channels of the recording do: the sensor is stuck",
                          .advice = "leave the column out of the recordings, or those with it"});
    }
  for (const Recording& one : holdout)
    for (const Recording& other : fit)
      if ((!one.content_hash.empty() && one.content_hash == other.content_hash) ||
          same_samples(one.samples, other.samples))
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
