// A life that `sealwatch simulate` makes, on the virtual bench or with a plant's own equations.
#pragma once

#include <optional>
#include <string>

#include "services/cli/commands.hpp"
#include "services/virtual_bench/simulate_life.hpp"

namespace sealwatch::cli {

/// Nothing where the options do not make a life, which is then said.
[[nodiscard]] std::optional<bench::LifeSetting> life_of(const SimulateOptions& options);

/// Its months; empty where none can be planned, which is then said.
[[nodiscard]] std::vector<bench::PlannedTest> plan_of(const AssetConfig& asset, const bench::LifeSetting& life);

/// What was true of one test: for whoever wants to judge an estimate by it.
[[nodiscard]] std::string truth_line(const ConditionSetting& condition, const bench::PlannedTest& test,
                                     const std::string& recording);

/// Tests, dates and the condition at the last, on standard output.
void say_life(const std::vector<bench::PlannedTest>& plan, const std::string& directory);

}  // namespace sealwatch::cli
