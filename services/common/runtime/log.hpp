// Log lines that people read and scripts can cut: time, level, service, what happened, key=value.
//
//   2031-04-12T03:00:41.120Z info state_detection concluded topic=state_report pst=... asset=XT03-MV2 message=...
//
// Every line about a test carries pst= and asset=, so `grep pst=ID *.log` follows one test through all services.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

SEALWATCH_ENUM(LogLevel, trace, debug, info, warn, error)

using LogFields = std::vector<std::pair<std::string_view, std::string>>;

/// From now on lines go to standard error or, where the configuration names a directory, to "<service>.log" in it (then
/// standard error gets warnings and errors alone). A full file is renamed to "<service>.1.log" and so on. Before this
/// call nothing is logged.
[[nodiscard]] Status start_logging(const LoggingConfig& config, const std::string& service);
/// Nothing is logged any more. For a copy of a process: a thread that it has not got may have been within a line.
void silence_log();
/// Writes what is buffered and closes the file.
void stop_logging();

[[nodiscard]] bool logs(LogLevel level);
/// Values with spaces or quotes are quoted.
void log_event(LogLevel level, std::string_view event, const LogFields& fields = {});
/// The same with topic, pst, asset and message id of `message` in front.
void log_message(LogLevel level, std::string_view event, const Message& message, LogFields fields = {});

}  // namespace sealwatch
