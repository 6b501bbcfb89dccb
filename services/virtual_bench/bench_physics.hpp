// The laws of an asset's `physics` at work on the bench: the same balances and laws as everywhere (model/physics.hpp),
// in plain numbers, within the bench's own integration and sensors.
//
//   dh/dt = rate(signals, h, parameters)      h: hidden state of a law, 0 at the start of a recording, or, for a law
//                                             that comes to rest at once (Law::hidden, settled), at its equilibrium
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::bench {

/// What a sensor does beside its low-pass, in this order:  lag, (1 + gain) y + bias, and of what is beyond `end` the
/// share `cut` is lost.
struct SensorError {
  double lag_s = 0.0;
  double gain = 0.0;
  double bias = 0.0;   ///< channel's unit
  double drift = 0.0;  ///< channel's unit: where the zero goes to, in about drift_time_s
  double drift_time_s = 1.0;
  double cut = 0.0, end = 0.0;
};

/// How a recording errs of what acted on the actuator:  u(t) = (1 + gain) u_recorded(t - delay + r t) + bias with r the
/// input_clock_rate, and a clock that is fast by clock_rate.
struct RecordError {
  double gain = 0.0;
  double bias = 0.0;  ///< channel's unit
  double delay_s = 0.0;
  double input_clock_rate = 0.0;
  double clock_rate = 0.0;
};

class BenchPhysics {
 public:
  using Added = std::array<double, Eha::kSites.size()>;

  BenchPhysics() = default;
  /// An Error naming the law that plant `eha` has no place for.
  [[nodiscard]] static Result<BenchPhysics> create(const AssetConfig& asset, const PlantDescription& plant);

  [[nodiscard]] bool any() const { return !terms_.empty(); }
  [[nodiscard]] bool sees_command_rate() const;
  [[nodiscard]] const std::vector<double>& hidden_scales() const { return scales_; }
  /// Whether hidden state k is at rest when a recording starts; the others then are 0.
  [[nodiscard]] bool settled(std::size_t k) const { return settled_[k]; }

  /// What the laws add at each site; `rates`, where not null, takes d hidden / dt.
  [[nodiscard]] Added added(const Eha::State<double>& y, const Eha::Input& input, const EhaParameters<double>& p,
                            const double* hidden, double* rates) const;
  [[nodiscard]] SensorError error_of(const std::string& channel) const;
  /// Of a channel that is recorded as an input, and of the clock.
  [[nodiscard]] RecordError record_error_of(const std::string& channel) const;

 private:
  struct Term {
    const Law* law = nullptr;
    std::vector<std::size_t> sites;
    std::vector<double> parameters;
    int hidden = -1;
    Roundings roundings{};
  };
  struct SensorTerm {
    std::string channel;
    SiteKind kind;
    std::vector<double> parameters;
  };
  [[nodiscard]] static LawOutput evaluate(const Term& term, std::size_t site, const Eha::State<double>& y,
                                          const Eha::Input& input, const EhaParameters<double>& p, const double* hidden,
                                          const Added& added);

  std::vector<Term> terms_;
  std::vector<SensorTerm> sensors_, recording_;  ///< the clock's channel is ""
  std::vector<double> scales_;
  std::vector<bool> settled_;
};

}  // namespace sealwatch::bench
