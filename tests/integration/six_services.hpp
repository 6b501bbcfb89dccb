// The real six processes on loopback, in a discovery tag of their own so that tests run side by side.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "services/cli/supervisor.hpp"

namespace sealwatch::testing {

/// What one program printed and how it ended.
struct Finished {
  int status = -1;
  std::string output;  ///< standard output and error
};

/// Stored conclusions: by service, every output's message id and exact text in the order of conclusion.
using StoredResults = std::map<std::string, std::vector<std::pair<std::string, std::string>>>;

class SixServices : public ::testing::Test {
 protected:
  SixServices();
  ~SixServices() override;

  /// Runs a program of the build tree to its end: run({"sealwatch", "watch", ...}).
  [[nodiscard]] Finished run(const std::vector<std::string>& arguments) const;
  /// Starts it and goes on.
  [[nodiscard]] pid_t start(const std::vector<std::string>& arguments, const std::filesystem::path& output) const;

  /// Recordings of one ageing actuator, made by the virtual bench once for all tests of this program.
  [[nodiscard]] static const std::vector<std::string>& recordings();

  [[nodiscard]] std::filesystem::path state_directory(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::vector<cli::ServiceProgram> programs(const std::string& state) const;
  /// Everything that the six journals hold as outputs; without publishing times and stream stamps.
  [[nodiscard]] StoredResults stored_results(const std::string& state) const;

  static std::string config() { return std::string(SEALWATCH_SOURCE_DIR) + "/config"; }
  static std::string program(const std::string& name) { return std::string(SEALWATCH_BINARY_DIR) + "/bin/" + name; }

  std::filesystem::path folder_;
};

}  // namespace sealwatch::testing
