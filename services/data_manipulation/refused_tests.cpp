#include "services/data_manipulation/refused_tests.hpp"

#include <algorithm>

namespace sealwatch {

std::optional<StandingAlarms> RefusedTests::look(const Message& output) {
  const auto* test = std::get_if<TestFeatures>(&output);
  if (test == nullptr || test->header.replay) return std::nullopt;
  if (test->header.event_time_known) {
    std::int64_t& newest = newest_ns_.try_emplace(test->asset_id, test->header.event_time_ns).first->second;
    if (test->header.event_time_ns < newest) return std::nullopt;
    newest = test->header.event_time_ns;
  }
  StandingAlarms alarms{.kind = "refused_test", .asset_id = test->asset_id, .standing = {}};
  if (const std::size_t why = test->abort_reason.find(kRefused); why != std::string::npos)
    alarms.standing.push_back({.kind = alarms.kind,
                               .asset_id = test->asset_id,
                               .subject = {},
                               .pst_id = test->header.pst_id,
                               .text = (test->recording_id.empty() ? "a test" : "recording " + test->recording_id) +
                                       " is " + test->abort_reason.substr(why),
                               .since_ns = test->header.event_time_known ? test->header.event_time_ns : 0});
  return alarms;
}

}  // namespace sealwatch
