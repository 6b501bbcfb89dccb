#include "tests/figures/page_screen.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <pugixml.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "services/common/report/page.hpp"
#include "tests/figures/svg_canvas.hpp"

namespace sealwatch::figures {
namespace {

constexpr double kMargin = 22.0;
constexpr double kLineHeight = 1.45;  // of the size of the letters

struct Font {
  double size = 15.0;  // px
  bool bold = false;
  std::string_view colour = "--text";
  bool monospaced = false;
};

struct Column {
  double x = 0.0, width = 0.0;
};

bool has_class(const pugi::xml_node& node, std::string_view wanted) {
  std::istringstream names(node.attribute("class").value());
  for (std::string name; names >> name;)
    if (name == wanted) return true;
  return false;
}

/// All text inside, with single blanks.
std::string words_of(const pugi::xml_node& node) {
  std::string text;
  const std::function<void(const pugi::xml_node&)> collect = [&](const pugi::xml_node& inside) {
    text += inside.value();
    for (const pugi::xml_node& child : inside.children()) collect(child);
  };
  collect(node);
  std::istringstream stream(text);
  std::string joined;
  for (std::string word; stream >> word;) joined += (joined.empty() ? "" : " ") + word;
  return joined;
}

/// Blanks between its elements are none of a drawing's.
void take_out_blanks(pugi::xml_node node) {
  for (pugi::xml_node child = node.first_child(); child;) {
    const pugi::xml_node next = child.next_sibling();
    if (child.type() == pugi::node_pcdata && words_of(child).empty())
      node.remove_child(child);
    else
      take_out_blanks(child);
    child = next;
  }
}

/// Of DejaVu Sans, the widest of the fonts that the style sheet names, in shares of the letters' size.
double width_of(std::string_view text, const Font& font) {
  double width = 0.0;
  for (const char letter : text) {
    if ((static_cast<unsigned char>(letter) & 0xC0U) == 0x80U) continue;  // not the first byte of a character
    if (font.monospaced)
      width += 0.602;
    else if (std::string_view(" ,.:;!|'()[]iljtfI").find(letter) != std::string_view::npos)
      width += 0.355;
    else
      width += std::string_view("mwMWOQ%").find(letter) != std::string_view::npos ? 0.9 : 0.615;
  }
  return width * font.size * (font.bold ? 1.09 : 1.0);
}

class Page {
 public:
  explicit Page(Canvas& canvas) : canvas_(canvas) {}

  /// Below `y`; returns where it ends.
  double blocks(const pugi::xml_node& parent, const Column& column, double y, const Font& font = {}) {
    for (const pugi::xml_node& node : parent.children()) y = block(node, column, y, font);
    return y;
  }

 private:
  double block(const pugi::xml_node& node, const Column& column, double y, const Font& font) {
    const std::string_view name = node.name();
    const double gap = in_panel_ ? 2.0 : 5.0;
    if (name == "h1") return lines(words_of(node), column, y + 2.0, {.size = 24.0, .bold = true});
    if (name == "h2") return heading(node, column, y);
    if (name == "h3") return lines(words_of(node), column, y + 8.0, {.size = 16.0, .bold = true});
    if (name == "p") return paragraph(node, column, y + gap, font) + gap;
    if (name == "ol") return list(node, column, y);
    if (name == "svg") return drawing(node, column, y);
    if (name != "div") return y;
    if (has_class(node, "banner")) return panel(node, column, y + 10.0, "--second", {.size = 17.3}) + 14.0;
    if (has_class(node, "steps")) return panel(node, column, y + 10.0, "--first", {}) + 14.0;
    if (has_class(node, "figures")) return figures(node, column, y + 4.0) + 8.0;
    if (has_class(node, "screen")) return side_by_side(node, column, y);
    return blocks(node, column, y, font);
  }

  double heading(const pugi::xml_node& node, const Column& column, double y) {
    y = lines(words_of(node), column, y + 4.0, {.size = 16.3, .bold = true});
    if (in_panel_) return y;
    rectangle(column.x, y + 4.0, column.width, 1.0, "--line");
    return y + 8.0;
  }

  double paragraph(const pugi::xml_node& node, const Column& column, double y, Font font) {
    if (const pugi::xml_node law = node.child("span"); law && has_class(law, "law")) {
      const Font code{.size = 13.8, .monospaced = true};
      rectangle(column.x, y, width_of(words_of(law), code) + 20.0, 30.0, "--soft");
      return std::max(y + 30.0, lines(words_of(law), {column.x + 10.0, column.width}, y + 4.0, code));
    }
    if (has_class(node, "verdict")) font = {.size = 18.4, .bold = true};
    if (has_class(node, "small")) font.size = 13.8;
    if (has_class(node, "muted")) font.colour = "--muted";
    return lines(words_of(node), column, y, font);
  }

  double list(const pugi::xml_node& node, const Column& column, double y) {
    constexpr double kIndent = 22.0;
    int number = 0;
    for (const pugi::xml_node& item : node.children("li")) {
      lines(std::to_string(++number) + ".", column, y + 3.0, {});
      y = lines(words_of(item), {column.x + kIndent, column.width - kIndent}, y + 3.0, {});
    }
    return y;
  }

  /// A grey box with a coloured edge, as high as what is in it.
  double panel(const pugi::xml_node& node, const Column& column, double y, std::string_view edge, const Font& font) {
    constexpr double kEdge = 7.0, kInside = 25.0, kAbove = 10.0;
    const Column inner{.x = column.x + kInside, .width = column.width - 2.0 * kInside};
    in_panel_ = true;
    const bool drawn = draws_;
    draws_ = false;
    const double end = blocks(node, inner, y + kAbove, font) + kAbove;
    draws_ = drawn;
    rectangle(column.x, y, column.width, end - y, "--soft");
    rectangle(column.x, y, kEdge, end - y, edge);
    blocks(node, inner, y + kAbove, font);
    in_panel_ = false;
    return end;
  }

  double figures(const pugi::xml_node& node, const Column& column, double y) {
    constexpr double kGap = 35.0, kLeast = 128.0;
    const Font large{.size = 19.2, .bold = true}, small{.size = 13.8, .colour = "--muted"};
    double x = column.x, end = y;
    for (const pugi::xml_node& figure : node.children("div")) {
      const std::string value = words_of(figure.child("b")), meaning = words_of(figure.child("span"));
      const double width = std::max({kLeast, width_of(value, large), width_of(meaning, small)});
      const double below = lines(value, {x, width + kGap}, y, large);
      end = std::max(end, lines(meaning, {x, width + kGap}, below, small));
      x += width + kGap;
    }
    return end;
  }

  double side_by_side(const pugi::xml_node& node, const Column& column, double y) {
    constexpr double kGap = 26.0, kLeftShare = 5.0 / 12.0;
    const double left = kLeftShare * (column.width - kGap);
    double x = column.x, end = y;
    for (const pugi::xml_node& part : node.children("div")) {
      const double width = x == column.x ? left : column.width - kGap - left;
      end = std::max(end, blocks(part, {x, width}, y));
      x += left + kGap;
    }
    return end;
  }

  double drawing(const pugi::xml_node& node, const Column& column, double y) {
    const double width = node.attribute("width").as_double(), height = node.attribute("height").as_double();
    const double scale = std::min(1.0, column.width / width);
    take_out_blanks(node);
    std::ostringstream svg;
    node.print(svg, "", pugi::format_raw);
    if (draws_) canvas_.raw("<g class=\"screen\">\n");  // the style sheet's letters of a drawing there
    if (draws_) canvas_.place(svg.str(), column.x, y, scale);
    if (draws_) canvas_.raw("</g>\n");
    return y + scale * height;
  }

  double lines(const std::string& text, const Column& column, double y, const Font& font) {
    std::istringstream stream(text);
    std::string line;
    const auto put = [&] {
      if (draws_) write(line, column.x, y + 1.08 * font.size, font);
      y += kLineHeight * font.size;
    };
    for (std::string word; stream >> word;) {
      if (!line.empty() && width_of(line + " " + word, font) > column.width) {
        put();
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    if (!line.empty()) put();
    return y;
  }

  void write(const std::string& words, double x, double y, const Font& font) {
    std::ostringstream text;
    text << "<text x=\"" << std::lround(x) << "\" y=\"" << std::lround(y) << "\" style=\"font-size:" << font.size
         << "px;font-weight:" << (font.bold ? 700 : 400)
         << (font.monospaced ? ";font-family:ui-monospace,'DejaVu Sans Mono',monospace" : "") << ";fill:var("
         << font.colour << ")\">" << report::escaped(words) << "</text>\n";
    canvas_.raw(text.str());
  }

  void rectangle(double x, double y, double width, double height, std::string_view colour) {
    if (!draws_) return;
    std::ostringstream svg;
    svg << "<rect x=\"" << std::lround(x) << "\" y=\"" << std::lround(y) << "\" width=\"" << std::lround(width)
        << "\" height=\"" << std::lround(height) << "\" style=\"fill:var(" << colour << ")\"/>\n";
    canvas_.raw(svg.str());
  }

  Canvas& canvas_;
  bool draws_ = true, in_panel_ = false;
};

}  // namespace

std::string page_screen(std::string_view title, const std::string& html, int width) {
  pugi::xml_document document;
  const std::string whole = "<body>" + html + "</body>";
  if (const auto read = document.load_string(whole.c_str(), pugi::parse_default | pugi::parse_ws_pcdata); !read)
    throw std::runtime_error(std::string("a page that is not well formed: ") + read.description());
  const Column column{.x = kMargin, .width = width - 2.0 * kMargin};
  Canvas measured(std::string(title), width, 0);
  const double end = Page(measured).blocks(document.child("body"), column, kMargin);
  Canvas canvas(std::string(title), width, static_cast<int>(std::lround(end + kMargin / 2.0)));
  Page(canvas).blocks(document.child("body"), column, kMargin);
  return canvas.svg();
}

}  // namespace sealwatch::figures
