// The text of an expression as a tree.
//
//   sum     = product {(+|-) product}          product = signed {(*|/) signed}       signed = [+|-] signed | power
//   power   = primary [^ signed]               primary = number [ "[" unit "]" ] | name [ "(" sum {, sum} ")" ] | ( sum )
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"

namespace sealwatch::equations {

struct Syntax {
  enum class Kind { number, name, call, negate, add, subtract, multiply, divide, power };
  Kind kind = Kind::number;
  std::string text;  ///< name or number as written
  std::string unit;  ///< of a number; "": none given
  double number = 0.0;
  std::size_t begin = 0, end = 0;  ///< in the expression
  std::vector<Syntax> operands = {};
};

/// An Error whose value is the part of the text that is wrong.
[[nodiscard]] Result<Syntax> parse(std::string_view text);

}  // namespace sealwatch::equations
