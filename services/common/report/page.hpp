// Self-contained HTML pages: escaping, style sheet, tables. No network, no script needed; light, dark and print.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sealwatch::report {

/// Text for HTML and SVG, in elements and in attributes: & < > " ' are escaped, control characters and bytes that are
/// not UTF-8 become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// HTML text (no elements) in which figures that contain a dash, a date or an interval, stay on one line.
[[nodiscard]] std::string unbroken(std::string_view text);

/// A whole page: <!DOCTYPE html> to </html>. `title` is escaped, `body` is HTML.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body);

/// A drawing as a file of its own: `body` is SVG of that many pixels; the page's style sheet goes with it, so that it is
/// legible in light and dark.
[[nodiscard]] std::string standalone_svg(std::string_view title, int width, int height, std::string_view body);

/// "<section><h2>title</h2>body</section>", the title escaped.
[[nodiscard]] std::string section(std::string_view title, std::string_view body);

/// Whether a section that is closed on the screen is opened for printing.
enum class Paper { closed, printed };

/// A section that is closed at first: its title, and in a few words what is inside, open it.
[[nodiscard]] std::string folded_section(std::string_view title, std::string_view inside, std::string_view body,
                                         Paper paper = Paper::closed);

/// "<p>" with escaped text.
[[nodiscard]] std::string paragraph(std::string_view text, std::string_view css_class = {});

/// A closed part that opens on click. The label is escaped.
[[nodiscard]] std::string folded(std::string_view label, std::string_view body);

/// A table. Cells are escaped unless given as html. All cells wrap where the page is too narrow.
class Table {
 public:
  /// Columns whose header begins with '>' are numbers, right-aligned; with '~' prose, which keeps some width (the signs
  /// are not shown).
  explicit Table(const std::vector<std::string>& headers);
  void row(const std::vector<std::string>& cells);
  void row_of_html(const std::vector<std::string>& cells, std::string_view css_class = {});
  /// On paper it is not divided between pages: its first rows say what the others belong to.
  void keep_together() { together_ = true; }
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::string html() const;

 private:
  std::vector<std::string> classes_;
  std::string head_, rows_;
  bool together_ = false;
};

}  // namespace sealwatch::report
