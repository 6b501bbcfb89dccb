#include "services/cli/plant_laws.hpp"

#include <algorithm>

#include "services/common/equations/own_law.hpp"

namespace sealwatch::cli {
namespace {

void add_id(std::vector<std::string>& ids, const Law& law) {
  if (std::ranges::find(ids, law.id) == ids.end()) ids.emplace_back(law.id);
}

}  // namespace

std::vector<std::string> laws_at(const Site& site) {
  std::vector<std::string> ids;
  for (const Law& law : all_laws())
    if (law.plant.empty() && !law.closed_form && fits(law, site)) add_id(ids, law);
  return ids;
}

std::vector<std::string> laws_at(const equations::TextSite& site, const std::vector<Law>& own) {
  std::vector<std::string> ids;
  const auto add = [&](const Law& law) {
    if (!law.closed_form && fits(law, site.site()) && (!law.plant.empty() || !equations::is_inert(law, site.site())))
      add_id(ids, law);
  };
  for (const Law& law : all_laws())
    if (law.plant.empty()) add(law);
  for (const Law& law : own) add(law);
  return ids;
}

}  // namespace sealwatch::cli
