#include "services/verification/command/options.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include "sealwatch/core/text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/verification/lives/run_lives.hpp"
#include "services/verification/trial/mismatch_records.hpp"
#include "services/verification/trial/mismatch_trial.hpp"

namespace sealwatch::cli {
namespace {

using verification::MismatchRecord;

constexpr const char* kRecords = "sets.jsonl";

struct PlannedSet {
  TrialStratum stratum;
  std::uint64_t seed;
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the zero of a comparison for a pointer
  friend auto operator<=>(const PlannedSet&, const PlannedSet&) = default;
};

int refused(const Error& error) {
  complain(error);
  return kBadInput;
}

std::string in(const std::string& directory, const char* name) {
  return (std::filesystem::path(directory) / name).string();
}

Result<std::vector<TrialStratum>> strata_of(const VerifyMismatchOptions& options) {
  std::vector<TrialStratum> strata;
  std::vector<std::string> names;
  for (const std::string_view name : EnumNames<TrialStratum>::kNames) names.emplace_back(name);
  for (const std::string& name : options.strata.empty() ? names : options.strata) {
    const auto stratum = value_of<TrialStratum>(name);
    if (!stratum)
      return fail(Error{.file = {},
                        .place = "--strata",
                        .value = name,
                        .rule = "is not a stratum of the trial",
                        .advice = suggest(name, names)});
    strata.push_back(*stratum);
  }
  return strata;
}

/// Sets of this shard: all strata's first sets first, so that an interrupted campaign has some of each.
std::vector<PlannedSet> planned_sets(const VerifyMismatchOptions& options, const std::vector<TrialStratum>& strata,
                                     const verification::Shard& shard) {
  std::vector<PlannedSet> sets;
  for (std::uint32_t k = shard.part - 1; k < static_cast<std::uint32_t>(options.sets); k += shard.of)
    for (const TrialStratum stratum : strata) sets.push_back({stratum, options.seed + k});
  return sets;
}

/// Hashes of the labels, to be committed before thresholds are frozen.
int write_seal(const VerifyMismatchOptions& options, const std::vector<TrialStratum>& strata) {
  const std::string file = in(options.directory, "sealed.txt");
  std::ofstream stream(file, std::ios::trunc);
  for (const TrialStratum stratum : strata) {
    std::string line(name_of(stratum));
    line.append(", seeds ").append(std::to_string(options.seed)).append(" to ");
    line.append(std::to_string(options.seed + static_cast<std::uint64_t>(options.sets) - 1)).append(": ");
    line.append(bench::label_hash(stratum, options.seed, options.sets, options.tolerance));
    stream << line << "\n";
    std::printf("%s\n", line.c_str());
  }
  stream.close();
  if (!stream) return refused({.file = file, .place = {}, .value = {}, .rule = "cannot be written", .advice = {}});
  return kOk;
}

/// Runs what is missing, appending a line for each set as soon as it is done.
class Campaign {
 public:
  Campaign(const VerifyMismatchOptions& options, std::vector<PlannedSet> missing, std::vector<MismatchRecord>& records)
      : options_(options),
        missing_(std::move(missing)),
        records_(records),
        stream_(in(options.directory, kRecords), std::ios::app | std::ios::binary),
        progress_("verify mismatch", missing_.size(), "sets") {}

  bool run() {
    const int threads =
        options_.threads > 0 ? options_.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::vector<std::jthread> workers;
    for (int k = 0; k < threads; ++k) workers.emplace_back([this] { work(); });
    workers.clear();
    progress_.finish();
    return static_cast<bool>(stream_);
  }

 private:
  void work() {
    for (std::size_t k = next_++; k < missing_.size() && !interrupted(); k = next_++) {
      const bench::TrialPlan plan = bench::plan_trial(missing_[k].stratum, missing_[k].seed, options_.tolerance);
      MismatchRecord record = verification::run_trial(plan, {.controls = !options_.without_controls, .threads = 1});
      const std::lock_guard guard(lock_);
      stream_ << to_json_line(record) << "\n" << std::flush;
      progress_.show(++done_, record.stratum + " " + std::to_string(record.seed) + ": " + record.answer.verdict);
      records_.push_back(std::move(record));
    }
  }

  const VerifyMismatchOptions& options_;
  std::vector<PlannedSet> missing_;
  std::vector<MismatchRecord>& records_;
  std::ofstream stream_;
  Progress progress_;
  std::mutex lock_;
  std::atomic<std::size_t> next_ = 0;
  std::size_t done_ = 0;
};

/// Whole lines only, so that the next is not written behind a cut one.
Status rewrite(const std::string& file, const std::vector<MismatchRecord>& records) {
  std::ofstream stream(file, std::ios::trunc | std::ios::binary);
  for (const MismatchRecord& record : records) stream << to_json_line(record) << "\n";
  stream.close();
  if (stream) return {};
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = "cannot be written", .advice = {}});
}

int conclude(const VerifyMismatchOptions& options, std::vector<MismatchRecord>& records) {
  std::ranges::sort(records, {}, [](const MismatchRecord& r) { return std::pair(r.stratum, r.seed); });
  const auto tallies = verification::summarise_trials(records);
  const std::string json = tallies_to_json(tallies);
  const std::string table = verification::trial_table(tallies);
  std::ofstream(in(options.directory, "results.json")) << json;
  std::ofstream(in(options.directory, "results.txt")) << table;
  std::ofstream(in(options.directory, "failures.txt")) << verification::trial_failures(records);
  std::printf("%s", options.json ? json.c_str() : table.c_str());
  if (!options.json)
    std::printf("\nin %s: sets.jsonl, results.json, results.txt, failures.txt\n", options.directory.c_str());
  return kOk;
}

}  // namespace

int run_verify_mismatch(const VerifyMismatchOptions& options) {
  const auto strata = strata_of(options);
  if (!strata) return refused(strata.error());
  const auto shard = verification::shard_named(options.shard);
  if (!shard) return refused(shard.error());
  std::error_code problem;
  std::filesystem::create_directories(options.directory, problem);
  if (options.seal) return write_seal(options, *strata);

  const std::string file = in(options.directory, kRecords);
  auto records = read_mismatch_records(file);
  if (!records) return refused(records.error());
  if (!records->empty() && !options.resume)
    return refused({.file = file,
                    .place = {},
                    .value = {},
                    .rule = "holds the sets of an earlier run",
                    .advice = "--resume goes on with it"});
  if (const Status written = rewrite(file, *records); !written) return refused(written.error());
  std::set<PlannedSet> done;
  for (const MismatchRecord& record : *records)
    if (const auto stratum = value_of<TrialStratum>(record.stratum)) done.insert({*stratum, record.seed});
  for (const std::string& directory : options.from) {
    auto others = read_mismatch_records(in(directory, kRecords));
    if (!others) return refused(others.error());
    for (MismatchRecord& record : *others)
      if (const auto stratum = value_of<TrialStratum>(record.stratum);
          stratum && done.insert({*stratum, record.seed}).second)
        records->push_back(std::move(record));
  }
  std::vector<PlannedSet> missing = planned_sets(options, *strata, *shard);
  std::erase_if(missing, [&](const PlannedSet& set) { return done.contains(set); });
  catch_interrupts();
  if (!Campaign(options, std::move(missing), *records).run())
    return refused({.file = file, .place = {}, .value = {}, .rule = "cannot be written", .advice = {}});
  const int status = conclude(options, *records);
  return interrupted() ? kAnswerIsNo : status;
}

}  // namespace sealwatch::cli
