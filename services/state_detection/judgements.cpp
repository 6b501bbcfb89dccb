#include "services/state_detection/judgements.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/config/judged_quantities.hpp"
#include "services/state_detection/history.hpp"
#include "services/state_detection/rules.hpp"

namespace sealwatch {
namespace {

RegionJudgement judgement_of(const Quantity& quantity, Reference reference, const AlertLimits& limits) {
  RegionJudgement judgement;
  judgement.quantity = quantity.name;
  judgement.reference = reference;
  judgement.unit = quantity.unit;
  judgement.value = quantity.value;
  judgement.advisory_limit = limits.advisory;
  judgement.warning_limit = limits.warning;
  judgement.alarm_limit = limits.alarm;
  return judgement;
}

/// Whether the channel moved by enough for a share of its variation to mean anything: ten times its noise.
bool varies(const ResidualSummary& residual) {
  constexpr double kLeastSignalToNoise = 10.0;
  const double share = 1.0 - residual.nrmse_percent / 100.0;
  return residual.noise_normalised_rms >= kLeastSignalToNoise * share;
}

/// Limits of a deviation hold on both of its sides.
AlertLimits on_side_of(double value, const Quantity& quantity, const AlertLimits& limits) {
  if (quantity.name != "fluid_temperature_deviation" || value >= 0.0) return limits;
  return {-limits.advisory, -limits.warning, -limits.alarm};
}

RegionJudgement judge_by_baseline(const Quantity& quantity, const BaselineRule& rule, const Baseline& baseline,
                                  Reference reference = Reference::own_baseline) {
  const double centre = baseline.centre(quantity.name, quantity.value);
  const double tolerance = std::max(rule.absolute, rule.relative * std::abs(centre));
  const double side = rule.side == Side::above ? std::max(centre, quantity.value) : quantity.value;
  return judgement_of(quantity, reference, baseline.limits(quantity.name, side, tolerance));
}

}  // namespace

std::vector<RegionJudgement> judge_indicators(const AssetConfig& asset, const std::vector<Quantity>& indicators,
                                              const Baseline& baseline) {
  std::vector<RegionJudgement> judgements;
  for (const Quantity& quantity : indicators) {
    if (const auto limits = fixed_limits(asset, quantity.name))
      judgements.push_back(judgement_of(quantity, Reference::limit, on_side_of(quantity.value, quantity, *limits)));
    if (const auto rule = baseline_rule(asset, quantity.name))
      judgements.push_back(judge_by_baseline(quantity, *rule, baseline));
  }
  return judgements;
}

std::vector<RegionJudgement> judge_residuals(const AssetConfig& asset, const std::vector<ResidualSummary>& residuals,
                                             const Baseline& baseline, const Baseline& accepted_baseline) {
  std::vector<RegionJudgement> judgements;
  for (const ResidualSummary& residual : residuals) {
    const std::string name = std::string(kResidualQuantity) + residual.channel;
    if (residual.reference == Reference::nominal_model) {
      const Quantity share{name, "%", 100.0 - residual.nrmse_percent, false, 0.0};
      if (const auto limits = fixed_limits(asset, name); limits && varies(residual))
        judgements.push_back(judgement_of(share, Reference::nominal_model, *limits));
    } else if (const auto rule = baseline_rule(asset, name)) {
      const Quantity rms{name, "1", residual.noise_normalised_rms, false, 0.0};
      const bool accepted = residual.reference == Reference::accepted_model;
      judgements.push_back(judge_by_baseline(rms, *rule, accepted ? accepted_baseline : baseline, residual.reference));
    }
  }
  return judgements;
}

std::optional<RegionJudgement> judge_again(const AssetConfig& asset, const Quantity& quantity, Reference reference,
                                           const Baseline& baseline, const Baseline& accepted_baseline) {
  if (reference == Reference::limit || reference == Reference::nominal_model) {
    const auto limits = fixed_limits(asset, quantity.name);
    if (!limits) return std::nullopt;
    return judgement_of(quantity, reference, on_side_of(quantity.value, quantity, *limits));
  }
  const auto rule = baseline_rule(asset, quantity.name);
  if (!rule) return std::nullopt;
  const bool accepted = reference == Reference::accepted_model;
  return judge_by_baseline(quantity, *rule, accepted ? accepted_baseline : baseline, reference);
}

std::vector<RegionJudgement> judge_channels(const AssetConfig& asset, const std::vector<ChannelStatus>& channels,
                                            const std::set<std::string>& expected) {
  std::set<std::string> judged = expected;
  for (const ChannelStatus& status : channels)
    if (status.state == ChannelState::OK) judged.insert(status.channel);
  const std::vector<ChannelStatus> lost = stale_channels(channels, expected);
  std::vector<RegionJudgement> judgements;
  for (const std::string& channel : judged) {
    const bool is_lost = std::any_of(lost.begin(), lost.end(), [&](const auto& l) { return l.channel == channel; });
    const Quantity quantity{std::string(kChannelQuantity) + channel, "1", is_lost ? kChannelLost : kChannelThere, false,
                            0.0};
    if (const auto limits = fixed_limits(asset, quantity.name))
      judgements.push_back(judgement_of(quantity, Reference::limit, *limits));
  }
  return judgements;
}

std::vector<ChannelStatus> stale_channels(const std::vector<ChannelStatus>& channels,
                                          const std::set<std::string>& expected) {
  std::vector<ChannelStatus> stale;
  for (const std::string& channel : expected) {
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [&](const ChannelStatus& status) { return status.channel == channel; });
    if (found == channels.end())
      stale.push_back({channel, ChannelState::NOT_USED, "not recorded"});
    else if (found->state != ChannelState::OK)
      stale.push_back(*found);
  }
  for (const ChannelStatus& status : channels)
    if (status.state == ChannelState::FAILED && !expected.contains(status.channel)) stale.push_back(status);
  return stale;
}

}  // namespace sealwatch
