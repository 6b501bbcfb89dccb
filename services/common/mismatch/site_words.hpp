// What a site takes and what laws see there, in words and units (model/physics.hpp lists the same for code).
#pragma once

#include <array>
#include <string_view>

#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch::mismatch {

struct SignalWords {
  std::string_view name;  ///< "piston velocity"; empty: the kind has no such signal
  std::string_view unit;
  std::string_view symbol = {};  ///< in the laws' equations: "v"
};

struct SiteWords {
  std::string_view quantity;  ///< "force against +x"
  std::string_view unit;      ///< empty for a sensor: its channel's
  std::array<SignalWords, kSiteSignals> signals;
};

[[nodiscard]] const SiteWords& words_of(SiteKind kind);
/// With the plant's own names and units where the site is of kind own.
[[nodiscard]] SiteWords words_at(const PlantDescription& plant, std::string_view element, SiteKind kind);

/// The signal that says whether and which way something moves, with its words; none: a kind at which nothing does.
struct MotionWords {
  std::size_t signal = kSiteSignals;
  const char *rest = "", *forward = "", *backward = "", *both = "";
};

[[nodiscard]] MotionWords motion_of(SiteKind kind);

}  // namespace sealwatch::mismatch
