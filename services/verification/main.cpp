// `sealwatch-verify`: what `sealwatch verify` runs. Arguments only.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/core/build_version.hpp"
#include "services/verification/command/arguments.hpp"

namespace {

int run(int argc, char** argv) {
  using namespace sealwatch::cli;
  CLI::App app("verify estimates, forecasts and explain against known truths", "sealwatch verify");
  app.set_version_flag("--version", sealwatch::version_line());
  VerifyOptions options;
  VerifyPart part = VerifyPart::rul;
  add_verify_arguments(app, options, [&part](VerifyPart chosen) { part = chosen; });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kBadInput;
  }
  switch (part) {
    case VerifyPart::rul:
      return run_verify_rul(options.rul);
    case VerifyPart::mismatch:
      return run_verify_mismatch(options.mismatch);
    case VerifyPart::merge:
      return run_verify_merge(options.merge);
  }
  return kInternalFailure;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return sealwatch::cli::with_output_written(run(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "sealwatch verify: internal failure: " << error.what() << "\n";
    return sealwatch::cli::kInternalFailure;
  }
}
