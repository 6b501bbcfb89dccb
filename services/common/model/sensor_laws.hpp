// Laws of one sensor, applied to its simulated signal s (after the low-pass that the asset gives the sensor):
//
//   lag    tau dr/dt = s - r        d r/d tau = q,  tau dq/dt = -(s - r)/tau - q
//   gain   z = (1 + g) r + b        d z/d g = r,    d z/d b = 1
//   drift  z += D w, w = 1 - exp(-t / T)            d z/d D = w,    d z/d T = -D t exp(-t / T) / T^2
//          (t from the first sample)
//   end    y = z - k max(z - y_max, 0)   d y/d z = 1 - k, d y/d k = -(z - y_max), d y/d y_max = k beyond y_max
//          (as sharp as the end of a converter's range; a search over y_max needs samples on both sides)
//
// All columns of sensitivities pass through the same linear operations.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/model/physics_terms.hpp"
#include "services/common/model/sensor_filter.hpp"

namespace sealwatch {

class SensorLaws {
 public:
  SensorLaws(const std::vector<SensorTerm>& terms, const std::string& channel, const ModelValues& values,
             std::span<const FreeQuantity> free, std::size_t columns)
      : output_(columns, 0.0) {
    for (const SensorTerm& term : terms) {
      if (term.channel != channel) continue;
      const Part part = part_of(term.parameter, values, free);
      if (term.kind == SiteKind::sensor_bias) bias_ = part;
      if (term.kind == SiteKind::sensor_gain) gain_ = part;
      if (term.kind == SiteKind::sensor_lag) lag_ = part;
      if (term.kind == SiteKind::sensor_drift) {
        drift_ = part;
        drift_time_ = part_of(term.parameter + 1, values, free);
      }
      if (term.kind == SiteKind::sensor_saturation) {
        saturation_ = part;
        end_ = part_of(term.parameter + 1, values, free);
      }
    }
    if (lag_.value > 0.0) {
      filters_.emplace_back(lag_.value, columns);
      filters_.emplace_back(lag_.value, 1);
    }
  }

  void advance(double step_s, const std::vector<double>& signal) {
    output_ = signal;
    if (!filters_.empty()) {
      filters_[0].advance(step_s, signal.data());
      output_ = filters_[0].output();
      const double slope = -(signal[0] - output_[0]) / lag_.value;
      filters_[1].advance(step_s, &slope);
      if (lag_.column != 0) output_[lag_.column] += filters_[1].output()[0];
    }
    const double before = output_[0];
    for (double& value : output_) value *= 1.0 + gain_.value;
    output_[0] += bias_.value;
    if (gain_.column != 0) output_[gain_.column] += before;
    if (bias_.column != 0) output_[bias_.column] += 1.0;
    drift(step_s);
    saturate();
  }

  [[nodiscard]] const std::vector<double>& output() const { return output_; }

 private:
  struct Part {
    double value = 0.0;
    std::size_t column = 0;  ///< of the sensitivities; 0: not free
  };

  static Part part_of(std::size_t parameter, const ModelValues& values, std::span<const FreeQuantity> free) {
    Part part{.value = values.parameters[parameter]};
    for (std::size_t k = 0; k < free.size(); ++k)
      if (free[k].kind == FreeQuantity::Kind::parameter && free[k].index == parameter) part.column = 1 + k;
    return part;
  }

  void drift(double step_s) {
    if (drift_.value == 0.0 && drift_.column == 0) return;
    age_s_ += step_s;
    const double T = drift_time_.value, left = std::exp(-age_s_ / T);
    output_[0] += drift_.value * (1.0 - left);
    if (drift_.column != 0) output_[drift_.column] += 1.0 - left;
    if (drift_time_.column != 0) output_[drift_time_.column] -= drift_.value * age_s_ * left / (T * T);
  }

  void saturate() {
    const bool absent = saturation_.value == 0.0 && saturation_.column == 0;
    const double beyond = output_[0] - end_.value;
    if (absent || beyond <= 0.0) return;
    for (double& value : output_) value *= 1.0 - saturation_.value;
    output_[0] += saturation_.value * end_.value;
    if (saturation_.column != 0) output_[saturation_.column] -= beyond;
    if (end_.column != 0) output_[end_.column] += saturation_.value;
  }

  Part bias_, gain_, lag_, drift_, drift_time_, saturation_, end_;
  double age_s_ = 0.0;  ///< since the first sample
  std::vector<SensorFilter> filters_;
  std::vector<double> output_;
};

}  // namespace sealwatch
