// The last resort of a stop: this process ends at a deadline, whatever its threads compute then. That is safe, as what
// counts is in the journal in whole transactions: killed at any instant, a service ends with the same results.
#pragma once

#include <chrono>

namespace sealwatch {

/// A service that was told to stop has this long to stop by itself.
inline constexpr std::chrono::milliseconds kServiceStops{1000};
/// A command that started services has a little longer, as it waits for them.
inline constexpr std::chrono::milliseconds kSupervisorStops{1700};
/// What any other command still computes is lost all the same.
inline constexpr std::chrono::milliseconds kCommandStops{300};

/// Once, before end_process_in.
void prepare_process_end();
/// May be called in a signal handler.
void end_process_in(std::chrono::milliseconds time, int exit_status);
/// It has stopped by itself.
void keep_process();

}  // namespace sealwatch
