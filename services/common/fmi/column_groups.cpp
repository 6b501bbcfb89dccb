#include "services/common/fmi/column_groups.hpp"

#include <algorithm>

namespace sealwatch::fmi {

std::vector<ColumnGroup> single_columns(std::size_t columns) {
  std::vector<ColumnGroup> groups(columns);
  for (std::size_t column = 0; column < columns; ++column)
    groups[column].columns = {static_cast<std::uint32_t>(column)};
  return groups;
}

std::vector<ColumnGroup> column_groups(std::span<const std::uint32_t> dependencies, std::size_t columns) {
  if (dependencies.empty()) return single_columns(columns);
  std::vector<std::span<const std::uint32_t>> rows;
  std::vector<std::vector<std::uint32_t>> rows_of(columns);
  for (std::size_t at = 0; at < dependencies.size(); at += 1 + dependencies[at]) {
    for (const std::uint32_t column : dependencies.subspan(at + 1, dependencies[at]))
      rows_of[column].push_back(static_cast<std::uint32_t>(rows.size()));
    rows.push_back(dependencies.subspan(at + 1, dependencies[at]));
  }
  std::vector<ColumnGroup> groups;
  const std::size_t none = columns;
  std::vector<std::size_t> group_of(columns, none), taken_for(columns, none);  // which column a group is not free for
  for (std::size_t column = 0; column < columns; ++column) {
    for (const std::uint32_t row : rows_of[column])
      for (const std::uint32_t other : rows[row])
        if (group_of[other] != none) taken_for[group_of[other]] = column;
    std::size_t group = 0;
    while (group < groups.size() && taken_for[group] == column) ++group;
    if (group == groups.size()) groups.emplace_back();
    group_of[column] = group;
    groups[group].columns.push_back(static_cast<std::uint32_t>(column));
    for (const std::uint32_t row : rows_of[column])
      groups[group].places.push_back({row, static_cast<std::uint32_t>(column)});
  }
  for (ColumnGroup& group : groups) std::ranges::sort(group.places, {}, &MatrixPlace::row);
  return groups;
}

}  // namespace sealwatch::fmi
