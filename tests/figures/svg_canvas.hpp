// Pictures for the documentation, put together from the program's own drawings: a stand-alone SVG with the pages' style
// sheet in it, so that it is legible in light and dark where a page shows it as an image.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::figures {

/// The first "<svg ...>...</svg>" after `marker` whose text contains `title`, nested ones included; "" where there is none.
[[nodiscard]] std::string drawing_in(std::string_view html, std::string_view marker, std::string_view title);

/// What stands between two texts of a page; "" where one is missing.
[[nodiscard]] std::string between(std::string_view html, std::string_view begin, std::string_view end);

class Canvas {
 public:
  Canvas(std::string title, int width, int height) : title_(std::move(title)), width_(width), height_(height) {}
  /// A drawing of the program with its left upper corner at (x, y), in its own size times `scale`.
  void place(std::string_view drawing, double x, double y, double scale = 1.0);
  void text(std::string_view words, double x, double y, std::string_view css_class = {},
            std::string_view anchor = "start");
  void raw(std::string_view svg) { body_ += svg; }
  [[nodiscard]] std::string svg() const;

 private:
  std::string title_;
  int width_ = 0, height_ = 0;
  std::string body_;
};

}  // namespace sealwatch::figures
