// Any bytes as a modelDescription.xml: an error or a description whose references all lead somewhere, never a crash.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "services/common/fmi/model_description.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto description = sealwatch::fmi::read_model_description("any.fmu", text);
  if (!description) return 0;
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  for (const auto* list : {&description->states, &description->derivatives})
    for (const auto& element : *list) {
      require(element.variable < description->variables.size());
      require(element.element < description->variables[element.variable].size);
    }
  for (const auto& variable : description->variables) {
    require(variable.start.empty() || variable.start.size() == variable.size);
    require(!variable.derivative_of || *variable.derivative_of < description->variables.size());
  }
  for (const auto& unit : description->units) require(!sealwatch::fmi::si_name(unit).empty());
  return 0;
}
