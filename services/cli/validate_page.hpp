// The report of `sealwatch validate`: for each recording a table, and for each channel its course, its residual and the
// residual's autocorrelation.
#pragma once

#include <string>

#include "services/common/verification/model_validation.hpp"

namespace sealwatch::cli {

[[nodiscard]] std::string validation_page(const AssetConfig& asset, const verification::ModelValidation& validation);

}  // namespace sealwatch::cli
