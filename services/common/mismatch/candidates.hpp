// What may be missing: every law of the catalogue at every place of this plant where it could act.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/simulation.hpp"

namespace sealwatch::mismatch {

/// A law at an element, with the points of its shape grid (all parameters of the law, strengths at their usual size).
struct Candidate {
  const Law* law = nullptr;
  std::string element;
  std::vector<std::size_t> sites;  ///< empty for a law of a sensor or of the recording
  std::string channel;             ///< of a sensor's or an input's law
  std::vector<std::vector<double>> grid;
  std::size_t passed_over = 0;  ///< points that residuals were looked at for, and that are not in the grid
  double strength_scale = 1.0;  ///< usual sizes are multiplied by it (a sensor's bias goes by its channel's range)
};

/// Laws with an equation of their own, closed forms (most of them without a name: id `unlisted`), or both.
enum class Laws : std::uint8_t { listed, closed_forms, all };

/// All candidates for a simulation's plant and recorded channels; those in `present` (element and id) are left out.
[[nodiscard]] std::vector<Candidate> find_candidates(const PlantSimulation& simulation,
                                                     const std::vector<PhysicsTerm>& present, Laws which);

/// The same law, or one of them comes to the other at the end of its range (Law::limit).
[[nodiscard]] bool overlap(const Law& a, const Law& b);

/// Whether usual sizes of its strength go by its channel's range.
[[nodiscard]] constexpr bool is_bias(SiteKind kind) {
  return kind == SiteKind::sensor_bias || kind == SiteKind::sensor_drift || kind == SiteKind::input_bias;
}

/// Size of its first strength from which an engineer of this plant would care.
[[nodiscard]] double significant_size(const Candidate& candidate, const PlantDescription& plant);

/// Unit of a law's parameter: that of the channel, for a law of its sensor that says so.
[[nodiscard]] std::string unit_of(const LawParameter& parameter, std::string_view element,
                                  const PlantDescription& plant);

/// Indices of the law's strengths.
[[nodiscard]] std::vector<std::size_t> strengths_of(const Law& law);

}  // namespace sealwatch::mismatch
