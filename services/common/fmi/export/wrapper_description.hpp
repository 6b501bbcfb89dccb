// The modelDescription.xml of an FMU with laws around it: that of the FMU, changed where the wrapper is another.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sealwatch/model/physics.hpp"
#include "services/common/fmi/fmu_file.hpp"

namespace sealwatch::fmi {

/// A variable that the FMU does not have.
struct OwnVariable {
  std::string name, unit, meaning;
  double start = 0.0;
  std::uint32_t reference = 0;
  double nominal = 0.0;      ///< 0: not said
  bool takes_alias = false;  ///< it is what an alias of its name stands for in the FMU
  const char* begins = "";   ///< of a state: kSettles, kOwn
};

/// How the hidden state of a law begins.
[[nodiscard]] inline const char* beginning_of(const HiddenState& hidden) {
  return hidden.settled ? kSettles : hidden.free_initial ? kOwn : "";
}

/// Of an element of a variable of the FMU, by its place in the description.
struct ChangedStart {
  std::size_t variable = 0, element = 0;
  double value = 0.0;
};

struct WrapperVariables {
  std::string token, identifier;
  std::vector<OwnVariable> hidden, hidden_rates, inputs, parameters, outputs;
  std::vector<ChangedStart> starts;                   ///< of the FMU's parameters
  std::vector<std::size_t> settling;                  ///< states of the FMU, by place in its description
  std::vector<std::size_t> local_inputs, calculated;  ///< of the FMU: inputs and parameters that follow from others
};

[[nodiscard]] Result<std::string> wrapper_description(const FmuFile& inner, const WrapperVariables& own);

}  // namespace sealwatch::fmi
