// The laws of an asset's `physics` at work in a simulation.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/model/simulation.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

/// How many laws with a hidden state a simulation can carry.
inline constexpr int kMaximumHiddenStates = 2;
/// Allowed local error of a hidden state, at the relative tolerance 1e-6, as a share of its usual size.
inline constexpr double kHiddenShare = 1e-5;

/// A law that adds to balances of the plant.
struct ActiveTerm {
  const Law* law = nullptr;
  std::vector<std::size_t> sites;   ///< of the plant
  std::size_t first_parameter = 0;  ///< in ModelValues::parameters
  int hidden = -1;                  ///< its place among the hidden states; -1: none
  Roundings roundings{};            ///< of the law in this plant
};

/// A law of a sensor.
struct SensorTerm {
  SiteKind kind = SiteKind::sensor_bias;
  std::string channel;
  std::size_t parameter = 0;  ///< the law's first, in ModelValues::parameters
};

/// A law of the recording: of an input, of the clock, or of the sensor of a channel that drives the simulation.
struct RecordingTerm {
  SiteKind kind = SiteKind::input_gain;
  std::string input;          ///< channel; "" of the clock
  std::size_t parameter = 0;  ///< in ModelValues::parameters
};

struct PhysicsTerms {
  std::vector<ActiveTerm> active;
  std::vector<SensorTerm> sensors;
  std::vector<RecordingTerm> recording;
  std::vector<PhysicsParameter> parameters;  ///< in the order of ModelValues::parameters behind the plant's
  std::vector<std::string> hidden_names;
  std::vector<double> hidden_scales;
};

/// Finds laws and sites; an Error naming what does not fit the plant.
[[nodiscard]] Result<PhysicsTerms> resolve_physics(const PlantDescription& plant, std::span<const Site> sites,
                                                   const AssetConfig& asset);

/// f(inputs) chained to what its inputs depend on: value and derivatives.
inline void add_scaled(double&, double, double) {}
template <int N>
void add_scaled(Dual<N>&, double, double) {}
template <int N>
void add_scaled(Dual<N>& result, double factor, const Dual<N>& x) {
  for (int k = 0; k < N; ++k)
    result.derivative[static_cast<std::size_t>(k)] += factor * x.derivative[static_cast<std::size_t>(k)];
}

template <class R, class H, class P>
[[nodiscard]] R chain(const LawScalar& f, const std::array<R, kSiteSignals>& signals, const H& hidden,
                      const P* parameter, std::size_t parameters) {
  R result(f.value);
  for (std::size_t k = 0; k < kSiteSignals; ++k) add_scaled(result, f.derivative[k], signals[k]);
  add_scaled(result, f.derivative[kSiteSignals], hidden);
  for (std::size_t k = 0; k < parameters; ++k) add_scaled(result, f.derivative[kSiteSignals + 1 + k], parameter[k]);
  return result;
}

}  // namespace sealwatch
