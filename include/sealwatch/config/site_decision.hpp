// What a site's decisions rest on besides its campaigns: costs and proof tests. Plain data from `sites:` of the
// configuration; both are optional.
#pragma once

#include <optional>
#include <string>

#include "sealwatch/core/time.hpp"

namespace sealwatch {

/// In the site's own currency. What each means: forecast/decision.hpp.
struct SiteCosts {
  double planned = 1.0;        ///< a replacement in a campaign
  double after_failure = 5.0;  ///< one after a failure
  double failed_month = 0.5;   ///< a month with a failed valve
  double unused_month = 0.0;   ///< a month of seal life thrown away
  std::string currency;        ///< "MNOK"
};

/// For the average probability of failure on demand: forecast/safety_margin.hpp.
struct SiteSafety {
  double dangerous_undetected_per_hour = 1e-6;  ///< lambda_DU of one valve
  double partial_stroke_coverage = 0.6;         ///< share of those failures that a partial stroke shows
  double full_stroke_interval_months = 12.0;
  std::optional<UtcTime> last_full_stroke;  ///< none: when the next is due is not known
};

struct SiteDecision {
  std::optional<SiteCosts> costs;
  std::optional<SiteSafety> safety;
};

}  // namespace sealwatch
