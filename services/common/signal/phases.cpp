#include "sealwatch/signal/phases.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sealwatch/signal/statistics.hpp"

namespace sealwatch::signal {
namespace {

constexpr double kStart = 0.10;         // share of the stroke's speed at which the piston counts as moving
constexpr double kStop = 0.05;          // and below which it counts as standing again
constexpr double kRunning = 0.50;       // share at which breakaway is over
constexpr double kLongestEffort_s = 2;  // effort builds up at most this long before the piston moves
constexpr double kDeparture_std = 5.0;  // robust standard deviations of the standstill level
constexpr double kDeparture_range = 0.02;

struct Stroke {
  std::size_t begin = 0;  ///< first sample that moves
  std::size_t end = 0;    ///< one past the last
  int direction = 0;
};

double speed_scale(const Motion& motion) {
  std::vector<double> speed(motion.velocity_m_s.size());
  std::transform(motion.velocity_m_s.begin(), motion.velocity_m_s.end(), speed.begin(),
                 [](double v) { return std::abs(v); });
  return quantile(std::move(speed), 0.95);
}

double travel(const Motion& motion, const Stroke& stroke) {
  double sum = 0.0;
  for (std::size_t i = stroke.begin; i < stroke.end; ++i) sum += motion.velocity_m_s[i];
  return std::abs(sum) * motion.interval_s;
}

/// Runs of motion in one direction that travel far enough, those that only pause joined.
std::vector<Stroke> find_strokes(const Motion& motion, double scale) {
  const std::vector<double>& velocity = motion.velocity_m_s;
  const double start = std::max(kStart * scale, motion.least_speed_m_s);
  const double stop = std::max(kStop * scale, 0.5 * motion.least_speed_m_s);
  std::vector<Stroke> strokes;
  for (std::size_t i = 0, end = 0; i < velocity.size(); i = end) {
    end = i + 1;  // every pass goes on by a sample at least, whatever it compares like
    if (!(std::abs(velocity[i]) >= start)) continue;
    Stroke stroke{.begin = i, .end = end, .direction = velocity[i] > 0.0 ? 1 : -1};
    while (end < velocity.size() && stroke.direction * velocity[end] >= stop) ++end;
    stroke.end = end;
    if (travel(motion, stroke) < motion.least_travel_m) continue;
    if (!strokes.empty() && strokes.back().direction == stroke.direction)
      strokes.back().end = stroke.end;
    else
      strokes.push_back(stroke);
  }
  return strokes;
}

/// First sample of the last stretch before `moving` in which this effort is away from its level since `standstill`.
std::size_t departure(const std::vector<double>& effort, std::size_t standstill, std::size_t moving,
                      std::size_t longest) {
  if (moving - standstill < 4) return moving;
  const std::vector<double> level_values(effort.begin() + static_cast<std::ptrdiff_t>(standstill),
                                         effort.begin() + static_cast<std::ptrdiff_t>(moving));
  const double level = median(level_values);
  std::vector<double> deviations(level_values.size());
  std::transform(level_values.begin(), level_values.end(), deviations.begin(),
                 [level](double value) { return std::abs(value - level); });
  const auto [least, most] = std::minmax_element(effort.begin(), effort.end());
  const double limit = kDeparture_std * 1.4826 * median(std::move(deviations)) + kDeparture_range * (*most - *least);
  std::size_t first = moving;
  while (first > standstill && moving - first < longest && std::abs(effort[first - 1] - level) > limit) --first;
  return first;
}

std::size_t running(const Motion& motion, const Stroke& stroke, double scale) {
  for (std::size_t i = stroke.begin; i < stroke.end; ++i)
    if (std::abs(motion.velocity_m_s[i]) >= kRunning * scale) return i;
  return stroke.begin;
}

class PhaseList {
 public:
  explicit PhaseList(const Motion& motion) : motion_(motion) {}
  void add(MotionKind kind, std::size_t end) {
    if (end <= begin_) return;
    phases_.push_back({.kind = kind, .begin_s = time_s(begin_), .end_s = time_s(end)});
    begin_ = end;
  }
  [[nodiscard]] std::size_t begin() const { return begin_; }
  [[nodiscard]] std::vector<MotionPhase> take() { return std::move(phases_); }

 private:
  [[nodiscard]] double time_s(std::size_t i) const {
    return motion_.begin_s + motion_.interval_s * static_cast<double>(i);
  }
  const Motion& motion_;
  std::size_t begin_ = 0;
  std::vector<MotionPhase> phases_;
};

}  // namespace

std::vector<MotionPhase> segment_phases(const Motion& motion) {
  if (motion.velocity_m_s.size() < 8) return {};
  const double scale = speed_scale(motion);
  const std::vector<Stroke> strokes = find_strokes(motion, scale);
  if (strokes.empty()) return {};
  const auto longest = static_cast<std::size_t>(kLongestEffort_s / motion.interval_s);
  PhaseList phases(motion);
  MotionKind standstill = MotionKind::rest;
  for (const Stroke& stroke : strokes) {
    if (stroke.direction == strokes.front().direction) {
      std::size_t effort_begin = stroke.begin;
      for (const std::vector<double>& effort : motion.effort)
        effort_begin = std::min(effort_begin, departure(effort, phases.begin(), stroke.begin, longest));
      phases.add(standstill, effort_begin);
      phases.add(MotionKind::breakaway, running(motion, stroke, scale));
      phases.add(MotionKind::out, stroke.end);
    } else {
      phases.add(standstill, stroke.begin);
      phases.add(MotionKind::back, stroke.end);
    }
    standstill = MotionKind::hold;
  }
  phases.add(standstill, motion.velocity_m_s.size());
  return phases.take();
}

}  // namespace sealwatch::signal
