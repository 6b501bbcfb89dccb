#include "services/common/mismatch/balance_words.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kDatasheetMatters = 0.05;  // of a datasheet value: what an engineer would care about

bool is_datasheet(const BalanceFinding& finding) { return finding.what.law == nullptr; }

std::string unit_of(const BalanceFinding& finding, const PlantDescription& plant) {
  if (is_datasheet(finding)) return plant.find_parameter(finding.what.name)->unit;
  for (const LawParameter& parameter : finding.what.law->parameters)
    if (parameter.name == finding.what.name && parameter.unit != "channel") return std::string(parameter.unit);
  const ChannelDescription* channel =
      plant.find_channel(finding.what.element.substr(finding.what.element.find(':') + 1));
  return channel == nullptr ? "1" : channel->unit;
}

LawAt law_of(const BalanceFinding& finding, const PlantDescription& plant) {
  if (!is_datasheet(finding))
    return {.id = std::string(finding.what.law->id),
            .form = std::string(finding.what.law->form),
            .element = finding.what.element,
            .law = std::string(finding.what.law->equation),
            .meaning = std::string(finding.what.law->meaning)};
  return {.id = std::string(kDatasheetValue),
          .form = finding.what.name,
          .element = finding.what.element,
          .law = finding.what.name,
          .meaning = "the asset's value of " + plant.find_parameter(finding.what.name)->meaning + " is wrong"};
}

std::string evidence_of(const BalanceFinding& finding, double held_out_gain) {
  std::string text = finding_in_words(finding);
  text.append(". Without it, the criterion is worse by ").append(number(finding.weight)).append(" (12 is decisive)");
  if (held_out_gain > 0.0)
    text.append(" and ").append(number(held_out_gain)).append(" in the likelihood of held-out recordings");
  return text.append(".");
}

// Others in its place: probabilities from the criterion, as for laws.
void weigh(FoundEffect& effect, const BalanceFinding& finding, const PlantDescription& plant) {
  double all = 1.0, element = 1.0;
  for (const BalanceFinding& other : finding.alternatives) {
    const LawAt law = law_of(other, plant);
    const double share = std::exp(-0.5 * std::min(other.weight, 1400.0));
    all += share;
    if (law.element == effect.what.element) element += share;
    const bool cannot_tell = other.weight < kCannotTell;
    if (cannot_tell) effect.indistinguishable.push_back(law);
    if (cannot_tell && law.element != effect.what.element) effect.same_elements.push_back(law.element);
    effect.alternatives.push_back({.what = law,
                                   .misfit_above_best = other.weight,
                                   .why_not = cannot_tell
                                                  ? "These recordings cannot distinguish it from the chosen one."
                                                  : "In its place the balances are worse by " + number(other.weight) +
                                                        " (12 counts as decisive)."});
  }
  effect.probability = std::min(1.0 / all, kNeverCertain);
  effect.element_probability = std::min(element / all, kNeverCertain);
}

}  // namespace

std::string finding_key(const BalanceFinding& finding) {
  std::string key = finding.what.element;
  key.append("/").append(finding.what.name);
  if (!is_datasheet(finding)) key.append("/").append(finding.what.law->id);
  return key;
}

std::string finding_in_words(const BalanceFinding& finding) {
  std::string text = finding.what.name;
  text.append(" of ").append(element_in_words(finding.what.element)).append(" is ").append(number(finding.value));
  if (is_datasheet(finding))
    text.append(", not ").append(number(finding.datasheet)).append(" as in the asset");
  else
    text.append(" (").append(in_words(std::string(finding.what.law->id))).append(")");
  return text;
}

FoundEffect effect_of(const BalanceFinding& finding, const PlantDescription& plant, double held_out_gain) {
  FoundEffect effect;
  effect.what = law_of(finding, plant);
  effect.parameters.push_back({.name = finding.what.name,
                               .unit = unit_of(finding, plant),
                               .value = finding.value,
                               .std_error = finding.std_error,
                               .at_bound = finding.at_bound});
  effect.delta_bic = -finding.weight;
  if (is_datasheet(finding)) {
    effect.engineering_share = std::abs(finding.value / finding.datasheet - 1.0) / kDatasheetMatters;
    effect.what.law.append(" = ").append(text::with_unit(finding.value, effect.parameters[0].unit, 4));
    effect.what.law.append(" in place of ").append(number(finding.datasheet, 4));
  } else {
    for (const LawParameter& parameter : finding.what.law->parameters)
      if (parameter.name == finding.what.name && parameter.significant > 0.0)
        effect.engineering_share = std::abs(finding.value) / sealwatch::significant_size(plant, parameter);
  }
  effect.evidence = evidence_of(finding, held_out_gain);
  weigh(effect, finding, plant);
  return effect;
}

std::string balance_in_words(std::size_t balance, const BalanceFit& fit) {
  const BalanceDescription& description = SwitchedBalances::kBalances[balance];
  std::string text = "Balance of ";
  text.append(description.name).append(" (").append(description.element).append("): leaves ");
  text.append(number(fit.error_before[balance])).append(" ").append(description.unit).append(" with the asset's free ");
  text.append("parameters fitted, ").append(number(fit.error_after[balance])).append(" with what was found.");
  return text;
}

std::string leakage_in_words(const BalanceFit& fit) {
  const auto leakage =
      std::ranges::find(fit.free, plant_or_default(SwitchedBalances::kPlant).wear_parameter, &BalanceParameter::name);
  if (leakage == fit.free.end()) return {};
  std::string text = "Internal leakage: " + leakage->name + " ";
  if (leakage->after_std < 0.5 * leakage->after)
    text.append(text::readable_with_error(leakage->after, leakage->after_std, "Pa s/m3")).append(".");
  else
    text +=
        "is not identifiable from these recordings: while the valves are open the pump's leakage takes the same "
        "course, "
        "and while they are closed the chambers' pressures hold.";
  return text;
}

std::string gross_summary(const Explanation& explanation) {
  if (explanation.verdict != Verdict::mismatch) return summary_of(explanation);
  std::string text = "The simulation is grossly off. By weight: ";
  for (std::size_t k = 0; k < explanation.effects.size(); ++k) {
    const FoundEffect& effect = explanation.effects[k];
    if (k > 0) text += "; ";
    text.append(std::to_string(k + 1)).append(". ").append(element_in_words(effect.what.element)).append(": ");
    if (effect.what.id == kDatasheetValue)
      text.append(effect.what.law);
    else
      text.append(effect.what.id)
          .append(" ")
          .append(effect.parameters[0].name)
          .append(" = ")
          .append(number(effect.parameters[0].value));
    if (!effect.indistinguishable.empty())
      text.append(" (or ").append(element_in_words(effect.indistinguishable.front().element)).append(")");
  }
  text += ". On held-out recordings the free run reproduces";
  for (const ChannelComparison& channel : explanation.holdout.channels)
    text.append(" ")
        .append(channel.channel)
        .append(" to ")
        .append(number(channel.nrmse_after))
        .append(" % instead of ")
        .append(number(channel.nrmse_before))
        .append(" %,");
  text.back() = '.';
  return text;
}

}  // namespace sealwatch::mismatch
