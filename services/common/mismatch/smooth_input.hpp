// The smoothest unknown input that explains a residual: linear between knots, estimated by ridge.
//
//   minimise over w, z   |r - H w - Z z|^2 / phi + lambda |D w|^2 / phi
//
// r [N]: whitened residual. H: its columns for hat functions of time, one a knot. Z: columns of the recording's own
// unknowns z (load, initial states), without prior. D: second differences. lambda maximises the marginal likelihood
// with w ~ N(0, (phi / lambda) (D'D)^-), phi profiled out:
//   -2 ln L = (N - rank Z - 2) ln S + ln|H~'H~ + lambda D'D| - (n - 2) ln lambda,   S = |r~|^2 - g' w,  g = H~'r~
// where ~ is without what Z explains. Covariance of w: max(1, phi) (H~'H~ + lambda D'D)^-1,
// phi = |r~ - H~ w|^2 / (N - rank Z - edf). The band is that of a smooth input: beside a jump w swings, by more than
// it. A constant that Z explains (a force beside a load) has no estimate: then w is that of mean 0. Source: Wahba, J.
// Royal Statistical Society B 40 (1978) 364; Wecker, Ansley, JASA 78 (1983) 81.
#pragma once

#include "sealwatch/model/simulation.hpp"

namespace sealwatch::mismatch {

/// Knots at equal distances.
struct Knots {
  double begin_s = 0.0;
  double spacing_s = 1.0;
  std::size_t count = 0;
  [[nodiscard]] double time_s(std::size_t knot) const { return begin_s + spacing_s * static_cast<double>(knot); }
  /// Hat functions that are not 0 at t: this one with the weight 1 - share, the next with share.
  struct Place {
    std::size_t knot = 0;
    double share = 0.0;
  };
  [[nodiscard]] Place at(double t) const;
};

/// 121 over the recording; fewer where they would be less than four samples apart.
[[nodiscard]] Knots make_knots(const std::vector<double>& time_s);

/// Means of samples of a function, weighed by the hat of each knot and by the time that each sample stands for.
[[nodiscard]] std::vector<double> hat_means(const Knots& knots, const std::vector<double>& time_s,
                                            const std::vector<double>& values);

/// The hats as contributions at sites: the same at all of them.
class HatColumns final : public InjectedColumns {
 public:
  HatColumns(Knots knots, const std::vector<std::size_t>& sites);
  [[nodiscard]] std::size_t columns() const override { return knots_.count; }
  [[nodiscard]] std::span<const Entry> entries() const override { return entries_; }
  void weigh(double t, Signals signals, std::span<double> weights) override;

 private:
  Knots knots_;
  std::size_t sites_;
  std::vector<Entry> entries_;  ///< knot after knot, its sites together
};

struct SmoothInput {
  Eigen::VectorXd value;           ///< w at the knots
  Eigen::VectorXd standard_error;  ///< of it
  double dispersion = 1.0;         ///< phi
  bool level_known = true;         ///< false: w is given up to a constant, as that of mean 0
};

/// An Error when the residual does not depend on the input.
[[nodiscard]] Result<SmoothInput> smooth_input(RowMatrix hats, const RowMatrix& own, Eigen::VectorXd residual);

}  // namespace sealwatch::mismatch
