#include "services/common/estimation/piecewise_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/common/estimation/rows_of.hpp"

namespace sealwatch {
namespace {

constexpr std::array<std::size_t, 2> kPieces = {32, 4};  // of a recording
constexpr std::size_t kFewestSamples = 8;                // of a piece
constexpr std::size_t kMostPieces = 128;                 // at a time: as many of all pieces as show the plant
constexpr int kIterations = 12;

struct Pieces {
  std::vector<TimeSeries> samples;
  std::vector<int> groups;          ///< which recording each was cut from
  std::vector<std::size_t> number;  ///< which piece of it
};

Pieces cut(std::span<const TimeSeries> recordings, std::size_t count) {
  const std::size_t step = (recordings.size() * count + kMostPieces - 1) / kMostPieces;
  Pieces pieces;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const std::size_t rows = recordings[k].time_s.size();
    const std::size_t parts = std::clamp<std::size_t>(rows / kFewestSamples, 1, count);
    for (std::size_t part = 0; part < parts; part += step) {
      pieces.samples.push_back(rows_of(recordings[k], part * rows / parts, (part + 1) * rows / parts));
      pieces.groups.push_back(static_cast<int>(k));
      pieces.number.push_back(part);
    }
  }
  return pieces;
}

void free_all_states(PemRecording& piece, const PlantDescription& plant) {
  for (const std::string& state : piece.simulation->free_state_names()) {
    const std::string name = "initial:" + state;
    if (std::ranges::find(piece.own, name, &Unknown::name) != piece.own.end()) continue;
    const FreeQuantity quantity = *piece.simulation->find(name);
    const double start = quantity.in(piece.simulation->start());
    const auto [least, most] = piece.simulation->initial_range(state);
    piece.own.push_back({.name = name,
                         .unit = plant.find_state(state) == nullptr ? "1" : plant.find_state(state)->unit,
                         .quantity = quantity,
                         .scale = start != 0.0 ? std::abs(start) : 1.0,
                         .start = start,
                         .min = least,
                         .max = most});
  }
}

const double* find_value(const std::vector<Unknown>& unknowns, const std::vector<double>& at, const std::string& name) {
  const auto found = std::ranges::find(unknowns, name, &Unknown::name);
  return found == unknowns.end() ? nullptr : &at[static_cast<std::size_t>(found - unknowns.begin())];
}

}  // namespace

std::optional<PemPoint> piecewise_start(const PemProblem& problem, const AssetConfig& asset,
                                        std::span<const TimeSeries> recordings, const ActuatorFitOptions& options) {
  if (std::ranges::any_of(problem.shared, [](const Unknown& unknown) { return unknown.group >= 0; })) return {};
  const PlantDescription& plant = problem.recordings.front().simulation->plant();
  PemPoint whole = start_point(problem, 1.0);
  ActuatorFitOptions of_pieces = options;
  of_pieces.maximum_iterations = kIterations;
  of_pieces.hopeless_rms = std::numeric_limits<double>::max();
  for (const std::size_t count : kPieces) {
    const Pieces pieces = cut(recordings, count);
    Result<PemProblem> cut_problem = make_pem_problem(asset, pieces.samples, pieces.groups);
    if (!cut_problem) return {};
    std::vector<Unknown> loads;  // of each recording, which follow what all share
    std::ranges::copy_if(cut_problem->shared, std::back_inserter(loads),
                         [](const Unknown& unknown) { return unknown.group >= 0; });
    cut_problem->shared = problem.shared;
    std::ranges::copy(loads, std::back_inserter(cut_problem->shared));
    cut_problem->simulation_options = problem.simulation_options;
    for (PemRecording& piece : cut_problem->recordings) free_all_states(piece, plant);
    PemPoint start = start_point(*cut_problem, 1.0);
    std::ranges::copy(whole.shared, start.shared.begin());
    const Result<PemOptimum> found = search(*cut_problem, std::move(start), of_pieces);
    if (!found) return {};
    const PemPoint& point = found->point;
    std::copy_n(point.shared.begin(), whole.shared.size(), whole.shared.begin());
    for (std::size_t k = 0; k < pieces.samples.size(); ++k) {
      const auto recording = static_cast<std::size_t>(pieces.groups[k]);
      const std::vector<Unknown>& own = problem.recordings[recording].own;
      for (std::size_t j = 0; j < own.size(); ++j) {
        const double* value =
            pieces.number[k] == 0 ? find_value(cut_problem->recordings[k].own, point.own[k], own[j].name) : nullptr;
        if (value == nullptr)
          value = find_value(cut_problem->shared, point.shared, own[j].name + ":" + std::to_string(recording));
        if (value != nullptr) whole.own[recording][j] = *value;
      }
    }
  }
  return whole;
}

}  // namespace sealwatch
