// Any plant: its elements as boxes in the order of its description, up to five to a row, and its sensors below.
#include "services/common/report/drawing_parts.hpp"
#include "services/common/report/plot_scale.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

constexpr std::size_t kMostPerRow = 5;
constexpr double kEdge = 10.0;
constexpr double kLeastWidth = 150.0;  ///< of a box
constexpr double kMostWidth = 240.0;
constexpr double kLetter = 8.2;  ///< mean width of a letter of a name, and
constexpr double kMargin = 24.0;
constexpr double kBoxHeight = 56.0;
constexpr double kPillHeight = 38.0;
constexpr double kPillStepY = 50.0;
constexpr double kGap = 40.0;  ///< between boxes of a row
constexpr double kStepY = 84.0;
constexpr double kLowerAlone = 7.0;
constexpr double kWordsHeight = 22.0;  ///< of the line above the sensors
constexpr std::string_view kSensor = "sensor:";

/// A row of equal boxes.
struct Grid {
  double width = kLeastWidth;
  std::size_t per_row = kMostPerRow;
  [[nodiscard]] double left(std::size_t place) const {
    return kEdge + (width + kGap) * static_cast<double>(place % per_row);
  }
  [[nodiscard]] std::size_t row(std::size_t place) const { return place / per_row; }
  [[nodiscard]] double rows(std::size_t places) const { return static_cast<double>((places + per_row - 1) / per_row); }
  [[nodiscard]] double right() const { return left(per_row - 1) + width + kEdge; }
};

std::string label_of(std::string_view element) {
  return text::in_words(element.starts_with(kSensor) ? element.substr(kSensor.size()) : element);
}

/// As wide as the longest name asks for, and no more columns than there are boxes.
Grid grid_for(const std::vector<std::string>& elements, const std::vector<std::string>& sensors) {
  std::size_t longest = 0;
  for (const auto* names : {&elements, &sensors})
    for (const std::string& name : *names) longest = std::max(longest, label_of(name).size());
  return {.width = std::clamp(kLetter * static_cast<double>(longest) + kMargin, kLeastWidth, kMostWidth),
          .per_row = std::clamp<std::size_t>(std::max(elements.size(), sensors.size()), 1, kMostPerRow)};
}

std::string rectangle(double x, double y, double width, double height, double corner) {
  return text::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\"/>", pixel(x), pixel(y),
                      pixel(width), pixel(height), pixel(corner));
}

std::string element_box(const Colouring& colouring, const Grid& grid, const std::string& element, std::size_t place) {
  const double x = grid.left(place), y = kEdge + kStepY * static_cast<double>(grid.row(place));
  std::string svg;
  if (place % grid.per_row != 0)  // from the box before
    svg = text::format("<path class=\"wire\" d=\"M{} {}H{}\"/>\n", pixel(x - kGap), pixel(y + kBoxHeight / 2.0),
                       pixel(x));
  const std::string name = label_of(element), shape = rectangle(x, y, grid.width, kBoxHeight, 5.0);
  return svg.append(colouring.part({.element = element,
                                    .shape = shape,
                                    .symbol = {},
                                    .label_x = x + grid.width / 2.0,
                                    .label_y = y + 26.0,
                                    .inside = true,
                                    .lower_alone = kLowerAlone,
                                    .label = name}));
}

/// A sensor: a box with round ends, faint where the channel is not recorded.
std::string pill(const Colouring& colouring, const Grid& grid, const std::string& element, std::size_t place,
                 double top) {
  const double x = grid.left(place), y = top + kPillStepY * static_cast<double>(grid.row(place));
  const std::string name = label_of(element), shape = rectangle(x, y, grid.width, kPillHeight, kPillHeight / 2.0);
  const bool seen = colouring.is_recorded(std::string_view(element).substr(kSensor.size()));
  return std::string(seen ? "<g>\n" : "<g opacity=\".4\">\n")
      .append(colouring.part({.element = element,
                              .shape = shape,
                              .symbol = {},
                              .label_x = x + grid.width / 2.0,
                              .label_y = y + 17.0,
                              .inside = true,
                              .lower_alone = kLowerAlone,
                              .label = name}))
      .append("</g>\n");
}

}  // namespace

std::string chain_drawing(const Colouring& colouring) {
  std::vector<std::string> elements, sensors;
  for (const ElementDescription& element : colouring.plant().elements)
    (element.name.starts_with(kSensor) ? sensors : elements).push_back(element.name);
  const Grid grid = grid_for(elements, sensors);
  std::string boxes;
  for (std::size_t k = 0; k < elements.size(); ++k) boxes += element_box(colouring, grid, elements[k], k);
  double bottom = kEdge + kStepY * grid.rows(elements.size());
  if (!sensors.empty()) {
    boxes += text::format("<text x=\"{}\" y=\"{}\">sensors</text>\n", pixel(kEdge), pixel(bottom));
    bottom += kWordsHeight - kEdge;
    for (std::size_t k = 0; k < sensors.size(); ++k) boxes += pill(colouring, grid, sensors[k], k, bottom);
    bottom += kPillStepY * grid.rows(sensors.size());
  }
  return text::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" class=\"drawing\" width=\"{0}\" "
             "height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n<title>Where the mismatch sits in the plant</title>\n",
             pixel(grid.right()), pixel(bottom))
      .append(boxes)
      .append("</svg>\n");
}

}  // namespace sealwatch::report
