// A stuck sensor: it keeps exactly one value where it should not.
//
//   run        samples one after the other with exactly the same value
//   too long   at least `least_samples` and `least_s`; of channels whose steps are unknown, `times_the_next` times as
//              long as any other run, as one that rounds coarsely stays for nearly as long elsewhere
//   should not a noise that shows never repeats for long; else something that the channel follows (a witness) moved
//              meanwhile by more than its least
//   spared     with `spare_ends`, a sensor at the end of its range: the value is its largest or smallest and comes
//              before or after the run too, where noise takes it there
//
// Samples come one by one, so that a service needs to keep none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sealwatch::signal {

struct StuckRule {
  std::uint64_t least_samples = 20;
  double least_s = 0.0;
  double times_the_next = 0.0;
  bool noise_shows = false;  ///< constant alone is enough, except at exactly zero (a meter's low-flow cut-off)
  bool spare_ends = false;
};

struct ConstantRun {
  double value = 0.0, begin_s = 0.0, end_s = 0.0;
  std::uint64_t samples = 0;
};

class StuckWatch {
 public:
  /// `least_moves`: of each witness, in its own unit; one of infinity never speaks.
  StuckWatch(StuckRule rule, std::vector<double> least_moves);
  /// `witnesses` in the order of `least_moves`; NaN: not recorded. A value that is no number ends a run.
  void add(double time_s, double value, std::span<const double> witnesses);
  /// Samples are missing: what was constant before need not have been in between.
  void interrupt();
  /// The longest run in which the channel was stuck.
  [[nodiscard]] std::optional<ConstantRun> stuck() const;

 private:
  struct Lengths {  ///< of the longest run and of the longest beside it, in samples
    std::uint64_t longest = 0, second = 0;
    void add(std::uint64_t samples);
  };
  void note_extremes(double value);
  [[nodiscard]] bool should_have_changed() const;
  [[nodiscard]] bool at_an_end() const;

  StuckRule rule_;
  std::vector<double> least_moves_;
  ConstantRun run_, found_;
  std::vector<double> low_, high_;                  ///< of the witnesses during the run
  Lengths lengths_;                                 ///< of the runs that have ended
  double least_ = 0.0, most_ = 0.0;                 ///< of all values
  std::uint64_t times_least_ = 0, times_most_ = 0;  ///< how often they came
};

}  // namespace sealwatch::signal
