// A plant file with an FMU in it (docs/own-simulation.md): what stands in place of the states' equations.
//
//   fmu:
//     file: model.fmu                                        beside the plant file
//     inputs: {u: drive_voltage - E}                         the FMU's inputs, expressions of the plant's
//     parameters: {M: M}                                     its parameters, expressions of the plant's parameters
//     interface: me                                          or cs, where it has both; me is taken first
//     settings: {n: 3, map: "a.txt"}                         its parameters that are no quantities: sizes, texts, switches
//     variables: {position: {variable: x1, unit: m}}         what is read of it, by the names that expressions use
//   states: {x: {variable: x1, unit: m, start: position}}    `variable` in place of `der`; start: fmu, as the FMU says
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/equations/text_plant.hpp"
#include "services/common/fmi/fmu_file.hpp"

namespace sealwatch::fmi {

struct FmuVariable {
  std::string name;  ///< in expressions
  std::string variable;
  std::string unit;  ///< SI
};

/// Start of a state that the FMU itself gives it, by its parameters.
inline constexpr const char* kStartOfFmu = "fmu";

struct FmuSection {
  std::string file;  ///< path
  Choice interface = Choice::model_exchange_first;
  Settings settings;                                                    ///< its parameters that are set once
  std::vector<std::pair<std::string, std::string>> inputs, parameters;  ///< the FMU's variable, an expression
  std::vector<FmuVariable> variables;
  std::vector<std::string> states;  ///< the FMU's name of each of the plant's states
};

/// As build_plant() of text plants: nothing where something is wrong, all of which went to `faults`.
[[nodiscard]] std::optional<equations::BuiltPlant> build_fmu_plant(const equations::TextPlant& text,
                                                                   const FmuSection& section,
                                                                   const equations::Faults& faults);

}  // namespace sealwatch::fmi
