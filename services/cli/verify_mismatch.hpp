// Options of `sealwatch verify mismatch`: the blind trial of `sealwatch explain` (docs/mismatch-trials.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sealwatch::cli {

struct VerifyMismatchOptions {
  std::string directory;
  int sets = 20;                    ///< of each stratum
  std::vector<std::string> strata;  ///< empty: all
  std::uint64_t seed = 1;           ///< of the first set; the next has the next
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
