// How late one channel is against another that has the same shape.
//
//   y(t) = b + g r(t - d) + e(t)      y channel, r reference, d offset [s] (positive: y is late), g gain of any sign
//
// A search over whole samples for the largest |correlation| is refined by Gauss-Newton steps on (b, g, d). The
// standard error of d is that of least squares with the autocorrelation of e counted (statistics.hpp).
#pragma once

#include <optional>
#include <span>

namespace sealwatch::signal {

struct OffsetEstimate {
  double offset_s = 0.0;
  double offset_std_s = 0.0;
  double gain = 0.0;         ///< g; negative: the signs differ
  double correlation = 0.0;  ///< of y and r(t - d), -1..1
};

/// Nothing when one of the signals does not vary, or when the best offset lies at the edge of the search.
[[nodiscard]] std::optional<OffsetEstimate> estimate_offset(std::span<const double> reference,
                                                            std::span<const double> channel, double interval_s,
                                                            double largest_offset_s);

}  // namespace sealwatch::signal
