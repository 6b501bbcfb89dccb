// The catalogue's laws as formulas for other tools: one text for C and for Modelica, whose function calls look alike.
//
//   s1..s4  the signals of the site, in the order of model/physics.hpp      h  hidden state
//   p1..p4  the law's parameters, in the law's order           r1..r3  the law's roundings, in the plant's sizes
//
// Functions beside tanh, exp, log, sqrt, sin, abs (fabs): helper_functions() has them. A test compares every formula with
// the law itself.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sealwatch/model/physics.hpp"

namespace sealwatch::fmi {

struct LawFormula {
  std::string_view id, form;
  std::string_view contribution;
  std::string_view rate = {};  ///< of the hidden state; "": none
};

/// Null where the law is a sensor's, or one that a plant brings with it.
[[nodiscard]] const LawFormula* find_formula(const Law& law);

struct LawText {
  std::string contribution;
  std::string rate;  ///< of the hidden state; "": none
};
/// Of the catalogue's laws and of those that a plant brings as text; nothing where the law is a sensor's or a recording's.
[[nodiscard]] std::optional<LawText> written(const Law& law);

/// Definitions of the helper functions that the formulas use.
[[nodiscard]] std::string helper_functions_c();
[[nodiscard]] std::string helper_functions_modelica();
/// A formula as C writes it: fabs for abs.
[[nodiscard]] std::string in_c(std::string_view formula);

}  // namespace sealwatch::fmi
