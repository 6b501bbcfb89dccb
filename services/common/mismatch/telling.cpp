#include "services/common/mismatch/telling.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/law_words.hpp"

namespace sealwatch::mismatch {
namespace {

const ChannelComparison* worst_channel(const PooledFit& fit) {
  const auto worst = std::ranges::max_element(fit.channels, {}, &ChannelComparison::rms_before);
  return worst == fit.channels.end() ? nullptr : &*worst;
}

// Where the laws found took most of the misfit.
const ChannelComparison* most_improved_channel(const PooledFit& fit) {
  const auto gain = [](const ChannelComparison& channel) {
    return channel.rms_before * channel.rms_before - channel.rms_after * channel.rms_after;
  };
  const auto most = std::ranges::max_element(fit.channels, {}, gain);
  return most == fit.channels.end() ? nullptr : &*most;
}

// Which change of the test's conditions tells apart laws of these kinds.
std::string separating_test(const FoundEffect& effect, bool is_stroke_test) {
  if (!effect.same_elements.empty() && effect.what.element.starts_with("sensor:"))
    return "Compare the sensor with a reference at rest, at two known values. No test can separate its error from the "
           "plant's.";
  if (!is_stroke_test)
    return "Record tests that separate these laws: with inputs that change at a third and at twice the rate, and over "
           "another part of the range.";
  return "Record tests that separate these laws: one at a third and one at twice the ramp speed, one with a clearly "
         "lower and one with a clearly higher load, and one over another part of the stroke.";
}

}  // namespace

std::string law_in_words(const LawAt& law) {
  return text::law_at(in_words(law.id), law.element, element_in_words(law.element), "at");
}

std::string left_in_words(const PooledFit& fit) {
  if (const ChannelComparison* most = fit.missed())
    return " A part remains unexplained: " + in_words(most->channel) + " still misses by " +
           text::misfit_text(most->rms_after) + " times the noise.";
  // Of samples that count nothing is missed: what the others miss has a cause of its own.
  const auto missed = std::ranges::max_element(fit.channels, {}, &ChannelComparison::rms_after);
  if (missed == fit.channels.end() || missed->rms_after < PooledFit::kNearly) return {};
  return " What the input did between samples may account for the rest: " + in_words(missed->channel) +
         " still misses by " + text::misfit_text(missed->rms_after) +
         " times the noise, and the values may be off by more than their errors say.";
}

std::string proof_in_words(const PooledFit& holdout) {
  const ChannelComparison* proof = most_improved_channel(holdout);
  if (proof == nullptr) return {};
  return "the misfit of " + in_words(proof->channel) + " on held-out recordings falls from " +
         text::misfit_text(proof->rms_before) + " to " + text::misfit_text(proof->rms_after) + " times the noise";
}

std::string reason_in_words(const Error& error) {
  return error.place.empty() ? error.rule : error.place + ": " + error.rule;
}

std::string element_in_words(const std::string& element) {
  constexpr std::string_view kSensor = "sensor:";
  if (element.starts_with(kSensor)) return "the sensor of " + in_words(element.substr(kSensor.size()));
  constexpr std::string_view kInput = "input:";
  if (element.starts_with(kInput)) return "the recorded input " + in_words(element.substr(kInput.size()));
  if (element == "clock") return "the recording's clock";
  const bool numbered = element.size() > 2 && element[element.size() - 2] == '_';  // "chamber A", "valve 1"
  return (numbered ? "" : "the ") + in_words(element);
}

std::string evidence_of(const FoundEffect& effect, std::size_t effects, double misfit_before, double misfit_after) {
  std::string text = effects > 1 ? "With the other laws found, " : "Adding ";
  text.append(law_in_words(effect.what)).append(" takes the mean squared residual of the fit recordings from ");
  text.append(text::misfit_text(misfit_before))
      .append(" to ")
      .append(text::misfit_text(misfit_after))
      .append(" times the noise variance.");
  return text;
}

std::string next_test_of(const Explanation& explanation) {
  const auto plant = find_plant(explanation.model);
  const bool is_stroke_test = plant && (*plant)->has_load();
  for (const FoundEffect& effect : explanation.effects)
    if (!effect.indistinguishable.empty()) return separating_test(effect, is_stroke_test);
  if (explanation.verdict != Verdict::undetermined) return {};
  if (explanation.fit_recordings.size() < 2)
    return std::string("Record at least three more tests ") +
           (is_stroke_test ? "at other loads, speeds and strokes" : "with inputs of other size, rate and range") +
           ", and hold one of them out. In a single recording, the parameters can absorb an effect, and "
           "nothing is left to prove a law on.";
  if (!explanation.statistically_significant)
    return is_stroke_test
               ? "Record tests under new conditions: a load that differs by at least 20 %, half and twice the ramp "
                 "speed, and a longer stroke. Include a rest and a hold of 3 s."
               : "Record tests under new conditions: inputs that change at half and at twice the rate, over a wider "
                 "range. Include a rest and a hold.";
  return std::string("Record the same asset ") +
         (is_stroke_test ? "at two further loads and speeds" : "with two further courses of its inputs") +
         ", with all available channels, and hold two of these recordings out.";
}

namespace {

// A sensor, the recorded input and the clock are no part of the simulation.
std::string found_in_words(const std::vector<FoundEffect>& effects) {
  std::vector<std::string> physics, faults;
  for (const FoundEffect& effect : effects) {
    const std::string& element = effect.what.element;
    const bool recorded = element.starts_with("sensor:") || element.starts_with("input:") || element == "clock";
    (recorded ? faults : physics).push_back(law_in_words(effect.what));
  }
  std::string text;
  if (!physics.empty()) text = "The simulation lacks " + joined(physics, " and ");
  if (!faults.empty())
    text += (physics.empty() ? "The recordings show " : ", and the recordings show ") + joined(faults, " and ");
  return text + ".";
}

constexpr double kNoLarger = 1.05;  // times the noise, whose own size is known no better

// Samples that count less are part of what is reported. What those that count miss alike is not the input's.
std::string hidden_by_the_input(const ChannelComparison* worst) {
  if (worst == nullptr || worst->rms_before < kNoLarger * std::max(1.0, worst->weighed_rms_after)) return {};
  return " What the input did between samples may account for the misfit of " + in_words(worst->channel) + " (" +
         text::misfit_text(worst->rms_before) + " times the noise). Record the input faster to see what it hides.";
}

}  // namespace

std::string summary_of(const Explanation& explanation) {
  std::string text;
  const ChannelComparison* worst = worst_channel(explanation.fit);
  if (explanation.verdict == Verdict::consistent) {
    return "Simulation and recordings agree within the noise once the free parameters are fitted. No physics is "
           "missing that these tests could have shown." +
           hidden_by_the_input(worst);
  }
  if (explanation.verdict == Verdict::mismatch) {
    text = found_in_words(explanation.effects);
    if (const std::string proof = proof_in_words(explanation.holdout); !proof.empty())
      text += (explanation.effects.size() > 1 ? " With them, " : " With it, ") + proof + "." +
              left_in_words(explanation.holdout);
    std::string_view begin = " These recordings cannot distinguish ";
    for (const FoundEffect& effect : explanation.effects) {
      if (effect.indistinguishable.empty()) continue;
      std::vector<std::string> others;
      for (const LawAt& other : effect.indistinguishable)
        others.push_back(effect.is_another_form(other) ? "another form of it (" + other.law + ")"
                                                       : law_in_words(other));
      text.append(std::exchange(begin, " Nor can they distinguish ")).append(law_in_words(effect.what));
      text.append(" from ").append(joined(others, " or ")).append(".");
    }
    return text;
  }
  if (!explanation.statistically_significant)
    return "No difference beyond the noise was found, but these recordings could not have shown effects of a "
           "significant "
           "size.";
  const bool small = worst != nullptr && worst->rms_before < kNoLarger;
  text = small ? "Simulation and recordings differ by no more than the noise, but not at random"
               : "Simulation and recordings differ beyond the noise";
  if (small) text.append(", p = ").append(number(explanation.p_value));
  if (worst != nullptr)
    text.append(" (")
        .append(in_words(worst->channel))
        .append(": ")
        .append(text::misfit_text(worst->rms_before))
        .append(" times the noise)");
  const bool single = explanation.fit_recordings.size() < 2 && explanation.holdout_recordings.empty();
  text += single ? "; a single recording cannot prove a law."
                 : ", and no law was found that also explains held-out recordings.";
  if (!explanation.location.empty())
    text.append(" Look first at ").append(element_in_words(explanation.location.front().element)).append(".");
  return text;
}

}  // namespace sealwatch::mismatch
