#include "services/verification/command/arguments.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

#include "services/cli/arguments.hpp"

namespace sealwatch::cli {
namespace {

void add_rul(CLI::App* rul, VerifyRulOptions& o) {
  rul->add_option("--asset", o.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
  rul->add_option("--out", o.directory, "directory for records and results (created if absent)")->required();
  rul->add_option("--lives", o.lives, "number of random lives")->capture_default_str();
  rul->add_option("--seed", o.seed, "same seed, same results")->check(not_negative)->capture_default_str();
  rul->add_option("--months", o.months, "months of service")->capture_default_str();
  rul->add_option("--rate", o.sample_rate_Hz, "samples a second")->capture_default_str();
  rul->add_option("--threads", o.threads, "0: one for each core")->check(CLI::Range(0, 256))->capture_default_str();
  rul->add_option("--shard", o.shard, "k/n: only this part of the lives, for `verify merge`")->capture_default_str();
  rul->add_option("--truth", o.truth, "circuit, actuator (nine-state bench) or condition (no test is simulated)")
      ->capture_default_str();
  rul->add_option("--forecaster", o.forecasters, "METHOD or METHOD:MONTHS, several times (default: all)");
  rul->add_option("--degradation", o.degradation,
                  "published_ln_t (default), published_t, bench, or NAME=NUMBER; several");
  rul->add_option("--missing", o.missing_share, "share of months without a test")->capture_default_str();
  rul->add_option("--cut", o.cut_share, "share of tests cut short")->capture_default_str();
  rul->add_option("--scenario", o.scenarios,
                  "reference, outliers, missing, aborted, replaced, load_change, contamination; several with commas, "
                  "or all: one table of them")
      ->delimiter(',');
  rul->add_flag("--direct", o.direct, "recordings go to the estimator directly, not through the first two layers");
  rul->add_flag("--resume", o.resume, "continue an interrupted run in --out");
  rul->add_flag("--json", o.json, "machine-readable result (schema sealwatch.verification/1)");
}

void add_mismatch(CLI::App* trial, VerifyMismatchOptions& o) {
  trial->add_option("--out", o.directory, "directory for records and results (created if absent)")->required();
  trial->add_option("--sets", o.sets, "sets of each stratum")->check(CLI::Range(0, 100000))->capture_default_str();
  trial
      ->add_option("--strata", o.strata,
                   "null, single, pair, outside, sensor, recording, source_sensors, concealed, inseparable, "
                   "nominal_only, asset_file "
                   "(default: all)")
      ->delimiter(',');
  trial->add_option("--seed", o.seed, "seed of the first set; each further set adds 1")
      ->check(not_negative)
      ->capture_default_str();
  trial
      ->add_option("--tolerance", o.tolerance,
                   "share by which the plant's values differ from those that the asset file fixes, in all sets "
                   "(standard deviation; 0: they are exact)")
      ->check(CLI::Range(0.0, 0.1))
      ->capture_default_str();
  trial->add_option("--threads", o.threads, "0: one for each core")->check(CLI::Range(0, 256))->capture_default_str();
  trial->add_option("--shard", o.shard, "k/n: only this part of the sets")->capture_default_str();
  trial->add_option("--from", o.from, "directories of other shards, whose sets are counted too");
  trial->add_flag("--no-controls", o.without_controls, "only the analysis itself");
  trial->add_flag("--seal", o.seal, "run nothing: write the hash of the sets' labels to sealed.txt");
  trial->add_flag("--resume", o.resume, "continue an interrupted run in --out");
  trial->add_flag("--json", o.json, "machine-readable result (schema sealwatch.mismatch_trial/1)");
}

void add_merge(CLI::App* merge, VerifyMergeOptions& o) {
  merge->add_option("directories", o.directories, "the --out of each shard")->required();
  merge->add_option("--out", o.directory, "directory for the results (created if absent)")->required();
  merge->add_flag("--json", o.json, "machine-readable result (schema sealwatch.verification/1)");
}

}  // namespace

void add_verify_arguments(CLI::App& verify, VerifyOptions& options, const std::function<void(VerifyPart)>& chosen) {
  verify.require_subcommand(1);
  const auto part = [&](VerifyPart which, const char* name, const char* meaning, const char* example) {
    CLI::App* subcommand = verify.add_subcommand(name, meaning);
    subcommand->footer(std::string("Example:\n  ") + example + "\n" + kExitStatus);
    subcommand->callback([chosen, which] { chosen(which); });
    return subcommand;
  };
  add_rul(part(VerifyPart::rul, "rul", "Monte Carlo: random lives, monthly tests, estimates, forecasts until failure",
               "sealwatch verify rul --asset config/assets/xt03-mv2.yaml --lives 1000 --out verification"),
          options.rul);
  add_mismatch(part(VerifyPart::mismatch, "mismatch", "blind trial of explain on recordings with hidden physics",
                    "sealwatch verify mismatch --sets 40 --strata null,single --out trial"),
               options.mismatch);
  add_merge(part(VerifyPart::merge, "merge", "merge the shards of one run; the result is that of an unsharded run",
                 "sealwatch verify merge shard1 shard2 --out verification"),
            options.merge);
}

}  // namespace sealwatch::cli
