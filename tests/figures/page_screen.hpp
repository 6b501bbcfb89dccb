// The top of a page of the program as SVG. A page is HTML, which few viewers draw inside an SVG, so its headings,
// paragraphs, panels and figures are set here again.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::figures {

/// `html`: well-formed elements of a page (report/page.hpp). `width`: pixels, margins included; the height follows.
[[nodiscard]] std::string page_screen(std::string_view title, const std::string& html, int width);

}  // namespace sealwatch::figures
