#include "services/common/runtime/system_clock.hpp"

#include <sys/timex.h>

namespace sealwatch {

std::optional<bool> clock_is_synchronised() {
  timex state{};  // modes 0: it only asks
  if (::adjtimex(&state) == -1) return std::nullopt;
  return (state.status & STA_UNSYNC) == 0;
}

}  // namespace sealwatch
