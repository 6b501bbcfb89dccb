// Where a law acts, as people say it.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::text {

/// A law at its element: "Coulomb friction of the piston", or with `preposition` "at" "external leakage at chamber A".
/// What the fluid holds is in it: "entrained air in the fluid". What a sensor, an input or a clock has is of the
/// quantity alone: "sensor bias of flow", "input bias of the recorded pump voltage", "clock rate of the recording".
/// `element` is the id ("sensor:flow"), `name` what it is called in a sentence ("the piston").
[[nodiscard]] std::string law_at(std::string_view law, std::string_view element, std::string_view name,
                                 std::string_view preposition);

}  // namespace sealwatch::text
