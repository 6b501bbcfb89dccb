#include "services/common/report/actuator_drawing.hpp"

#include "services/common/report/drawing_parts.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot_scale.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

constexpr double kShown = 0.01;  ///< probability from which on it is written beside the element
constexpr std::string_view kSensor = "sensor:";

std::string text_at(double x, double y, std::string_view anchor, std::string_view css_class, std::string_view text) {
  return std::string("<text x=\"")
      .append(pixel(x))
      .append("\" y=\"")
      .append(pixel(y))
      .append("\" text-anchor=\"")
      .append(anchor)
      .append("\" class=\"")
      .append(css_class)
      .append("\">")
      .append(escaped(text))
      .append("</text>\n");
}

}  // namespace

double Colouring::probability(std::string_view element) const {
  for (const mismatch::Location& place : location_)
    if (place.element == element) return place.probability;
  return 0.0;
}

bool Colouring::same_as_most_probable(std::string_view element) const {
  return !location_.empty() && std::ranges::find(location_.front().indistinguishable_from, element) !=
                                   location_.front().indistinguishable_from.end();
}

std::string Colouring::filled(std::string_view element, std::string_view shape) const {
  std::string title = text::in_words(element);
  for (const ElementDescription& description : plant_.elements)
    if (description.name == element) title.append(": ").append(description.meaning);
  const double share = probability(element);
  if (share > 0.0) title.append(" (").append(text::percent_text(share)).append(")");
  std::string svg = std::string("<g class=\"part\"><title>").append(escaped(title)).append("</title>");
  svg.append(shape).append("</g>\n");
  const bool same = same_as_most_probable(element);
  if (share >= kShown || same) {
    svg.append(same ? "<g class=\"hot same\" fill-opacity=\"" : "<g class=\"hot\" fill-opacity=\"");
    svg.append(text::number_text(0.1 + 0.75 * std::clamp(share, 0.0, 1.0), 2))
        .append("\">")
        .append(shape)
        .append("</g>\n");
  }
  return svg;
}

std::string Colouring::part(const Part& part) const {
  const double share = probability(part.element);
  std::string svg = filled(part.element, part.shape);
  svg.append("<g class=\"symbol\">").append(part.symbol).append("</g>\n");
  // A halo keeps the words legible on a strong colour, light and dark.
  const std::string_view strong = part.inside ? "title named" : "title";
  const std::string name = part.label.empty() ? text::in_words(part.element) : std::string(part.label);
  const double label_y = part.label_y + (share >= kShown ? 0.0 : part.lower_alone);
  svg += text_at(part.label_x, label_y, part.anchor, share >= kShown ? strong : "", name);
  if (share >= kShown)
    svg += text_at(part.label_x, part.label_y + 17.0, part.anchor, part.inside ? strong : "share",
                   text::percent_text(share));
  return svg;
}

std::string Colouring::sensor(std::string_view channel, std::string_view letters, double x, double y) const {
  const std::string element = std::string(kSensor).append(channel);
  const std::string disc =
      std::string("<circle cx=\"").append(pixel(x)).append("\" cy=\"").append(pixel(y)).append("\" r=\"12\"/>");
  std::string svg = is_recorded(channel) ? "<g>\n" : "<g opacity=\".35\">\n";
  svg += filled(element, disc);
  svg += text_at(x, y + 4.0, "middle", "letters", letters);
  const double share = probability(element);
  if (share >= kShown) svg += text_at(x + 16.0, y + 4.0, "start", "share", text::percent_text(share));
  return svg.append("</g>\n");
}

std::string actuator_drawing(const PlantDescription& plant, std::span<const mismatch::Location> location,
                             const std::vector<std::string>& recorded) {
  const Colouring colouring(plant, location, recorded);
  const std::optional<std::string> own = own_drawing(colouring);
  return own ? *own : chain_drawing(colouring);
}

}  // namespace sealwatch::report
