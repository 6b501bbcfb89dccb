#include "services/common/mismatch/gross_mismatch.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "services/common/estimation/channel_noise.hpp"
#include "services/common/mismatch/balance_words.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/error_floor.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/why_none.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kGross = 20.0;  // times the noise: as where a fit is given up (ActuatorFitOptions::hopeless_rms)
constexpr double kExplainedAtLeast = 0.5;  // of the misfit, as for laws
constexpr int kPolishIterations = 40;
constexpr std::size_t kPolished = 4;  // recordings that the simulation is fitted to: those that move furthest
constexpr int kOwnIterations = 20;    // for load and initial state

// Of the mean square misfit, in the median channel: one channel's rare outliers do not speak for all.
double typical_share(const PooledFit& fit) {
  std::vector<double> shares;
  for (const ChannelComparison& channel : fit.channels)
    shares.push_back(1.0 - std::pow(channel.rms_after / channel.rms_before, 2));
  if (shares.empty()) return 0.0;
  std::ranges::sort(shares);
  return std::clamp(shares[shares.size() / 2], 0.0, 1.0);
}

class GrossMismatch {
 public:
  GrossMismatch(const AssetConfig& asset, const PlantDescription& plant, const Data& fit, const Data& holdout,
                const ExplainOptions& options, const Progress& progress)
      : asset_(asset), plant_(plant), noise_fit_(fit), noise_holdout_(holdout), options_(options), progress_(progress) {
    const ChannelScales spread = spread_of(fit);
    fit_ = with_error_floor(asset, fit, spread);
    holdout_ = with_error_floor(asset, holdout, spread);
  }

  std::optional<Explanation> run() {
    Result<SwitchedBalances> balances = SwitchedBalances::create(noise_fit_);
    if (!balances) return std::nullopt;
    const Result<FittedModel> as_it_is = simulated(asset_, fit_);
    if (as_it_is && rms_in_noise(*as_it_is, asset_, noise_fit_) < kGross) return std::nullopt;
    tell("what each balance leaves over", 0.05);
    found_ = search_balances(asset_, plant_, *balances, options_.maximum_laws);
    take_back_what_does_not_hold(*balances);
    tell("simulating with it and without", 0.3);
    if (!compare_fit()) return std::nullopt;
    tell("proving on held-out recordings", 0.7);
    compare_held_out();
    describe();
    tell("done", 1.0);
    return std::move(result_);
  }

 private:
  void tell(std::string_view step, double share) const {
    if (progress_) progress_(step, share);
  }

  [[nodiscard]] Result<FittedModel> simulated(const AssetConfig& asset, const Data& data) const {
    return fit_model(with_fixed_parameters(asset), data, nullptr, options_.threads, kOwnIterations);
  }

  // The recordings in which most happens.
  [[nodiscard]] Data furthest() const {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < fit_.samples.size(); ++k) {
      const auto [low, high] = std::ranges::minmax(find_series(fit_.samples[k], plant_, ChannelRole::stroke)->values);
      order.emplace_back(high - low, k);
    }
    std::ranges::stable_sort(order, std::greater<>(), &std::pair<double, std::size_t>::first);
    Data chosen;
    chosen.deadline = fit_.deadline;
    chosen.start_as_measured = fit_.start_as_measured;
    for (std::size_t k = 0; k < std::min(kPolished, order.size()); ++k) {
      chosen.names.push_back(fit_.names[order[k].second]);
      chosen.samples.push_back(fit_.samples[order[k].second]);
    }
    return chosen;
  }

  // The balances see each equation alone, with what was recorded in it: what they found stands. The simulation sees all
  // of them together over time, and is fitted by the parameters that the asset file leaves open. Asked for what the
  // balances found too, it ends in minima that do not carry over: on the shared bench with nearly twice the misfit.
  void polish(BalanceModel& model) const {
    const Data data = furthest();
    const Result<FittedModel> start = simulated(model.asset, data);
    if (!start) return;
    AssetConfig asset = model.asset;
    for (PhysicsTerm& term : asset.physics)
      for (auto& [name, setting] : term.parameters) setting.estimate = false;
    const Result<FittedModel> polished = fit_model(asset, data, &*start, options_.threads, kPolishIterations);
    if (!polished || polished->misfit >= start->misfit) return;
    for (auto& [name, setting] : model.asset.parameters) setting.value = polished->asset.parameters.at(name).value;
  }

  // Their error contains how far the simulation went from the balances.
  void take_over_values() {
    for (BalanceParameter& parameter : found_.free) {
      const double value = found_.model.asset.parameters.at(parameter.name).value;
      parameter.after_std = std::hypot(parameter.after_std, value - parameter.after);
      parameter.after = value;
      parameter.before = found_.baseline.asset.parameters.at(parameter.name).value;
    }
  }

  // False where the model as it is follows the recordings, or cannot be simulated at all.
  bool compare_fit() {
    polish(found_.baseline);
    const Result<FittedModel> before = simulated(found_.baseline.asset, fit_);
    if (!before || rms_in_noise(*before, asset_, noise_fit_) < kGross) return false;
    polish(found_.model);
    take_over_values();
    const Result<FittedModel> after = simulated(found_.model.asset, fit_);
    misfit_before_ = before->misfit / before->residuals;
    misfit_after_ = after ? after->misfit / after->residuals : misfit_before_;
    for (std::size_t k = 0; k < fit_.samples.size() && after; ++k)
      add_comparison(*before, *after, fit_, noise_fit_, k, k);
    return true;
  }

  // Held-out balances, their loads fitted, must be better with each finding than without it.
  void take_back_what_does_not_hold(const SwitchedBalances& balances) {
    if (holdout_.samples.empty()) return;
    const Result<SwitchedBalances> held_out = SwitchedBalances::create(noise_holdout_);
    if (!held_out) return;
    const double with_all = held_out_loss(*held_out, found_.model);
    std::vector<BalanceFinding> kept;
    for (BalanceFinding& finding : found_.findings) {
      const double gain = held_out_loss(*held_out, finding.without) - with_all;
      held_out_gain_[finding_key(finding)] = gain;
      if (gain > 0.0) {
        kept.push_back(std::move(finding));
        continue;
      }
      result_.notes.push_back("What fits better (" + finding_in_words(finding) +
                              ") does not improve the balances of the held-out recordings: it is not claimed.");
      put_back(found_.model, asset_, finding.what);
    }
    const bool fewer = kept.size() < found_.findings.size();
    found_.findings = std::move(kept);
    if (fewer) found_.model = refit_balances(asset_, balances, found_).model;
  }

  void compare_held_out() {
    BlockGains blocks;
    const auto add = [&](const AssetConfig& old_asset, const AssetConfig& new_asset, const Data& data,
                         const Data& noise, std::size_t k, bool left_out) {
      const Result<FittedModel> before = simulated(old_asset, one_of(data, k)),
                                after = simulated(new_asset, one_of(data, k));
      if (!before || !after) return;
      const BlockGains own = block_gains(*before, *after, 0);
      blocks.gain.insert(blocks.gain.end(), own.gain.begin(), own.gain.end());
      add_comparison(*before, *after, data, noise, k, 0);
      result_.recordings.back().left_out = left_out;
      result_.recordings.back().holdout = !left_out;
    };
    for (std::size_t k = 0; k < holdout_.samples.size(); ++k)
      add(found_.baseline.asset, found_.model.asset, holdout_, noise_holdout_, k, false);
    for (std::size_t k = 0; holdout_.samples.empty() && fit_.samples.size() > 1 && k < fit_.samples.size(); ++k) {
      const Result<SwitchedBalances> rest = SwitchedBalances::create(all_but(noise_fit_, k));
      if (!rest) continue;
      const BalanceFit refitted = refit_balances(asset_, *rest, found_);
      add(refitted.baseline.asset, refitted.model.asset, fit_, noise_fit_, k, true);
    }
    gain_ = gain_interval(blocks, std::max(1.0, misfit_after_), options_.seed);
    proven_ = !blocks.gain.empty() && gain_.low > 0.0;
  }

  // Residuals in the sensors' noise.
  void add_comparison(const FittedModel& before, const FittedModel& after, const Data& data, const Data& noise,
                      std::size_t k, std::size_t in_model) {
    RecordingComparison comparison = compare_in(before, after, data, k, in_model);
    for (ChannelComparison& channel : comparison.channels) {
      const double sigma = noise_std_of(asset_, *noise.samples[k].find(channel.channel), noise.samples[k].time_s);
      const double floor = data.samples[k].find(channel.channel)->noise_std;
      channel.rms_before *= floor / sigma;
      channel.rms_after *= floor / sigma;
      for (TimeSeries* curves : {&comparison.recorded, &comparison.before, &comparison.after})
        for (Series& series : curves->channels)
          if (series.name == channel.channel) series.noise_std = sigma;
    }
    const GainInterval interval =
        gain_interval(block_gains(before, after, in_model), std::max(1.0, misfit_after_), options_.seed);
    comparison.likelihood_gain = interval.gain;
    comparison.gain_low = interval.low;
    comparison.gain_high = interval.high;
    result_.recordings.push_back(std::move(comparison));
  }

  static RecordingComparison compare_in(const FittedModel& before, const FittedModel& after, const Data& data,
                                        std::size_t k, std::size_t in_model) {
    if (in_model == k) return compare(before, after, data, k);
    return compare(before, after, one_of(data, k), in_model);
  }

  void describe() {
    result_.asset_id = asset_.asset_id;
    result_.model = asset_.model;
    result_.fit_recordings = fit_.names;
    result_.holdout_recordings = holdout_.names;
    result_.p_value = 1e-300;
    result_.statistically_significant = true;
    result_.fit = pool(result_.recordings, false);
    result_.holdout = pool(result_.recordings, true);
    result_.explained_share = typical_share(result_.holdout.channels.empty() ? result_.fit : result_.holdout);
    for (const BalanceFinding& finding : found_.findings)
      result_.effects.push_back(effect_of(finding, plant_, held_out_gain_[finding_key(finding)]));
    result_.location = locate(result_.effects);
    for (const BalanceParameter& parameter : found_.free)
      result_.parameters.push_back({.name = parameter.name,
                                    .unit = plant_.find_parameter(parameter.name)->unit,
                                    .before = parameter.before,
                                    .before_std = parameter.before_std,
                                    .after = parameter.after,
                                    .after_std = parameter.after_std,
                                    .datasheet = asset_.parameters.at(parameter.name).value,
                                    .before_at_bound = !std::isfinite(parameter.before_std),
                                    .after_at_bound = !std::isfinite(parameter.after_std)});
    result_.prognosis = prognosis_shift(asset_, result_.parameters);
    result_.explained = found_.model.asset;
    add_notes();
    const ChannelComparison* worse = made_worse(result_.holdout);
    if (worse != nullptr) result_.notes.push_back(does_not_carry_over(*worse));
    const bool explained =
        proven_ && worse == nullptr && !result_.effects.empty() && result_.explained_share >= kExplainedAtLeast;
    if (!explained) {  // what is not proven, or explains too little, is a place to look at, not an effect
      result_.effects.clear();
      result_.explained = found_.baseline.asset;
    }
    result_.verdict = explained ? Verdict::mismatch : Verdict::undetermined;
    result_.next_test = next_test_of(result_);
    result_.summary = gross_summary(result_);
  }

  void add_notes() {
    result_.notes.push_back("The simulation from the datasheet misses these recordings by " +
                            number(std::sqrt(misfit_before_) * kErrorFloor * 100.0) +
                            " % of their channels' spread, far beyond the noise: the balances with the recorded states "
                            "in them were searched "
                            "first, and the free-running simulation proves what they found. Residuals count against an "
                            "error floor of 2 % of "
                            "each channel's spread; what stays is the model's error, not noise.");
    for (std::size_t b = 0; b < SwitchedBalances::kBalances.size(); ++b)
      result_.notes.push_back(balance_in_words(b, found_));
    result_.notes.push_back("Gain of likelihood on held-out recordings: " + number(gain_.gain) + " (" +
                            number(gain_.low) + " to " + number(gain_.high) + ").");
    if (const std::string leakage = leakage_in_words(found_); !leakage.empty()) result_.notes.push_back(leakage);
    for (const BalanceParameter& parameter : found_.free)
      if (parameter.name != plant_.wear_parameter && !std::isfinite(parameter.after_std))
        result_.notes.push_back(parameter.name +
                                " ends at its bound or is not seen: something that its element lacks is "
                                "still wanted there.");
    if (misfit_after_ > 1.0)
      result_.notes.push_back("A remainder stays unexplained: the free run still misses by " +
                              number(std::sqrt(misfit_after_) * kErrorFloor * 100.0) + " % of the channels' spread.");
  }

  const AssetConfig& asset_;
  const PlantDescription& plant_;
  const Data &noise_fit_, &noise_holdout_;
  const ExplainOptions& options_;
  const Progress& progress_;
  Data fit_, holdout_;
  BalanceFit found_;
  std::map<std::string, double> held_out_gain_;
  double misfit_before_ = 0.0, misfit_after_ = 0.0;
  GainInterval gain_;
  bool proven_ = false;
  Explanation result_;
};

}  // namespace

std::optional<Explanation> explain_gross_mismatch(const AssetConfig& asset, const Data& fit, const Data& holdout,
                                                  const ExplainOptions& options, const Progress& progress) {
  const auto plant = find_plant(asset.model);
  if (!plant || asset.model != SwitchedBalances::kPlant || !asset.physics.empty()) return std::nullopt;
  return GrossMismatch(asset, **plant, fit, holdout, options, progress).run();
}

}  // namespace sealwatch::mismatch
