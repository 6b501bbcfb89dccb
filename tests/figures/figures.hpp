// The documentation's pictures, each as a stand-alone SVG. docs/figures.sh makes what they show.
#pragma once

#include <string>

#include "sealwatch/core/recording.hpp"
#include "tests/figures/svg_canvas.hpp"

namespace sealwatch::figures {

[[nodiscard]] std::string partial_stroke(const Recording& recording);
[[nodiscard]] std::string valve_signature(const Recording& recording);
/// The same test without and with dry friction, by which the controller's position does not change.
[[nodiscard]] std::string concealed_effect(const Recording& plain, const Recording& hidden);

/// The plant `eha` with the names of its elements.
[[nodiscard]] std::string actuator();
/// The six services with their topics.
[[nodiscard]] std::string layers();

/// Of pages that the program wrote: the first screen of a report; recording, old and new simulation of a channel beside
/// the missing term; the first screen of the forecast page.
[[nodiscard]] std::string first_screen(const std::string& report_page);
[[nodiscard]] std::string before_and_after(const std::string& report_page, const std::string& channel);
[[nodiscard]] std::string forecast_screen(const std::string& forecast_page);

}  // namespace sealwatch::figures
