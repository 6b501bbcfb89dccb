// Estimates and misfits with the digits that the recordings tell.
#pragma once

#include <string>

namespace sealwatch::text {

/// A misfit over the noise, whose own size is hardly known to a hundredth: "115", "9.64", "0.99".
[[nodiscard]] std::string misfit_text(double value);

/// An estimate with three digits more than its standard error has, so that rounding changes no simulation; without an
/// error with seven: 0.0058892018 -> 0.005889202.
[[nodiscard]] double rounded_to_error(double value, double error);

}  // namespace sealwatch::text
