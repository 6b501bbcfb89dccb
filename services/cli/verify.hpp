// Options of `sealwatch verify rul` and `sealwatch verify merge`: Monte Carlo verification (docs/verification.md).
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

}  // namespace sealwatch::cli
