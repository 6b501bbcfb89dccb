// What health assessment remembers of one asset's tests: the grades that the trend looks back on, and the last report,
// which a test that tells nothing carries over. Both without the tests that an operator retracted.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/retracted_tests.hpp"
#include "services/health_assessment/trend.hpp"

namespace sealwatch {

/// Grade, likelihood and proposals of `last`, put into a report on a test that does not tell.
void carry_over(const std::optional<HealthReport>& last, HealthReport& report);

class PastHealth {
 public:
  explicit PastHealth(std::size_t trend_tests = 24) : trend_tests_(trend_tests) {}

  /// Before a test is concluded: whether earlier ones do not count any more (message/retracted_tests.hpp).
  [[nodiscard]] bool meet(const std::string& pst_id) { return retracted_.meet(pst_id); }
  void add(const HealthReport& report);
  /// From now on the tests that it means do not count, or count again, or the replacement that it means was none.
  void apply(const Retraction& retraction) { retracted_.apply(retraction); }
  [[nodiscard]] bool counts(const std::string& pst_id) const { return retracted_.counts(pst_id); }

  /// The last report that counts since the last replacement.
  [[nodiscard]] std::optional<HealthReport> last() const;
  /// Of admissible tests that count, the newest trend_tests, oldest first.
  [[nodiscard]] std::vector<GradeAt> grades() const;

 private:
  struct Test {
    std::string pst_id;
    std::optional<UtcTime> time;
    bool graded = false;  ///< admissible, with a grade and a date
    double grade = 0.0;
    std::vector<std::string> replacements;  ///< ids of those that it is the first test after
  };
  /// Whether the actuator or seal is another from this test on.
  [[nodiscard]] bool begins(const std::vector<std::string>& replacements) const;

  std::size_t trend_tests_;
  std::vector<Test> tests_;           ///< all
  std::deque<HealthReport> reports_;  ///< the last of them in full
  RetractedTests retracted_;
};

}  // namespace sealwatch
