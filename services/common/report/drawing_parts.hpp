// What both kinds of drawing are made of: elements that show their probability, sensors. Internal to actuator_drawing.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "services/common/report/actuator_drawing.hpp"

namespace sealwatch::report {

/// The shape of an element, and where its name stands. `shape` and `symbol` are SVG; the shape is filled, the symbol
/// drawn upon it.
struct Part {
  std::string_view element;
  std::string_view shape;
  std::string_view symbol;
  double label_x = 0.0, label_y = 0.0;
  std::string_view anchor = "middle";
  bool inside = false;          ///< the name stands in the shape, whose colour may be strong
  double lower_alone = 0.0;     ///< how much lower the name stands without a probability below it
  std::string_view label = {};  ///< the name as it is shown; else the element's
};

class Colouring {
 public:
  Colouring(const PlantDescription& plant, std::span<const mismatch::Location> location,
            const std::vector<std::string>& recorded)
      : plant_(plant), location_(location), recorded_(recorded) {}

  /// An element with its name and, from 1 % on, its probability.
  [[nodiscard]] std::string part(const Part& part) const;

  /// A sensor: a disc with `letters` in it and the probability below.
  [[nodiscard]] std::string sensor(std::string_view channel, std::string_view letters, double x, double y) const;

  /// What drives the simulation (the plant's inputs; the flow, where the voltage is not recorded) is not among its
  /// outputs and counts as recorded.
  [[nodiscard]] bool is_recorded(std::string_view channel) const {
    const ChannelDescription* description = plant_.find_channel(channel);
    const bool may_drive = description != nullptr && (description->input || description->role == ChannelRole::flow);
    return may_drive || std::ranges::find(recorded_, channel) != recorded_.end();
  }
  [[nodiscard]] const PlantDescription& plant() const { return plant_; }

 private:
  [[nodiscard]] double probability(std::string_view element) const;
  [[nodiscard]] bool same_as_most_probable(std::string_view element) const;
  /// The shape filled by probability, with a title that shows when pointed at.
  [[nodiscard]] std::string filled(std::string_view element, std::string_view shape) const;

  const PlantDescription& plant_;
  std::span<const mismatch::Location> location_;
  const std::vector<std::string>& recorded_;
};

/// Of a plant whose folder has a drawing; nothing: it has none.
[[nodiscard]] std::optional<std::string> own_drawing(const Colouring& colouring);
/// Drawing of any plant.
[[nodiscard]] std::string chain_drawing(const Colouring& colouring);

}  // namespace sealwatch::report
