// Names and units of what laws see and give at each kind of site (model/physics.hpp), as plants that are written as text
// use them.
#pragma once

#include <array>
#include <string_view>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch::equations {

struct SignalName {
  std::string_view name;  ///< "": there is none
  std::string_view unit;
  double usual = 0.0;  ///< in `eha`, for whose sizes laws are written
};

struct SiteNames {
  std::string_view unit;  ///< of what is added; "": the plant's (SiteKind::own)
  std::array<SignalName, kSiteSignals> signals;
};

[[nodiscard]] const SiteNames& names_of_site(SiteKind kind);

/// Whether a law of the catalogue lacks the signals that it needs there: what is left of it is the rounding of its corners.
[[nodiscard]] bool is_inert(const Law& law, const Site& site);

}  // namespace sealwatch::equations
