#include "services/common/mismatch/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>

#include "services/common/estimation/rows_of.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/windows.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kLong = 10.0;          // correlation times, so that each half has some five of its own
constexpr std::size_t kSamples = 4000;  // that are enough for an autocorrelation

double correlation_time(std::vector<double> values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  const double square = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  if (!(square > 0.0)) return 0.0;
  double samples = 1.0;
  for (std::size_t lag = 1; lag < values.size() / 2; ++lag) {
    const auto later = values.begin() + static_cast<std::ptrdiff_t>(lag);
    const double rho = std::inner_product(later, values.end(), values.begin(), 0.0) / square;
    if (rho <= 0.0) break;
    samples += 2.0 * rho;
  }
  return samples;
}

Recording piece_of(const Recording& whole, std::size_t begin, std::size_t end) {
  Recording piece = whole;
  piece.samples = rows_of(whole.samples, begin, end);
  const std::string when =
      ", " + number(piece.samples.time_s.front(), 4) + " to " + number(piece.samples.time_s.back(), 4) + " s";
  piece.recording_id = (whole.recording_id.empty() ? whole.file : whole.recording_id) + when;
  piece.file += when;
  piece.content_hash += when;
  if (!piece.start_time) piece.start_time = UtcTime{};  // both halves are of one time, whenever that was
  return piece;
}

}  // namespace

double correlation_time_s(const TimeSeries& samples, std::span<const std::string> outputs) {
  const std::size_t step = samples.time_s.size() / kSamples + 1;
  const double spacing_s = static_cast<double>(step) * (samples.time_s.back() - samples.time_s.front()) /
                           static_cast<double>(std::max<std::size_t>(samples.time_s.size() - 1, 1));
  double longest = 0.0;
  for (const std::string& name : outputs) {
    const Series* channel = samples.find(name);
    if (channel == nullptr) continue;
    std::vector<double> thinned;
    for (std::size_t k = 0; k < channel->values.size(); k += step) thinned.push_back(channel->values[k]);
    longest = std::max(longest, spacing_s * correlation_time(std::move(thinned)));
  }
  return longest;
}

std::vector<Recording> in_halves(const Recording& recording, std::span<const std::string> outputs) {
  const std::vector<double>& time_s = recording.samples.time_s;
  const double length_s = time_s.back() - time_s.front(), tau_s = correlation_time_s(recording.samples, outputs);
  if (!(tau_s > 0.0) || length_s < kLong * tau_s) return {};
  const double half_s = 0.5 * (length_s - tau_s);
  const auto end = std::ranges::upper_bound(time_s, time_s.front() + half_s) - time_s.begin();
  const auto begin = std::ranges::lower_bound(time_s, time_s.back() - half_s) - time_s.begin();
  return {piece_of(recording, 0, static_cast<std::size_t>(end)),
          piece_of(recording, static_cast<std::size_t>(begin), time_s.size())};
}

std::vector<Recording> thinned(std::span<const Recording> recordings, std::vector<std::string>& notes) {
  std::vector<Recording> result(recordings.begin(), recordings.end());
  for (Recording& recording : result) {
    const std::size_t rows = recording.samples.time_s.size(), numbers = rows * (1 + recording.samples.channels.size()),
                      step = (numbers + kMostNumbersAnalysed - 1) / kMostNumbersAnalysed;
    if (step <= 1) continue;
    recording.samples = rows_of(recording.samples, 0, rows, step);
    notes.push_back(recording.file + ": one row in " + std::to_string(step) + " was analysed, as its " +
                    std::to_string(numbers) + " numbers are more than " + std::to_string(kMostNumbersAnalysed) + ".");
  }
  return result;
}

}  // namespace sealwatch::mismatch
