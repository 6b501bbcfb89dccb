// The parts of `sealwatch verify` and their options: Monte Carlo verification of estimates and forecasts
// (docs/records/verification.md), and the blind trial of `sealwatch explain` (docs/records/mismatch-trials.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sealwatch::cli {

struct VerifyRulOptions {
  std::string asset_file;
  std::string directory;
  int lives = 1000;
  std::uint64_t seed = 1;
  int months = 240;
  double sample_rate_Hz = 50.0;
  int threads = 0;  ///< 0: one for each core
  std::string shard = "1/1";
  std::string truth = "circuit";
  std::vector<std::string> forecasters;  ///< empty: all
  std::vector<std::string> degradation;  ///< NAME=NUMBER
  double missing_share = 0.0;
  double cut_share = 0.0;
  std::vector<std::string> scenarios;  ///< several, or "all": one table of them; empty: the reference
  bool direct = false;                 ///< without data acquisition and data manipulation
  bool resume = false;
  bool json = false;
};
int run_verify_rul(const VerifyRulOptions& options);

struct VerifyMergeOptions {
  std::vector<std::string> directories;
  std::string directory;
  bool json = false;
};
int run_verify_merge(const VerifyMergeOptions& options);

struct VerifyMismatchOptions {
  std::string directory;
  int sets = 20;                    ///< of each stratum
  std::vector<std::string> strata;  ///< empty: all
  std::uint64_t seed = 1;           ///< of the first set; the next has the next
  double tolerance = 0.0;           ///< share by which the values that the asset fixes are drawn; 0: they are exact
  int threads = 0;                  ///< 0: one for each core
  std::string shard = "1/1";
  std::vector<std::string> from;  ///< directories whose records are counted too
  bool without_controls = false;
  bool seal = false;
  bool resume = false;
  bool json = false;
};
int run_verify_mismatch(const VerifyMismatchOptions& options);

}  // namespace sealwatch::cli
