// What `explain` is given: recordings as data, and what is refused.
#pragma once

#include <span>

#include "sealwatch/core/recording.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// In the order of their times, where all have one. Named by their ids, or by their files where another of these or of
/// `others` has the same id.
[[nodiscard]] Data data_of(std::span<const Recording> recordings, std::span<const Recording> others = {});
[[nodiscard]] Data without(const Data& data, std::size_t left_out);
[[nodiscard]] Data only(const Data& data, std::size_t one);

/// Recordings of another asset, channels that the plant does not know, a holdout that is fitted too.
[[nodiscard]] Status check(const AssetConfig& asset, std::span<const Recording> fit,
                           std::span<const Recording> holdout);

/// Whether nothing moves in any recording.
[[nodiscard]] bool at_rest(const FittedModel& model, const Data& data);

}  // namespace sealwatch::mismatch
