#include "services/common/mismatch/regime.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "services/common/mismatch/site_words.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kEnergy = 0.9, kTime = 0.65;  // least and most share of a regime that is named
constexpr double kRestNamed = 0.05;            // share of time from which it is worth saying that rest has none
constexpr double kAtRest = 0.05;               // of the largest speed
constexpr double kSpread = 0.1;                // of a signal's size, in its range, from which it splits
constexpr double kLongestStep_s = 0.05;
constexpr std::size_t kMostWords = 3;

/// One step of a simulation: how long it stands for, what acts in it.
struct Step {
  double weight_s = 0.0;
  double energy = 0.0;
  double phase = 0.0;  ///< of the recording, 0 to 1
  std::array<double, kSiteSignals> signals{};
};

/// The signal that says whether and which way something moves, with its words; none: a kind at which nothing does.
struct Motion {
  std::size_t signal = kSiteSignals;
  const char *rest = "", *forward = "", *backward = "", *both = "";
};

Motion motion_of(SiteKind kind) {
  constexpr const char *kStill = "shaft at rest", *kForward = "turning forwards", *kBackward = "turning backwards",
                       *kTurning = "turning, both directions";
  switch (kind) {
    case SiteKind::piston_force:
      return {0, "at rest", "moving towards +x", "moving towards -x", "moving, both directions"};
    case SiteKind::seal_leakage:
      return {1, "at rest", "moving towards +x", "moving towards -x", "moving, both directions"};
    case SiteKind::shaft_torque:
      return {0, kStill, kForward, kBackward, kTurning};
    case SiteKind::pump_slip:
    case SiteKind::winding_voltage:
      return {1, kStill, kForward, kBackward, kTurning};
    case SiteKind::voltage_command:
      return {1, "without command", "positive command", "negative command", "commanded, both directions"};
    case SiteKind::line_drop:
      return {0, "without flow", "oil flowing into the chamber", "oil flowing out of the chamber",
              "oil flowing, both directions"};
    default:
      return {};
  }
}

std::string number_with_unit(double value, std::string_view unit) {
  double factor = 1.0;
  if (unit == "m" || unit == "m/s") factor = 1e3, unit = unit == "m" ? "mm" : "mm/s";
  if (unit == "Pa") factor = 1e-5, unit = "bar";
  if (unit == "m3/s") factor = 6e4, unit = "L/min";
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.2g", value * factor);
  if (std::abs(value * factor) >= 100.0) std::snprintf(text.data(), text.size(), "%.0f", value * factor);
  return std::string(text.data()).append(" ").append(unit);
}

std::vector<Step> steps_of(std::span<const TermPath> recordings) {
  std::vector<Step> steps;
  for (const TermPath& path : recordings)
    for (std::size_t k = 0; k < path.time_s.size(); ++k) {
      const std::vector<double>& t = path.time_s;
      const double weight = 0.5 * (t[std::min(k + 1, t.size() - 1)] - t[k == 0 ? 0 : k - 1]);
      const double duration = std::max(t.back() - t.front(), 1e-12);
      steps.push_back({.weight_s = weight,
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
void split_motion(const Motion& motion, std::vector<Step>& steps, std::vector<std::string>& words) {
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

void split_signal(const SignalWords& signal, std::size_t index, bool by_size, const std::vector<Step>& steps,
                  std::vector<std::string>& words) {
  const auto of = [&](const Step& step) { return by_size ? std::abs(step.signals[index]) : step.signals[index]; };
  const double lowest = quantile(steps, 0.05, of), highest = quantile(steps, 0.95, of);
  if (highest - lowest < kSpread * std::max(std::abs(lowest), std::abs(highest))) return;
  std::vector<std::pair<double, const Step*>> by_value;
  for (const Step& step : steps) by_value.emplace_back(of(step), &step);
  const Range range = narrowest_range(std::move(by_value));
  const bool from_lowest = range.low <= lowest, to_highest = range.high >= highest;
  if (!range.shares.named() || (from_lowest && to_highest)) return;
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

}  // namespace

std::string regime_of(std::span<const TermPath> recordings, SiteKind kind) {
  std::vector<Step> steps = steps_of(recordings);
  std::vector<std::string> words;
  if (shares(steps, [](const Step&) { return true; }).energy > 0.0) {
    const Motion motion = motion_of(kind);
    split_motion(motion, steps, words);
    const auto& signals = words_of(kind).signals;
    for (std::size_t k = 0; k < kSiteSignals; ++k)
      if (!signals[k].name.empty()) {
        const bool by_size = k == motion.signal || signals[k].unit == "A" || signals[k].unit == "m3/s";
        split_signal(signals[k], k, by_size, steps, words);
      }
    if (shares(steps, [](const Step& step) { return step.phase < 1.0 / 3.0; }).named())
      words.emplace_back("in the first third of the recording");
    if (shares(steps, [](const Step& step) { return step.phase > 2.0 / 3.0; }).named())
      words.emplace_back("in the last third of the recording");
  }
  if (words.empty()) return "throughout";
  if (words.size() > kMostWords) words.resize(kMostWords);
  std::string text = words.front();
  for (std::size_t k = 1; k < words.size(); ++k) text.append("; ").append(words[k]);
  return text;
}

std::string regime_of(const FittedModel& with, const std::string& element, const Law& law,
                      std::span<const double> parameters) {
  std::vector<TermPath> paths;
  for (std::size_t k = 0; !is_sensor(law.kind) && k < with.problem.recordings.size(); ++k)
    if (Result<TermPath> path = term_path(point_of(with, k), element, law.kind, &law, parameters, kLongestStep_s))
      paths.push_back(std::move(*path));
  return regime_of(paths, law.kind);
}

}  // namespace sealwatch::mismatch
