// The missing force, flow, torque or voltage of one element over one recording, as the data alone demand it.
//
// An unknown input w(t) at the element's site, linear between knots, explains what the recording holds beyond the model
// (smooth_input.hpp: weak-constraint smoother, smoothness by marginal likelihood), beside the recording's own load and
// initial states. What the figure means:
//   - With a model that holds the effect, `with`, the simulation runs with its law, so that the trajectory is that of
//     the recording; then the law's contribution is given back to the residual, r + H w_law, and w has to ask for all
//     of it. Smoothness is asked of w, not of its difference from the law: where the law is wrong w departs from it,
//     as far as its parameters leave something (they are those of `with`).
//   - Without one the model stays as it was fitted, and w is what its parameters have not swallowed.
//   - w is linear in the residual, at that trajectory. For an effect that no law describes and that moves the
//     trajectory far (the piston elsewhere, a valve shut that should be open), and for a law far from right, it shows
//     time and direction, not size. Where the law reacts to the input itself (dry friction at rest takes up any force)
//     the data say little, and the band is wide.
//   - `demanded`, `law` and `state_value` are means over the same time (the knot's hat), so that a jump is drawn by all
//     as a ramp of this length. `path_state` and `path_law` are the law as it is.
//   - `band` is 1.96 standard errors under noise of the assumed colour, raised by the root of what stays unexplained.
//   - A constant that the recording's load takes up has no estimate: then the mean is that of the law, 0 without one,
//     and `quantity` says "up to a constant".
// A sensor's error is the same with hats in its channel instead of in a balance.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// `element`: for a sensor "sensor:flow". `with`, `law`: null where no law was found; `parameters` of the law in its
/// order, as estimated in `with`. `signal`: which of the site's signals it is to be shown against. An Error when the
/// plant has no such site, the recording does not depend on it, or nothing can be simulated.
[[nodiscard]] Result<MissingTerm> missing_term(const FittedModel& without, const FittedModel* with, const Data& data,
                                               std::size_t recording, const std::string& element, SiteKind kind,
                                               const Law* law, std::span<const double> parameters,
                                               std::size_t signal = 0);

/// The same of the window that follows in time.
void append(MissingTerm& term, MissingTerm&& next);

}  // namespace sealwatch::mismatch
