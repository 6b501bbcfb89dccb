// Expressions of a plant as C statements.
#pragma once

#include <span>
#include <string>

#include "services/common/equations/text_equations.hpp"

namespace sealwatch::fmi {

/// A number as C reads it back to the last bit.
[[nodiscard]] std::string c_number(double value);

/// A function that fills `result` with the nodes' values:
///   static void NAME(double t, const double* x, const double* u, const double* p, const double* e, double* result)
/// `u`: the used inputs, then the rates of those in `rates`. Tables stand in c_tables().
[[nodiscard]] std::string c_function(const std::string& name, const equations::TextEquationsParts& parts,
                                     std::span<const equations::Node> nodes, std::span<const std::size_t> rates);

/// The tables of these expressions and how they are read; "" where there are none.
[[nodiscard]] std::string c_tables(const equations::Expressions& expressions);

}  // namespace sealwatch::fmi
