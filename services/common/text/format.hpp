// format("{:.3g} {}", value, unit) by libfmt: checked by the compiler, of any length, the same in every locale.
#pragma once

#include <fmt/core.h>

namespace sealwatch::text {

using fmt::format;

}  // namespace sealwatch::text
