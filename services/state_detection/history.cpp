#include "services/state_detection/history.hpp"

#include <algorithm>

namespace sealwatch {

AssetHistory::AssetHistory(const RegionOptions& region, const BaselineOptions& baseline)
    : region_options_(region), baseline_options_(baseline), baseline_(baseline) {}

void AssetHistory::restart() {
  baseline_ = Baseline(baseline_options_);
  filters_.clear();
  known_channels_.clear();
}

void AssetHistory::judge(RegionJudgement& judgement) {
  const std::string key = judgement.quantity + "/" + std::string(name_of(judgement.reference));
  filters_.try_emplace(key, region_options_).first->second.update(judgement);
}

void AssetHistory::learn(const StateReport& report) {
  last_was_replay = report.header.replay;
  if (report.header.pst_id.empty()) {
    last_overdue_id = report.header.message_id;
    return;
  }
  if (!is_judged(report.verdict)) return;
  last_judged_id = report.header.message_id;
  if (report.header.event_time_known) schedule.tested(UtcTime{report.header.event_time_ns});
  for (const RegionJudgement& judgement : report.judgements) {
    if (judgement.quantity.starts_with(kChannelQuantity))
      known_channels_.insert(judgement.quantity.substr(kChannelQuantity.size()));
    else if (judgement.reference == Reference::own_baseline && judgement.raw_region == AlertRegion::normal &&
             report.verdict == PstVerdict::passed)
      baseline_.learn(judgement.quantity, judgement.value);
  }
}

AlertRegion AssetHistory::worst_region() const {
  AlertRegion worst = AlertRegion::normal;
  for (const auto& [key, filter] : filters_) worst = std::max(worst, filter.region());
  return worst;
}

}  // namespace sealwatch
