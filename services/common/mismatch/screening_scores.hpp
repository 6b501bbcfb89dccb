// From the projected columns of a screening to what is said of each variant: score, p value, gain, smallest size that
// would show. Equations: screening.hpp.
#pragma once

#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// Fills in every variant. `raw_norm`: |s_j|^2 before anything was taken off; `grams`: s~_b' s~_b of each variant per
/// block, entries one after the other; `residuals`: how many there are.
void evaluate(Screening& screening, const Eigen::VectorXd& raw_norm, const Eigen::MatrixXd& grams, double residuals,
              const Resolution& resolution);

/// Smallest p value of all variants when g is nothing but noise, N(0, G); how many independent tests it stands for.
void calibrate(Screening& screening, const ScreeningOptions& options);

/// How far a law of the smallest detectable size would move the estimate of the seal's leakage resistance, relative.
/// `gram`, `cross`: of the shared unknowns, and of these with the laws.
void find_leakage_shifts(Screening& screening, const FittedModel& model, const Eigen::MatrixXd& gram,
                         const Eigen::MatrixXd& cross);

}  // namespace sealwatch::mismatch
