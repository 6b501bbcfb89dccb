#include "services/health_assessment/past_health.hpp"

#include <algorithm>
#include <utility>

namespace sealwatch {
namespace {

/// Two years of monthly tests: who retracts more at once starts without a last report.
constexpr std::size_t kInFull = 24;
constexpr std::string_view kCarried = "carried over from ";

/// A test that told nothing repeats what was last said: of a test that is retracted meanwhile, another is to be.
bool is_carried(const HealthReport& report, const HealthReport* before) {
  if (!report.ambiguity_group.empty())
    return !report.ambiguity_group.front().evidence.empty() &&
           report.ambiguity_group.front().evidence.front().starts_with(kCarried);
  return before != nullptr && !report.admissible_for_prognosis &&
         report.health_grade_known == before->health_grade_known && report.health_grade == before->health_grade &&
         report.no_fault_likelihood == before->no_fault_likelihood && before->ambiguity_group.empty();
}

}  // namespace

void carry_over(const std::optional<HealthReport>& last, HealthReport& report) {
  if (!last) return;
  report.health_grade_known = last->health_grade_known;
  report.health_grade = last->health_grade;
  report.no_fault_likelihood = last->no_fault_likelihood;
  report.ambiguity_group = last->ambiguity_group;
  for (ProposedFault& fault : report.ambiguity_group)
    fault.evidence = {std::string(kCarried) + last->header.message_id + ": this test does not tell"};
}

bool PastHealth::begins(const std::vector<std::string>& replacements) const {
  return std::ranges::any_of(replacements, [this](const auto& id) { return retracted_.holds(id); });
}

void PastHealth::add(const HealthReport& report) {
  const bool graded = report.admissible_for_prognosis && report.health_grade_known && report.header.event_time_known;
  Test test{.pst_id = report.header.pst_id,
            .time = {},
            .graded = graded,
            .grade = report.health_grade,
            .replacements = replacements_before(report.header)};
  if (report.header.event_time_known) test.time = UtcTime{report.header.event_time_ns};
  retracted_.know(test.pst_id, test.time);
  tests_.push_back(std::move(test));
  reports_.push_back(report);
  if (reports_.size() > kInFull) reports_.pop_front();
}

std::optional<HealthReport> PastHealth::last() const {
  std::optional<HealthReport> last;
  const HealthReport* before = nullptr;
  for (const HealthReport& report : reports_) {
    if (begins(replacements_before(report.header))) last.reset(), before = nullptr;
    const bool carried = is_carried(report, before);
    const bool own_grade = !carried || before == nullptr || report.health_grade != before->health_grade;
    before = &report;
    if (!counts(report.header.pst_id)) continue;
    const std::optional<HealthReport> earlier = std::exchange(last, report);
    if (!carried) continue;
    const HealthReport none;
    last->health_grade_known = own_grade;
    last->no_fault_likelihood = none.no_fault_likelihood;
    last->ambiguity_group.clear();
    if (!own_grade) last->health_grade = none.health_grade;
    carry_over(earlier, *last);
    if (own_grade) last->health_grade_known = true, last->health_grade = report.health_grade;
  }
  return last;
}

std::vector<GradeAt> PastHealth::grades() const {
  std::vector<GradeAt> grades;
  for (const Test& test : tests_) {
    if (begins(test.replacements)) grades.clear();
    if (test.graded && counts(test.pst_id)) grades.push_back({*test.time, test.grade});
  }
  if (grades.size() > trend_tests_)
    grades.erase(grades.begin(), grades.end() - static_cast<std::ptrdiff_t>(trend_tests_));
  return grades;
}

}  // namespace sealwatch
