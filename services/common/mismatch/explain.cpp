#include "sealwatch/mismatch/explain.hpp"

#include <algorithm>
#include <iterator>

#include "services/common/mismatch/analysis.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/pieces.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

// One recording alone, in two where it is long; nothing otherwise.
std::vector<Recording> halves_of_one(const AssetConfig& asset, std::span<const Recording> fit,
                                     std::span<const Recording> holdout) {
  if (fit.size() != 1 || !holdout.empty()) return {};
  const auto simulation = PlantSimulation::create(asset, fit.front().samples);
  return simulation ? in_halves(fit.front(), (*simulation)->channels()) : std::vector<Recording>{};
}

}  // namespace

Status ExplainOptions::validate() const {
  if (!(false_alarm_rate > 0.0 && false_alarm_rate < 0.5))
    return fail("false_alarm_rate must be between 0 and 0.5, is " + number(false_alarm_rate));
  if (maximum_laws < 1 || maximum_laws > 3)
    return fail("maximum_laws must be 1 to 3, is " + std::to_string(maximum_laws));
  if (!(time_limit_s > 0.0)) return fail("time_limit_s must be positive, is " + number(time_limit_s));
  if (threads < 1) return fail("threads must be at least 1, is " + std::to_string(threads));
  return {};
}

Result<Explanation> explain(const AssetConfig& asset, std::span<const Recording> fit,
                            std::span<const Recording> holdout, const ExplainOptions& options,
                            const Progress& progress) {
  if (const Status status = options.validate(); !status) return fail(status.error());
  if (const Status status = check(asset, fit, holdout); !status) return fail(status.error());
  std::vector<std::string> notes;
  const std::vector<Recording> kept_aside = thinned(holdout, notes);
  std::vector<Recording> fitted = thinned(fit, notes);
  std::vector<Recording> halves = halves_of_one(asset, fitted, kept_aside);
  if (!halves.empty()) fitted = halves;
  Data data = data_of(fitted, kept_aside);
  data.are_parts = !halves.empty();
  Result<Explanation> found = Analysis(asset, std::move(data), data_of(kept_aside, fitted), options, progress).run();
  if (!found) return found;
  std::ranges::move(notes, std::back_inserter(found->notes));
  if (const auto plant = find_plant(asset.model))
    for (const std::string& remark : (*plant)->remarks) found->notes.push_back("Of the plant's file: " + remark + ".");
  if (!halves.empty())
    found->notes.push_back(
        "The one recording is long enough to be two, a correlation time apart: each half is left out "
        "in turn.");
  std::vector<std::string> told;  // of recordings of one kind once
  for (const auto& list : {fit, holdout})
    for (const Recording& recording : list) {
      if (!recording.left_aside.empty())
        found->notes.push_back(recording.file + ": columns that the plant does not know were left aside: " +
                               joined(recording.left_aside, " and ") + ".");
      for (const std::string& warning : recording.warnings)
        if (recording.warnings != told) found->notes.push_back(recording.file + ": " + warning + ".");
      told = recording.warnings;
    }
  return found;
}

}  // namespace sealwatch::mismatch
