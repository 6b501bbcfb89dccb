#include "services/state_detection/past_tests.hpp"

#include <algorithm>
#include <set>

#include "sealwatch/config/judged_quantities.hpp"
#include "services/state_detection/judgements.hpp"

namespace sealwatch {

std::uint16_t PastTests::index_of(const RegionJudgement& judgement) {
  const auto found = std::ranges::find_if(
      names_, [&](const Name& name) { return name.quantity == judgement.quantity && name.unit == judgement.unit; });
  const auto index = static_cast<std::uint16_t>(found - names_.begin());
  if (found == names_.end()) names_.push_back({judgement.quantity, judgement.unit});
  return index;
}

bool PastTests::add(const StateReport& report) {
  Test test{.pst_id = report.header.pst_id,
            .time = {},
            .verdict = report.verdict,
            .replacements = replacements_before(report.header),
            .replay = report.header.replay,
            .accepted_discrepancy = report.accepted_discrepancy,
            .judgements = {}};
  if (report.header.event_time_known) test.time = UtcTime{report.header.event_time_ns};
  for (const RegionJudgement& judgement : report.judgements)
    test.judgements.push_back({index_of(judgement), judgement.reference, judgement.value});
  retracted_.know(test.pst_id, test.time);
  tests_.push_back(std::move(test));
  return retracted_.counts(tests_.back().pst_id);
}

/// Which channels it had stands in its judgements; which it should have had follows from the tests before.
StateReport PastTests::judged_by(const AssetConfig& asset, const Test& test, const AssetHistory& history) const {
  StateReport report;
  report.asset_id = asset.asset_id;
  report.header.message_id = "state_report/" + test.pst_id;
  report.header.pst_id = test.pst_id;
  report.header.replay = test.replay;
  report.header.event_time_known = test.time.has_value();
  report.header.event_time_ns = test.time.value_or(UtcTime{}).nanoseconds;
  report.verdict = test.verdict;
  report.accepted_discrepancy = test.accepted_discrepancy;
  std::vector<ChannelStatus> there;
  for (const Judgement& judgement : test.judgements) {
    const Name& name = names_[judgement.quantity];
    if (!name.quantity.starts_with(kChannelQuantity)) {
      const Quantity quantity{name.quantity, name.unit, judgement.value, false, 0.0};
      if (auto anew =
              judge_again(asset, quantity, judgement.reference, history.baseline(), history.accepted_baseline()))
        report.judgements.push_back(std::move(*anew));
    } else if (judgement.value == kChannelThere) {
      there.push_back({name.quantity.substr(kChannelQuantity.size()), ChannelState::OK, {}});
    }
  }
  if (!is_judged(test.verdict)) return report;
  const std::set<std::string> expected = history.expected_channels();
  for (const ChannelStatus& stale : stale_channels(there, expected)) report.stale_channels.push_back(stale.channel);
  for (RegionJudgement& judgement : judge_channels(asset, there, expected))
    report.judgements.push_back(std::move(judgement));
  return report;
}

std::optional<StateReport> PastTests::judge_anew(const AssetConfig& asset, AssetHistory& fresh) const {
  std::optional<StateReport> last;
  for (const Test& test : tests_) {
    const bool replaced =
        std::ranges::any_of(test.replacements, [this](const auto& id) { return retracted_.holds(id); });
    if (replaced) fresh.restart();  // whatever the test is worth
    if (!retracted_.counts(test.pst_id)) continue;
    fresh.use_accepted(test.accepted_discrepancy);
    StateReport report = judged_by(asset, test, fresh);
    if (is_judged(report.verdict)) fresh.judge(report.judgements);
    report.region = fresh.worst_region();
    fresh.learn(report);
    last = std::move(report);
  }
  return last;
}

}  // namespace sealwatch
