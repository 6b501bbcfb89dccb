#include "services/common/mismatch/regime.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/mismatch/site_words.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kEnergy = 0.9, kTime = 0.65;  // least and most share of a regime that is named
constexpr double kRestNamed = 0.05;            // share of time from which it is worth saying that rest has none
constexpr double kAtRest = 0.05;               // of the largest speed
constexpr double kSpread = 0.1;                // of a signal's size, in its range, from which it splits
constexpr double kAlike = 0.2;                 // of eta2, within which signals decide alike
constexpr double kActive = 0.1;                // of the term's 99 % quantile
constexpr double kThroughout = 0.95;           // share of the time
constexpr std::size_t kBins = 24;              // of a signal's range
constexpr std::size_t kMostWords = 3;

/// One step of a simulation: how long it stands for, what acts in it.
struct Step {
  double weight_s = 0.0;
  double term = 0.0;
  double energy = 0.0;
  double phase = 0.0;  ///< of the recording, 0 to 1
  std::array<double, kSiteSignals> signals{};
};

std::string number_with_unit(double value, std::string_view unit) {
  double factor = 1.0;
  if (unit == "m" || unit == "m/s") factor = 1e3, unit = unit == "m" ? "mm" : "mm/s";
  if (unit == "Pa") factor = 1e-5, unit = "bar";
  if (unit == "m3/s") factor = 6e4, unit = "L/min";
  const double shown = value * factor, size = std::abs(shown);
  if (size >= 100.0) return text::format("{:.0f} {}", shown, unit);
  return text::format("{:.{}g} {}", shown, size < 10.0 ? 2 : 3, unit);
}

std::vector<Step> steps_of(std::span<const TermPath> recordings) {
  std::vector<Step> steps;
  for (const TermPath& path : recordings)
    for (std::size_t k = 0; k < path.time_s.size(); ++k) {
      const std::vector<double>& t = path.time_s;
      const double weight = 0.5 * (t[std::min(k + 1, t.size() - 1)] - t[k == 0 ? 0 : k - 1]);
      const double duration = std::max(t.back() - t.front(), 1e-12);
      steps.push_back({.weight_s = weight,
                       .term = path.contribution[k],
                       .energy = weight * path.contribution[k] * path.contribution[k],
                       .phase = (t[k] - t.front()) / duration,
                       .signals = path.signals[k]});
    }
  return steps;
}

struct Shares {
  double energy = 0.0, time = 0.0;
  [[nodiscard]] bool named() const { return energy >= kEnergy && time <= kTime; }
};

template <class Inside>
Shares shares(const std::vector<Step>& steps, const Inside& inside) {
  Shares part, all;
  for (const Step& step : steps) {
    all.energy += step.energy, all.time += step.weight_s;
    if (inside(step)) part.energy += step.energy, part.time += step.weight_s;
  }
  return {part.energy / std::max(all.energy, 1e-300), part.time / std::max(all.time, 1e-300)};
}

// The value below which a signal stays for that share of the time.
template <class Of>
double quantile(const std::vector<Step>& steps, double share, const Of& of) {
  std::vector<std::pair<double, double>> values;
  double time_s = 0.0, below_s = 0.0;
  for (const Step& step : steps) values.emplace_back(of(step), step.weight_s), time_s += step.weight_s;
  std::ranges::sort(values);
  for (const auto& [value, weight_s] : values)
    if (below_s += weight_s; below_s >= share * time_s) return value;
  return values.back().first;
}

// Names the motion and leaves only the steps in which it acts.
void split_motion(const MotionWords& motion, std::vector<Step>& steps, std::vector<std::string>& words) {
  if (motion.signal == kSiteSignals) return;
  const auto speed = [&](const Step& step) { return step.signals[motion.signal]; };
  const double rest = kAtRest * quantile(steps, 0.98, [&](const Step& step) { return std::abs(speed(step)); });
  const auto forward = [&](const Step& step) { return speed(step) > rest; };
  const auto backward = [&](const Step& step) { return speed(step) < -rest; };
  const auto at_rest = [&](const Step& step) { return std::abs(speed(step)) <= rest; };
  const Shares resting = shares(steps, at_rest);
  const auto keep = [&](const char* name, const auto& inside) {
    words.emplace_back(name);
    std::erase_if(steps, [&](const Step& step) { return !inside(step); });
  };
  if (resting.named()) return keep(motion.rest, at_rest);
  const bool acts_at_rest = resting.energy > (1.0 - kEnergy) * resting.time;
  if (resting.time > 0.0 && acts_at_rest) return;
  std::erase_if(steps, at_rest);
  if (shares(steps, forward).named()) return keep(motion.forward, forward);
  if (shares(steps, backward).named()) return keep(motion.backward, backward);
  if (resting.time < kRestNamed) return;
  words.emplace_back(motion.both);
}

// Size from which the term is there; of one that is there for less than a hundredth of the time, by its largest value.
double least_active(const std::vector<Step>& steps) {
  const auto size = [](const Step& step) { return std::abs(step.term); };
  const double least = kActive * quantile(steps, 0.99, size);
  if (least > 0.0) return least;
  double largest = 0.0;
  for (const Step& step : steps) largest = std::max(largest, size(step));
  return kActive * largest;
}

// The values between which most of the energy falls, in the least time.
struct Range {
  double low = 0.0, high = 0.0;
  Shares shares;
};
Range narrowest_range(std::vector<std::pair<double, const Step*>> by_value) {
  std::ranges::sort(by_value, {}, [](const auto& one) { return one.first; });
  Shares all, inside;
  for (const auto& [value, step] : by_value) all.energy += step->energy, all.time += step->weight_s;
  Range best{.shares = {1.0, 1.0}};
  std::size_t first = 0;
  for (const auto& [value, step] : by_value) {
    inside.energy += step->energy, inside.time += step->weight_s;
    for (; inside.energy - by_value[first].second->energy >= kEnergy * all.energy; ++first)
      inside.energy -= by_value[first].second->energy, inside.time -= by_value[first].second->weight_s;
    if (inside.energy >= kEnergy * all.energy && inside.time < best.shares.time * all.time)
      best = {by_value[first].first, value, {inside.energy / all.energy, inside.time / all.time}};
  }
  return best;
}

// The values between which nearly none of the energy falls, in the most time: a term that acts at both ends.
Range widest_gap(std::vector<std::pair<double, const Step*>> by_value) {
  std::ranges::sort(by_value, {}, [](const auto& one) { return one.first; });
  Shares all, inside;
  for (const auto& [value, step] : by_value) all.energy += step->energy, all.time += step->weight_s;
  Range best;
  std::size_t first = 0;
  for (const auto& [value, step] : by_value) {
    inside.energy += step->energy, inside.time += step->weight_s;
    for (; inside.energy > (1.0 - kEnergy) * all.energy; ++first)
      inside.energy -= by_value[first].second->energy, inside.time -= by_value[first].second->weight_s;
    if (inside.time > best.shares.time * all.time)
      best = {by_value[first].first, value, {inside.energy / all.energy, inside.time / all.time}};
  }
  return best;
}

// Share of the variance of `of` between the values of a signal, in bins of its range.
template <class Of>
double correlation_ratio(const std::vector<Step>& steps, std::size_t signal, const Of& of) {
  const auto value = [&](const Step& step) { return step.signals[signal]; };
  const double low = quantile(steps, 0.01, value), high = quantile(steps, 0.99, value);
  if (!(high > low)) return 0.0;
  std::array<double, kBins> time{}, sum{};
  double all_time = 0.0, mean = 0.0, square = 0.0, between = 0.0;
  for (const Step& step : steps) {
    const double place = static_cast<double>(kBins) * (value(step) - low) / (high - low);
    const auto bin = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kBins) - 1.0));
    time[bin] += step.weight_s, sum[bin] += step.weight_s * of(step);
    all_time += step.weight_s, mean += step.weight_s * of(step), square += step.weight_s * of(step) * of(step);
  }
  mean /= all_time;
  const double variance = square / all_time - mean * mean;
  if (variance <= 1e-9 * square / all_time) return 0.0;  // a constant goes by nothing
  for (std::size_t bin = 0; bin < kBins; ++bin)
    if (time[bin] > 0.0) between += time[bin] * std::pow(sum[bin] / time[bin] - mean, 2);
  return between / all_time / variance;
}

// A range with one end is told from where the term sets in, not from where most of its energy is: a valve opens at a
// pressure, and does most far above.
template <class Of>
Range from_where_it_acts(Range range, double lowest, double highest, const std::vector<Step>& steps, const Of& of) {
  const bool from_lowest = range.low <= lowest, to_highest = range.high >= highest;
  if (!range.shares.named() || from_lowest == to_highest) return range;
  const double least = least_active(steps);
  std::vector<Step> active;
  std::ranges::copy_if(steps, std::back_inserter(active),
                       [&](const Step& step) { return std::abs(step.term) > least; });
  Range wider = range;
  if (from_lowest) wider.high = std::max(range.high, quantile(active, 0.99, of));
  if (to_highest) wider.low = std::min(range.low, quantile(active, 0.01, of));
  wider.shares = shares(steps, [&](const Step& step) { return of(step) >= wider.low && of(step) <= wider.high; });
  return wider.shares.named() && (wider.low <= lowest) == from_lowest && (wider.high >= highest) == to_highest ? wider
                                                                                                               : range;
}

void split_signal(const SignalWords& signal, std::size_t index, bool by_size, const std::vector<Step>& steps,
                  std::vector<std::string>& words) {
  const auto of = [&](const Step& step) { return by_size ? std::abs(step.signals[index]) : step.signals[index]; };
  const double lowest = quantile(steps, 0.05, of), highest = quantile(steps, 0.95, of);
  if (highest - lowest < kSpread * std::max(std::abs(lowest), std::abs(highest))) return;
  std::vector<std::pair<double, const Step*>> by_value;
  for (const Step& step : steps) by_value.emplace_back(of(step), &step);
  const Range range = from_where_it_acts(narrowest_range(by_value), lowest, highest, steps, of);
  const bool from_lowest = range.low <= lowest, to_highest = range.high >= highest;
  if (!range.shares.named() || (from_lowest && to_highest)) {
    const Range gap = widest_gap(std::move(by_value));
    if (gap.shares.time < 1.0 - kTime || gap.low <= lowest || gap.high >= highest) return;
    words.push_back(std::string(signal.name)
                        .append(" below ")
                        .append(number_with_unit(gap.low, signal.unit))
                        .append(" or above ")
                        .append(number_with_unit(gap.high, signal.unit)));
    return;
  }
  const std::string low = number_with_unit(range.low, signal.unit), high = number_with_unit(range.high, signal.unit);
  std::string text(signal.name);
  if (from_lowest)
    text.append(" below ").append(high);
  else if (to_highest)
    text.append(" above ").append(low);
  else
    text.append(" between ").append(low).append(" and ").append(high);
  words.push_back(std::move(text));
}

std::string percent(double share) {
  if (share < 0.01) return "less than 1 %";
  return text::percent(share, 0);
}

// Of the signals that the term's size goes by.
void split_signals(SiteKind kind, const std::array<SignalWords, kSiteSignals>& signals, const std::vector<Step>& steps,
                   std::vector<std::string>& words) {
  if (steps.empty()) return;
  std::array<double, kSiteSignals> ratio{};
  for (std::size_t k = 0; k < kSiteSignals; ++k)
    if (!signals[k].name.empty())
      ratio[k] = correlation_ratio(steps, k, [](const Step& step) { return std::abs(step.term); });
  const double largest = *std::ranges::max_element(ratio);
  for (std::size_t k = 0; k < kSiteSignals; ++k) {
    if (signals[k].name.empty() || ratio[k] < largest - kAlike) continue;
    const bool by_size = k == motion_of(kind).signal || signals[k].unit == "A" || signals[k].unit == "m3/s";
    split_signal(signals[k], k, by_size && !is_sensor(kind), steps, words);
  }
}

}  // namespace

std::string regime_of(std::span<const TermPath> recordings, SiteKind kind,
                      const std::array<SignalWords, kSiteSignals>& signals, bool whole) {
  std::vector<Step> steps = steps_of(recordings);
  if (steps.empty()) return {};
  if (!(shares(steps, [](const Step&) { return true; }).energy > 0.0)) return "nowhere in these recordings";
  const double least = least_active(steps);
  const double active = shares(steps, [&](const Step& step) { return std::abs(step.term) > least; }).time;
  std::vector<std::string> words;
  split_motion(motion_of(kind), steps, words);
  split_signals(kind, signals, steps, words);
  if (whole && shares(steps, [](const Step& step) { return step.phase < 1.0 / 3.0; }).named())
    words.emplace_back("in the first third of the recording");
  if (whole && shares(steps, [](const Step& step) { return step.phase > 2.0 / 3.0; }).named())
    words.emplace_back("in the last third of the recording");
  if (words.empty()) {
    if (active >= kThroughout) return "throughout";
    return std::string(active > kTime ? "most of the time (" : "at times (").append(percent(active)).append(")");
  }
  if (words.size() > kMostWords) words.resize(kMostWords);
  std::string text = words.front();
  for (std::size_t k = 1; k < words.size(); ++k) text.append("; ").append(words[k]);
  return text.append(", ").append(percent(active)).append(" of the time");
}

std::string regime_of(std::span<const TermPath> recordings, SiteKind kind) {
  return regime_of(recordings, kind, words_of(kind).signals);
}

std::array<SignalWords, kSiteSignals> signals_of(const PlantSimulation& simulation, const std::string& element,
                                                 SiteKind kind) {
  std::array<SignalWords, kSiteSignals> signals = words_at(simulation.plant(), element, kind).signals;
  const std::size_t channel = is_sensor(kind) ? channel_of(simulation, element) : simulation.channels().size();
  if (channel == simulation.channels().size()) return signals;
  if (const auto* description = simulation.plant().find_channel(simulation.channels()[channel]))
    signals.front() = {"measured value", description->unit};
  return signals;
}

std::array<bool, kSiteSignals> signals_seen(std::span<const TermPath> recordings, const Law& law,
                                            std::span<const double> parameters, const PlantDescription& plant) {
  constexpr std::size_t kEvery = 10;    // steps: neighbours see the same
  constexpr double kSomeMemory = 0.3;   // of the hidden state's size: neither at rest nor at its end
  constexpr std::size_t kPosition = 1;  // of the piston's signals
  std::array<bool, kSiteSignals> seen{};
  if (is_sensor(law.kind)) return {true};
  const Roundings roundings = roundings_of(plant, law);
  const double hidden = law.hidden ? kSomeMemory * law.hidden->scale : 0.0;
  for (const TermPath& path : recordings)
    for (std::size_t step = 0; step < path.signals.size(); step += kEvery) {
      const LawOutput output = law.evaluate(law_input(path.signals[step], hidden, parameters, roundings));
      for (std::size_t k = 0; k < kSiteSignals; ++k)
        seen[k] = seen[k] || output.contribution.derivative[k] != 0.0 || output.rate.derivative[k] != 0.0;
    }
  if (law.kind == SiteKind::piston_force && law.hidden) seen[kPosition] = true;  // what a memory of the way shows over
  return seen;
}

std::size_t deciding_signal(std::span<const TermPath> recordings, SiteKind kind,
                            const std::array<bool, kSiteSignals>& seen) {
  constexpr double kNearlyEqual = 0.05;
  const std::vector<Step> steps = steps_of(recordings);
  std::size_t best = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < kSiteSignals && !steps.empty(); ++k) {
    if (words_of(kind).signals[k].name.empty() || !seen[k]) continue;
    const double ratio = correlation_ratio(steps, k, [](const Step& step) { return step.term; });
    if (ratio > largest + kNearlyEqual) best = k, largest = ratio;
  }
  return best;
}

}  // namespace sealwatch::mismatch
