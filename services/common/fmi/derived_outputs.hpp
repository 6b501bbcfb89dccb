// Variables that a unit computes from the derivative of a state, as an accelerometer's from that of a velocity. What a
// law adds to the derivative behind the unit does not reach them:
//
//   dw/dk = c d(dx/dt)/dk       for every state, input and parameter k that moves dx/dt, with one c at all points
//
// What moves w alone, such as a sensor's own parameter, says nothing. One k alone proves nothing: a velocity moves as
// the derivative of its way does and is not computed from it. A parameter may change c: a net force is the mass times
// the derivative, and does not move with the mass.
#pragma once

#include <span>
#include <vector>

#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

struct DerivedOutput {
  std::size_t variable = 0, state = 0;  ///< places in FmuBlock::variables, FmuBlock::states
  double factor = 1.0;                  ///< c, in SI
  bool scaled = false;                  ///< parameters change c: it may be one force of one part, too
};

/// Of these variables and states those that belong together; an Error where the unit does not even start.
[[nodiscard]] Result<std::vector<DerivedOutput>> outputs_of_derivatives(const FmuBlock& block,
                                                                        std::span<const std::size_t> variables,
                                                                        std::span<const std::size_t> states);

}  // namespace sealwatch::fmi
