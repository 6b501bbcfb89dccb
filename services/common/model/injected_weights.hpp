// What an absent law would add at each site, for a strength of one unit: known at the ends of steps, asked for within
// them. An output such as the flow through a stiff valve is the small difference of large changes, of the states and of
// what the law adds. Between the ends of steps both have to follow the same kind of course, or their difference is
// rounding.
//
//   w(t) = sum_j w(t_j) prod_(i != j) (t - t_i) / (t_j - t_i)      t_j: ends of the last steps, as the states are
//                                                                  interpolated (backward_differences.hpp)
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

class InjectedWeights {
 public:
  /// `columns` stays; null: there are none.
  explicit InjectedWeights(InjectedColumns* columns);

  /// At the end of a step, from the signals of all sites. The same time may come twice.
  std::span<const double> weigh(double t, InjectedColumns::Signals signals);
  /// At a time within the last step. Zero before the first.
  [[nodiscard]] std::span<const double> at(double t);
  /// What follows begins anew: the input has jumped.
  void forget() { known_ = 0; }

 private:
  struct Node {
    double time = 0.0;
    std::vector<double> weights;
  };
  static constexpr std::size_t kNodes = 4;  ///< a cubic: of higher order few steps are

  InjectedColumns* columns_;
  std::array<Node, kNodes> nodes_;  ///< the newest first
  std::size_t known_ = 0;
  std::vector<double> between_;
};

}  // namespace sealwatch
