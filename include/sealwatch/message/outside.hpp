// Which topics come from outside the services, and what a service sends in place of a message that it has lost or whose
// samples it keeps no more.
#pragma once

#include <string_view>

namespace sealwatch {

/// Whether who writes it keeps a journal and beats: what comes from outside does neither.
[[nodiscard]] constexpr bool is_of_a_service(std::string_view topic) {
  return topic != "raw_samples" && topic != "acknowledgement" && topic != "maintenance_event" &&
         topic != "model_acceptance";
}

/// What the id of a message begins with that stands for one whose row in its writer's journal is damaged: readers count
/// on, and take nothing from it.
inline constexpr std::string_view kDamagedMessage = "damaged/";

/// What the id of a message begins with of which only the header could be read, as it has a value that is none here or
/// ends before it should: readers count on, and take nothing from it. Its own id follows.
inline constexpr std::string_view kUnreadableMessage = "unreadable/";

/// What the producer of a message begins with whose samples its writer keeps no more (retention): readers count on, and
/// conclude nothing from it.
inline constexpr std::string_view kExpired = "expired: ";
[[nodiscard]] constexpr bool is_expired(std::string_view producer) { return producer.starts_with(kExpired); }

}  // namespace sealwatch
