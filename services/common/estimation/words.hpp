// Numbers and reports in words, as people read them.
#pragma once

#include <string>

#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch {

/// Three significant digits: "2.61e+13", "0.0213", "12.3".
[[nodiscard]] std::string in_words(double value);

/// The report of a fit that could not be made.
[[nodiscard]] FitReport cannot_fit(std::string model, std::string reason);

}  // namespace sealwatch
