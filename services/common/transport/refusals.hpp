// What Cyclone DDS says on standard error is read along: only there it tells whom DDS Security refused.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::transport {

/// From now on; once in a process. All goes to standard error as before.
void listen_to_cyclone();

/// Whether a line of Cyclone's says that somebody else was refused.
[[nodiscard]] bool tells_a_refusal(std::string_view line);

/// It is told once, as an alarm (refused_by_dds).
void note_refusal(const std::string& words);

}  // namespace sealwatch::transport
