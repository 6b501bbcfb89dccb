// What single tests ask for, and what is in force after all of them: the memory that keeps one month's noise from
// flapping the advice.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/time.hpp"
#include "services/advisory_generation/options.hpp"

namespace sealwatch {

/// How far the seal's wear calls for work, in order.
SEALWATCH_ENUM(WearLevel, none, plan, book, book_at_once, replace)

}  // namespace sealwatch

namespace sealwatch::advisory_generation {

/// What one test asks for by itself. A test that says nothing about the wear (left out of the forecast, history too
/// short) has no wear level and does not vote.
struct TestVerdict {
  std::optional<WearLevel> wear = {};
  /// What it would ask for if the work were one campaign earlier; none: the same. Advice is only eased below this: the
  /// date steps from campaign to campaign, years apart, when the probability of failure wavers about its limit.
  std::optional<WearLevel> wear_a_campaign_earlier = {};
  std::optional<UtcTime> replace_by = {};  ///< whole days
  bool urgent = false;                     ///< takes force at once, without confirmation
  bool instruments_doubted = false;
  bool failed = false;                          ///< the valve did not do its partial stroke
  std::set<std::string> doubted_channels = {};  ///< whose instruments are doubted, where they have names
  friend bool operator==(const TestVerdict&, const TestVerdict&) = default;
};

/// What is in force.
struct InForce {
  WearLevel wear = WearLevel::none;
  std::optional<UtcTime> replace_by = {};  ///< whole days
  bool instruments_doubted = false;
  bool failing = false;
  std::set<std::string> doubted_channels = {};  ///< of the tests that still count
  friend bool operator==(const InForce&, const InForce&) = default;
};

/// The last tests' verdicts and what is in force after them.
class VerdictMemory {
 public:
  /// Takes the next test, done at `now`: worse levels and earlier dates by k of n or urgently, better ones only after a
  /// row of tests (Options).
  const InForce& judge(const TestVerdict& verdict, std::optional<UtcTime> now, const Options& options);
  /// Takes back a test with what was in force after it.
  void restore(const TestVerdict& verdict, const InForce& in_force);
  [[nodiscard]] const InForce& in_force() const { return in_force_; }

 private:
  void remember(const TestVerdict& verdict);
  void judge_wear(const TestVerdict& verdict, const Options& options);
  void drop_stale_date(const TestVerdict& verdict, UtcTime now, const Options& options);
  void judge_date(const TestVerdict& verdict, UtcTime now, const Options& options);

  std::vector<TestVerdict> last_;  ///< newest last, bounded
  InForce in_force_;
};

/// Both in one line that stands as the last reason of every advisory, for people and for restore():
/// "this test alone says: no work yet (with the work one campaign earlier: plan the work); replacement by
/// 2017-06-01; instruments doubted: flow, position; stroke done. The advice rests on all tests so far; together they
/// say: ...", or "... together they say the same".
[[nodiscard]] std::string in_words(const TestVerdict& verdict, const InForce& in_force);
struct VerdictRecord {
  TestVerdict verdict;
  InForce in_force;
};
[[nodiscard]] std::optional<VerdictRecord> from_words(const std::string& line);

}  // namespace sealwatch::advisory_generation
