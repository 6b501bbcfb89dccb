#include "services/state_detection/phase_means.hpp"

#include <algorithm>
#include <numeric>

namespace sealwatch {
namespace {

constexpr double kLeftOutAtBegin = 0.3;  // share of a phase; six time constants of the flow sensor in a 3 s hold
constexpr double kLeftOutAtEnd = 0.1;
constexpr std::size_t kFewestSamples = 5;

bool is_hold(const Phase& phase) { return phase.kind == PhaseKind::hold; }
bool is_motion(const Phase& phase) { return phase.kind == PhaseKind::out || phase.kind == PhaseKind::back; }

}  // namespace

PhaseMeans::PhaseMeans(const TestWindow& window, const PlantDescription& plant) : window_(window), plant_(plant) {}

const Series* PhaseMeans::usable(ChannelRole channel) const {
  const Series* series = find_series(window_.samples, plant_, channel);
  if (series == nullptr) return nullptr;
  for (const ChannelStatus& status : window_.channel_status)
    if (status.channel == series->name && status.state != ChannelState::OK) return nullptr;
  return series;
}

std::vector<PhaseMeans::Span> PhaseMeans::spans(Motion motion) const {
  const std::vector<double>& time = window_.samples.time_s;
  std::vector<Span> result;
  for (const Phase& phase : window_.phases) {
    if (motion == Motion::holding ? !is_hold(phase) : !is_motion(phase)) continue;
    const double length = phase.end_s - phase.begin_s;
    const auto index = [&](double t) {
      return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
    };
    const Span span{index(phase.begin_s + kLeftOutAtBegin * length), index(phase.end_s - kLeftOutAtEnd * length)};
    if (span.last < span.first + kFewestSamples) continue;
    if (motion != Motion::holding && extends(span) != (motion == Motion::extending)) continue;
    result.push_back(span);
  }
  return result;
}

std::optional<bool> PhaseMeans::extends(const Span& span) const {
  if (const Series* position = usable(ChannelRole::stroke))
    return position->values[span.last - 1] > position->values[span.first];
  if (const Series* velocity = usable(ChannelRole::speed)) {
    const auto begin = velocity->values.begin();
    return std::accumulate(begin + static_cast<std::ptrdiff_t>(span.first),
                           begin + static_cast<std::ptrdiff_t>(span.last), 0.0) > 0.0;
  }
  return std::nullopt;
}

std::optional<double> PhaseMeans::mean(ChannelRole channel, Motion motion) const {
  const Series* series = usable(channel);
  if (series == nullptr) return std::nullopt;
  double sum = 0.0;
  std::size_t count = 0;
  for (const Span& span : spans(motion)) {
    for (std::size_t k = span.first; k < span.last; ++k) sum += series->values[k];
    count += span.last - span.first;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

std::optional<double> PhaseMeans::speed_from_position(Motion motion) const {
  const Series* position = usable(ChannelRole::stroke);
  if (position == nullptr) return std::nullopt;
  double way = 0.0;
  double time = 0.0;
  for (const Span& span : spans(motion)) {
    way += position->values[span.last - 1] - position->values[span.first];
    time += window_.samples.time_s[span.last - 1] - window_.samples.time_s[span.first];
  }
  if (!(time > 0.0)) return std::nullopt;
  return way / time;
}

std::optional<double> PhaseMeans::speed(Motion motion) const {
  return usable(ChannelRole::stroke) != nullptr ? speed_from_position(motion) : mean(ChannelRole::speed, motion);
}

std::optional<double> PhaseMeans::pressure_difference(Motion motion) const {
  const auto a = mean(ChannelRole::pressure_up, motion);
  const auto b = mean(ChannelRole::pressure_down, motion);
  if (a && b) return *a - *b;
  return mean(ChannelRole::pressure_difference, motion);
}

}  // namespace sealwatch
