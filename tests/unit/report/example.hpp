// An explanation made by hand, with every part filled: Stribeck friction at the piston of a nominal actuator, seen in
// partial stroke tests that are drawn from simple shapes, not simulated.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

[[nodiscard]] mismatch::Explanation example_explanation();

/// Nothing was found.
[[nodiscard]] mismatch::Explanation consistent_example();

}  // namespace sealwatch::report
