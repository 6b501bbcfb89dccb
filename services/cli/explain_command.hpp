// `sealwatch explain` but for the analysis itself, which is given: reading, writing, telling, exit status.
#pragma once

#include <functional>
#include <span>

#include "sealwatch/mismatch/explain.hpp"
#include "services/cli/commands.hpp"

namespace sealwatch::cli {

using ExplainEngine = std::function<Result<mismatch::Explanation>(
    const AssetConfig& asset, std::span<const Recording> fit, std::span<const Recording> holdout,
    const mismatch::ExplainOptions& options, const mismatch::Progress& progress)>;

/// Writes report.json, report.html and asset.explained.yaml to options.directory, and prints the summary, or with
/// options.json the report. Status 0: consistent, or a mismatch that is named; 1: undetermined; 2: bad input.
[[nodiscard]] int explain_with(const ExplainEngine& engine, const ExplainOptions& options);

}  // namespace sealwatch::cli
