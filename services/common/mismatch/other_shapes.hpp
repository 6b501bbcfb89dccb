// What may stand in place of the laws that a search just added: a greedy search takes the law that is easiest to find,
// and asks others to fill what it leaves.
#pragma once

#include <optional>
#include <vector>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// Each law that was just added to the best trial `before` starts again in its place: where something is left beyond the
/// noise, its refit from the linear step may have ended in a local minimum, or the law has another form than the
/// catalogue's, and another law was or would be asked to fill that. `asked`: the screening that proposed them.
void from_other_shapes(Naming& naming, const Trial& before, const Screening& asked, const Data& data,
                       const ExplainOptions& options);

/// Each law that was found before another one competes with those of other elements that would do best in its place: where
/// something is missing was decided when the others were not yet there. (At its own element a law with more freedom always
/// does as well.)
void another_law_for_each(Naming& naming, const Data& data, const ExplainOptions& options);

/// Near the noise the one law found competes again with those that promise most: what was found before something else was
/// unknown (sensors' gains, a value of each test) was compared without that.
void compete_again(Naming& naming, const Data& data, const ExplainOptions& options);

/// Several laws at one element may be parts of one (dry friction, drag and friction by pressure: a Stribeck curve):
/// each law of the element is asked for what they do together, and stays where several are not worth another law.
void one_law_for_several(Naming& naming, const Data& data, const ExplainOptions& options);

/// Whether the best leaves nothing: neither a law's score tells more, nor the misfit. What a search that stopped early
/// left lies in its own parameters, and what a closed form would do may lie beyond all listed laws: no score sees that.
[[nodiscard]] bool is_at_the_noise(const Naming& naming, const ExplainOptions& options);

/// A trial without one of its laws: as it was fitted already, from that trial or to convergence, else fitted from the
/// trial, and kept. None where that cannot be simulated or time is up.
[[nodiscard]] std::optional<Trial> without_law(Naming& naming, const Trial& trial, std::size_t slot, const Data& data,
                                               int threads);

/// What a model leaves; that of the last one asked is remembered, as a search asks twice before it takes a model.
[[nodiscard]] Result<Screening> look(Naming& naming, const std::shared_ptr<const FittedModel>& model, const Data& data,
                                     const ExplainOptions& options);

/// Goes on with the search for the trial's values; the trial becomes the best, with a new last screening. False, and a
/// remark, where what it leaves cannot be looked at: then the best stays what it was. Where time is up before that, it is
/// the best all the same, and `not_asked` says so.
[[nodiscard]] bool take(Naming& naming, const Trial& trial, const Data& data, const ExplainOptions& options);

/// Without those that add only a law of a sensor or of the recorded input to `from`, which takes up some of whatever is
/// missing, and that takes less than half of what is left.
[[nodiscard]] std::vector<Trial> causes_among(std::vector<Trial> trials, const Trial& from);

/// phi of the best of all these models.
[[nodiscard]] double smallest_dispersion(const std::vector<Trial>& trials, const FittedModel& model);

}  // namespace sealwatch::mismatch
