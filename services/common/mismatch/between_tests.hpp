// Whether the recordings differ from one another rather than from the model: each alone agrees with it, all together do
// not, because a parameter (a seal that ages) changed between the tests.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The parameter that changed, in one sentence; nothing where one of the recordings disagrees with the model by itself.
[[nodiscard]] std::optional<std::string> change_between_tests(const AssetConfig& asset, const Data& data);

}  // namespace sealwatch::mismatch
