#include "services/state_detection/history.hpp"

#include <algorithm>

#include "sealwatch/config/judged_quantities.hpp"
#include "sealwatch/message/made_up.hpp"
#include "services/state_detection/judgements.hpp"

namespace sealwatch {

namespace {

constexpr std::string_view kOfAccepted = "/accepted_model";  // how the keys of its filters end

std::string key_of(const RegionJudgement& judgement) {
  return judgement.quantity + "/" + std::string(name_of(judgement.reference));
}

/// Off temperature, saturated or with many samples missing: this test alone is in the warning region of one of them.
bool is_poor_recording(const std::vector<RegionJudgement>& judgements) {
  return std::any_of(judgements.begin(), judgements.end(), [](const RegionJudgement& j) {
    return concerns_recording(j.quantity) &&
           region_of(j.value, {j.advisory_limit, j.warning_limit, j.alarm_limit}) >= AlertRegion::warning;
  });
}

}  // namespace

bool concerns_recording(std::string_view quantity) {
  return quantity == "fluid_temperature_deviation" || quantity == "drive_saturation" || quantity == "missing_share";
}

AssetHistory::AssetHistory(const RegionOptions& region, const BaselineOptions& baseline)
    : region_options_(region), baseline_options_(baseline), baseline_(baseline), accepted_baseline_(baseline) {}

void AssetHistory::restart() {
  baseline_ = Baseline(baseline_options_);
  filters_.clear();
  channels_.clear();
  accepted_baseline_ = Baseline(baseline_options_);
}

void AssetHistory::use_accepted(const std::string& discrepancy_id) {
  if (discrepancy_id == accepted_) return;
  accepted_ = discrepancy_id;
  accepted_baseline_ = Baseline(baseline_options_);
  std::erase_if(filters_, [](const auto& entry) { return entry.first.ends_with(kOfAccepted); });
}

void AssetHistory::judge(std::vector<RegionJudgement>& judgements) {
  const bool poor = is_poor_recording(judgements);
  std::erase_if(filters_, [&](const auto& entry) {
    return entry.first.starts_with(kChannelQuantity) &&
           std::ranges::none_of(judgements, [&](const auto& one) { return key_of(one) == entry.first; });
  });
  for (RegionJudgement& judgement : judgements) {
    RegionFilter& filter = filters_.try_emplace(key_of(judgement), region_options_).first->second;
    if (poor && !concerns_recording(judgement.quantity))
      filter.look(judgement);
    else
      filter.update(judgement);
  }
}

void AssetHistory::learn(const StateReport& report) {
  last_was_replay = report.header.replay;
  if (report.header.pst_id.empty()) {
    last_overdue_id = report.header.message_id;
    return;
  }
  has_live_tests |= !report.header.replay && !is_made_up_test(report.header.pst_id);
  if (!is_judged(report.verdict)) return;
  last_judged_id = report.header.message_id;
  if (report.header.event_time_known) schedule.tested(UtcTime{report.header.event_time_ns});
  const bool teaches = report.verdict == PstVerdict::passed && !is_poor_recording(report.judgements);
  learn_channels(report.judgements);
  for (const RegionJudgement& judgement : report.judgements) {
    if (judgement.reference == Reference::own_baseline && judgement.raw_region == AlertRegion::normal && teaches)
      baseline_.learn(judgement.quantity, judgement.value);
    else if (judgement.reference == Reference::accepted_model && judgement.raw_region == AlertRegion::normal && teaches)
      accepted_baseline_.learn(judgement.quantity, judgement.value);
  }
}

void AssetHistory::learn_channels(const std::vector<RegionJudgement>& judgements) {
  std::set<std::string> there;
  for (const RegionJudgement& judgement : judgements)
    if (judgement.quantity.starts_with(kChannelQuantity) && judgement.value == kChannelThere)
      there.insert(judgement.quantity.substr(kChannelQuantity.size()));
  channels_.push_back(std::move(there));
  if (channels_.size() > kTestsForChannels) channels_.pop_front();
}

std::set<std::string> AssetHistory::expected_channels() const {
  std::map<std::string, std::size_t> tests;
  for (const std::set<std::string>& there : channels_)
    for (const std::string& channel : there) ++tests[channel];
  std::set<std::string> expected;
  for (const auto& [channel, count] : tests)
    if (2 * count > channels_.size()) expected.insert(channel);
  return expected;
}

AlertRegion AssetHistory::worst_region() const {
  AlertRegion worst = AlertRegion::normal;
  for (const auto& [key, filter] : filters_) worst = std::max(worst, filter.region());
  return worst;
}

}  // namespace sealwatch
