#include "services/cli/replay_page.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "services/cli/forecast_page.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"

namespace sealwatch::cli {
namespace {

/// Whether prognosis's journal holds the tests that were just played; complains where it is that of other services.
bool is_of_these_services(StateJournals& journals, const Histories& replayed_here) {
  for (const auto& [asset_id, replayed] : replayed_here) {
    const auto journal = journals.journal_of(Topic::leakage_estimate);
    const auto ids = journals.ids(Topic::leakage_estimate, asset_id);
    if (!journal || !ids) {
      complain(journal ? ids.error() : journal.error());
      return false;
    }
    const std::set<std::string> kept(ids->begin(), ids->end());
    const auto strange = std::ranges::find_if(replayed.estimates(), [&](const LeakageEstimate& estimate) {
      const Header& header = estimate.header;
      const bool of_this_writer = header.writer_id.empty() || header.writer_id == (*journal)->writer_id();
      return !of_this_writer || !kept.contains(header.message_id);
    });
    if (strange == replayed.estimates().end()) continue;
    complain(Error{.file = (*journal)->place(),
                   .place = "--page",
                   .value = strange->header.pst_id,
                   .rule = "was just played and is not of this journal: the services keep theirs elsewhere",
                   .advice = "give the --state that the services were started with"});
    return false;
  }
  return true;
}

/// Of what was replayed offline; else of what prognosis keeps, which knows the tests of earlier replays too.
std::optional<std::vector<ForecastQuestion>> questions_of(const ReplayOptions& options,
                                                          const Configuration& configuration,
                                                          const Histories& replayed_here) {
  std::vector<ForecastQuestion> questions;
  std::optional<StateJournals> journals;
  if (!options.offline && !(journals = StateJournals::open(options.state_directory, options.config)))
    return std::nullopt;
  if (journals && !is_of_these_services(*journals, replayed_here)) return std::nullopt;
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
  if (!questions) {
    std::fprintf(stderr, "sealwatch: --page: %s is not written\n", options.page.c_str());
    return kBadInput;
  }
  if (questions->empty()) {
    std::fprintf(stderr,
                 "sealwatch: %s is not written: nothing new was concluded of what wears in this replay; `sealwatch "
                 "forecast --page` draws what the services keep\n",
                 options.page.c_str());
    return kAnswerIsNo;
  }
  if (const Status written = write_forecasts(options.page, *questions); !written) {
    complain(written.error());
    return kBadInput;
  }
  if (!options.json) std::printf("\nwrote %s: the forecast as a page for a browser\n", options.page.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
