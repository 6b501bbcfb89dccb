// Phases of a partial stroke test, from the piston's motion.
//
//   rest -> breakaway -> out -> hold -> back -> hold   (a bench may repeat it: breakaway -> out -> hold -> back ->
//   hold)
//
// "out" is the direction of the first stroke, whichever sign it has. The piston runs while its speed exceeds 10 % of
// the stroke's speed (95th percentile of |v|); it leaves that state below 5 %. Breakaway begins when the load pressure
// or the drive departs from its level at standstill (else with the first motion) and ends at half the stroke's speed.
// Every standstill after a stroke is a hold. Phases follow one another without gaps.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace sealwatch::signal {

enum class MotionKind { rest, breakaway, out, hold, back };

struct MotionPhase {
  MotionKind kind = MotionKind::rest;
  double begin_s = 0.0;
  double end_s = 0.0;  ///< [begin_s, end_s)
  [[nodiscard]] double duration_s() const { return end_s - begin_s; }
};

/// Smooth (zero-phase filtered) motion on a uniform time axis.
struct Motion {
  double begin_s = 0.0;     ///< time of the first sample
  double interval_s = 0.0;  ///< between samples
  std::vector<double> velocity_m_s;
  /// Signals that depart from their standstill level before the piston breaks away: load pressure, drive voltage.
  std::vector<std::vector<double>> effort;
  /// Slowest motion that counts as motion: several standard deviations of the smoothed velocity's noise.
  double least_speed_m_s = 0.0;
  /// Shorter strokes are not strokes but noise.
  double least_travel_m = 0.0;
};

/// Empty when the piston did not move: then the whole test is rest and nobody can tell more.
[[nodiscard]] std::vector<MotionPhase> segment_phases(const Motion& motion);

}  // namespace sealwatch::signal
