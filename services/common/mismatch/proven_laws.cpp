#include "services/common/mismatch/proven_laws.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/other_shapes.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostToCarryOver = 6;  // explanations of a gross misfit that predict recordings

class Proving {
 public:
  Proving(const ToProve& of, Trial best, TimeBudget& time) : of_(of), time_(time) { result_.best = std::move(best); }

  ProvenLaws run() {
    if (excess(*result_.best.model) > kGross)
      in_gross_misfit();
    else
      one_by_one();
    return std::move(result_);
  }

 private:
  // Effects that do not help on held-out recordings are taken back, the last first. That time is up says nothing against
  // a law: what a search that was cut has found is proven, whatever time it takes.
  void one_by_one() {
    time_.allow_what_is_needed();
    while (!result_.best.effects.empty()) {
      Trial fewer = without(result_.best, result_.best.effects.size() - 1, of_);
      const Result<BlockGains> blocks = of_.held_out.gains(fewer, result_.best);
      if (blocks && !blocks->gain.empty() &&
          gain_interval(*blocks, dispersion(*result_.best.model), of_.held_out.options.seed).low > 0.0) {
        result_.proven = true;
        result_.not_compared = blocks->not_compared;
        return;
      }
      result_.notes.push_back(why_not_proven(blocks));
      result_.best = std::move(fewer);
    }
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

  // What does not carry over, as a whole and by each law, gives way to the likeliest explanation with fewer laws.
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
      const std::vector<Trial> fewer = likeliest(of_.naming, 1, result_.best.effects.size() - 1);
      result_.best = fewer.empty() ? Trial{{}, of_.baseline} : fewer.front();
    }
  }

  static std::string does_not_help(const Effect& effect) {
    return "A law that fits better (" + law_in_words(law_at(effect)) +
           ") does not improve the held-out recordings: it is not claimed.";
  }

  [[nodiscard]] std::string why_not_proven(const Result<BlockGains>& blocks) const {
    const std::string law = "A law that fits better (" + law_in_words(law_at(result_.best.effects.back())) + ") ";
    if (!blocks)
      return law + "cannot be simulated on the held-out recordings (" + reason_in_words(blocks.error()) +
             "): it is not claimed.";
    if (!blocks->gain.empty()) return does_not_help(result_.best.effects.back());
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
