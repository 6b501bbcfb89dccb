#include "services/common/estimation/piecewise_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/common/estimation/own_jumps.hpp"
#include "services/common/estimation/rows_of.hpp"

namespace sealwatch {
namespace {

constexpr std::array<std::size_t, 2> kPieces = {32, 4};  // of a recording without jumps
constexpr std::size_t kPerJump = 8;                      // pieces at first, of one with jumps
constexpr std::size_t kBeside = 8;                       // samples beside a jump: this part of those up to the next
constexpr std::size_t kFewestSamples = 8;                // of a piece
constexpr std::size_t kMostPieces = 128;                 // at a time: as many of all pieces as show the plant
constexpr int kIterations = 12;

struct Pieces {
  std::vector<TimeSeries> samples;
  std::vector<int> groups;         ///< which recording each was cut from
  std::vector<std::size_t> first;  ///< its first row there
};

/// Of each recording and channel, where it jumps by itself.
using Jumps = std::vector<std::vector<std::vector<std::size_t>>>;

Jumps jumps_of(const PemProblem& problem, std::span<const TimeSeries> recordings) {
  Jumps jumps(recordings.size());
  for (std::size_t k = 0; k < recordings.size(); ++k)
    for (const std::string& channel : problem.recordings[k].simulation->channels())
      jumps[k].push_back(own_jumps(*problem.recordings[k].simulation, *recordings[k].find(channel)));
  return jumps;
}

/// How many pieces are cut of a recording, time after time. At first few of them have a jump, and none has two.
std::vector<std::size_t> numbers_of_pieces(const Jumps& jumps, std::span<const TimeSeries> recordings) {
  std::size_t most = 0, longest = 0;
  for (const TimeSeries& recorded : recordings) longest = std::max(longest, recorded.time_s.size());
  for (const auto& recording : jumps)
    for (const auto& channel : recording) most = std::max(most, channel.size());
  if (most == 0) return {kPieces.begin(), kPieces.end()};
  std::vector<std::size_t> numbers;
  const std::size_t first = std::min(kPerJump * (most + 1), longest / kFewestSamples);
  for (std::size_t count = first; count > 1; count /= 2) numbers.push_back(count);
  return numbers;
}

/// Weights of a recording's residuals. While values are wrong a jump is simulated early or late, by many times the
/// noise and whatever the slopes say: beside a jump samples have no weight.
Eigen::VectorXd weights_beside(const std::vector<std::vector<std::size_t>>& jumps, std::size_t rows) {
  const std::size_t width = jumps.size();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(width * rows));
  for (std::size_t channel = 0; channel < width; ++channel) {
    const std::vector<std::size_t>& at = jumps[channel];
    for (std::size_t k = 0; k < at.size(); ++k) {
      const std::size_t before = at[k] - (k > 0 ? at[k - 1] : 0),
                        behind = (k + 1 < at.size() ? at[k + 1] : rows) - at[k];
      const std::size_t beside = 1 + std::min(before, behind) / kBeside;
      for (std::size_t row = at[k] - std::min(beside, at[k]); row < std::min(rows, at[k] + beside); ++row)
        weights(static_cast<Eigen::Index>(width * row + channel)) = 0.0;
    }
  }
  return weights;
}

/// The first row from there whose samples show a start: it is the mean of three, in which there is no jump.
std::size_t first_without_jump(const Eigen::VectorXd& weights, std::size_t width, std::size_t row, std::size_t end) {
  constexpr std::size_t kOfStart = 3;
  const auto jumps = [&](std::size_t at) {
    return !weights.segment(static_cast<Eigen::Index>(width * at), static_cast<Eigen::Index>(width * kOfStart)).all();
  };
  std::size_t first = row;
  while (first + kOfStart < end && jumps(first)) ++first;
  return first + kOfStart < end ? first : row;
}

Pieces cut(std::span<const TimeSeries> recordings, const std::vector<Eigen::VectorXd>& weights, std::size_t count) {
  const std::size_t step = (recordings.size() * count + kMostPieces - 1) / kMostPieces;
  Pieces pieces;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const std::size_t rows = recordings[k].time_s.size();
    const std::size_t parts = std::clamp<std::size_t>(rows / kFewestSamples, 1, count);
    for (std::size_t part = 0; part < parts; part += step) {
      const std::size_t end = (part + 1) * rows / parts, width = static_cast<std::size_t>(weights[k].size()) / rows;
      const std::size_t first = first_without_jump(weights[k], width, part * rows / parts, end);
      if (part > 0 && end - first < kFewestSamples) continue;
      pieces.first.push_back(first);
      pieces.samples.push_back(rows_of(recordings[k], first, end));
      pieces.groups.push_back(static_cast<int>(k));
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

/// The pieces have the unknowns of the whole, states and loads of their own, and the noise of the whole, of which they
/// themselves show too little.
void share_unknowns(const PemProblem& problem, const Pieces& pieces, const std::vector<Eigen::VectorXd>& weights,
                    PemProblem& of_pieces) {
  const PlantDescription& plant = problem.recordings.front().simulation->plant();
  std::vector<Unknown> loads;  // of each recording, which follow what all share
  std::ranges::copy_if(of_pieces.shared, std::back_inserter(loads),
                       [](const Unknown& unknown) { return unknown.group >= 0; });
  of_pieces.shared = problem.shared;
  std::ranges::copy(loads, std::back_inserter(of_pieces.shared));
  of_pieces.simulation_options = problem.simulation_options;
  for (std::size_t k = 0; k < pieces.samples.size(); ++k) {
    PemRecording& piece = of_pieces.recordings[k];
    free_all_states(piece, plant);
    const auto recording = static_cast<std::size_t>(pieces.groups[k]);
    piece.noise_std = problem.recordings[recording].noise_std;
    const Eigen::Index width = piece.noise_std.size();
    piece.weight = weights[recording].segment(width * static_cast<Eigen::Index>(pieces.first[k]),
                                              width * std::ssize(pieces.samples[k].time_s));
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
  PemPoint whole = start_point(problem, 1.0);
  ActuatorFitOptions of_pieces = options;
  of_pieces.maximum_iterations = kIterations;
  of_pieces.hopeless_rms = std::numeric_limits<double>::max();
  const Jumps jumps = jumps_of(problem, recordings);
  std::vector<Eigen::VectorXd> weights;
  for (std::size_t k = 0; k < recordings.size(); ++k)
    weights.push_back(weights_beside(jumps[k], recordings[k].time_s.size()));
  for (const std::size_t count : numbers_of_pieces(jumps, recordings)) {
    const Pieces pieces = cut(recordings, weights, count);
    Result<PemProblem> cut_problem = make_pem_problem(asset, pieces.samples, pieces.groups);
    if (!cut_problem) return {};
    share_unknowns(problem, pieces, weights, *cut_problem);
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
            pieces.first[k] == 0 ? find_value(cut_problem->recordings[k].own, point.own[k], own[j].name) : nullptr;
        if (value == nullptr)
          value = find_value(cut_problem->shared, point.shared, own[j].name + ":" + std::to_string(recording));
        if (value != nullptr) whole.own[recording][j] = *value;
      }
    }
  }
  return whole;
}

}  // namespace sealwatch
