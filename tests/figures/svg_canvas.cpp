#include "tests/figures/svg_canvas.hpp"

#include <sstream>

#include "services/common/report/page.hpp"

namespace sealwatch::figures {
namespace {

/// Length of the element that begins at `text`, its nested <svg> included.
std::size_t length_of_svg(std::string_view text) {
  constexpr std::string_view kOpen = "<svg";
  constexpr std::string_view kClose = "</svg>";
  int depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text.substr(at).starts_with(kOpen)) ++depth;
    if (text.substr(at).starts_with(kClose) && --depth == 0) return at + kClose.size();
  }
  return 0;
}

}  // namespace

std::string drawing_in(std::string_view html, std::string_view marker, std::string_view title) {
  std::size_t at = html.find(marker);
  while (at != std::string_view::npos && (at = html.find("<svg", at)) != std::string_view::npos) {
    const std::string_view drawing = html.substr(at, length_of_svg(html.substr(at)));
    if (drawing.find(title) != std::string_view::npos) return std::string(drawing);
    at += drawing.size();
  }
  return {};
}

std::string between(std::string_view html, std::string_view begin, std::string_view end) {
  const std::size_t from = html.find(begin);
  if (from == std::string_view::npos) return {};
  const std::size_t to = html.find(end, from + begin.size());
  return to == std::string_view::npos ? std::string()
                                      : std::string(html.substr(from + begin.size(), to - from - begin.size()));
}

void Canvas::place(std::string_view drawing, double x, double y, double scale) {
  std::string svg(drawing);
  // The style sheet sizes drawings of a page; here their attributes do.
  if (const std::size_t role = svg.find(" role=\"img\""); role != std::string::npos) svg.erase(role, 11);
  std::ostringstream group;
  group << "<g transform=\"translate(" << x << ' ' << y << ") scale(" << scale << ")\">\n" << svg << "</g>\n";
  body_ += group.str();
}

void Canvas::text(std::string_view words, double x, double y, std::string_view css_class, std::string_view anchor) {
  std::ostringstream text;
  text << "<text class=\"" << css_class << "\" x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">"
       << report::escaped(words) << "</text>\n";
  body_ += text.str();
}

std::string Canvas::svg() const { return report::standalone_svg(title_, width_, height_, body_); }

}  // namespace sealwatch::figures
