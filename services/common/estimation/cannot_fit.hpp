// The report of a fit that could not be made.
#pragma once

#include <string>

#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch {

[[nodiscard]] FitReport cannot_fit(std::string model, std::string reason);

}  // namespace sealwatch
