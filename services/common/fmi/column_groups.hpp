// Columns of a Jacobian that are found together, by one difference or one directional derivative: no row depends on two
// of them (A. R. Curtis, M. J. D. Powell, J. K. Reid, On the estimation of sparse Jacobian matrices, 1974).
//
//   (f(x + sum of h_k e_k) - f(x)) / h_k = df/dx_k      in each row that depends on x_k alone of the group
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sealwatch::fmi {

struct MatrixPlace {
  std::uint32_t row = 0, column = 0;
};

struct ColumnGroup {
  std::vector<std::uint32_t> columns;
  std::vector<MatrixPlace> places;  ///< what may differ from zero; of a column alone: nothing, as all rows may
};

/// Every column alone.
[[nodiscard]] std::vector<ColumnGroup> single_columns(std::size_t columns);

/// Groups by what each row depends on, as Setup::dependencies says it; every column alone where that is empty. The
/// columns in order, each in the first group that it fits: a matrix with b diagonals takes b groups.
[[nodiscard]] std::vector<ColumnGroup> column_groups(std::span<const std::uint32_t> dependencies, std::size_t columns);

/// The rows of a matrix with entries in this group: visitor(row, column).
template <class Visitor>
void visit_places(const ColumnGroup& group, std::size_t rows, Visitor&& visitor) {
  if (group.columns.size() == 1)
    for (std::size_t row = 0; row < rows; ++row) visitor(row, group.columns[0]);
  else
    for (const MatrixPlace& place : group.places) visitor(place.row, place.column);
}

}  // namespace sealwatch::fmi
