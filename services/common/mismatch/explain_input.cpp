#include "services/common/mismatch/explain_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sealwatch/signal/noise_floor.hpp"
#include "sealwatch/signal/stuck.hpp"
#include "services/common/mismatch/recorded_units.hpp"
#include "services/common/mismatch/telling.hpp"

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

// How far a channel must move to speak against one that does not: far beyond its noise.
double moves_from(const Series& channel) {
  constexpr double kMoves = 50.0;
  const double noise = signal::estimate_noise_floor(channel.values).standard_deviation;
  return noise > 0.0 ? kMoves * noise : std::numeric_limits<double>::infinity();
}

// An output that is one number for a tenth of the recording or more while another moves far beyond its noise: a dead
// sensor, which gains and offsets of healthy ones would be bent to explain. `outputs`: all of them, with how far each
// must move.
std::optional<signal::ConstantRun> stuck_run(const std::vector<double>& time_s, const Series& channel,
                                             const std::vector<std::pair<const Series*, double>>& outputs) {
  constexpr double kLong = 0.1, kTimesTheNext = 10.0;
  std::vector<double> least_moves, values(outputs.size());
  for (const auto& [series, least] : outputs) least_moves.push_back(least);  // its own never moves while it is constant
  signal::StuckWatch watch(
      {.least_samples = static_cast<std::uint64_t>(std::ceil(kLong * static_cast<double>(time_s.size()))),
       .times_the_next = kTimesTheNext,
       .spare_ends = true},
      std::move(least_moves));
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    for (std::size_t c = 0; c < outputs.size(); ++c) values[c] = outputs[c].first->values[k];
    watch.add(time_s[k], channel.values[k], values);
  }
  return watch.stuck();
}

Status check_sensors(const PlantSimulation& simulation, const Recording& recording) {
  const std::vector<double>& time_s = recording.samples.time_s;
  std::vector<std::pair<const Series*, double>> outputs;
  for (const std::string& name : simulation.channels()) {
    const Series* series = recording.samples.find(name);
    outputs.emplace_back(series, moves_from(*series));
  }
  for (const auto& [series, least] : outputs) {
    const auto run = stuck_run(time_s, *series, outputs);
    if (!run) continue;
    const std::string during = run->samples == time_s.size() ? "never changes"
                                                             : "does not change from " + number(run->begin_s, 4) +
                                                                   " s to " + number(run->end_s, 4) + " s";
    return fail(Error{.file = recording.file,
                      .place = "column " + series->name,
                      .value = {},
                      .rule = during + " while other channels of the recording do: the sensor is stuck",
                      .advice = "leave the column out of the recordings, or those with it"});
  }
  return {};
}

}  // namespace

Data data_of(std::span<const Recording> recordings, std::span<const Recording> others) {
  std::vector<const Recording*> in_turn;
  for (const Recording& recording : recordings) in_turn.push_back(&recording);
  if (std::ranges::all_of(recordings, [](const Recording& one) { return one.start_time.has_value(); }))
    std::ranges::stable_sort(in_turn, {}, [](const Recording* one) { return *one->start_time; });
  Data data;
  for (const Recording* recording : in_turn) {
    const auto alike = std::ranges::count(recordings, recording->recording_id, &Recording::recording_id) +
                       std::ranges::count(others, recording->recording_id, &Recording::recording_id);
    data.names.push_back(alike > 1 || recording->recording_id.empty() ? recording->file : recording->recording_id);
    data.samples.push_back(recording->samples);
    data.start_time.push_back(recording->start_time);
  }
  return data;
}

Data without(const Data& data, std::size_t left_out) {
  Data rest = data;
  const auto at = static_cast<std::ptrdiff_t>(left_out);
  rest.names.erase(rest.names.begin() + at);
  rest.samples.erase(rest.samples.begin() + at);
  if (!rest.start_time.empty()) rest.start_time.erase(rest.start_time.begin() + at);
  if (!rest.colour.empty()) rest.colour.erase(rest.colour.begin() + at);
  if (!rest.weight.empty()) rest.weight.erase(rest.weight.begin() + at);
  return rest;
}

Data only(const Data& data, std::size_t one) {
  Data single{.names = {data.names[one]},
              .samples = {data.samples[one]},
              .colour = {},
              .groups = {},
              .resolution = data.resolution,
              .own_parameter = data.own_parameter,
              .known = data.known,
              .deadline = data.deadline};
  if (!data.start_time.empty()) single.start_time = {data.start_time[one]};
  if (!data.colour.empty()) single.colour = {data.colour[one]};
  if (!data.weight.empty()) single.weight = {data.weight[one]};
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
      if (const Status sensors = check_sensors(**simulation, recording); !sensors) return fail(sensors.error());
      if (const std::string unit = another_unit((*simulation)->plant(), recording.samples); !unit.empty())
        return fail(Error{
            .file = recording.file, .place = {}, .value = {}, .rule = unit, .advice = "check the units in its header"});
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

// Of a plant that has a stroke that, else everything.
static bool shows_motion(const PlantSimulation& simulation, const std::string& channel) {
  const std::string stroke = channel_name(simulation.plant(), ChannelRole::stroke);
  return stroke.empty() || channel == stroke;
}

bool at_rest(const FittedModel& model, const Data& data) {
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    for (Eigen::Index c = 0; c < part.noise_std.size(); ++c) {
      if (!shows_motion(*part.simulation, part.simulation->channels()[static_cast<std::size_t>(c)])) continue;
      const auto column = part.simulation->recorded().col(c);
      if (column.maxCoeff() - column.minCoeff() > 2.0 * kRest * part.noise_std(c)) return false;
    }
  }
  const PlantSimulation& simulation = *model.problem.recordings.front().simulation;
  return std::ranges::any_of(simulation.channels(),
                             [&](const std::string& name) { return shows_motion(simulation, name); });
}

}  // namespace sealwatch::mismatch
