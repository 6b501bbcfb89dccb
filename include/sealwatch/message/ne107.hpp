// NAMUR NE 107 (2017), section 4: what a device says of itself, here of each alarm of a service and of the service. The
// one table of it: docs/reference/alarms.md tells it to people, and a test holds the two side by side.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "sealwatch/message/alarm_state.hpp"

namespace sealwatch {

/// The most pressing first, but for `good`.
enum class Ne107 { good, failure, function_check, out_of_specification, maintenance_required };

[[nodiscard]] constexpr std::string_view words(Ne107 category) {
  constexpr std::array<std::string_view, 5> kWords = {"good", "failure", "function check", "out of specification",
                                                      "maintenance required"};
  return kWords.at(static_cast<std::size_t>(category));
}

struct Ne107Row {
  std::string_view kind;  ///< ServiceAlarm::kind
  Ne107 category;
};

/// Failure: something is not concluded from. Function check: what is concluded may not be what is meant for use. Out of
/// specification: something goes on that the configuration does not foresee. Maintenance required: all is still seen,
/// and will not be for ever.
inline constexpr std::array kNe107 = {
    Ne107Row{"no_heartbeat", Ne107::failure},
    Ne107Row{"set_aside", Ne107::failure},
    Ne107Row{"future_test", Ne107::failure},
    Ne107Row{"refused_test", Ne107::failure},
    Ne107Row{"refused_conclusion", Ne107::failure},
    Ne107Row{"recording_not_taken", Ne107::failure},
    Ne107Row{"sensor_lost", Ne107::failure},
    Ne107Row{"missing_blocks", Ne107::failure},
    Ne107Row{kOutOfServiceAlarm, Ne107::function_check},
    Ne107Row{"clock_step", Ne107::out_of_specification},
    Ne107Row{"rival", Ne107::out_of_specification},
    Ne107Row{"unknown_writer", Ne107::out_of_specification},
    Ne107Row{"flood", Ne107::out_of_specification},
    Ne107Row{"unknown_asset", Ne107::out_of_specification},
    Ne107Row{"refused_right", Ne107::out_of_specification},
    Ne107Row{"clock_unsynchronised", Ne107::maintenance_required},
    Ne107Row{"awaits_confirmation", Ne107::maintenance_required},
    Ne107Row{"unpublished_model", Ne107::maintenance_required},
    Ne107Row{kAdviceAlarm, Ne107::maintenance_required},
    Ne107Row{kOverdueAlarm, Ne107::maintenance_required},
};

/// Of a kind that is not known, of a newer service: a failure.
[[nodiscard]] constexpr Ne107 category_of(std::string_view alarm_kind) {
  const auto* const found = std::ranges::find(kNe107, alarm_kind, &Ne107Row::kind);
  return found == kNe107.end() ? Ne107::failure : found->category;
}

/// The more pressing of the two.
[[nodiscard]] constexpr Ne107 worse(Ne107 a, Ne107 b) {
  return a == Ne107::good || (b != Ne107::good && b < a) ? b : a;
}

}  // namespace sealwatch
