// What a setting's text means for the variable that it sets: numbers with spaces between them, true and false, items of
// an enumeration by name or number.
#pragma once

#include <string>

#include "services/common/fmi/model_description.hpp"

namespace sealwatch::fmi {

/// The same in numbers alone, true and false but for a Boolean; a text stays as it is. An Error with value, rule and
/// advice where the variable cannot have that value.
[[nodiscard]] Result<std::string> value_of_setting(const Variable& variable, const std::string& text);

}  // namespace sealwatch::fmi
