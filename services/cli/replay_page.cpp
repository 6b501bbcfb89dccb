#include "services/cli/replay_page.hpp"

#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "services/cli/forecast_page.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"

namespace sealwatch::cli {
namespace {

/// Of what was replayed offline; else of what prognosis keeps, which knows the tests of earlier replays too.
std::optional<std::vector<ForecastQuestion>> questions_of(const ReplayOptions& options,
                                                          const Configuration& configuration,
                                                          const Histories& replayed_here) {
  std::vector<ForecastQuestion> questions;
  std::optional<StateJournals> journals;
  if (!options.offline && !(journals = StateJournals::open(options.state_directory, options.config)))
    return std::nullopt;
  for (const auto& [asset_id, replayed] : replayed_here) {
    const AssetConfig* asset = configuration.find_asset(asset_id);
    const auto history = journals ? history_in(*journals, asset_id) : std::optional(replayed);
    if (!history) return std::nullopt;
    if (asset == nullptr) continue;
    if (auto question = history->question(*asset, configuration)) questions.push_back(std::move(*question));
  }
  return questions;
}

}  // namespace

int write_replay_page(const ReplayOptions& options, const Configuration& configuration,
                      const Histories& replayed_here) {
  const auto questions = questions_of(options, configuration, replayed_here);
  if (!questions) return kBadInput;
  if (questions->empty()) {
    std::fprintf(stderr, "sealwatch: %s is not written: no test that was replayed tells of a seal\n",
                 options.page.c_str());
    return kAnswerIsNo;
  }
  if (const Status written = write_forecasts(options.page, *questions); !written) {
    complain(written.error());
    return kBadInput;
  }
  if (!options.json) std::printf("\nin %s: the forecast with plots, for a browser\n", options.page.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
