// `sealwatch`: one program with subcommands for engineers and operators.
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include "services/cli/command_line.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/fmi/host_process.hpp"
#include "services/common/runtime/large_blocks.hpp"

int main(int argc, char** argv) {
  sealwatch::give_large_blocks_back();
  sealwatch::fmi::slow_starts() = [](const std::string& text) { std::cerr << "sealwatch: " + text + "\n"; };
  try {
    return sealwatch::cli::with_output_written(sealwatch::cli::CommandLine().run(argc, argv));
  } catch (const std::bad_alloc&) {
    std::cerr << "sealwatch: memory is used up: give fewer or shorter recordings, or raise the limit of this process\n";
    return sealwatch::cli::kInternalFailure;
  } catch (const std::exception& error) {
    std::cerr << "sealwatch: internal failure: " << error.what() << "\n";
    return sealwatch::cli::kInternalFailure;
  }
}
