// Which variable of an FMU is which quantity of the plant around it, for the wrapper that is exported of both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/equations/text_equations.hpp"
#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

/// A variable by which a value goes in or out, as fmi2_wrapper.c has it.
struct WrapperPort {
  std::uint32_t reference = 0;
  const char* type = "kReal";
  bool continuous = true;  ///< may change between events
  Conversion unit;
  std::uint32_t element = 0, size = 1;  ///< of an array
};

/// A type of variables, as fmi2_wrapper.c names it: FMI 2.0 has whole numbers of one kind.
[[nodiscard]] const char* type_in_c(FmiType type, Version version);

/// An input or a parameter of the FMU, and the expression that the plant file has for it.
struct DrivenVariable {
  std::size_t variable = 0;          ///< in the description
  equations::Node node = 0;          ///< of the frame
  std::optional<std::size_t> alone;  ///< the input or parameter of the plant that it is, laws apart
  bool with_laws = false;
  WrapperPort port;
};

struct WrapperPorts {
  std::vector<DrivenVariable> inputs, parameters;
  std::vector<WrapperPort> states, rates, variables;
  std::vector<std::optional<std::size_t>>
      shown;              ///< of each output: the variable of the FMU that it is, in the description
  std::uint32_t own = 0;  ///< first reference that the FMU does not have
};

/// An Error where an input that changes at events alone is an expression.
[[nodiscard]] Result<WrapperPorts> wrapper_ports(const FmuEquations& unit, const equations::TextEquationsParts& frame);

}  // namespace sealwatch::fmi
