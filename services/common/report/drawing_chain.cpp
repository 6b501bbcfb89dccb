// Any plant: its elements as boxes in the order of its description, five to a row, and its sensors below.
#include "services/common/report/drawing_parts.hpp"
#include "services/common/report/plot_scale.hpp"

namespace sealwatch::report {
namespace {

constexpr std::size_t kPerRow = 5;
constexpr double kBoxWidth = 150.0;
constexpr double kBoxHeight = 56.0;
constexpr double kPillHeight = 38.0;
constexpr double kPillStepY = 50.0;
constexpr double kStepX = 190.0;
constexpr double kStepY = 84.0;
constexpr std::string_view kSensor = "sensor:";

std::string rectangle(double x, double y, double height, double corner) {
  return std::string("<rect x=\"")
      .append(pixel(x))
      .append("\" y=\"")
      .append(pixel(y))
      .append("\" width=\"")
      .append(pixel(kBoxWidth))
      .append("\" height=\"")
      .append(pixel(height))
      .append("\" rx=\"")
      .append(pixel(corner))
      .append("\"/>");
}

/// From one box to the next in its row.
std::string arrow(double x, double y) {
  const std::string from = pixel(x + kBoxWidth);
  const std::string to = pixel(x + kStepX);
  const std::string at = pixel(y + kBoxHeight / 2.0);
  return std::string("<path class=\"wire\" d=\"M")
      .append(from)
      .append(" ")
      .append(at)
      .append("H")
      .append(to)
      .append("\"/>\n");
}

/// A sensor: a box with round ends, faint where the channel is not recorded.
std::string pill(const Colouring& colouring, const std::string& element, double x, double y) {
  const std::string shape = rectangle(x, y, kPillHeight, kPillHeight / 2.0);
  const bool seen = colouring.is_recorded(std::string_view(element).substr(kSensor.size()));
  return std::string(seen ? "<g>\n" : "<g opacity=\".4\">\n")
      .append(colouring.part({.element = element,
                              .shape = shape,
                              .symbol = {},
                              .label_x = x + kBoxWidth / 2.0,
                              .label_y = y + 17.0,
                              .inside = true}))
      .append("</g>\n");
}

std::size_t row_of(std::size_t place) { return place / kPerRow; }

std::size_t rows_for(std::size_t places) { return (places + kPerRow - 1) / kPerRow; }

}  // namespace

std::string chain_drawing(const Colouring& colouring) {
  std::string wires;
  std::string boxes;
  std::size_t count = 0;
  std::vector<std::string> sensors;
  for (const ElementDescription& element : colouring.plant().elements) {
    if (element.name.starts_with(kSensor)) {
      sensors.push_back(element.name);
      continue;
    }
    const double x = 10.0 + kStepX * static_cast<double>(count % kPerRow);
    const double y = 10.0 + kStepY * static_cast<double>(row_of(count));
    if (count % kPerRow != 0) wires += arrow(x - kStepX, y);
    const std::string shape = rectangle(x, y, kBoxHeight, 5.0);
    boxes += colouring.part({.element = element.name,
                             .shape = shape,
                             .symbol = {},
                             .label_x = x + kBoxWidth / 2.0,
                             .label_y = y + 26.0,
                             .inside = true});
    ++count;
  }
  const double rows = static_cast<double>(rows_for(count));
  const double sensors_y = 10.0 + kStepY * rows;
  for (std::size_t k = 0; k < sensors.size(); ++k)
    boxes += pill(colouring, sensors[k], 10.0 + kStepX * static_cast<double>(k % kPerRow),
                  sensors_y + kPillStepY * static_cast<double>(row_of(k)));
  const std::string height = pixel(sensors_y + kPillStepY * static_cast<double>(rows_for(sensors.size())));
  return std::string("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" class=\"drawing\" width=\"960\" height=\"")
      .append(height)
      .append("\" viewBox=\"0 0 960 ")
      .append(height)
      .append("\">\n<title>Where the mismatch sits in the plant</title>\n")
      .append(wires)
      .append(boxes)
      .append("</svg>\n");
}

}  // namespace sealwatch::report
