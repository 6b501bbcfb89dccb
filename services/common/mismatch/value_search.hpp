// The search for laws beside fixed values of the asset file that may be off (Data::fixed): a value that does what laws
// were found for takes their place, and the search goes on beside it.
#pragma once

#include <optional>
#include <vector>

#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/value_swaps.hpp"

namespace sealwatch::mismatch {

/// Fixed values that `from` has free and the baseline has not.
[[nodiscard]] std::vector<KnownValue> freed_by(const Trial& from, const FittedModel& baseline, const Data& data);

/// The search goes on from `from` beside these values.
[[nodiscard]] Result<Naming> beside_values(const Naming& naming, const std::vector<KnownValue>& values,
                                           const Trial& from, const Data& data, const ExplainOptions& options,
                                           const Progress& progress);

/// The search beside a value that takes the place of laws; nothing where these did better in the end: the value is then
/// among those refused.
[[nodiscard]] std::optional<Naming> search_beside(Naming& naming, const ValueSwap& swap, const Data& data,
                                                  const ExplainOptions& options, const Progress& progress);

/// A fixed value of the asset file in place of laws found, all of them without shapes or not, where that explains more by
/// far: the search beside it. Nothing where none does, or laws did better in the end.
[[nodiscard]] std::optional<Naming> value_in_place(Naming& naming, bool without_shapes, const Data& data,
                                                   const ExplainOptions& options, const Progress& progress);

/// In a gross misfit, before any law was found: a fixed value that ends it alone. Laws would be asked one after the other
/// to do what it does.
[[nodiscard]] std::optional<ValueSwap> value_that_ends_it(const Naming& naming, const Data& data, int threads);

}  // namespace sealwatch::mismatch
