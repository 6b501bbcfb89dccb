// The missing force, flow, torque or voltage of one element over one recording, as the data alone demand it.
//
// The model without the effect is simulated; its residual is explained by an unknown input w(t) at the element's site,
// linear between knots (smooth_input.hpp: weak-constraint smoother, smoothness by marginal likelihood), beside the
// recording's own load and initial states. No law takes part in it. What the figure means:
//   - With a model that has the effect, `with`: the same model with the law taken out again and nothing else changed
//     but this recording's load and initial states. So w is to be compared with the law at its full size. Without one:
//     the model as it was fitted, and w is what its parameters have not swallowed.
//   - w is linear in the residual, at the trajectory of the model without the effect. For an effect that moves the
//     trajectory far (the piston elsewhere, a valve shut that should be open) it shows time and direction, not size.
//   - `demanded`, `law` and `state_value` are means over the same quarter of a second (the knot's hat), so that a jump
//     is drawn by all as a ramp of this length.
//   - `band` is 1.96 standard errors under noise of the assumed colour, raised by the root of what stays unexplained.
//   - A constant that the recording's load takes up has no estimate: then the mean is that of the law, 0 without one,
//     and `quantity` says "up to a constant".
// A sensor's error is the same with hats in its channel instead of in a balance.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// `element`: for a sensor "sensor:flow". `with`, `law`: null where no law was found; `parameters` of the law in its
/// order, as estimated in `with`. An Error when the plant has no such site, the recording does not depend on it, or
/// nothing can be simulated.
[[nodiscard]] Result<MissingTerm> missing_term(const FittedModel& without, const FittedModel* with, const Data& data,
                                               std::size_t recording, const std::string& element, SiteKind kind,
                                               const Law* law, std::span<const double> parameters);

}  // namespace sealwatch::mismatch
