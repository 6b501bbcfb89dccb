// Any plant: its elements as boxes in the order of its description, five to a row, and its sensors below.
#include "services/common/report/drawing_parts.hpp"
#include "services/common/report/plot_scale.hpp"

namespace sealwatch::report {
namespace {

constexpr std::size_t kPerRow = 5;
constexpr double kBoxWidth = 150.0;
constexpr double kBoxHeight = 56.0;
constexpr double kStepX = 190.0;
constexpr double kStepY = 84.0;
constexpr std::string_view kSensor = "sensor:";

std::string box(double x, double y) {
  return std::string("<rect x=\"")
      .append(pixel(x))
      .append("\" y=\"")
      .append(pixel(y))
      .append("\" width=\"")
      .append(pixel(kBoxWidth))
      .append("\" height=\"")
      .append(pixel(kBoxHeight))
      .append("\" rx=\"5\"/>");
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

/// "pressure_a" as "pa": first letters of the words.
std::string initials(std::string_view channel) {
  std::string letters;
  bool first = true;
  for (const char letter : channel) {
    if (first) letters += letter;
    first = letter == '_';
  }
  return letters.substr(0, 3);
}

}  // namespace

std::string chain_drawing(const Colouring& colouring) {
  std::string wires;
  std::string boxes;
  std::size_t count = 0;
  std::vector<std::string> sensors;
  for (const ElementDescription& element : colouring.plant().elements) {
    if (element.name.starts_with(kSensor)) {
      sensors.push_back(element.name.substr(kSensor.size()));
      continue;
    }
    const double x = 10.0 + kStepX * static_cast<double>(count % kPerRow);
    const double y = 10.0 + kStepY * static_cast<double>(count / kPerRow);
    if (count % kPerRow != 0) wires += arrow(x - kStepX, y);
    const std::string shape = box(x, y);
    boxes += colouring.part(
        {.element = element.name, .shape = shape, .symbol = {}, .label_x = x + kBoxWidth / 2.0, .label_y = y + 26.0});
    ++count;
  }
  const double rows = static_cast<double>((count + kPerRow - 1) / kPerRow);
  const double sensor_y = 10.0 + kStepY * rows + 12.0;
  double x = 28.0;
  for (const std::string& channel : sensors) {
    boxes += colouring.sensor(channel, initials(channel), x, sensor_y);
    x += 80.0;
  }
  const std::string height = pixel(sensor_y + 26.0);
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
