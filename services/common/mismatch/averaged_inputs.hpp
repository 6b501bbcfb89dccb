// A search far from the recordings, with averaged inputs. An input that is held jumps at every sample, and each jump
// costs a restart of the integration: five steps where a line between the means of neighbours, of the same delay and
// area, takes one. What that changes is the ripple within a sample, which only the fastest states show: nothing beside
// what a gross misfit misses. The laws found go on from there with the inputs as they were held.
#pragma once

#include <memory>
#include <optional>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The same recordings with their held inputs averaged, but for those that the plant itself holds; nothing where none
/// is held.
[[nodiscard]] std::optional<Data> with_averaged_inputs(const AssetConfig& asset, const Data& data);

/// As fit_model(), by way of averaged inputs where the search sets out far from the recordings, or from the asset's
/// values.
[[nodiscard]] Result<FittedModel> fit_by_averaged_inputs(const AssetConfig& asset, const Data& data,
                                                         const FittedModel* start, int threads);

struct Averaged {
  Data data;
  std::shared_ptr<const FittedModel> model;
};
/// A model that was fitted to `held` and misses it grossly, fitted with averaged inputs; nothing where these change the
/// outputs by more than a twentieth of the mean square that it misses. A search ends where it comes to less than that
/// (Data::least_excess).
[[nodiscard]] std::optional<Averaged> averaged(const FittedModel& model, const Data& held, int threads);

}  // namespace sealwatch::mismatch
