#include "services/common/recording/repeated_times.hpp"

#include <algorithm>

namespace sealwatch {

bool RepeatedTimes::settle(std::vector<std::vector<double>>& columns, std::size_t time) {
  constexpr double kJust = 1e-7;  // of the distance of samples: below what rounds a Co-Simulation unit's steps
  const std::size_t last = columns[time].size() - 1, before = last - 1;
  const auto take_out = [&](std::size_t row) {
    for (std::vector<double>& column : columns)
      if (column.size() > last) column.erase(column.begin() + static_cast<std::ptrdiff_t>(row));
  };
  const bool equal = std::ranges::all_of(columns, [&](const std::vector<double>& column) {
    return column.size() <= last || column[last] == column[before];
  });
  if (equal) return take_out(last), true;
  if (before == 0 || before == after_jump_) return take_out(before), true;
  double& moved = columns[time][before];
  moved -= kJust * (moved - columns[time][before - 1]);
  after_jump_ = last;
  return moved > columns[time][before - 1] && moved < columns[time][last];
}

}  // namespace sealwatch
