#include "services/common/mismatch/gross_mismatch.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "services/common/core/in_parallel.hpp"
#include "services/common/estimation/channel_noise.hpp"
#include "services/common/mismatch/balance_words.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/error_floor.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/recorded_units.hpp"
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
    const Result<FittedModel> as_it_is = simulated(asset_, fit_, options_.threads);
    if (as_it_is && rms_in_noise(*as_it_is, asset_, noise_fit_) < kGross) return std::nullopt;
    tell("computing what each balance lacks", 0.05);
    found_ = search_balances(asset_, plant_, *balances, options_.maximum_laws, options_.threads);
    take_back_what_does_not_hold(*balances);
    tell("simulating with and without it", 0.3);
    if (!baseline_is_far_off()) return std::nullopt;
    simulate_with_findings();
    tell("proving on held-out recordings", 0.7);
    apart_ = recordings_apart();
    compare_held_out();
    while (take_back_what_makes_a_channel_worse(*balances)) {
    }
    describe();
    tell("done", 1.0);
    return std::move(result_);
  }

 private:
  void tell(std::string_view step, double share) const {
    if (progress_) progress_(step, share);
  }

  [[nodiscard]] Result<FittedModel> simulated(const AssetConfig& asset, const Data& data, int threads) const {
    return fit_model(with_fixed_parameters(asset), data, nullptr, threads, kOwnIterations);
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
  void polish(BalanceModel& model, int threads) const {
    const Data data = furthest();
    const Result<FittedModel> start = simulated(model.asset, data, threads);
    if (!start) return;
    AssetConfig asset = model.asset;
    for (PhysicsTerm& term : asset.physics)
      for (auto& [name, setting] : term.parameters) setting.estimate = false;
    const Result<FittedModel> polished = fit_model(asset, data, &*start, threads, kPolishIterations);
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
  bool baseline_is_far_off() {
    polish(found_.baseline, options_.threads);
    Result<FittedModel> before = simulated(found_.baseline.asset, fit_, options_.threads);
    if (!before || rms_in_noise(*before, asset_, noise_fit_) < kGross) return false;
    misfit_before_ = before->misfit / before->residuals;
    before_.emplace(std::move(*before));
    return true;
  }

  void simulate_with_findings() {
    polish(found_.model, options_.threads);
    compare_fit();
  }

  void compare_fit() {
    take_over_values();
    const Result<FittedModel> after = simulated(found_.model.asset, fit_, options_.threads);
    misfit_after_ = after ? after->misfit / after->residuals : misfit_before_;
    fit_comparisons_.clear();
    for (std::size_t k = 0; k < fit_.samples.size() && after; ++k)
      fit_comparisons_.push_back(comparison(*before_, *after, fit_, noise_fit_, k));
  }

  // Held-out balances, their loads fitted, must be better with each finding than without it. Where they do not go where
  // it acts (a drive's limit, at a lighter load) they cannot tell: then the fitted recordings must, each left out in turn.
  void take_back_what_does_not_hold(const SwitchedBalances& balances) {
    if (holdout_.samples.empty()) return;
    const Result<SwitchedBalances> held_out = SwitchedBalances::create(noise_holdout_);
    if (!held_out) return;
    const double with_all = held_out_loss(*held_out, found_.model);
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < found_.findings.size(); ++k) {
      const BalanceFinding& finding = found_.findings[k];
      double gain = held_out_loss(*held_out, finding.without) - with_all;
      const bool not_shown = gain <= 0.0 && gain > -0.5 * kCannotTell;
      if (not_shown) gain = gain_where_left_out(k);
      held_out_gain_[finding_key(finding)] = gain;
      if (gain <= 0.0) out.push_back(k);
      if (gain > 0.0 && !not_shown) continue;
      result_.notes.push_back("What fits better (" + finding_in_words(finding) +
                              (gain > 0.0 ? ") does not show in the balances of the held-out recordings: the fitted "
                                            "ones, each left out in turn, are better with it."
                                          : ") does not improve the balances of the held-out recordings: it is not "
                                            "claimed."));
    }
    if (out.empty()) return;
    for (auto k = out.rbegin(); k != out.rend(); ++k) take_out(*k, found_);
    found_ = refit_findings(asset_, plant_, balances, found_, options_.threads);
  }

  // By a finding, of minus the logarithm of the likelihood of each fitted recording's balances, fitted to the others'.
  [[nodiscard]] double gain_where_left_out(std::size_t finding) const {
    BalanceFit fewer = found_;
    take_out(finding, fewer);
    const auto gains = in_parallel<double>(noise_fit_.samples.size(), options_.threads, [&](std::size_t k) {
      const Result<SwitchedBalances> one = SwitchedBalances::create(one_of(noise_fit_, k)),
                                     rest = SwitchedBalances::create(all_but(noise_fit_, k));
      if (!one || !rest) return 0.0;
      return held_out_loss(*one, refit_balances(asset_, *rest, fewer).model) -
             held_out_loss(*one, refit_balances(asset_, *rest, found_).model);
    });
    return std::accumulate(gains.begin(), gains.end(), 0.0);
  }

  // A recording that took no part, as the model is: one of those held out, or of those fitted, left out.
  struct Apart {
    Data data, noise;
    std::optional<SwitchedBalances> rest;  // of one left out: what the others say
    FittedModel before;
  };

  [[nodiscard]] std::vector<Apart> recordings_apart() const {
    std::vector<Apart> apart;
    const auto add = [&](const AssetConfig& asset, const Data& data, const Data& noise, std::size_t k,
                         std::optional<SwitchedBalances> rest) {
      Data one = one_of(data, k);
      if (Result<FittedModel> before = simulated(asset, one, options_.threads))
        apart.push_back({std::move(one), one_of(noise, k), std::move(rest), std::move(*before)});
    };
    for (std::size_t k = 0; k < holdout_.samples.size(); ++k)
      add(found_.baseline.asset, holdout_, noise_holdout_, k, std::nullopt);
    for (std::size_t k = 0; holdout_.samples.empty() && fit_.samples.size() > 1 && k < fit_.samples.size(); ++k)
      if (Result<SwitchedBalances> rest = SwitchedBalances::create(all_but(noise_fit_, k))) {
        const AssetConfig baseline = refit_balances(asset_, *rest, found_).baseline.asset;
        add(baseline, fit_, noise_fit_, k, std::move(*rest));
      }
    return apart;
  }

  // Those recordings with what was found and without.
  struct HeldOut {
    std::vector<RecordingComparison> comparisons;
    BlockGains blocks;
    [[nodiscard]] PooledFit pooled() const { return pool(comparisons, true); }
  };

  [[nodiscard]] HeldOut held_out(const BalanceFit& found, int threads) const {
    HeldOut held_out;
    for (const Apart& one : apart_) {
      const AssetConfig asset = one.rest ? refit_balances(asset_, *one.rest, found).model.asset : found.model.asset;
      const Result<FittedModel> after = simulated(asset, one.data, threads);
      if (!after) continue;
      const BlockGains own = block_gains(one.before, *after, 0);
      held_out.blocks.gain.insert(held_out.blocks.gain.end(), own.gain.begin(), own.gain.end());
      held_out.comparisons.push_back(comparison(one.before, *after, one.data, one.noise, 0));
      held_out.comparisons.back().left_out = one.rest.has_value();
      held_out.comparisons.back().holdout = !one.rest;
    }
    return held_out;
  }

  void compare_held_out() {
    held_out_ = held_out(found_, options_.threads);
    gain_ = gain_interval(held_out_.blocks, std::max(1.0, misfit_after_), options_.seed);
    proven_ = !held_out_.blocks.gain.empty() && gain_.low > 0.0;
  }

  // Where a held-out channel gets worse, takes back the finding without which the channel that fares worst fares best.
  // Whether it did so: all others are fitted, polished and simulated anew.
  bool take_back_what_makes_a_channel_worse(const SwitchedBalances& balances) {
    const PooledFit now = held_out_.pooled();
    const ChannelComparison* worse = made_worse(now);
    if (worse == nullptr || found_.findings.empty() || passed(fit_.deadline)) return false;
    const std::vector<double> worst =
        in_parallel<double>(found_.findings.size(), options_.threads, [&](std::size_t finding) {
          BalanceFit fewer = found_;
          take_out(finding, fewer);
          return fares_worst(held_out(fewer, 1));
        });
    const auto out = static_cast<std::size_t>(std::ranges::min_element(worst) - worst.begin());
    const BalanceFinding finding = found_.findings[out];
    const auto before = std::tuple(found_, fit_comparisons_, misfit_after_, held_out_, gain_, proven_);
    take_out(out, found_);
    found_ = refit_findings(asset_, plant_, balances, found_, options_.threads);
    simulate_with_findings();
    compare_held_out();
    if (passed(fit_.deadline) || fares_worst(held_out_) >= fares_worst(std::get<HeldOut>(before))) {
      std::tie(found_, fit_comparisons_, misfit_after_, held_out_, gain_, proven_) = before;
      return false;
    }
    result_.notes.push_back("What fits better (" + finding_in_words(finding) +
                            ") does not carry over: on held-out recordings " + in_words(worse->channel) +
                            " gets worse with it, from " + number(worse->rms_before) + " to " +
                            number(worse->rms_after) + " times its noise. It is not claimed.");
    return true;
  }

  void take_out(std::size_t finding, BalanceFit& found) const {
    put_back(found.model, asset_, found.findings[finding].what);
    found.findings.erase(found.findings.begin() + static_cast<std::ptrdiff_t>(finding));
  }

  // Misfit after over misfit before, of the channel that fares worst; a recording that cannot be simulated is worse.
  [[nodiscard]] double fares_worst(const HeldOut& held_out) const {
    if (held_out.comparisons.size() < apart_.size()) return std::numeric_limits<double>::infinity();
    return times_worse(held_out.pooled());
  }

  // Residuals in the sensors' noise.
  [[nodiscard]] RecordingComparison comparison(const FittedModel& before, const FittedModel& after, const Data& data,
                                               const Data& noise, std::size_t k) const {
    RecordingComparison comparison = compare(before, after, data, k);
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
        gain_interval(block_gains(before, after, k), std::max(1.0, misfit_after_), options_.seed);
    comparison.likelihood_gain = interval.gain;
    comparison.gain_low = interval.low;
    comparison.gain_high = interval.high;
    return comparison;
  }

  void describe() {
    result_.asset_id = asset_.asset_id;
    result_.model = asset_.model;
    result_.fit_recordings = fit_.names;
    result_.holdout_recordings = holdout_.names;
    result_.p_value = 1e-300;
    result_.statistically_significant = true;
    result_.recordings = std::move(fit_comparisons_);
    std::ranges::move(held_out_.comparisons, std::back_inserter(result_.recordings));
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
  std::optional<FittedModel> before_;  // the recordings that are fitted, as the model is
  double misfit_before_ = 0.0, misfit_after_ = 0.0;
  std::vector<RecordingComparison> fit_comparisons_;
  std::vector<Apart> apart_;
  HeldOut held_out_;
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
