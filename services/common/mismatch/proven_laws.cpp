#include "services/common/mismatch/proven_laws.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostToCarryOver = 6;  // explanations of a gross misfit that predict recordings

class Proving {
 public:
  Proving(const ToProve& of, Trial best, TimeBudget& time) : of_(of), time_(time) { result_.best = std::move(best); }

  ProvenLaws run() {
    take_back_what_is_no_fault();
    take_back_what_takes_up_little();
    if (excess(*result_.best.model) > kGross)
      in_gross_misfit();
    else
      near_the_noise();
    return std::move(result_);
  }

 private:
  // Where a search was cut before it asked again beside sensors that are off by what they may be.
  void take_back_what_is_no_fault() {
    time_.allow_what_is_needed();
    for (std::size_t k = result_.best.effects.size(); k-- > 0;) {
      const Effect effect = result_.best.effects[k];
      if (!is_within_tolerance(effect, *result_.best.model, of_.sensors)) continue;
      result_.notes.push_back("What fits better (" + law_in_words(effect) +
                              ") is within that sensor's tolerance: it is no fault.");
      result_.best = without(result_.best, k, of_);
    }
  }

  // A sensor or a recorded input takes up some of whatever is missing: beside other laws, and with something left beyond
  // the noise, it counts where it takes half of what is left without it.
  void take_back_what_takes_up_little() {
    const Naming& naming = of_.naming;
    time_.allow_what_is_needed();
    for (std::size_t k = result_.best.effects.size(); k-- > 0;) {
      const Effect effect = result_.best.effects[k];
      if (result_.best.effects.size() == 1 || !is_of_measurement(effect.law->kind)) continue;
      if (!differs(naming.last.p_value, *result_.best.model, of_.held_out.options.false_alarm_rate)) return;
      Trial fewer = without(result_.best, k, of_);
      if (!takes_up_little(*fewer.model, *result_.best.model)) continue;
      result_.notes.push_back("A remainder beyond the noise would be taken in part by " + law_in_words(effect) +
                              ", which takes up some of whatever is missing: it is not claimed.");
      result_.best = std::move(fewer);
    }
  }

  // That time is up says nothing against a law: what a search that was cut has found is proven, whatever time it takes.
  void near_the_noise() {
    time_.allow_what_is_needed();
    while (!result_.best.effects.empty()) {
      const Result<BlockGains> whole = of_.held_out.gains({{}, of_.naming.baseline}, result_.best);
      const std::vector<double> helps = help_of_each(whole);
      const auto least = static_cast<std::size_t>(std::ranges::min_element(helps) - helps.begin());
      if (helps[least] > 0.0 && interval(*whole).low > 0.0) {
        result_.proven = true;
        result_.not_compared = whole->not_compared;
        return;
      }
      result_.notes.push_back(why_not_proven(result_.best.effects[least], whole));
      result_.best = without(result_.best, least, of_);
    }
  }

  // By how much the likelihood of held-out recordings rises with each law beside the others: without end where nothing
  // can be simulated there without it. None where the explanation itself cannot be compared, of its last law.
  [[nodiscard]] std::vector<double> help_of_each(const Result<BlockGains>& whole) const {
    constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();
    std::vector<double> helps(result_.best.effects.size(), kWithoutEnd);
    if (!whole || whole->gain.empty()) {
      helps.back() = -kWithoutEnd;
      return helps;
    }
    for (std::size_t law = 0; law < helps.size(); ++law) {
      const auto own = of_.held_out.gains(without(result_.best, law, of_), result_.best);
      if (own && !own->gain.empty()) helps[law] = interval(*own).gain;
    }
    return helps;
  }

  [[nodiscard]] GainInterval interval(const BlockGains& blocks) const {
    return gain_interval(blocks, dispersion(*result_.best.model), of_.held_out.options.seed);
  }

  // Of the likeliest explanations the one that predicts the fitted recordings best, each from the others: those that were
  // kept aside take no part in that. Where there are none, the first is asked whatever time it takes, so that a search
  // that was cut can be proven.
  void choose_what_carries_over() {
    if (of_.held_out.fit.samples.size() < 2) return;
    const bool is_the_proof = of_.held_out.holdout.samples.empty();
    is_the_proof ? time_.allow_what_is_needed() : time_.allow(kChosenBy);
    const Data none;
    const CarryOver from_others =
        carry_over({of_.held_out.fit, none, of_.held_out.window_s, of_.held_out.options, of_.held_out.kept});
    std::vector<std::pair<double, Trial>> order;  // by the fall of the misfit that they predict
    for (const Trial& trial : likeliest(of_.naming, kMostToCarryOver)) {
      const Worth worth = from_others.of_whole(trial);
      if (worth.whole.low > 0.0) order.emplace_back(worth.whole.gain * dispersion(*trial.model), trial);
      time_.allow(kChosenBy);
      if (!time_.in_time("which other explanation carries over better")) break;
    }
    std::ranges::stable_sort(order, std::greater<>(), &std::pair<double, Trial>::first);
    if (is_the_proof) time_.allow_what_is_needed();
    for (auto& [gain, trial] : order) {
      const Worth worth = from_others.of(trial);
      time_.allow(kChosenBy);
      if (!worth.carries_over()) {
        if (!time_.in_time("whether each law of another explanation carries over")) return;
        continue;
      }
      result_.best = std::move(trial);
      result_.proven = is_the_proof;
      if (result_.proven) result_.not_compared = worth.not_compared;
      return;
    }
  }

  // What does not carry over, as a whole and by each law, does so without the law that helps least, or not at all.
  void in_gross_misfit() {
    choose_what_carries_over();
    if (result_.proven) return;
    time_.allow_what_is_needed();
    const CarryOver kept_aside = carry_over(of_.held_out);
    while (!result_.best.effects.empty()) {
      const Worth worth = kept_aside.of(result_.best);
      if (worth.carries_over()) {
        result_.proven = true;
        result_.not_compared = worth.not_compared;
        return;
      }
      const std::size_t least = worth.of_law.empty() ? result_.best.effects.size() - 1 : worth.least();
      result_.notes.push_back(does_not_help(result_.best.effects[least]));
      result_.best = without(result_.best, least, of_);
    }
  }

  static std::string does_not_help(const Effect& effect) {
    return "A law that fits better (" + law_in_words(effect) +
           ") does not improve the held-out recordings: it is not claimed.";
  }

  static std::string why_not_proven(const Effect& effect, const Result<BlockGains>& blocks) {
    const std::string law = "A law that fits better (" + law_in_words(effect) + ") ";
    if (!blocks)
      return law + "cannot be simulated on the held-out recordings (" + reason_in_words(blocks.error()) +
             "): it is not claimed.";
    if (!blocks->gain.empty()) return does_not_help(effect);
    if (blocks->not_compared.empty()) return "With one recording nothing can be held out: what fits it is not claimed.";
    return law + "cannot be compared with anything on the held-out recordings: it is not claimed.";
  }

  [[nodiscard]] CarryOver carry_over(const HeldOut& held_out) const { return carry_over_of(of_, held_out); }

  const ToProve& of_;
  TimeBudget& time_;
  ProvenLaws result_;
};

}  // namespace

Trial without(const Trial& trial, std::size_t slot, const ToProve& of) {
  const HeldOut& held_out = of.held_out;
  const Data data = in_windows(held_out.fit, held_out.window_s);
  return without_law(of.naming, trial, slot, data, held_out.options.threads).value_or(Trial{{}, of.baseline});
}

CarryOver carry_over_of(const ToProve& of, const HeldOut& held_out) {
  return {held_out, {{}, of.baseline}, [of](const Trial& trial, std::size_t law) { return without(trial, law, of); }};
}

ProvenLaws prove(const ToProve& of, Trial best, TimeBudget& time) { return Proving(of, std::move(best), time).run(); }

}  // namespace sealwatch::mismatch
