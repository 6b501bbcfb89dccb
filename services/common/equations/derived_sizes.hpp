// Sizes of laws that follow from others: where forces are a tenth and ways four times as large, stiffnesses are a
// fortieth. Frictions per speed do not follow: speeds at which friction changes do not grow with the speed of travel.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sealwatch::equations {

/// Units from which the size of this one follows; empty: from none.
[[nodiscard]] std::vector<std::string> sources_of_size(std::string_view unit);

/// Adds what follows from the sizes that are there and is not given itself.
void add_derived_sizes(std::map<std::string, double>& sizes);

/// Units that stand in laws, or from which or into which sizes of laws follow: what a size may be given for.
[[nodiscard]] std::vector<std::string> units_of_sizes();

/// The fewest of the needed units, in their order, whose sizes still have to be given for all to be known.
[[nodiscard]] std::vector<std::string> sizes_to_give(const std::map<std::string, double>& given,
                                                     std::vector<std::string> needed);

}  // namespace sealwatch::equations
