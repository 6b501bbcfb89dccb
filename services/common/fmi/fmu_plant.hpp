// A plant file with an FMU in it (docs/own-simulation.md): what stands in place of the states' equations.
//
//   fmu:
//     file: model.fmu                                        beside the plant file
//     inputs: {u: drive_voltage - E}                         the FMU's inputs, expressions of the plant's
//     parameters: {M: M}                                     its parameters, expressions of the plant's parameters
//     variables: {position: {variable: x1, unit: m}}         what is read of it, by the names that expressions use
//   states: {x: {variable: x1, unit: m, start: position}}    `variable` in place of `der`
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/equations/text_plant.hpp"

namespace sealwatch::fmi {

struct FmuVariable {
  std::string name;  ///< in expressions
  std::string variable;
  std::string unit;  ///< SI
};

struct FmuSection {
  std::string file;                                                     ///< path
  std::vector<std::pair<std::string, std::string>> inputs, parameters;  ///< the FMU's variable, an expression
  std::vector<FmuVariable> variables;
  std::vector<std::string> states;  ///< the FMU's name of each of the plant's states
};

/// As build_plant() of text plants: nothing where something is wrong, all of which went to `faults`.
[[nodiscard]] std::optional<equations::BuiltPlant> build_fmu_plant(const equations::TextPlant& text,
                                                                   const FmuSection& section,
                                                                   const equations::Faults& faults);

}  // namespace sealwatch::fmi
