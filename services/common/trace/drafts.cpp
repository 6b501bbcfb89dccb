#include "services/common/trace/drafts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::VectorXd;

AlteredChannel altered(const Pair& pair, const Freedom& freedom, bool about_start, bool smooth) {
  const bool without_noise = smooth && pair.smooth;
  return {.recorded = without_noise ? pair.recorded - pair.noise : pair.recorded,
          .simulated = without_noise ? &*pair.smooth : &pair.course,
          .about = about_start ? pair.simulated(0) : 0.0,
          .least_variance = pair.least_variance + open_variance(pair, freedom, smooth).mean()};
}

std::optional<Draft> fit_courses(const CommonTimes& times, const std::vector<const Pair*>& pairs,
                                 const Freedom& freedom, bool about_start, bool smooth) {
  std::vector<AlteredChannel> channels;
  for (const Pair* pair : pairs) channels.push_back(altered(*pair, freedom, about_start, smooth));
  std::optional<AlterationFit> fit = fit_alteration(times.time_s, channels, freedom, times.joints);
  if (!fit) return {};
  if (smooth)
    for (std::size_t k = 0; k < pairs.size(); ++k) fit->altered[k] += pairs[k]->noise;
  return Draft{.told = {}, .pairs = pairs, .fit = std::move(*fit), .freedom = freedom, .smooth = smooth};
}

/// Whether channel `k` of the recording carries the simulation's noise.
bool carries_noise(const Draft& draft, std::size_t k) {
  constexpr double kLess = 0.5;  // of the variance; the course between two samples has at least 0.64 of the noise's
  const Pair& pair = *draft.pairs[k];
  const VectorXd left = (pair.recorded - draft.fit.altered[k]).segment(draft.fit.first, draft.fit.count);
  const double own = pair.noise.squaredNorm() / static_cast<double>(pair.noise.size());
  return std::pow(signal::estimate_noise_floor(span_of(left)).standard_deviation, 2) < kLess * own;
}

std::optional<Draft> fitted(const CommonTimes& times, const std::vector<const Pair*>& pairs, const Freedom& freedom,
                            bool about_start) {
  std::optional<Draft> written = fit_courses(times, pairs, freedom, about_start, false);
  bool as_written = true;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (pairs[k]->smooth) as_written = as_written && written && carries_noise(*written, k);
  return as_written ? std::move(written) : fit_courses(times, pairs, freedom, about_start, true);
}

std::vector<AlteredParameter> parameters_of(const AlterationFit& fit, const Freedom& freedom, const std::string& unit) {
  std::vector<AlteredParameter> out;
  if (freedom.gain) out.push_back({"gain", fit.gain, fit.gain_std, "1"});
  if (!freedom.gain && freedom.fixed_gain < 0.0) out.push_back({"gain", freedom.fixed_gain, 0.0, "1"});
  if (freedom.offset) out.push_back({"offset", fit.offset, fit.offset_std, unit});
  if (freedom.delay) out.push_back({"delay", fit.delay_s, fit.delay_std_s, "s"});
  if (freedom.clock) out.push_back({"clock rate", fit.clock, fit.clock_std, "1"});
  return out;
}

}  // namespace

VectorXd open_variance(const Pair& pair, const Freedom& freedom, bool smooth) {
  if (!freedom.delay && !freedom.clock) return pair.between;
  const Course& course = smooth && pair.smooth ? *pair.smooth : pair.course;
  return VectorXd::Constant(pair.between.size(), course.mean_variance());
}

bool follows_nothing(const AlterationFit& fit, const Freedom& freedom) {
  return freedom.gain && std::abs(fit.gain) <= kShifted * fit.gain_std;
}

std::optional<Draft> draft_of(const CommonTimes& times, const std::vector<const Pair*>& pairs, const Freedom& freedom,
                              bool about_start) {
  std::optional<Draft> draft = fitted(times, pairs, freedom, about_start);
  if (!draft || follows_nothing(draft->fit, freedom)) return {};
  const AlterationFit& fit = draft->fit;
  Alteration& told = draft->told;
  told.parameters = parameters_of(fit, freedom, pairs.front()->unit);
  told.criterion = fit.criterion;
  double before = 0.0, after = 0.0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Pair& pair = *pairs[k];
    const auto beyond_noise = [&pair](const VectorXd& left) {
      return std::max(left.squaredNorm() / static_cast<double>(left.size()) / pair.noise_variance - 1.0, 0.0);
    };
    before += beyond_noise(pair.recorded - pair.simulated);
    after += beyond_noise((pair.recorded - fit.altered[k]).segment(fit.first, fit.count));
  }
  told.removed_share = before > 0.0 ? std::clamp(1.0 - after / before, 0.0, 1.0) : 0.0;
  return draft;
}

double unaltered_criterion(const CommonTimes& times, const std::vector<const Pair*>& pairs) {
  const std::optional<Draft> as_it_is = draft_of(times, pairs, {});
  return as_it_is ? as_it_is->told.criterion : std::numeric_limits<double>::infinity();
}

}  // namespace sealwatch::trace
