// Order analysis: at how many periods in a turn of a shaft the residuals have a line.
//
//   theta(t) = integral of omega dt     angle of the shaft along the simulation [rad]
//   E_N = sum over channels c and blocks b of 1 s of |projection of r_cb on cos(N theta), sin(N theta)|^2
//
// r: whitened residuals. The mean and the slope of each block are taken off first: a slow course is no line. Blocks count
// by their energy, as the plant's answer has another phase at another speed (Fyfe, Munck, Mech. Syst. Signal Process.
// 11 (1997) 187).
#pragma once

#include <vector>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Laws with a whole number of periods in a turn set out from the numbers with the strongest lines in place of usual
/// ones, as many as there were; the others count as passed over (Candidate). Unchanged where no recording can be
/// simulated.
void set_out_from_strongest_orders(std::vector<Candidate>& candidates, const FittedModel& model, int threads);

}  // namespace sealwatch::mismatch
