// `sealwatch explain`: where simulation and recordings differ, by what physics, and whether adding it helps
// (docs/reference/report.schema.json).
#include "sealwatch/mismatch/explain.hpp"

#include "services/cli/explain_command.hpp"

namespace sealwatch::cli {

int run_explain(const ExplainOptions& options) { return explain_with(mismatch::explain, options); }

}  // namespace sealwatch::cli
