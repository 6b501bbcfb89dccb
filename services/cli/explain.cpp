// `sealwatch explain`: where simulation and recordings differ, by what physics, and whether adding it helps
// (docs/reference/report.schema.json).
#include "sealwatch/mismatch/explain.hpp"

#include <malloc.h>

#include "services/cli/explain_command.hpp"

namespace sealwatch::cli {

int run_explain(const ExplainOptions& options) {
  // Matrices of many megabytes come and go: each is to be given back at once instead of leaving holes in the heap (a
  // third of the memory).
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  return explain_with(mismatch::explain, options);
}

}  // namespace sealwatch::cli
