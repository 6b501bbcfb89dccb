#include "services/common/estimation/growing_start.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "services/common/estimation/rows_of.hpp"

namespace sealwatch {
namespace {

constexpr double kShortest = 1.0 / 16.0;  ///< share of a recording
constexpr double kGrowth = 1.5;
constexpr std::size_t kFewestSamples = 8;  // of a beginning
constexpr int kIterations = 12;

}  // namespace

std::optional<PemPoint> growing_start(const PemProblem& problem, const AssetConfig& asset,
                                      std::span<const TimeSeries> recordings, const ActuatorFitOptions& options) {
  if (std::ranges::any_of(problem.shared, [](const Unknown& unknown) { return unknown.group >= 0; })) return {};
  ActuatorFitOptions of_beginnings = options;
  of_beginnings.maximum_iterations = kIterations;
  of_beginnings.hopeless_rms = std::numeric_limits<double>::max();
  PemPoint point = start_point(problem, 1.0);
  for (double share = kShortest; share < 1.0; share *= kGrowth) {
    std::vector<TimeSeries> beginnings;
    for (const TimeSeries& recorded : recordings) {
      const std::size_t rows = recorded.time_s.size();
      const auto first = static_cast<std::size_t>(share * static_cast<double>(rows));
      beginnings.push_back(rows_of(recorded, 0, std::min(rows, std::max(kFewestSamples, first))));
    }
    Result<PemProblem> beginning = make_pem_problem(asset, beginnings);
    if (!beginning) return {};
    beginning->shared = problem.shared;
    beginning->simulation_options = problem.simulation_options;
    for (std::size_t k = 0; k < problem.recordings.size(); ++k)
      if (beginning->recordings[k].own.size() != problem.recordings[k].own.size()) return {};
    Result<PemOptimum> found = search(*beginning, point, of_beginnings);
    if (!found) return {};
    point = std::move(found->point);
  }
  return point;
}

}  // namespace sealwatch
