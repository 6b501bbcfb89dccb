// The last resort of a stop: this process ends at a deadline, whatever its threads compute then. That is safe, as what
// counts is in the journal in whole transactions: killed at any instant, a service ends with the same results.
#pragma once

#include <chrono>

namespace sealwatch {

/// A service that was told to stop has this long to stop by itself.
inline constexpr std::chrono::milliseconds kServiceStops{1000};
/// A command has a little longer: it waits for the services that it started.
inline constexpr std::chrono::milliseconds kCommandStops{1800};

/// Once, before end_process_in.
void prepare_process_end();
/// May be called in a signal handler.
void end_process_in(std::chrono::milliseconds time, int exit_status);
/// It has stopped by itself.
void keep_process();

}  // namespace sealwatch
