// One test on a uniform time axis with its smoothed channels and phases: what features are computed from.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/signal/filters.hpp"
#include "sealwatch/signal/phases.hpp"

namespace sealwatch::signal {

/// What is known of the cylinder and the pump; what is not is absent, and so are the features that need it.
struct Cylinder {
  std::optional<double> area_a_m2;  ///< A_A
  double area_ratio = 1.0;          ///< A_B / A_A
  std::optional<double> dead_volume_m3;
  std::optional<double> bulk_modulus_Pa;
  std::optional<double> displacement_m3_rad;
  double stroke_m = 0.0;  ///< whole stroke of the cylinder; 0 when not known
};

/// Index range [begin, end) of the window.
struct Range {
  std::size_t begin = 0;
  std::size_t end = 0;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

class TestRecord {
 public:
  /// `samples` uniform with at least 8 rows, each channel's noise_std set; must outlive the record, as must the
  /// plant, which says what its channels are. Smooths every channel without phase and finds the phases.
  TestRecord(const TimeSeries& samples, Cylinder cylinder, const PlantDescription& plant);

  [[nodiscard]] const TimeSeries& samples() const { return samples_; }
  [[nodiscard]] const Cylinder& cylinder() const { return cylinder_; }
  [[nodiscard]] double interval_s() const { return interval_s_; }
  [[nodiscard]] const std::vector<MotionPhase>& phases() const { return phases_; }
  /// What was filtered and with which phase, in words.
  [[nodiscard]] const std::string& filter_description() const { return filter_description_; }

  /// Channel as recorded; nullptr when it is not.
  [[nodiscard]] const std::vector<double>* raw(ChannelRole channel) const;
  /// Zero-phase low-passed channel; nullptr when it is not recorded.
  [[nodiscard]] const std::vector<double>* smooth(ChannelRole channel) const;
  /// Standard deviation of the noise left in the smoothed channel.
  [[nodiscard]] double smooth_noise_std(ChannelRole channel) const;

  /// The channel that drives the actuator, where it is recorded.
  [[nodiscard]] const Series* drive() const { return find_series(samples_, *plant_, ChannelRole::drive); }

  /// Position [m], as recorded or, up to its start, as the integral of velocity; empty when neither is there.
  [[nodiscard]] const std::vector<double>& position() const { return position_; }
  [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }
  /// Load pressure p_L = p_A - r p_B, or the differential pressure; empty when neither is there.
  [[nodiscard]] const std::vector<double>& load_pressure() const { return load_pressure_; }
  [[nodiscard]] const std::vector<double>& smooth_load_pressure() const { return smooth_load_pressure_; }

  [[nodiscard]] Range range(const MotionPhase& phase) const;
  /// The middle of a stroke, where the piston runs steadily: from the first to the last sample above 95 % of the
  /// stroke's median speed, less 0.3 s (at most a fifth) at either end for filters and sensor lags. Absent when shorter
  /// than 0.3 s.
  [[nodiscard]] std::optional<Range> middle(const MotionPhase& stroke) const;
  /// A standstill less 0.5 s after the stroke before it and 0.2 s before the next. Absent when shorter than 0.3 s.
  [[nodiscard]] std::optional<Range> settled(const MotionPhase& standstill) const;

 private:
  void smooth_channels();
  void find_motion();
  void find_load_pressure();
  [[nodiscard]] Motion motion() const;

  const TimeSeries& samples_;
  Cylinder cylinder_;
  const PlantDescription* plant_;
  double interval_s_ = 0.0;
  LowPass filter_;
  std::string filter_description_;
  std::map<std::string, std::vector<double>, std::less<>> smooth_;
  std::vector<double> position_, velocity_, load_pressure_, smooth_load_pressure_;
  double velocity_noise_std_ = 0.0;
  std::vector<MotionPhase> phases_;
};

}  // namespace sealwatch::signal
