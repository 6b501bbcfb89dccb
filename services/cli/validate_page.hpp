// The report of `sealwatch validate`: for each recording a table, and for each channel its course, its residual and the
// residual's autocorrelation.
#pragma once

#include <string>

#include "services/common/estimation/model_validation.hpp"

namespace sealwatch::cli {

/// Whether the model is what was recorded, for the terminal and the page.
[[nodiscard]] const char* verdict_in_words(const ModelValidation& validation);

/// What to do about what was found; empty: nothing.
[[nodiscard]] const char* next_step(const ModelValidation& validation);

[[nodiscard]] std::string validation_page(const AssetConfig& asset, const ModelValidation& validation);

}  // namespace sealwatch::cli
