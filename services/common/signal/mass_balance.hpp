// Mass balance of chamber A over a stretch of time T (docs/model.md, chamber_a):
//
//   q_leak = mean(q) - A_A (x(T) - x(0)) / T - (V_A / beta) (p_A(T) - p_A(0)) / T,   V_A = V_0 + A_A mean(x)
//
// Differences of smoothed ends give the mean rates exactly, whatever the course in between. With the differential
// pressure alone, half of its change is taken for p_A (both chambers share it); without pressures nothing is.
#pragma once

#include <optional>
#include <vector>

#include "sealwatch/signal/statistics.hpp"
#include "sealwatch/signal/test_record.hpp"

namespace sealwatch::signal {

class MassBalance {
 public:
  explicit MassBalance(const TestRecord& test) : test_(test) {}
  /// Flow, motion and the piston's area are known.
  [[nodiscard]] bool possible() const;
  /// Leakage flow, ranges weighted by their precision [m3/s]; absent for no ranges.
  [[nodiscard]] std::optional<Estimate> leakage(const std::vector<Range>& ranges) const;
  /// (p_A - p_B) / q_leak over the ranges [Pa s/m3]; absent when the flow is not clearly (three standard errors) there.
  [[nodiscard]] std::optional<Estimate> resistance(const std::vector<Range>& ranges) const;

 private:
  [[nodiscard]] Estimate leakage(Range range) const;
  [[nodiscard]] Estimate rate(const std::vector<double>& smooth, double noise_std, Range range) const;
  [[nodiscard]] Estimate compression(Range range) const;
  [[nodiscard]] std::vector<double> differential_pressure() const;

  const TestRecord& test_;
};

}  // namespace sealwatch::signal
