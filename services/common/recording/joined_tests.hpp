// Files of one test, one after the other.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/recording/log_reader.hpp"

namespace sealwatch {

/// The files in "A.csv+B.csv"; `path` itself where it is one.
[[nodiscard]] std::vector<std::string> parts_of(const std::string& path);

/// The first test of each file goes on with the last of the file before it: by the clock where both tell it, else by
/// their times. Times of a file may begin where those of the file before it began, as a logger counts anew in each; then
/// LogLayout::time_resets rules, as within one file.
class JoinedTests {
 public:
  explicit JoinedTests(std::string time_resets) : time_resets_(std::move(time_resets)) {}

  /// An Error, which does not name `file`, where its content was there before or its times are not behind.
  [[nodiscard]] Status append(const std::string& file, std::vector<LogTest> next);
  [[nodiscard]] std::vector<LogTest> take() { return std::move(tests_); }

 private:
  /// The last test's times as its file has them.
  struct OwnTimes {
    double begin_s = 0.0, end_s = 0.0, step_s = 0.0;
  };
  [[nodiscard]] Status refuse_again(const std::string& file, const LogTest& next);
  [[nodiscard]] Result<std::optional<double>> shift_behind(const LogTest& next) const;
  [[nodiscard]] Error not_behind(const LogTest& next, std::string rule, std::string advice) const;
  [[nodiscard]] Status go_on_with(LogTest next, double shift_s);

  std::string time_resets_;
  std::vector<LogTest> tests_;
  std::string last_file_;
  OwnTimes last_;
  double shift_s_ = 0.0;                                     ///< added to the times of the last file
  std::vector<std::pair<std::string, std::string>> hashes_;  ///< of what a file begins with, and the file
};

}  // namespace sealwatch
