#include "sealwatch/signal/stuck.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::signal {

StuckWatch::StuckWatch(StuckRule rule, std::vector<double> least_moves)
    : rule_(rule), least_moves_(std::move(least_moves)), low_(least_moves_), high_(least_moves_) {}

void StuckWatch::add(double time_s, double value, std::span<const double> witnesses) {
  if (!std::isfinite(value)) return interrupt();
  if (run_.samples == 0 || value != run_.value) {
    interrupt();
    run_ = {.value = value, .begin_s = time_s, .end_s = time_s, .samples = 0};
    low_.assign(witnesses.begin(), witnesses.end());
    high_ = low_;
  }
  run_.end_s = time_s;
  ++run_.samples;
  for (std::size_t k = 0; k < least_moves_.size(); ++k) {
    low_[k] = std::fmin(low_[k], witnesses[k]);  // fmin and fmax pass over NaN
    high_[k] = std::fmax(high_[k], witnesses[k]);
  }
  note_extremes(value);
  const bool long_enough = run_.samples >= rule_.least_samples && run_.end_s - run_.begin_s >= rule_.least_s;
  if (long_enough && run_.samples > found_.samples && should_have_changed()) found_ = run_;
}

void StuckWatch::interrupt() {
  lengths_.add(run_.samples);
  run_.samples = 0;
}

void StuckWatch::Lengths::add(std::uint64_t samples) {
  second = std::max(second, std::min(samples, longest));
  longest = std::max(longest, samples);
}

void StuckWatch::note_extremes(double value) {
  const bool first = times_least_ == 0;
  if (first || value < least_) least_ = value, times_least_ = 0;
  if (first || value > most_) most_ = value, times_most_ = 0;
  if (value == least_) ++times_least_;
  if (value == most_) ++times_most_;
}

bool StuckWatch::should_have_changed() const {
  if (rule_.noise_shows && run_.value != 0.0) return true;
  for (std::size_t k = 0; k < least_moves_.size(); ++k)
    if (high_[k] - low_[k] > least_moves_[k]) return true;  // false for NaN
  return false;
}

bool StuckWatch::at_an_end() const {
  return (found_.value == least_ && times_least_ > found_.samples) ||
         (found_.value == most_ && times_most_ > found_.samples);
}

std::optional<ConstantRun> StuckWatch::stuck() const {
  if (found_.samples == 0 || (rule_.spare_ends && at_an_end())) return std::nullopt;
  Lengths all = lengths_;
  all.add(run_.samples);
  const std::uint64_t next = found_.samples < all.longest ? all.longest : all.second;
  if (static_cast<double>(found_.samples) < rule_.times_the_next * static_cast<double>(next)) return std::nullopt;
  return found_;
}

}  // namespace sealwatch::signal
