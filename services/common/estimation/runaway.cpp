#include "services/common/estimation/runaway.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/estimation/rows_of.hpp"

namespace sealwatch {
namespace {

constexpr double kRunsAway =
    4.0;  // decades: a start that is known to a ten-thousandth of the signal tells nothing then
constexpr std::size_t kFewestInPiece = 10;

/// Of each output that shows one state alone, the decades by which an error in that state's start has grown by the end.
std::map<std::string, double> grown_over(const AssetConfig& asset, const TimeSeries& piece, const Deadline* deadline) {
  std::map<std::string, double> decades;
  const auto simulation = PlantSimulation::create(asset, piece);
  if (!simulation) return decades;
  std::vector<FreeQuantity> starts;
  for (std::size_t k = 0; k < (*simulation)->state_names().size(); ++k)
    starts.push_back({FreeQuantity::Kind::initial_state, k});
  const Result<SimulatedOutputs> outputs = (*simulation)->run((*simulation)->start(), starts, {.deadline = deadline});
  if (!outputs) return decades;
  const Eigen::Index channels = outputs->values.cols(), last = outputs->values.rows() - 1;
  for (Eigen::Index c = 0; c < channels; ++c) {
    const auto first = outputs->sensitivities.row(c);
    Eigen::Index state = 0;
    if (!(first.cwiseAbs().maxCoeff(&state) > 0.0) || (first.array() != 0.0).count() != 1) continue;
    const double grown = std::abs(outputs->sensitivities(last * channels + c, state) / first(state));
    if (std::isfinite(grown))
      decades[(*simulation)->channels()[static_cast<std::size_t>(c)]] = std::log10(std::max(grown, 1e-300));
  }
  return decades;
}

}  // namespace

std::optional<Runaway> find_runaway(const AssetConfig& asset, const TimeSeries& recorded, const Deadline* deadline) {
  const auto plant = find_plant(asset.model);
  if (!plant || (*plant)->file.empty()) return std::nullopt;
  std::map<std::string, double> least;
  for (const std::size_t pieces : {20, 10}) {  // what grows in pieces of one length alone does not run away
    const std::size_t count = recorded.time_s.size() / pieces;
    if (count < kFewestInPiece) return std::nullopt;
    std::map<std::string, double> decades;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const TimeSeries rows = rows_of(recorded, piece * count, (piece + 1) * count);
      for (const auto& [channel, grown] : grown_over(asset, rows, deadline)) decades[channel] += grown;
      if (passed(deadline)) return std::nullopt;  // a product without some of its pieces says nothing
    }
    for (const auto& [channel, grown] : decades) {
      const auto known = least.try_emplace(channel, grown).first;
      known->second = std::min(known->second, grown);
    }
  }
  std::optional<Runaway> most;
  for (const auto& [channel, grown] : least)
    if (grown > kRunsAway && (!most || grown > most->decades)) most = {channel, grown};
  return most;
}

std::string in_words(const Runaway& runaway) {
  return "The simulated plant runs away by itself: an error in the start of " + runaway.channel + " grows 10^" +
         std::to_string(std::lround(runaway.decades)) +
         "-fold over the test. No simulation over the whole test can follow the machine, and what differs says little "
         "of it.";
}

std::string advice_for_runaway() {
  return "Use shorter tests, or put what holds the machine, such as its controller, into the plant's equations.";
}

}  // namespace sealwatch
