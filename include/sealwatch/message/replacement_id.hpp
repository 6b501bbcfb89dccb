// The message id of a replacement, which ends in its time (time_of_replacement in retraction.hpp). It tells kind and
// time of the report too: one that was taken back can be reported again, as what no longer holds is a report, by its
// id, and no moment.
#pragma once

#include <string>
#include <string_view>

#include "sealwatch/core/time.hpp"

namespace sealwatch {

/// `report`: what tells one report from another.
[[nodiscard]] inline std::string replacement_id_of(const std::string& report, const std::string& asset_id,
                                                   std::string_view kind, UtcTime replaced) {
  return "maintenance_event/" + asset_id + "/" + std::string(kind) + "/" + report + "/" + format_utc(replaced);
}
[[nodiscard]] inline std::string replacement_id(const std::string& asset_id, std::string_view kind, UtcTime reported,
                                                UtcTime replaced) {
  return replacement_id_of(format_utc(reported), asset_id, kind, replaced);
}

/// Whether a report of that id may be one of this kind: an id of before kinds stood in it tells none.
[[nodiscard]] inline bool may_report(std::string_view id, const std::string& asset_id, std::string_view kind) {
  const std::string of_asset = "maintenance_event/" + asset_id + "/";
  if (!id.starts_with(of_asset)) return false;
  id.remove_prefix(of_asset.size());
  return id.find('/') == std::string_view::npos || id.starts_with(std::string(kind) + "/");
}

}  // namespace sealwatch
