// The arguments of `sealwatch verify`, declared once for two programs: sealwatch, whose help, manual page and completion
// tell them, and sealwatch-verify, which does the work.
#pragma once

#include <CLI/App.hpp>
#include <functional>

#include "services/verification/command/options.hpp"

namespace sealwatch::cli {

enum class VerifyPart { rul, mismatch, merge };

struct VerifyOptions {
  VerifyRulOptions rul;
  VerifyMismatchOptions mismatch;
  VerifyMergeOptions merge;
};

/// Adds the parts to `verify`, the options being filled when it is parsed; `chosen` is then told which part it is. Both
/// must live as long as `verify`.
void add_verify_arguments(CLI::App& verify, VerifyOptions& options, const std::function<void(VerifyPart)>& chosen);

}  // namespace sealwatch::cli
