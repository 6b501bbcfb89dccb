// Where a signal jumps from one sample to the next: a change that is far from its neighbours' mean, by how they scatter
// about it. With d_k = y_k - y_k-1 and m the mean of the three changes on either side,
//
//   |d_k - m| > 8 max_j |d_j - m|
//
// A slope, a corner and a wave of several samples a period are no jump, nor is an outlier, whose next change is as large;
// of two jumps within three samples neither is told.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sealwatch::signal {

/// The first samples behind each jump that is larger than `least`, in the signal's unit; rising.
[[nodiscard]] std::vector<std::size_t> find_jumps(std::span<const double> values, double least = 0.0);

}  // namespace sealwatch::signal
